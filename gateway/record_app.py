# SPDX-License-Identifier: Apache-2.0
"""The composition root of `ros2-gateway record`: a robot, the core, and its only client."""

import asyncio
import logging
import os
import signal
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import AsyncExitStack

from gateway.access.audit import Audit
from gateway.access.permissions import UNLIMITED
from gateway.backports import Runner
from gateway.codec.image import confine_to_calling_thread
from gateway.codec.types import Types
from gateway.config.model import Config
from gateway.core.errors import ProtocolError
from gateway.core.missing_parts import complete
from gateway.core.router import Router
from gateway.definitions import known_definitions
from gateway.ending_signals import ENDING
from gateway.errors import UsageError
from gateway.memory import keep_large_blocks
from gateway.recording.active_recording import RecordingPlan, RecordingStatus
from gateway.recording.recorder import Recorder, recordings_directory
from gateway.sources.rclpy.configured import open_source
from schemas.table import Table

PROGRESS_S = 1.0

Show = Callable[[RecordingStatus], None]


def record(
    config: Config, plan: RecordingPlan, show: Show, was_interrupted: Callable[[], bool]
) -> RecordingStatus:
    """Record until one of the `ENDING` signals, or until the recording ends by itself.

    *show* gets the state once a second. A second signal ends the process at once. The next
    start completes its file.

    Raises:
        KeyboardInterrupt: the process *was_interrupted* before it handled signals itself.
        UsageError: this machine cannot record.
        ConfigError: ROS refuses its part of the configuration.
        RosMissingError: rclpy is missing.
    """
    with Runner() as runner:
        return runner.run(_record(config, plan, show, was_interrupted))


async def _record(
    config: Config, plan: RecordingPlan, show: Show, was_interrupted: Callable[[], bool]
) -> RecordingStatus:
    keep_large_blocks()
    confine_to_calling_thread()
    changed = asyncio.Event()
    stop = _handle_signals(changed)
    if was_interrupted():
        raise KeyboardInterrupt
    async with AsyncExitStack() as stack:
        definitions = known_definitions(config.types.paths, "types.paths")
        source = await stack.enter_async_context(open_source(config, definitions))
        workers = stack.enter_context(ThreadPoolExecutor(config.images.workers, "picture"))
        types, audit = Types(definitions), Audit(time.time_ns, level=logging.DEBUG)
        router = Router(
            complete(source),
            types,
            Table.load(),
            limits=config.limits,
            workers=workers,
            version="",
            audit=audit,
            control=config.control,
        )
        stack.callback(router.close)
        directory = recordings_directory(config.recording, os.environ)
        recorder = Recorder(router, types, directory, config.recording, audit)
        recorder.watch(changed.set)
        try:
            recorder.start(plan)
        except ProtocolError as error:
            raise UsageError(str(error)) from error
        while recorder.is_recording:
            show(recorder.status())
            if stop.is_set() and recorder.status().state in {"starting", "recording"}:
                recorder.stop(UNLIMITED)
            changed.clear()
            await _wait(changed, PROGRESS_S)
        return recorder.status()


def _handle_signals(changed: asyncio.Event) -> asyncio.Event:
    """Return an event that the first signal sets, with *changed*. The next one ends the process."""
    loop, stop = asyncio.get_running_loop(), asyncio.Event()

    def end() -> None:
        for number in ENDING:
            loop.remove_signal_handler(number)
            signal.signal(number, signal.SIG_DFL)
        stop.set()
        changed.set()

    for number in ENDING:
        loop.add_signal_handler(number, end)
    return stop


async def _wait(event: asyncio.Event, timeout_s: float) -> None:
    waiting = asyncio.ensure_future(event.wait())
    await asyncio.wait([waiting], timeout=timeout_s)
    waiting.cancel()
