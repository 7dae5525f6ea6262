# SPDX-License-Identifier: Apache-2.0
"""Servers for clients that block: an asynchronous context in a thread with its own loop."""

import asyncio
import contextlib
import threading
from collections.abc import Iterator
from concurrent.futures import Future
from contextlib import AbstractAsyncContextManager
from typing import TypeVar

T = TypeVar("T")

TIMEOUT_S = 240  # a gateway imports for a while on a busy machine


@contextlib.contextmanager
def in_background(context: AbstractAsyncContextManager[T]) -> Iterator[T]:
    """Enter `context` in a thread, which serves until this context is left."""
    entered: Future[tuple[T, asyncio.AbstractEventLoop, asyncio.Event]] = Future()

    async def serve() -> None:
        async with context as value:
            leave = asyncio.Event()
            entered.set_result((value, asyncio.get_running_loop(), leave))
            await leave.wait()

    def run() -> None:
        try:
            asyncio.run(serve())
        except BaseException as error:
            if entered.done():
                raise
            entered.set_exception(error)

    thread = threading.Thread(target=run, name="background")
    thread.start()
    value, loop, leave = entered.result(TIMEOUT_S)
    try:
        yield value
    finally:
        loop.call_soon_threadsafe(leave.set)
        thread.join(TIMEOUT_S)
