# SPDX-License-Identifier: Apache-2.0
"""Counts wrong tokens, so that an address that tries many costs little."""

import ipaddress
from collections import OrderedDict
from dataclasses import dataclass
from typing import Final

MAX_FAILURES: Final = 10  # of an address within a window: a person who pastes the wrong one
WINDOW_S: Final = 60.0
MAX_ADDRESSES: Final = 1024  # of which failures are remembered, 300 KB


@dataclass(slots=True)
class _Window:
    began_s: float
    failures: int = 0


class FailedAttempts:
    """The failures of each address in the last minute, or of each /64 network of IPv6."""

    def __init__(self) -> None:
        self._windows: OrderedDict[str, _Window] = OrderedDict()

    def __len__(self) -> int:
        """Count the addresses that are remembered."""
        return len(self._windows)

    def add(self, address: str, now_s: float) -> bool:
        """Count a failure, and return whether the address has had too many."""
        key = network_of(address)
        window = self._windows.pop(key, None)
        if window is None or now_s - window.began_s >= WINDOW_S:
            window = _Window(now_s)
        self._windows[key] = window  # the newest last
        if len(self._windows) > MAX_ADDRESSES:
            self._windows.popitem(last=False)
        window.failures += 1
        return window.failures > MAX_FAILURES


def network_of(address: str) -> str:
    """Return an IPv4 address, or the /64 of an IPv6 one: a host can use all addresses of it."""
    try:
        parsed = ipaddress.ip_address(address.partition("%")[0])
    except ValueError:
        return address
    if isinstance(parsed, ipaddress.IPv6Address):
        if parsed.ipv4_mapped is not None:
            return str(parsed.ipv4_mapped)
        return str(ipaddress.ip_network((parsed, 64), strict=False))
    return str(parsed)
