# SPDX-License-Identifier: Apache-2.0
"""Writing several frames at once, so that a full socket is noticed on every version of Python."""

import asyncio
import sys
from collections.abc import Callable, Iterable
from typing import Final

from gateway.codec.chunks import Chunk

_Write = Callable[[Iterable[Chunk]], object]


# A join of fewer bytes is cheaper than a system call for each frame. A larger one delays others.
MOST_JOINED_BYTES: Final = 256 * 1024


def batch_writer(
    transport: asyncio.WriteTransport, version: tuple[int, ...] = sys.version_info[:3]
) -> _Write:
    """Return the function that writes several frames to a transport.

    That is `writelines`. In Python 3.12.0 to 3.12.8, 3.13.0 and 3.13.1 it never calls
    `pause_writing` (CVE-2024-12254), and a client that does not read would fill the memory. Before
    3.12, the one of asyncio joins all frames. In these versions, a few frames are joined into one
    copy, and the pieces of large frames are written one by one.
    """
    is_deaf = (3, 12) <= version < (3, 12, 9) or (3, 13) <= version < (3, 13, 2)
    joins = type(transport).writelines is asyncio.WriteTransport.writelines
    if not (is_deaf or joins):
        return transport.writelines

    def write(frames: Iterable[Chunk]) -> None:
        batch = list(frames)
        if sum(map(len, batch)) <= MOST_JOINED_BYTES:
            transport.write(b"".join(batch))
            return
        for piece in batch:
            transport.write(piece)

    return write
