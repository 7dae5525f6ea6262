# SPDX-License-Identifier: Apache-2.0
"""A DDS domain for one test process and what it starts, which nobody else on the machine uses."""

import os
import socket
from typing import Final

# Above 101, the ports of a domain are those that Linux gives to anybody who asks for any.
DOMAINS: Final = range(1, 102)


def claim() -> int:
    """Return a domain that is this process's own until it ends."""
    first = os.getpid() % len(DOMAINS)
    for number in (*DOMAINS[first:], *DOMAINS[:first]):
        claimed = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        try:
            # an abstract address is not a file that could be left, and ends with the process
            claimed.bind(f"\0ros2-json-gateway/tests/dds-domain/{number}")
        except OSError:
            claimed.close()
            continue
        if not _is_in_use(number):
            claimed.detach()  # open from now on
            return number
        claimed.close()
    raise RuntimeError("somebody on this machine uses each of the DDS domains from 1 to 101")


def _is_in_use(domain: int) -> bool:
    """Return whether a robot, or other people's tests, have their first participant there."""
    discovery_port = 7400 + 250 * domain + 10  # DDSI-RTPS 2.5, 9.6.2.4: PB + DG * domain + d1
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind(("", discovery_port))
        except OSError:
            return True
    return False
