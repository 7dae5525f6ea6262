# SPDX-License-Identifier: Apache-2.0
"""Options of a client's socket, where the kernel has them; Linux has all."""

import contextlib
import socket
from typing import Final

# Frames wait where they can be dropped, and do not age in the kernel.
TCP_NOTSENT_LOWAT_BYTES: Final = 16 * 1024


def tune(sock: socket.socket | None, send_deadline_s: float) -> None:
    """Bound the kernel's buffer, and let it give up on a peer that acknowledges nothing."""
    if sock is None:
        return
    for option, value in (
        ("TCP_NOTSENT_LOWAT", TCP_NOTSENT_LOWAT_BYTES),
        ("TCP_USER_TIMEOUT", round(send_deadline_s * 1000)),
    ):
        number = getattr(socket, option, None)
        if number is not None:
            with contextlib.suppress(OSError):
                sock.setsockopt(socket.IPPROTO_TCP, number, value)
