# SPDX-License-Identifier: Apache-2.0
"""Options of a client's socket, where the kernel has them; Linux has all."""

import contextlib
import socket
from typing import Final

# Frames wait where they can be dropped, and do not age in the kernel.
TCP_NOTSENT_LOWAT_BYTES: Final = 16 * 1024

# A stream of pictures has no pings: so the kernel asks after a peer that nothing is sent to.
KEEP_IDLE_S: Final = 15
KEEP_INTERVAL_S: Final = 5

# The gateway looks whether a client takes something, and says so in its log; the kernel, which ends
# a connection without a word, comes second.
KERNEL_SLACK_S: Final = 1


def tune(sock: socket.socket | None, send_deadline_s: float) -> None:
    """Bound the kernel's buffer, and let it give up on a peer that acknowledges nothing."""
    if sock is None:
        return
    with contextlib.suppress(OSError):
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for option, value in (
        ("TCP_NOTSENT_LOWAT", TCP_NOTSENT_LOWAT_BYTES),
        ("TCP_USER_TIMEOUT", round((send_deadline_s + KERNEL_SLACK_S) * 1000)),
        ("TCP_KEEPIDLE", KEEP_IDLE_S),
        ("TCP_KEEPINTVL", KEEP_INTERVAL_S),
    ):
        number = getattr(socket, option, None)
        if number is not None:
            with contextlib.suppress(OSError):
                sock.setsockopt(socket.IPPROTO_TCP, number, value)
