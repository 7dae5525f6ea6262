# SPDX-License-Identifier: Apache-2.0
"""Things that stay open for a while after their last use."""

import pytest

from gateway.sources import client_cache
from gateway.sources.client_cache import ClientCache
from tests.client import eventually
from tests.clock import StoppedClock

MAX_IDLE = 128


class Thing:
    def __init__(self) -> None:
        self.is_closed = False

    def close(self) -> None:
        self.is_closed = True


async def test_users_of_one_key_share_one_thing() -> None:
    things: ClientCache[Thing] = ClientCache()
    with things.use("a", Thing) as first, things.use("a", Thing) as second:
        assert first is second
    with things.use("a", Thing) as third, things.use("b", Thing) as other:
        assert third is first
        assert other is not first
    things.close()
    assert first.is_closed
    assert other.is_closed


async def test_a_thing_is_closed_a_while_after_its_last_use(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(client_cache, "IDLE_S", 0.01)
    things: ClientCache[Thing] = ClientCache()
    with things.use("a", Thing) as thing:
        with things.use("a", Thing):
            pass
        assert len(things) == 1
    assert not thing.is_closed
    await eventually(lambda: thing.is_closed)
    assert len(things) == 0


async def test_an_unused_client_stays_open_for_5_s(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = StoppedClock(monkeypatch)
    things: ClientCache[Thing] = ClientCache()
    with things.use("a", Thing) as thing:
        with things.use("a", Thing):
            pass
        await clock.advance(10)
    await clock.advance(4.99)
    assert not thing.is_closed
    await clock.advance(0.02)
    assert thing.is_closed


async def test_a_client_that_is_used_again_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(client_cache, "IDLE_S", 0.01)
    things: ClientCache[Thing] = ClientCache()
    with things.use("a", Thing) as thing:
        pass
    with things.use("a", Thing):
        with things.use("b", Thing) as other:
            pass
        await eventually(lambda: other.is_closed)
        assert not thing.is_closed
    await eventually(lambda: thing.is_closed)


async def test_only_so_many_linger_and_the_longest_idle_goes_first() -> None:
    things: ClientCache[Thing] = ClientCache()
    opened = []
    for number in range(MAX_IDLE + 2):
        with things.use(number, Thing) as thing:
            opened.append(thing)
    assert [thing.is_closed for thing in opened] == [True, True, *[False] * MAX_IDLE]
    things.close()


async def test_a_recently_used_client_is_not_the_longest_idle() -> None:
    things: ClientCache[Thing] = ClientCache()
    with things.use("long", Thing) as long_used:
        with things.use("before", Thing) as before:
            pass
        for number in range(1, MAX_IDLE):
            with things.use(number, Thing):
                pass
    assert before.is_closed
    assert not long_used.is_closed
    things.close()


async def test_closing_while_in_use_closes_at_once_and_only_once() -> None:
    things: ClientCache[Thing] = ClientCache()
    with things.use("a", Thing) as thing:
        things.close()
        assert thing.is_closed
    assert len(things) == 0
