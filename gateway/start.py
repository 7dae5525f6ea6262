# SPDX-License-Identifier: Apache-2.0
"""The end of a start: a robot can be driven, or no robot listens."""

import asyncio
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Final

from gateway.faults import Fault
from gateway.metrics.state import ControlState

LOOK_S: Final = 0.05  # too short to notice
ALONE_S: Final = 5.0  # a robot that is not discovered by then does not run
INVITE_S: Final = 30.0  # a gateway whose guard does not start serves anyway


class Start:
    """Judges whether a gateway that serves already can do what moves a robot."""

    def __init__(self, control: Callable[[], ControlState]) -> None:
        self._control = control
        self._began_s = time.monotonic()

    def faults(self) -> Sequence[Fault]:
        """Return what keeps a robot from being driven, unless the guard itself reports it."""
        drives, guard_is_ready, losses = self._control()
        if not drives or (losses and not guard_is_ready):
            return ()
        if any(each.listeners and each.is_guarded for each in drives):
            return ()
        is_alone = not any(each.listeners for each in drives)
        if guard_is_ready and is_alone and time.monotonic() - self._began_s >= ALONE_S:
            return ()
        text = "no robot can be driven yet, because the guard process starts: wait a moment"
        return (Fault("starting", text),)

    @contextmanager
    def inviting(self, *invitations: Callable[[], None]) -> Iterator[None]:
        """Call all *invitations* once a robot can be driven or no robot listens, unless it ends."""
        loop = asyncio.get_running_loop()
        timer: asyncio.Handle

        def look() -> None:
            nonlocal timer
            if self.faults() and time.monotonic() - self._began_s < INVITE_S:
                timer = loop.call_later(LOOK_S, look)
            else:
                for invite in invitations:
                    invite()

        timer = loop.call_soon(look)
        try:
            yield
        finally:
            timer.cancel()
