# SPDX-License-Identifier: Apache-2.0
"""Events of topics, to the clients on the topic and to those who watch all."""

import time
from types import SimpleNamespace

import pytest

from gateway.access.permissions import Identity, Policy
from gateway.config.access import AccessConfig, ViewerConfig
from gateway.core.topic_events import MAX_AT_ONCE
from gateway.sources.source import Qos, TopicEvent
from tests.client import eventually
from tests.core.conftest import STRING, Bench

GONE = "topic /t: /outside publishes no longer, nobody does"


async def test_a_publisher_that_goes_is_told_to_its_subscribers_and_to_watchers(bench: Bench):
    publisher = bench.ros.add_publisher("/t", STRING)
    listener, watcher, other = (bench.client() for _ in range(3))
    listener.send(op="subscribe", id="s", topic="/t")
    watcher.send(op="events", id="e")
    assert watcher.of("events") == [{"op": "events", "id": "e", "watch": True}]
    await eventually(lambda: not bench.ros._is_changing)
    publisher.close()
    await watcher.sees(1, "event")
    assert watcher.of("event") == [
        {"op": "event", "id": "e", "topic": "/t", "code": "publisher_gone", "msg": GONE}
    ]
    (status,) = listener.of("status")
    assert (status["level"], status["code"], status["msg"]) == ("warning", "publisher_gone", GONE)
    assert status["id"] == "s"
    assert other.frames == []


async def test_events_come_until_they_are_not_wanted_any_more(bench: Bench):
    watchers = [bench.client() for _ in range(2)]
    for each in watchers:
        each.send(op="events")
    watchers[0].send(op="events", watch=False)
    watchers[1].router.leave(watchers[1].session)
    bench.client().send(op="subscribe", topic="/t", type=STRING)
    bench.ros.subscriptions[0].on_event(TopicEvent("messages_lost", "topic /t: one"))
    assert not [frame for each in watchers for frame in each.of("event")]


async def test_an_event_for_many_clients_comes_once_to_a_watcher(bench: Bench):
    watcher = bench.sender(op="events")
    for depth in (1, 2):
        bench.client().send(op="subscribe", topic="/t", type=STRING, qos={"depth": depth})
    for subscription in bench.ros.subscriptions:
        subscription.on_event(TopicEvent("messages_lost", "topic /t: one"))
    assert len(watcher.of("event")) == 1
    bench.ros.subscriptions[0].on_event(TopicEvent("messages_lost", "topic /t: another"))
    assert len(watcher.of("event")) == 2


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    clock = SimpleNamespace(now_ns=time.monotonic_ns())
    clock.monotonic_ns = lambda: clock.now_ns
    monkeypatch.setattr("gateway.core.topic_events.time", clock)
    return clock


async def test_an_event_that_happens_again_after_a_second_is_sent_again(
    bench: Bench, clock: SimpleNamespace
):
    watcher = bench.sender(op="events")
    for depth in (1, 2):
        bench.client().send(op="subscribe", topic="/t", type=STRING, qos={"depth": depth})
    first, second = bench.ros.subscriptions
    first.on_event(TopicEvent("messages_lost", "topic /t: one"))
    clock.now_ns += 900_000_000
    second.on_event(TopicEvent("messages_lost", "topic /t: one"))
    assert len(watcher.of("event")) == 1
    clock.now_ns += 100_000_000
    first.on_event(TopicEvent("messages_lost", "topic /t: one"))
    assert len(watcher.of("event")) == 2


async def test_a_flood_of_events_is_bounded_and_counted(bench: Bench, clock: SimpleNamespace):
    watcher, listener = bench.client(), bench.client()
    watcher.send(op="events")
    listener.send(op="subscribe", topic="/t", type=STRING)
    (subscription,) = bench.ros.subscriptions
    for number in range(512):
        subscription.on_event(TopicEvent("messages_lost", f"topic /t: {number}"))
    assert len(watcher.of("event")) == 256
    assert not any("skipped" in event for event in watcher.of("event"))
    clock.now_ns += 51_000_000  # 20 a second
    for number in range(2):
        subscription.on_event(TopicEvent("messages_lost", f"topic /t: more, {number}"))
    assert len(watcher.of("event")) == 257
    assert watcher.of("event")[-1]["skipped"] == 256


async def test_a_watcher_hears_of_the_topics_that_it_may_see(bench: Bench):
    policy = Policy(AccessConfig(viewer=ViewerConfig(deny_subscribe=("/secret",))))
    watcher = bench.client(identity=Identity("wall", policy.of("viewer")))
    watcher.send(op="events")
    for topic in ("/secret", "/open"):
        bench.client().send(op="subscribe", topic=topic, type=STRING)
    for subscription in bench.ros.subscriptions:
        subscription.on_event(TopicEvent("messages_lost", f"topic {subscription.topic}: one"))
    assert [frame["topic"] for frame in watcher.of("event")] == ["/open"]


async def test_a_watcher_pays_for_the_topics_alone_that_it_may_see(bench: Bench):
    policy = Policy(AccessConfig(viewer=ViewerConfig(deny_subscribe=("/secret",))))
    watcher, admin = bench.client(identity=Identity("wall", policy.of("viewer"))), bench.client()
    for each in (watcher, admin):
        each.send(op="events")
    for topic in ("/secret", "/open"):
        bench.client().send(op="subscribe", topic=topic, type=STRING)
    secret, opened = bench.ros.subscriptions
    for number in range(2 * MAX_AT_ONCE):
        secret.on_event(TopicEvent("messages_lost", f"topic /secret: {number}"))
    opened.on_event(TopicEvent("messages_lost", "topic /open: one"))
    assert [frame["topic"] for frame in watcher.of("event")] == ["/open"]
    assert "skipped" not in watcher.of("event")[0]

    def is_counted() -> bool:
        secret.on_event(TopicEvent("messages_lost", f"topic /secret: {len(admin.frames)}"))
        return "skipped" in admin.of("event")[-1]

    await eventually(is_counted)
    assert len(watcher.of("event")) == 1


async def test_a_client_gets_no_name_of_a_node_that_it_may_not_see(bench: Bench):
    policy = Policy(AccessConfig(viewer=ViewerConfig(deny_subscribe=("/outside",))))
    viewer, admin = bench.client(identity=Identity("wall", policy.of("viewer"))), bench.client()
    publisher = bench.ros.add_publisher("/t", STRING, Qos("best_effort"))
    for each in (viewer, admin):
        each.send(op="events")
        each.send(op="subscribe", topic="/t", type=STRING, qos={"reliability": "reliable"})
    await admin.sees(1, "event")
    publisher.close()
    await admin.sees(2, "event")
    for kind in ("event", "status"):
        codes = ["qos_incompatible", "publisher_gone"]
        assert [frame["code"] for frame in viewer.of(kind)] == codes
        assert all("topic /t: /outside " in frame["msg"] for frame in admin.of(kind))
        assert all("topic /t: a node " in frame["msg"] for frame in viewer.of(kind))
    late = bench.client(identity=Identity("wall", policy.of("viewer")))
    bench.ros.add_publisher("/t", STRING, Qos("best_effort"))
    await admin.sees(3, "status")
    late.send(op="subscribe", topic="/t", type=STRING, qos={"reliability": "reliable"})
    assert ["a node offers" in frame["msg"] for frame in late.of("status")] == [True]


async def test_a_mismatch_with_a_client_s_publisher_is_also_an_event(bench: Bench):
    watcher, speaker = bench.client(), bench.client()
    watcher.send(op="events")
    speaker.send(op="advertise", id=1, topic="/t", type=STRING, qos={"durability": "volatile"})
    latched = Qos("reliable", "transient_local")
    bench.ros.add_subscription("/t", STRING, lambda _: None, latched)
    await watcher.sees(1, "event")
    assert watcher.of("event")[0]["code"] == "qos_incompatible"
    assert speaker.of("status")[0]["id"] == 1
