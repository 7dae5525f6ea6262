# SPDX-License-Identifier: Apache-2.0
"""Reports of topics that fall silent and are heard again, over the fake ROS and a clock by hand."""

import time
from collections.abc import Iterator

import pytest

from gateway.core.topics import silence_watch
from gateway.core.topics.silence_watch import TICK_S
from gateway.core.topics.subscription import Subscription
from gateway.sources.source import Qos
from tests.client import Frame
from tests.clock import StoppedClock
from tests.core.conftest import STRING, Bench, Socketless

INT32 = "std_msgs/msg/Int32"
SECOND = 1_000_000_000


class Clock:
    """The monotonic clock of the topics and of their ticks."""

    def __init__(self) -> None:
        self.now_ns = 1000 * SECOND


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Iterator[Clock]:
    clock = Clock()
    monkeypatch.setattr(silence_watch, "TICK_S", 3600)
    monkeypatch.setattr(time, "monotonic_ns", lambda: clock.now_ns)
    yield clock
    monkeypatch.undo()


async def ticks(bench: Bench) -> None:
    """Let what is on its way arrive, and then some ticks happen, if there are any."""
    await bench.settle()
    watch = bench.router._subscriptions._silence_watch
    for _ in range(3):
        if watch._timer is not None:
            watch._timer.cancel()
            watch._tick()


def told(client: Socketless) -> list[Frame]:
    return [frame for frame in client.of("status") if frame["code"] in {"stale", "fresh"}]


def codes(client: Socketless) -> list[str]:
    return [frame["code"] for frame in told(client)]


def hear(bench: Bench, text: str = "x") -> None:
    bench.ros.publish("/t", bench.cdr(STRING, data=text))


async def test_a_client_that_asks_hears_of_silence_once_and_of_its_end(bench: Bench, clock: Clock):
    bench.ros.add_publisher("/t", STRING)
    client = bench.sender(op="subscribe", id="s", topic="/t", stale_after_ms=1000)
    hear(bench)
    await ticks(bench)
    clock.now_ns += SECOND - 1
    await ticks(bench)
    assert told(client) == []
    clock.now_ns += SECOND
    await ticks(bench)
    clock.now_ns += 3 * SECOND
    await ticks(bench)
    hear(bench)
    await ticks(bench)
    clock.now_ns += SECOND - 1
    await ticks(bench)
    stale, fresh = told(client)
    about = {"op": "status", "request": "subscribe", "id": "s"}
    assert about.items() <= stale.items()
    assert about.items() <= fresh.items()
    assert stale["level"] == "warning"
    assert stale["msg"] == "topic /t: no message for 2.0 s"
    assert fresh["level"] == "info"
    assert fresh["msg"] == "topic /t: messages again, after 5.0 s"
    assert len(client.messages) == 2


async def test_a_client_that_does_not_ask_hears_nothing_and_costs_no_tick(
    bench: Bench, clock: Clock
):
    client = bench.listener("/t", STRING)
    hear(bench)
    clock.now_ns += 3600 * SECOND
    await ticks(bench)
    assert client.of("status") == []
    assert bench.router._subscriptions._silence_watch._timer is None


async def test_a_topic_that_nobody_publishes_is_silent_since_the_subscription(
    bench: Bench, clock: Clock
):
    client = bench.sender(op="subscribe", topic="/t", stale_after_ms=1000)
    clock.now_ns += SECOND
    await ticks(bench)
    assert codes(client) == ["stale"]
    bench.ros.add_publisher("/t", STRING)
    await bench.settle()
    hear(bench)
    await ticks(bench)
    assert codes(client) == ["stale", "fresh"]


async def test_another_type_on_the_topic_is_heard_as_well(bench: Bench, clock: Clock):
    first = bench.ros.add_publisher("/t", STRING)
    client = bench.sender(op="subscribe", topic="/t", stale_after_ms=1000)
    hear(bench)
    await ticks(bench)
    bench.ros.remove_publisher(first)
    clock.now_ns += SECOND
    await ticks(bench)
    bench.ros.add_publisher("/t", INT32)
    await bench.settle()
    bench.ros.publish("/t", bench.cdr(INT32, data=7))
    await ticks(bench)
    assert codes(client) == ["stale", "fresh"]


async def test_samples_that_came_while_the_loop_stood_still_count_first(bench: Bench, clock: Clock):
    client = bench.listener("/t", STRING, stale_after_ms=1000)
    hear(bench)
    await ticks(bench)
    subscriptions = bench.router._subscriptions
    clock.now_ns += 2 * SECOND
    subscriptions._silence_watch._tick()  # before anything that waits in DDS is taken
    hear(bench)
    await bench.settle()
    await ticks(bench)
    assert told(client) == []


async def test_a_client_that_wants_no_status_gets_the_one_that_it_asked_for(
    bench: Bench, clock: Clock
):
    client = bench.sender(op="set_level", level="none")
    client.send(op="subscribe", topic="/t", type=STRING, stale_after_ms=1000)
    clock.now_ns += SECOND
    await ticks(bench)
    assert codes(client) == ["stale"]


async def test_of_several_requests_the_shortest_silence_counts(bench: Bench, clock: Clock):
    client = bench.client()
    for number, stale_after_ms in enumerate((5000, 1000, None)):
        client.send(
            op="subscribe", id=number, topic="/t", type=STRING, stale_after_ms=stale_after_ms
        )
    clock.now_ns += SECOND
    await ticks(bench)
    assert [frame["id"] for frame in told(client)] == [1]


async def test_nothing_ticks_once_the_last_one_has_gone(bench: Bench, clock: Clock):
    one, other = bench.client(), bench.client()
    one.send(op="subscribe", topic="/t", type=STRING, stale_after_ms=1000)
    other.send(op="subscribe", topic="/t", type=STRING, stale_after_ms=1000)
    watch = bench.router._subscriptions._silence_watch
    one.send(op="unsubscribe", topic="/t")
    assert watch._timer is not None
    bench.router.leave(other.session)
    assert watch._timer is None
    clock.now_ns += SECOND
    await ticks(bench)
    assert told(one) == told(other) == []


@pytest.mark.parametrize("silence", [0, 99, -1, "1000", 3_600_001])
async def test_a_silence_out_of_range_is_refused(bench: Bench, silence: object):
    client = bench.sender(op="subscribe", topic="/t", type=STRING, stale_after_ms=silence)
    ((code, text),) = client.statuses
    assert code == "bad_request"
    assert "stale_after_ms" in text


async def test_each_reason_of_a_publisher_that_does_not_match_has_its_code(bench: Bench):
    client = bench.sender(op="subscribe", topic="/t", type=STRING, qos={"reliability": "reliable"})
    bench.ros.add_publisher("/t", STRING, Qos(reliability="best_effort"))
    await client.sees(1, "status")
    bench.ros.add_publisher("/t", INT32)
    await client.sees(2, "status")
    assert [code for code, _ in client.statuses] == ["qos_incompatible", "type_conflict"]


async def test_a_report_comes_within_100_ms(bench: Bench, clock: Clock, monkeypatch):
    monkeypatch.setattr(silence_watch, "TICK_S", TICK_S)
    loop_clock = StoppedClock(monkeypatch)
    client = bench.sender(op="subscribe", topic="/t", type=STRING, stale_after_ms=200)
    looks = 0
    heard_ns = bench.router._subscriptions._silence_watch._heard_ns

    def look(subscription: Subscription) -> int:
        nonlocal looks
        looks += 1
        return heard_ns(subscription)

    bench.router._subscriptions._silence_watch._heard_ns = look
    for _ in range(30):
        assert codes(client) == []
        clock.now_ns += SECOND // 100
        await loop_clock.advance(0.01)
        if codes(client):
            break
    assert codes(client) == ["stale"]
    assert looks <= 7
