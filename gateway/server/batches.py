# SPDX-License-Identifier: Apache-2.0
"""Writing several frames at once, so that a full socket is noticed on every version of Python."""

import asyncio
import sys
from collections.abc import Callable, Iterable

from gateway.codec.pieces import Piece

_Write = Callable[[Iterable[Piece]], object]


def batch_writer(
    transport: asyncio.WriteTransport, version: tuple[int, ...] = sys.version_info[:3]
) -> _Write:
    """Return the function that writes several frames to a transport.

    That is `writelines`. In Python 3.12.0 to 3.12.8, 3.13.0 and 3.13.1 it never calls
    `pause_writing` (CVE-2024-12254), and a client that does not read would fill the memory; there
    the frames are joined, which costs a copy, and written as one.
    """
    if (3, 12) <= version < (3, 12, 9) or (3, 13) <= version < (3, 13, 2):
        return lambda frames: transport.write(b"".join(frames))
    return transport.writelines
