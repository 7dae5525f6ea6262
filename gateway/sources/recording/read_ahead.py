# SPDX-License-Identifier: Apache-2.0
"""A thread that reads a recording, some batches before they are played."""

import asyncio
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import islice
from typing import Final, NamedTuple

from gateway.sources.recording.recording import Recording
from gateway.sources.recording.tracks import Recorded

BATCH_MESSAGES: Final = 256
BATCH_BYTES: Final = 4 * 1024 * 1024  # and one message more, however large
BATCHES: Final = 3  # that wait to be played, or are being read


class ReadBatch(NamedTuple):
    """Messages that follow each other."""

    messages: Sequence[Recorded]
    latched: Sequence[Recorded] | None = None  # of the first batch: what latched topics hold
    is_last: bool = False
    error: Exception | None = None  # that ended the reading


class ReadAhead:
    """Batches from a position on. *on_batch* is called on the loop when one has come."""

    def __init__(self, recording: Recording, on_batch: Callable[[], None]) -> None:
        self._recording = recording
        self._on_batch = on_batch
        self._loop = asyncio.get_running_loop()
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="recording")
        self._messages: Iterator[Recorded] = iter(())  # of the thread
        self._seeks = 0  # a number of the newest position. Reading from an older one ends early
        self._waiting: deque[Future[ReadBatch]] = deque()

    def seek(self, position_ns: int) -> None:
        """Forget what was read, and read from *position_ns* on."""
        self._forget()
        number = self._seeks
        self._submit(lambda: self._begin(position_ns, lambda: number == self._seeks))

    def take(self) -> ReadBatch | None:
        """Return the next batch, or ``None`` if it has not come. None follows the last one."""
        if not self._waiting or not self._waiting[0].done():
            return None
        batch = self._waiting.popleft().result()
        if batch.is_last:
            self._forget()
        else:
            self._fill()
        return batch

    def close(self) -> None:
        """End the thread and close the files. This waits for the batch that is being read."""
        self._forget()
        self._thread.submit(self._recording.close)
        self._thread.shutdown(wait=True)

    def _forget(self) -> None:
        self._seeks += 1
        for batch in self._waiting:
            batch.cancel()
        self._waiting.clear()

    def _fill(self) -> None:
        while len(self._waiting) < BATCHES:
            self._submit(self._next)

    def _submit(self, read: Callable[[], ReadBatch]) -> None:
        batch = self._thread.submit(read)
        self._waiting.append(batch)
        batch.add_done_callback(lambda _: self._tell())

    def _tell(self) -> None:
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._on_batch)

    # In the thread

    def _begin(self, position_ns: int, is_wanted: Callable[[], bool]) -> ReadBatch:
        try:
            latched = self._recording.latched_before(position_ns, is_wanted)
        except Exception as error:  # noqa: BLE001  # of the libraries, whose kinds are many
            return ReadBatch((), is_last=True, error=error)
        self._messages = self._recording.messages(position_ns)
        return self._next()._replace(latched=latched)

    def _next(self) -> ReadBatch:
        found: list[Recorded] = []
        size = 0
        try:
            for each in islice(self._messages, BATCH_MESSAGES):
                found.append(each)
                size += len(each.cdr)
                if size > BATCH_BYTES:
                    break
            else:
                return ReadBatch(found, is_last=len(found) < BATCH_MESSAGES)
        except Exception as error:  # noqa: BLE001  # as above
            return ReadBatch(found, is_last=True, error=error)
        return ReadBatch(found)
