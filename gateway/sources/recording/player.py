# SPDX-License-Identifier: Apache-2.0
"""Plays a recording in time: position, rate, pause, steps, and jumps."""

import asyncio
import logging
import time
from collections import deque
from collections.abc import Callable, Sequence
from typing import Final

from gateway.sources.recording.options import MAX_RATE, MIN_RATE, PlayOptions
from gateway.sources.recording.read_ahead import ReadAhead
from gateway.sources.recording.recording import Recording
from gateway.sources.recording.tracks import Recorded

MAX_PER_TURN: Final = 256  # then other work has its turn
LOOP_GAP_S: Final = 0.02  # a recording may have one message

_NS_PER_S: Final = 1e9

logger = logging.getLogger(__name__)

OnMessages = Callable[[Sequence[Recorded]], None]


class Player:
    """Gives messages when their time has come.

    *on_messages* gets them, *on_latched* what latched topics hold after a jump. *on_jump_back* is
    called before these if time has jumped back.
    """

    def __init__(
        self,
        recording: Recording,
        options: PlayOptions,
        on_messages: OnMessages,
        on_latched: OnMessages,
        on_jump_back: Callable[[], None],
    ) -> None:
        self.start_ns, self.end_ns = recording.start_ns, recording.end_ns
        self.is_paused = options.is_paused
        self.rate = options.rate
        self._loops = options.loop
        self._on_messages, self._on_latched = on_messages, on_latched
        self._on_jump_back = on_jump_back
        self._loop = asyncio.get_running_loop()
        self._ahead = ReadAhead(recording, self._turn)
        self._timer: asyncio.Handle | None = None
        self._waiting: deque[Recorded] = deque()
        self._steps = 0  # messages to play although it is paused
        self._has_read_all = False
        self._is_seeking = False  # nothing has been read there yet
        self._last_ns = self.end_ns  # the end, which is earlier in a damaged file
        self._anchor_ns = self.start_ns  # the position at `_anchor_s`
        self._anchor_s = time.monotonic()
        self._seek(self.start_ns + round(options.start_s * _NS_PER_S))

    @property
    def position_ns(self) -> int:
        """The time of the recording that is being played."""
        if self.is_paused or self._is_seeking:
            return self._anchor_ns
        played_s = (time.monotonic() - self._anchor_s) * self.rate
        return min(self._anchor_ns + round(played_s * _NS_PER_S), self.end_ns)

    @property
    def is_over(self) -> bool:
        """True once the last message was played."""
        return self._has_read_all and not self._waiting

    def pause(self) -> None:
        """Stand still."""
        self._anchor(self.position_ns)
        self.is_paused = True

    def resume(self) -> None:
        """Go on. At the end, begin again."""
        if self.is_over:
            self.seek(self.start_ns)
        self._anchor(self.position_ns)
        self.is_paused = False
        self._steps = 0
        self._turn()

    def set_rate(self, rate: float) -> bool:
        """Play so many times as fast as it was. Return whether that is possible."""
        if not MIN_RATE <= rate <= MAX_RATE:
            return False
        self._anchor(self.position_ns)
        self.rate = rate
        self._turn()
        return True

    def step(self, count: int) -> int:
        """Play so many messages more, soon, while it is paused. Return 0 if it cannot.

        At the end, those that are left to play are forgotten.
        """
        if not self.is_paused or self.is_over:
            return 0
        self._steps += count
        self._turn()
        return count

    def seek(self, position_ns: int) -> bool:
        """Go on from a time of the recording. Return whether the recording has it."""
        if not self.start_ns <= position_ns <= self.end_ns:
            return False
        is_back = position_ns < self.position_ns
        self._seek(position_ns)
        if is_back:
            self._on_jump_back()
        return True

    def close(self) -> None:
        """Play no more, and close the files."""
        self._cancel_timer()
        self.is_paused = True
        self._ahead.close()

    def _seek(self, position_ns: int) -> None:
        self._cancel_timer()  # it may be about to begin the next loop
        self._waiting.clear()
        self._steps = 0
        self._has_read_all = False
        self._is_seeking = True
        self._anchor(position_ns)
        self._ahead.seek(position_ns)

    def _anchor(self, position_ns: int) -> None:
        self._anchor_ns, self._anchor_s = position_ns, time.monotonic()

    def _turn(self) -> None:
        """Play what is due, and wait for what comes next."""
        self._cancel_timer()
        if self.is_paused and not self._steps:
            self._refill()  # shows what latched topics hold
            return
        due = self._due()
        try:
            if due:
                self._on_messages(due)
        finally:  # a bug of a subscriber does not end it
            self._wait()

    def _cancel_timer(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _wait(self) -> None:
        """Have the next turn come when something is due."""
        if self.is_over:
            self._end()
        elif self._steps and self._waiting:
            self._timer = self._loop.call_soon(self._turn)
        elif self._waiting and not self.is_paused:
            wait_s = (self._waiting[0].time_ns - self.position_ns) / self.rate / _NS_PER_S
            self._timer = self._loop.call_later(max(wait_s, 0.0), self._turn)

    def _due(self) -> list[Recorded]:
        position_ns = self.position_ns
        due: list[Recorded] = []
        while len(due) < MAX_PER_TURN and (self._waiting or self._refill()):
            if self._steps:
                self._steps -= 1
                self._anchor(self._waiting[0].time_ns)
            elif self.is_paused or self._waiting[0].time_ns > position_ns:
                break
            due.append(self._waiting.popleft())
        return due

    def _refill(self) -> bool:
        """Take the next batch, if it has come. Return whether there is a message now."""
        if self._waiting or self._has_read_all:
            return bool(self._waiting)
        batch = self._ahead.take()
        if batch is None:
            return False
        if batch.latched is not None:
            self._is_seeking = False
            self._anchor(self._anchor_ns)
            self._on_latched(batch.latched)
        self._waiting.extend(batch.messages)
        self._has_read_all = batch.is_last
        if batch.error is not None:
            reason = str(batch.error) or type(batch.error).__name__
            self._loops = False
            self._last_ns = batch.messages[-1].time_ns if batch.messages else self._anchor_ns
            logger.error("the recording is damaged, it ends here: %s", reason)
        return bool(self._waiting)

    def _end(self) -> None:
        self._steps = 0
        if self._loops:
            self._timer = self._loop.call_later(LOOP_GAP_S, self.seek, self.start_ns)
            return
        self._anchor(self._last_ns)
        if not self.is_paused:
            self.is_paused = True
            logger.info("the recording has ended: seek, or resume to play it again")
