# SPDX-License-Identifier: Apache-2.0
"""The address of a client behind reverse proxies, as those that are trusted report it."""

import ipaddress
import re
from collections.abc import Iterator, Sequence
from ipaddress import IPv4Network, IPv6Network
from typing import Final

from websockets.datastructures import Headers

Network = IPv4Network | IPv6Network

# RFC 7239, 4: for=192.0.2.60, for="[2001:db8::17]:4711", for=_hidden
_FOR: Final = re.compile(r'(?:^|;)\s*for\s*=\s*"?([^";]*)"?', re.IGNORECASE)
_WITH_PORT: Final = re.compile(r"^(?:\[(?P<v6>[^\]]+)\]|(?P<v4>[0-9.]+))(?::[0-9]+)?$")


def client_address(peer: str, headers: Headers, trusted: Sequence[Network]) -> str:
    """Return the address that counts as the client's.

    It is the nearest address that does not belong to a trusted proxy. Addresses beyond it are only
    the client's claim, and so is everything if the peer itself is not trusted.
    """
    address = peer
    if not _is_trusted(peer, trusted):
        return peer
    for hop in _hops(headers):
        plain = _plain(hop)
        if plain is None:  # hidden or malformed: the proxy that reports it is the nearest known
            return address
        address = plain
        if not _is_trusted(address, trusted):
            return address
    return address


def _hops(headers: Headers) -> Iterator[str]:
    """Yield the addresses that proxies report, the nearest first."""
    forwarded = ",".join(headers.get_all("Forwarded"))
    if forwarded:
        for element in reversed(forwarded.split(",")):
            found = _FOR.search(element)
            yield found[1].strip() if found else ""
        return
    named = ",".join(headers.get_all("X-Forwarded-For"))
    if named:
        yield from (hop.strip() for hop in reversed(named.split(",")))


def _plain(hop: str) -> str | None:
    """Return an address without port and brackets, or ``None`` if it is something else."""
    with_port = _WITH_PORT.match(hop)
    text = (with_port["v6"] or with_port["v4"]) if with_port else hop
    try:
        return str(ipaddress.ip_address(text))
    except ValueError:
        return None


def _is_trusted(address: str, trusted: Sequence[Network]) -> bool:
    if not trusted:
        return False
    try:
        parsed = ipaddress.ip_address(address.partition("%")[0])
    except ValueError:
        return False
    if isinstance(parsed, ipaddress.IPv6Address) and parsed.ipv4_mapped is not None:
        parsed = parsed.ipv4_mapped  # an IPv4 peer of a socket that serves both
    return any(parsed in network for network in trusted)
