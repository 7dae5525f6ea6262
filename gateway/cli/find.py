# SPDX-License-Identifier: Apache-2.0
"""The command `ros2-gateway find`: the gateways on this network."""

import contextlib
import socket
import time
from collections.abc import Iterator, Sequence
from typing import Final

from gateway.errors import GatewayError
from gateway.transport.lan_discovery import MAX_BYTES, PORT, FoundGateway, found, question

# All gateways of this machine hear the second, also without a network.
BROADCASTS: Final = ("255.255.255.255", "127.255.255.255")
ASK_AGAIN_S: Final = 0.4  # a datagram may be lost
MAX_FOUND: Final = 256


def gateways(
    wait_s: float, targets: Sequence[str] = BROADCASTS, port: int = PORT
) -> list[tuple[str, FoundGateway]]:
    """Return the gateways that answer within *wait_s*, each with its address, sorted by name."""
    seen: dict[tuple[str, str], FoundGateway] = {}
    for host, gateway in _answers(wait_s, targets, port):
        seen.setdefault((host, gateway.id), gateway)
        if len(seen) == MAX_FOUND:
            break
    elsewhere = {run for host, run in seen if not _is_loopback(host)}
    # from its own machine, a gateway is heard at two addresses: others can use only one
    found = [
        (host, gateway)
        for (host, run), gateway in seen.items()
        if not _is_loopback(host) or run not in elsewhere
    ]
    return sorted(found, key=lambda each: (each[1].name, each[0], each[1].port))


def lines(wait_s: float) -> list[str]:
    """Return a line for each gateway.

    Raises:
        GatewayError: no gateway has answered.
    """
    found = gateways(wait_s)
    if not found:
        raise GatewayError(
            "no gateway has answered: start one with --lan, and allow UDP port 9090 in its firewall"
            " (with discoverable=false, a gateway never answers)"
        )
    return [line(host, gateway) for host, gateway in found]


def line(host: str, gateway: FoundGateway) -> str:
    """Return what people need to connect."""
    parts = [gateway.url(host)]
    if gateway.tls_port is not None:
        parts.append(f"wss://{host}:{gateway.tls_port}{gateway.path}")
    access = "needs a token" if gateway.needs_token else "needs no token"
    return f"{gateway.name}  {' and '.join(parts)}  {access}, version {gateway.version}"


def _is_loopback(host: str) -> bool:
    return host.startswith("127.")


def _answers(
    wait_s: float, targets: Sequence[str], port: int
) -> Iterator[tuple[str, FoundGateway]]:
    end_s = time.monotonic() + wait_s
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asking:
        asking.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
        while (left_s := end_s - time.monotonic()) > 0:
            for target in targets:
                with contextlib.suppress(OSError):  # no network there
                    asking.sendto(question(), (target, port))
            next_s = time.monotonic() + min(left_s, ASK_AGAIN_S)
            while (left_s := next_s - time.monotonic()) > 0:
                asking.settimeout(left_s)
                with contextlib.suppress(OSError):
                    datagram, sender = asking.recvfrom(MAX_BYTES)
                    gateway = found(datagram)
                    if gateway is not None:
                        yield sender[0], gateway
