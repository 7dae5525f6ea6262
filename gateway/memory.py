# SPDX-License-Identifier: Apache-2.0
"""Memory: large blocks that are kept, and objects that are not searched for garbage."""

import ctypes
import gc
from typing import Final

# from malloc.h of glibc
_M_TRIM_THRESHOLD: Final = -1
_M_MMAP_THRESHOLD: Final = -3

_LARGEST_KEPT_BYTES: Final = 32 * 1024**2  # the most that glibc allows; an 8K picture is larger
_FREE_KEPT_BYTES: Final = 64 * 1024**2  # a dozen 1080p pictures in transit, as rgb8


def keep_large_blocks() -> None:
    """Serve blocks up to 32 MiB from the heap, and keep up to 64 MiB of it when they are freed.

    By default glibc maps a large block anew for each message and unmaps it after, and the kernel
    clears every page of it: for a 640x480 picture on its way through rclpy that is 640 page
    faults, 1.3 ms, more than encoding it takes. Does nothing with another C library.
    """
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (AttributeError, OSError, TypeError):  # TypeError: CDLL(None) on Windows
        return
    mallopt(_M_MMAP_THRESHOLD, _LARGEST_KEPT_BYTES)
    mallopt(_M_TRIM_THRESHOLD, _FREE_KEPT_BYTES)


def exempt_from_collection() -> None:
    """Exempt what exists now from garbage collection.

    A full collection looks at each object: the 50,000 of an idle gateway take 20 ms, in which
    nobody is served. Call this when all parts stand.
    """
    gc.freeze()
