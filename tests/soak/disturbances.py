# SPDX-License-Identifier: Apache-2.0
"""The timetable of faults of publishers, links, and clients during the load."""

import contextlib
import signal
import time
from collections.abc import AsyncIterator
from typing import Final

from tests.soak.actor import Actor, acting
from tests.soak.bad_link import BadLink
from tests.soak.over import Over
from tests.soak.silences import Gap

SENSORS_LIVE_S: Final = 30.0
SENSORS_AWAY_S: Final = 3.0
# DDS finds the successor of a killed participant at once, or when it announces itself again, 3 s
# later. This also holds for bare subscribers, and for each at another time.
FOUND_S: Final = 3.5
CUT_EVERY_S: Final = 25.0
# The short one is survived. The long one ends the connection, unless a proxy cuts it.
CUTS_S: Final = (2.0, 15.0)
# The same with a client that is frozen: half of the time, as long as it runs between.
FREEZES_S: Final = (3.0, 10.0)


class Sensors:
    """The publisher of all topics, which can be killed and return."""

    def __init__(self) -> None:
        self._stack = contextlib.AsyncExitStack()
        self._actor: Actor | None = None
        self.epoch = 0
        self.away: list[Gap] = []
        self._killed_s: float | None = None

    async def start(self) -> None:
        """Begin, or return, with another epoch."""
        self.epoch += 1
        self._actor = await self._stack.enter_async_context(acting("publisher", self.epoch))
        if self._killed_s is not None:
            self.away.append((self._killed_s, time.monotonic() + FOUND_S))

    async def kill(self) -> None:
        """Kill it: it says goodbye to nobody."""
        if self._actor is not None:
            self._killed_s = time.monotonic()
            self._actor.signal(signal.SIGKILL)
            await self._stack.aclose()
            self._actor = None

    async def end(self) -> None:
        """End it in peace."""
        await self._stack.aclose()

    async def die_and_return(self, over: Over) -> None:
        """Be killed and return until it is over, and be there then."""
        while not await over.within(SENSORS_LIVE_S):
            if over.may_kill:
                await self.kill()
                await over.within(SENSORS_AWAY_S)
                await self.start()


@contextlib.asynccontextmanager
async def sensors() -> AsyncIterator[Sensors]:
    """Have publishers of all topics."""
    running = Sensors()
    await running.start()
    try:
        yield running
    finally:
        await running.end()


async def cut_now_and_then(link: BadLink, over: Over) -> int:
    """Cut a link for a while, over and over. Return how often."""
    cuts = 0
    while not await over.within(CUT_EVERY_S):
        await link.cut(True)
        await over.within(CUTS_S[cuts % len(CUTS_S)])
        await link.cut(False)
        cuts += 1
    return cuts


async def freeze_half_of_the_time(client: Actor, over: Over) -> int:
    """Stop a client's process for as long as it runs, over and over. Return how often."""
    freezes = 0
    while True:
        seconds = FREEZES_S[freezes % len(FREEZES_S)]
        if await over.within(seconds):
            return freezes
        client.signal(signal.SIGSTOP)
        is_over = await over.within(seconds)
        client.signal(signal.SIGCONT)
        freezes += 1
        if is_over:
            return freezes
