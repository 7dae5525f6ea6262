# SPDX-License-Identifier: Apache-2.0
"""The recorder: it makes one recording at a time."""

import asyncio
import logging
import threading
from collections.abc import Callable, Mapping, Sequence
from datetime import datetime
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import Final

from gateway.access.audit import Audit
from gateway.access.permissions import Identity
from gateway.codec.types import Types
from gateway.config.recording import RecordingConfig
from gateway.core.errors import ProtocolError
from gateway.core.router import Router
from gateway.errors import HOW_TO_GET_RECORDINGS
from gateway.faults import Fault
from gateway.recording.active_recording import (
    ActiveRecording,
    Mark,
    RecordingPlan,
    RecordingStatus,
)
from gateway.recording.entries import incomplete
from gateway.recording.writer import RecordingWriter

# Names of sources that do not know the distribution of the robot.
_NO_DISTROS: Final = {"recording", "zenoh"}

logger = logging.getLogger(__name__)


def recordings_directory(config: RecordingConfig, environment: Mapping[str, str]) -> Path:
    """Return where recordings are, by default as the XDG Base Directory Specification says."""
    if config.directory is not None:
        return Path(config.directory)
    base = environment.get("XDG_DATA_HOME", "")
    # the specification: a relative path is invalid, and ignored
    folder = Path(base) if base.startswith("/") else Path.home() / ".local" / "share"
    return folder / "ros2-gateway" / "recordings"


class Recorder:
    """Makes one recording at a time. It belongs to nobody: it goes on when its client leaves."""

    def __init__(
        self, router: Router, types: Types, directory: Path, config: RecordingConfig, audit: Audit
    ) -> None:
        """Complete what a killed process left in the *directory*, in a thread."""
        self._router = router
        self._types = types
        self._directory = directory
        self._config = config
        self._audit = audit
        self._library = f"ros2-json-gateway {version('ros2-json-gateway')}"
        self._watching: list[Callable[[], None]] = []
        self._recording: ActiveRecording | None = None
        if find_spec("mcap") is not None:
            threading.Thread(target=self._repair, name="repair", daemon=True).start()

    def watch(self, on_change: Callable[[], None]) -> None:
        """Call *on_change* whenever a recording has begun or ended."""
        self._watching.append(on_change)

    @property
    def is_recording(self) -> bool:
        """True until everything is in the file."""
        return self._recording is not None and not self._recording.is_over

    def start(self, plan: RecordingPlan) -> None:
        """Begin to record. `status` says when the file is open, or why it cannot be.

        Raises:
            ProtocolError: a recording is under way, or this machine cannot record.
        """
        if self._recording is not None and self.is_recording:
            name = self._recording.folder.name
            text = f"at most 1 recording at a time, and {name} is under way: stop it first"
            raise ProtocolError("limit_exceeded", text)
        if find_spec("mcap") is None:
            raise ProtocolError("not_found", f"mcap is missing: {HOW_TO_GET_RECORDINGS}")
        name = datetime.now().astimezone().strftime("recording_%Y-%m-%d_%H-%M-%S")
        folder = self._directory / name
        loop = asyncio.get_running_loop()

        def on_change() -> None:
            loop.call_soon_threadsafe(self._on_state)

        writer = RecordingWriter(folder, self._config, self._library, on_change, self._distro)
        self._recording = ActiveRecording(self._router, self._types, writer, plan)
        self._audit.follow(self._recording.write_event)
        self._record("recording_started", plan.identity)

    def stop(self, identity: Identity, *, success: bool | None = None) -> None:
        """End the recording. `is_recording` says when its file is complete.

        Raises:
            ProtocolError: there is no recording.
        """
        recording = self._current()
        self._record("recording_stopped", identity)
        recording.stop(success=success)

    def mark(self, mark: Mark, identity: Identity) -> None:
        """Write a text into the recording, and begin or end an episode.

        Raises:
            ProtocolError: there is no recording, or no episode to end.
        """
        self._current().mark(mark, identity)

    def status(self) -> RecordingStatus:
        """Return the state of the current recording, or of the last one."""
        if self._recording is None:
            return RecordingStatus(state="stopped")
        return self._recording.status()

    def faults(self) -> Sequence[Fault]:
        """Return why a recording has ended by itself, or lacks messages."""
        status = self.status()
        if status.why:
            return (Fault("degraded", f"the recording has ended: {status.why}"),)
        if self.is_recording and status.dropped:
            text = "the recording lacks messages, because the disk is too slow: record less"
            return (Fault("degraded", text),)
        return ()

    def close(self, timeout_s: float) -> None:
        """Complete the file, for a limited time."""
        if self._recording is not None and self.is_recording:
            if not self._recording.is_stopping:
                self._recording.stop()
            self._recording.join(timeout_s)
            self._on_state()

    @property
    def _distro(self) -> str:
        distro = self._router.ros.distro
        return "" if distro in _NO_DISTROS else distro

    def _current(self) -> ActiveRecording:
        if self._recording is None or self._recording.is_stopping:
            raise ProtocolError("not_found", "nothing is being recorded: start a recording first")
        return self._recording

    def _on_state(self) -> None:
        recording = self._recording
        if recording is not None and recording.status().state == "stopped" and self.is_recording:
            recording.end()
            self._audit.unfollow(recording.write_event)
            if why := recording.status().why:
                logger.error("the recording %s has ended: %s", recording.folder, why)
                self._audit.record("recording_ended", reason=why)
        for on_change in self._watching:
            on_change()

    def _record(self, event: str, identity: Identity) -> None:
        self._audit.record(event, name=identity.name, role=identity.role)

    def _repair(self) -> None:
        if incomplete(self._directory):  # else nothing is imported
            from gateway.recording.folder import repair_all

            repair_all(self._directory, self._config, self._library, self._distro)
