# SPDX-License-Identifier: Apache-2.0
"""Opens a recording in a thread for which nobody has to wait: large files take their time."""

import asyncio
import contextlib
import logging
import threading
from collections.abc import Sequence
from concurrent.futures import Future, InvalidStateError
from pathlib import Path

from gateway.sources.recording.errors import RecordingError
from gateway.sources.recording.recording import Recording, open_recording

logger = logging.getLogger(__name__)


async def opened(paths: Sequence[Path]) -> Recording:
    """Open files. If this is cancelled, reading ends soon, and the process need not wait for it.

    Raises:
        RecordingError: they cannot be played.
    """
    found: Future[Recording] = Future()

    def show(progress: str) -> None:
        if found.cancelled():
            raise RecordingError("nobody waits for the recording: start again")
        logger.info(progress)

    def run() -> None:
        with contextlib.suppress(InvalidStateError):  # cancelled
            try:
                recording = open_recording(paths, logger.warning, show)
            except BaseException as error:  # noqa: BLE001  # the one that waits gets it
                found.set_exception(error)
                return
            try:
                found.set_result(recording)
            except InvalidStateError:
                recording.close()

    threading.Thread(target=run, name="recording", daemon=True).start()
    return await asyncio.wrap_future(found)
