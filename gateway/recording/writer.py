# SPDX-License-Identifier: Apache-2.0
"""The thread that writes a recording: a slow disk delays nobody but it."""

import contextlib
import itertools
import logging
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal

from gateway.config.recording import RecordingConfig
from gateway.errors import system_reason
from gateway.recording.disk import MOST_AT_ONCE, MOST_AT_ONCE_BYTES, PAUSE_S, why_full
from gateway.recording.entries import RecordedMessage, RecordedNote
from gateway.recording.waiting import WaitingMessages

if TYPE_CHECKING:  # the package mcap may be missing
    from gateway.recording.mcap_file import RecordingFile

# A killed process loses what came in both together and in the time of a write: less than 1 s.
SYNC_S: Final = 0.75
LOOK_S: Final = 0.1
# Until so much waits, nobody wakes the thread: it looks by itself.
WAKE_BYTES: Final = 4 * 1024**2
# Starts and ends of episodes. Each has up to 400 characters.
MAX_WAITING_NOTES: Final = 1000
# Between two looks at the free space.
MAX_UNCHECKED_BYTES: Final = 1024**2

State = Literal["starting", "recording", "stopping", "stopped"]

logger = logging.getLogger(__name__)


class RecordingWriter:
    """Writes the files of one recording in a thread, until it is stopped or the disk is full.

    *on_change* is called by the thread, whenever `state` has changed. `why` is the reason of an end
    by itself.
    """

    def __init__(
        self,
        folder: Path,
        config: RecordingConfig,
        library: str,
        on_change: Callable[[], None],
        distro: str = "",
    ) -> None:
        """Create the *folder*, or one with a number if it exists."""
        self.folder = folder
        self.why = ""
        self.waiting = WaitingMessages(config.queue_bytes)
        self.messages = 0
        self._config = config
        self._library = library
        self._distro = distro
        self._on_change = on_change
        self._notes: deque[RecordedNote] = deque()
        self._has_begun = self._is_stopping = self._is_over = False
        self._wake = threading.Event()
        self._complete_bytes = 0  # of all files but the one that is being written
        self._file_bytes = 0
        self._files = 0
        self._thread = threading.Thread(target=self._run, name="recording", daemon=True)
        self._thread.start()

    @property
    def state(self) -> State:
        """The state of the recording."""
        if self._is_over:
            return "stopped"
        if self._is_stopping:
            return "stopping"
        return "recording" if self._has_begun else "starting"

    @property
    def size(self) -> int:
        """The bytes in all files."""
        return self._complete_bytes + self._file_bytes

    def put(self, message: RecordedMessage) -> None:
        """Have a message written soon. This does not wait."""
        waiting = self.waiting
        waiting.put(message)
        if waiting.size > WAKE_BYTES and not self._wake.is_set():
            self._wake.set()

    @property
    def is_full_of_notes(self) -> bool:
        """True while no more metadata records should come, but the last one."""
        return len(self._notes) >= MAX_WAITING_NOTES

    def note(self, note: RecordedNote) -> None:
        """Have a metadata record written soon."""
        self._notes.append(note)

    def stop(self) -> None:
        """Write what waits, and complete the file. `state` says when that is done."""
        self._is_stopping = True
        self._wake.set()

    def join(self, timeout_s: float) -> None:
        """Wait for the end of the thread after `stop`."""
        self._thread.join(timeout_s)

    def _run(self) -> None:
        try:
            self._write_files()
        except OSError as error:
            self.why = f"cannot write {self.folder}, {system_reason(error)}"
        except Exception:
            self.why = "an internal error, which the log has"
            logger.exception("the recording has ended")
        self._is_over = True
        self._tell()

    def _write_files(self) -> None:
        # not before: the package mcap may be missing
        from gateway.recording.folder import write_metadata

        self.folder = _create(self.folder)
        self.why = why_full(self.folder, self._config)
        if self.why:
            self.folder.rmdir()
            return
        is_over = False
        while not is_over:
            is_over = self._write_file()
            write_metadata(self.folder, self._distro)

    def _write_file(self) -> bool:
        """Write the next file. Return whether it is the last one."""
        from gateway.recording.mcap_file import RecordingFile

        file = RecordingFile(self.folder / f"{self.folder.name}_{self._files}.mcap", self._library)
        try:
            if not self._has_begun:
                self._has_begun = True
                self._tell()
            is_over = self._fill(file)
            path = file.finish()
        except BaseException:
            file.abandon()
            raise
        self._files += 1
        self._complete_bytes += path.stat().st_size
        self._file_bytes = 0
        return is_over

    def _fill(self, file: "RecordingFile") -> bool:
        """Write until the file is full, or the recording over. Return whether it is over."""
        config = self._config
        began_s = synced_s = time.monotonic()
        while True:
            self._wake.wait(LOOK_S)
            self._wake.clear()
            is_stopping = self._is_stopping  # before what came until then is taken
            self._write(file, self.waiting.take())
            while self._notes:
                file.note(self._notes.popleft())
            self._file_bytes = file.size
            if is_stopping or self.why:
                return True
            now_s = time.monotonic()
            if now_s - synced_s >= SYNC_S:
                file.sync()
                synced_s = now_s
            is_long = config.max_file_s is not None and now_s - began_s >= config.max_file_s
            if is_long or file.size >= config.max_file_bytes:
                return False

    def _write(self, file: "RecordingFile", messages: Sequence[RecordedMessage]) -> None:
        """Write messages while the disk has room. Let the event loop run in between."""
        unchecked = MAX_UNCHECKED_BYTES
        count = size = 0
        for message in (*messages, None):
            if count >= MOST_AT_ONCE or size >= MOST_AT_ONCE_BYTES or message is None:
                self.waiting.written(count, size)
                unchecked += size
                count = size = 0
                time.sleep(PAUSE_S)
            if unchecked >= MAX_UNCHECKED_BYTES:
                unchecked = 0
                self.why = why_full(self.folder, self._config)
            if message is None or self.why:
                return
            file.add(message)
            self.messages += 1
            count += 1
            size += len(message.cdr)

    def _tell(self) -> None:
        with contextlib.suppress(RuntimeError):  # the loop is closed
            self._on_change()


def _create(folder: Path) -> Path:
    """Create a directory. If another process has just created it, create the next one."""
    names = (f"{folder.name}_{number}" for number in itertools.count(2))
    new = folder
    while True:
        try:
            new.mkdir(parents=True)
        except FileExistsError:
            new = folder.with_name(next(names))
        else:
            return new
