# SPDX-License-Identifier: Apache-2.0
"""A TCP connection as Linux knows it, by ``struct tcp_info`` (linux/tcp.h)."""

import socket
import struct
from typing import Final

from gateway.server.link import Reading

# its members, and where Linux 4.19 and later have them
_READ_BYTES: Final = 216
_ACKED: Final = struct.Struct("=120xQ")  # tcpi_bytes_acked
_UNSENT_AND_MIN_RTT: Final = struct.Struct("=144xII")  # tcpi_notsent_bytes, tcpi_min_rtt in us
_SENT: Final = struct.Struct("=200xQQ")  # tcpi_bytes_sent, tcpi_bytes_retrans
_OPTION: Final[int | None] = getattr(socket, "TCP_INFO", None)
_UNKNOWN_RTT_US: Final = 0xFFFFFFFF


def read_tcp_info(sock: socket.socket | None) -> Reading | None:
    """Return what the kernel knows; ``None`` if it does not say. It takes 1 to 3 us."""
    if sock is None or _OPTION is None:
        return None
    try:
        info = sock.getsockopt(socket.IPPROTO_TCP, _OPTION, _READ_BYTES)
    except OSError:  # it has just been closed, or is no TCP
        return None
    if len(info) < _READ_BYTES:  # an older kernel
        return None
    (acked,) = _ACKED.unpack_from(info)
    unsent, min_rtt_us = _UNSENT_AND_MIN_RTT.unpack_from(info)
    sent, sent_again = _SENT.unpack_from(info)
    min_rtt_s = 0.0 if min_rtt_us == _UNKNOWN_RTT_US else min_rtt_us / 1e6
    return Reading(acked, sent - sent_again - acked + unsent, min_rtt_s)
