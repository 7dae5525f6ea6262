# SPDX-License-Identifier: Apache-2.0
"""The file of the audit log. A thread writes it, so that a disk that hangs delays nothing."""

import contextlib
import errno
import logging
import os
import queue
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from gateway.errors import ConfigError, system_reason
from gateway.faults import Fault

MAX_WAITING: Final = 1000  # lines, 300 KB. If the disk hangs, the newest are lost
FLUSH_S: Final = 0.3  # at the end, for what still waits: the whole shutdown has 2 s

logger = logging.getLogger(__name__)


class AuditFile:
    """Appends lines to a file of mode 0600. A full one replaces FILE.1.

    Raises:
        ConfigError: the file cannot be opened.
    """

    def __init__(self, path: Path, max_bytes: int) -> None:
        self._path = path
        self._max_bytes = max_bytes
        self._lines: queue.Queue[str | None] = queue.Queue(MAX_WAITING)
        self._lost = 0  # counted on the caller's side, and by the thread
        self._is_failing = False
        try:
            self._descriptor = self._open()
        except OSError as error:
            raise ConfigError(f"audit.file: cannot write {path}, {system_reason(error)}") from error
        self._thread = threading.Thread(target=self._run, name="audit", daemon=True)
        self._thread.start()

    def write(self, line: str) -> None:
        """Have a line written soon. This does not wait, so the line is lost if too many wait."""
        try:
            self._lines.put_nowait(line)
        except queue.Full:
            self._lost += 1

    def faults(self) -> Sequence[Fault]:
        """Return whether lines are being lost."""
        if not self._is_failing and not self._lost:
            return ()
        return (Fault("degraded", "the audit log cannot be written, and its lines are lost"),)

    def close(self) -> None:
        """Write what waits, for a moment at most, and close the file."""
        try:
            self._lines.put(None, timeout=FLUSH_S)
        except queue.Full:
            return  # the disk hangs, and the thread ends with the process
        self._thread.join(FLUSH_S)

    def _run(self) -> None:
        while (line := self._lines.get()) is not None:
            try:
                self._append(line.encode() + b"\n")
            except OSError as error:
                self._lost += 1
                if not self._is_failing:
                    self._is_failing = True
                    logger.error("cannot write %s, %s", self._path, system_reason(error))
            else:
                if self._is_failing or self._lost:
                    lines = "1 line is" if self._lost == 1 else f"{self._lost} lines are"
                    logger.warning("%s: %s missing", self._path, lines)
                self._is_failing, self._lost = False, 0
        os.close(self._descriptor)

    def _append(self, data: bytes) -> None:
        size = os.fstat(self._descriptor).st_size
        if size and size + len(data) > self._max_bytes:
            with contextlib.suppress(FileNotFoundError):  # renamed, but then no room
                self._path.replace(self._path.with_name(f"{self._path.name}.1"))
            new = self._open()
            os.close(self._descriptor)
            self._descriptor = new
            size = 0
        written = os.write(self._descriptor, data)
        if written < len(data):  # the disk is full, and half a line is not JSON
            os.ftruncate(self._descriptor, size)
            raise OSError(errno.ENOSPC, "no space left on device")

    def _open(self) -> int:
        flags = os.O_WRONLY | os.O_CREAT | os.O_APPEND
        descriptor = os.open(self._path, flags, 0o600)
        os.fchmod(descriptor, 0o600)  # also if it existed
        return descriptor
