# SPDX-License-Identifier: Apache-2.0
"""The tasks of a source, whose failure nobody else would notice."""

import asyncio
import logging
import sys
from collections.abc import Awaitable, Sequence
from typing import TypeVar, cast

from gateway.faults import Fault

logger = logging.getLogger("gateway")

_Opened = TypeVar("_Opened")


async def unless(stop: asyncio.Event, opening: Awaitable[_Opened]) -> _Opened | None:
    """Open something, as a part of this task. Return ``None`` if *stop* comes first."""
    task = cast("asyncio.Task[object]", asyncio.current_task())
    is_open = False

    async def give_up() -> None:
        await stop.wait()
        if not is_open:
            task.cancel()

    waiting = asyncio.create_task(give_up())
    try:
        return await opening
    except asyncio.CancelledError:
        if not stop.is_set():
            raise
        if sys.version_info >= (3, 11):
            task.uncancel()
        return None
    finally:
        is_open = True
        waiting.cancel()


class SourceTasks:
    """Reports each task that a source began when it was opened, and that fails later."""

    def __init__(self) -> None:
        self._faults: list[Fault] = []

    async def watch(self, opening: Awaitable[_Opened]) -> _Opened:
        """Open a source, and watch the tasks that it leaves running."""
        others = asyncio.all_tasks()
        source = await opening
        for task in asyncio.all_tasks() - others:
            task.add_done_callback(self._ended)
        return source

    def faults(self) -> Sequence[Fault]:
        """Return what has failed."""
        return self._faults

    def _ended(self, task: asyncio.Task[object]) -> None:
        error = None if task.cancelled() else task.exception()
        if error is not None:
            text = f"task {task.get_name()} of the source has failed, {type(error).__name__}"
            logger.error("%s: restart the gateway", text, exc_info=error)
            self._faults.append(Fault("dead", f"{text}: it must be restarted"))
