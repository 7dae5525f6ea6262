# SPDX-License-Identifier: Apache-2.0
import asyncio

import pytest

from gateway.sources.graph_watches import GraphWatches
from tests.clock import StoppedClock


@pytest.fixture
async def clock(monkeypatch: pytest.MonkeyPatch) -> StoppedClock:
    return StoppedClock(monkeypatch)


async def test_changes_are_told_together_a_tenth_of_a_second_after_the_first(clock):
    watches = GraphWatches(asyncio.get_running_loop())
    told: list[str] = []
    for name in ("one", "other"):
        watches.add(lambda name=name: told.append(name))
    watches.notify()
    await clock.advance(0.09)
    watches.notify()
    assert told == []
    await clock.advance(0.02)
    assert told == ["one", "other"]
    await clock.advance(1)
    assert told == ["one", "other"]
    watches.notify()
    await clock.advance(0.11)
    assert told == ["one", "other"] * 2


async def test_nobody_is_told_after_closing(clock: StoppedClock) -> None:
    watches = GraphWatches(asyncio.get_running_loop())
    told: list[str] = []
    closed = watches.add(lambda: told.append("closed"))
    watches.add(closed.close)
    first = watches.add(lambda: told.append("open"))
    watches.notify()
    closed.close()
    await clock.advance(0.11)
    assert told == ["open"]
    first.close()
    watches.notify()
    watches.close()
    await clock.advance(0.11)
    assert told == ["open"]
