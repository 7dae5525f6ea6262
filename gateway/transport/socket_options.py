# SPDX-License-Identifier: Apache-2.0
"""Options of a client's socket, where the kernel has them. Linux has all."""

import contextlib
import socket
from typing import Final

# Frames wait where they can be dropped, and do not age in the kernel.
TCP_NOTSENT_LOWAT_BYTES: Final = 16 * 1024

# The kernel asks after a peer that nothing is on the way to, which answers even while its program
# stands still: a dead link is found within 12 s. It asks later than a ping by default would.
KEEP_IDLE_S: Final = 6
KEEP_INTERVAL_S: Final = 2
KEEP_COUNT: Final = 3


def tune(sock: socket.socket | None) -> None:
    """Bound the kernel's buffer, and let it find a dead link while nothing is sent.

    While something is on the way, `KeepAlive` judges. TCP_USER_TIMEOUT would cut off also a peer
    that lives and takes nothing for a while, and make the kernel ask for as long.
    """
    if sock is None:
        return
    with contextlib.suppress(OSError):
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for option, value in (
        ("TCP_NOTSENT_LOWAT", TCP_NOTSENT_LOWAT_BYTES),
        ("TCP_KEEPIDLE", KEEP_IDLE_S),
        ("TCP_KEEPINTVL", KEEP_INTERVAL_S),
        ("TCP_KEEPCNT", KEEP_COUNT),
    ):
        number = getattr(socket, option, None)
        if number is not None:
            with contextlib.suppress(OSError):
                sock.setsockopt(socket.IPPROTO_TCP, number, value)
