# SPDX-License-Identifier: Apache-2.0
"""Memory: what is kept for the next message, what goes back, and what is never searched."""

import asyncio
import ctypes
import gc
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Final

# from malloc.h of glibc
_M_TRIM_THRESHOLD: Final = -1
_M_MMAP_THRESHOLD: Final = -3

_LARGEST_KEPT_BYTES: Final = 32 * 1024**2  # the most that glibc allows. An 8K image is larger
_FREE_KEPT_BYTES: Final = 64 * 1024**2  # a dozen 1080p pictures in transit, as rgb8

# Memory of a peak is returned after this time. It costs 4 ms, and page faults for the next images.
RETURN_S: Final = 60.0


def keep_large_blocks() -> None:
    """Serve blocks up to 32 MiB from the heap, and keep up to 64 MiB of it when they are freed.

    By default glibc maps and unmaps a large block for each message, and the kernel clears every
    page of it. For a 640x480 image in rclpy that is 640 page faults or 1.3 ms, more than encoding
    takes. Does nothing with another C library.
    """
    mallopt = _libc_function("mallopt")
    if mallopt is not None:
        mallopt(_M_MMAP_THRESHOLD, _LARGEST_KEPT_BYTES)
        mallopt(_M_TRIM_THRESHOLD, _FREE_KEPT_BYTES)


@contextmanager
def returning_free_memory() -> Iterator[None]:
    """Give free pages back to the kernel, every `RETURN_S`, until the context ends.

    Otherwise the memory for large blocks would only grow. Each peak leaves holes between blocks
    that live for long, and the next peak finds no hole of its size. Does nothing with another C
    library.
    """
    trim = _libc_function("malloc_trim")
    if trim is None:
        yield
        return
    loop = asyncio.get_running_loop()
    timer: asyncio.TimerHandle | None = None

    def wait() -> None:
        nonlocal timer
        timer = loop.call_later(RETURN_S, give_back)

    def give_back() -> None:
        trim(0)
        wait()

    wait()
    try:
        yield
    finally:
        if timer is not None:
            timer.cancel()


def exempt_from_collection() -> None:
    """Exempt what exists now from garbage collection.

    A full collection looks at each object: the 50,000 of an idle gateway take 20 ms, in which
    nobody is served. Call this when all parts stand.
    """
    gc.freeze()


def _libc_function(name: str) -> Any | None:
    try:
        return getattr(ctypes.CDLL(None), name)
    except (AttributeError, OSError, TypeError):  # TypeError: CDLL(None) on Windows
        return None
