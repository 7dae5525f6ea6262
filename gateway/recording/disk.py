# SPDX-License-Identifier: Apache-2.0
"""The disk of a recording: its free space, and how much a thread writes to it at once."""

import os
from pathlib import Path
from typing import Final

from gateway.config.recording import RecordingConfig
from gateway.errors import GatewayError

# A thread holds the GIL for so many messages, 0.1 ms, and gives it back. Without a pause the
# event loop waits for 5 ms (`sys.getswitchinterval`).
MOST_AT_ONCE: Final = 16
MOST_AT_ONCE_BYTES: Final = 64 * 1024
PAUSE_S: Final = 0.0001


class DiskFullError(GatewayError):
    """Raised before something would take the space that is to stay free."""


def why_full(folder: Path, config: RecordingConfig, more: int = 0) -> str:
    """Return why no *more* bytes may be written, or "" while there is room.

    Raises:
        OSError: the disk cannot be asked.
    """
    disk = os.statvfs(folder)
    free = disk.f_bavail * disk.f_frsize
    share = config.min_free_share * disk.f_blocks * disk.f_frsize
    setting = "min_free_bytes" if config.min_free_bytes <= share else "min_free_share"
    least = min(config.min_free_bytes, share)
    if free - more >= least:
        return ""
    return (
        f"the disk has {free / 1e6:.0f} MB left, and {least / 1e6:.0f} MB are to stay free:"
        f" delete old recordings, or lower recording.{setting}"
    )
