# SPDX-License-Identifier: Apache-2.0
"""The shared memory that Fast DDS leaves behind when its process is killed.

Each participant writes its samples into its segment (0.5 MB, more for large messages) and holds a
lock on a file next to it. A participant that ends removes both. If one is killed, another one that
has received from it removes them. Otherwise they stay until the machine restarts or a person calls
``fastdds shm clean``.

A participant that was refused its segment leaves an empty one, without a lock.

A process that is killed while it writes to another one, or reads, keeps the mutex of that port.
Fast DDS waits 1 s for it before it gives up (``BOOST_INTERPROCESS_TIMEOUT_WHEN_LOCKING``).
"""

import contextlib
import fcntl
import logging
import os
import re
import resource
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from gateway.log_fields import counted
from gateway.sources.rclpy import fast_dds
from gateway.sources.source import RosError

FOLDER: Final = Path("/dev/shm")  # noqa: S108  # where POSIX' shm_open puts it on Linux
# A participant that starts creates the file first, and takes the lock a moment later.
MIN_AGE_S: Final = 2
NEEDED_BYTES: Final = 16 * 1024  # by lttng-ust, which rclpy loads: two pages, which stay

# Fast DDS 2, Fast DDS 3. Ports have other names, and are used again by the next participant.
_SEGMENT: Final = re.compile(r"(fastrtps|fastdds)_[0-9a-f]{16}")
LOCK: Final = re.compile(rf"{_SEGMENT.pattern}_el")

_logger = logging.getLogger(__name__)


def remove_abandoned_segments(folder: Path = FOLDER) -> int:
    """Remove the segments of this user whose owner is dead, and return their number.

    A process that still reads one keeps it until it has finished.
    """
    removed = 0
    with contextlib.suppress(OSError):  # there is no such folder
        for path in list(folder.iterdir()):
            if LOCK.fullmatch(path.name):
                with contextlib.suppress(OSError):  # it is locked, or has gone
                    removed += _remove_if_abandoned(path)
            elif _SEGMENT.fullmatch(path.name):
                with contextlib.suppress(OSError):  # it has gone
                    _remove_if_refused(path)
    if removed:
        segments = counted(removed, "segment")
        _logger.info("removed %s of shared memory that killed programs left", segments)
    return removed


@contextlib.contextmanager
def without_shared_memory() -> Iterator[None]:
    """Keep Fast DDS from creating shared memory for the participants of this context.

    They send and receive only by UDP. A profile cannot say so, because rmw chooses the transports
    itself for the discovery range LOCALHOST. In this context the process cannot write to files: the
    log waits in its buffer. Python ignores SIGXFSZ. Enter it before `fast_dds.profile`.
    """
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    with fast_dds.silence():  # it reports as an error that there is no shared memory
        resource.setrlimit(resource.RLIMIT_FSIZE, (0, hard))
        try:
            yield
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def needed_bytes(folder: Path = FOLDER) -> int:
    """Return how many bytes must be free to start ROS, 0 if this user has started it before."""
    pages = folder.glob(f"lttng-ust-wait-*-{os.geteuid()}")
    return 0 if any(page.stat().st_blocks for page in pages) else NEEDED_BYTES


def check_room(folder: Path = FOLDER) -> None:
    """Check that ROS can start. DDS itself does without shared memory if there is little room.

    Raises:
        RosError: there is no room.
    """
    try:
        found = os.statvfs(folder)
    except OSError:  # no such folder: DDS does without
        return
    free = found.f_bavail * found.f_frsize
    if found.f_blocks and free < needed_bytes(folder):
        raise RosError(
            "internal",
            f"no space left in {folder}, {free} bytes free, needs {NEEDED_BYTES}: remove files"
            " there, for example with `fastdds shm clean`",
        )


def _remove_if_abandoned(lock: Path) -> bool:
    descriptor = os.open(lock, os.O_RDONLY | os.O_NOFOLLOW | os.O_CLOEXEC)
    try:
        status = os.fstat(descriptor)
        if status.st_uid != os.geteuid() or time.time() - status.st_mtime < MIN_AGE_S:
            return False
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)  # raises if its owner lives
        lock.with_name(lock.name.removesuffix("_el")).unlink(missing_ok=True)
        lock.unlink()
    finally:
        os.close(descriptor)
    return True


def _remove_if_refused(segment: Path) -> None:
    """Remove what `without_shared_memory` leaves, and a full disk. The size needs no report."""
    status = segment.lstat()
    is_old = status.st_uid == os.geteuid() and time.time() - status.st_mtime >= MIN_AGE_S
    if is_old and not status.st_size and not segment.with_name(f"{segment.name}_el").exists():
        segment.unlink()
