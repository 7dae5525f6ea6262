# SPDX-License-Identifier: Apache-2.0
"""A client's socket: its options, and its state as Linux knows it.

The state is ``struct tcp_info`` (linux/tcp.h). Linux has all options.
"""

import contextlib
import socket
import struct
from typing import Final

from gateway.transport.link import Reading

with contextlib.suppress(ImportError):  # Windows has neither, nor TCP_INFO
    import fcntl
    import termios

# Frames wait where they can be dropped, and do not age in the kernel.
TCP_NOTSENT_LOWAT_BYTES: Final = 16 * 1024

# The kernel asks after a peer that nothing is on the way to, which answers even while its program
# stands still: a dead link is found within 12 s. It asks later than a ping by default would.
KEEP_IDLE_S: Final = 6
KEEP_INTERVAL_S: Final = 2
KEEP_COUNT: Final = 3

# the members of tcp_info, and where Linux 4.9 and later have them
_READ_BYTES: Final = 152
_UNACKED: Final = struct.Struct("=24xI28xI")  # tcpi_unacked, tcpi_last_ack_recv in ms
_ACKED: Final = struct.Struct("=120xQ")  # tcpi_bytes_acked
_MIN_RTT: Final = struct.Struct("=148xI")  # tcpi_min_rtt in us
_QUEUED: Final = struct.Struct("=i")
_OPTION: Final[int | None] = getattr(socket, "TCP_INFO", None)
_ESTABLISHED: Final = 1  # of tcpi_state, its first byte
_UNKNOWN_RTT_US: Final = 0xFFFFFFFF


def read_tcp_info(sock: socket.socket | None) -> Reading | None:
    """Return what the kernel knows, or ``None`` if it does not say. It takes 1 to 3 us."""
    if sock is None or _OPTION is None:
        return None
    try:
        info = sock.getsockopt(socket.IPPROTO_TCP, _OPTION, _READ_BYTES)
        # SIOCOUTQ of tcp(7): tcpi_bytes_sent counts twice what the first queue has dropped
        queued = fcntl.ioctl(sock.fileno(), termios.TIOCOUTQ, bytes(_QUEUED.size))
    except OSError:  # it has just been closed, or is not TCP
        return None
    if len(info) < _READ_BYTES:  # an older kernel
        return None
    unacked, last_ack_ms = _UNACKED.unpack_from(info)
    (acked,) = _ACKED.unpack_from(info)
    (min_rtt_us,) = _MIN_RTT.unpack_from(info)
    min_rtt_s = 0.0 if min_rtt_us == _UNKNOWN_RTT_US else min_rtt_us / 1e6
    # with a closed window nothing is unacknowledged: the peer's kernel lives, and takes nothing
    unanswered_s = last_ack_ms / 1e3 if unacked else 0.0
    return Reading(acked, _QUEUED.unpack(queued)[0], min_rtt_s, unanswered_s)


def is_ended(sock: socket.socket | None) -> bool:
    """Return whether the peer has closed its side, which no read may have come to yet."""
    if sock is None or _OPTION is None:
        return False
    try:
        return sock.getsockopt(socket.IPPROTO_TCP, _OPTION, 1)[0] != _ESTABLISHED
    except OSError:
        return False


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
