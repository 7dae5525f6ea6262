# SPDX-License-Identifier: Apache-2.0
"""The service of tf2_web_republisher, as roslibpy's TFClient calls it, and its topics."""

import itertools
import re
from typing import Any

import pytest

from gateway.access.permissions import Identity, Policy
from gateway.config.access import AccessConfig
from gateway.fronts.rosbridge.operations.topics import Subscribe
from gateway.fronts.rosbridge.tf2_web_republisher import service
from gateway.fronts.rosbridge.tf2_web_republisher.virtual_topic import VirtualTopic
from tests.client import eventually
from tests.clock import StoppedClock
from tests.core.conftest import LIMITS, Bench, Socketless, lone_session
from tests.core.transforms.asking import request, xs
from tests.core.transforms.conftest import Robot
from tests.wire import unpacked


@pytest.fixture(autouse=True)
def numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let topics end in 1, 2 and so on."""
    numbers = itertools.count(1)
    monkeypatch.setattr(service.secrets, "token_hex", lambda _: str(next(numbers)))


FIRST = "/tf2_web_republisher/tf_repub_1"


def call(client: Socketless, service: str = "/republish_tfs", **more: Any) -> Any:
    """Call the service, and return the response."""
    about = {"id": "c", "type": "tf2_web_republisher/RepublishTFs"}
    client.send(op="call_service", service=service, args=request(**more), **about)
    return client.of("service_response")[-1]


def arrays(client: Socketless) -> list[dict[str, float]]:
    return xs([message["transforms"] for message in client.messages])


@pytest.mark.parametrize("service", ["/republish_tfs", "republish_tfs"])
async def test_the_service_answers_with_a_topic_that_has_the_transforms(
    robot: Robot, client: Socketless, service: str
):
    timeout = {"secs": 2, "nsecs": 0}
    assert call(client, service, timeout=timeout) == {
        "op": "service_response",
        "id": "c",
        "service": service,
        "values": {"topic_name": FIRST},
        "result": True,
    }
    client.send(op="set_level", level="info")
    client.send(
        op="subscribe", id="s", topic=FIRST, type="tf2_web_republisher/TFArray", throttle_rate=0
    )
    assert [frame["msg"] for frame in client.of("status")] == [
        f"subscribed to {FIRST} (tf2_web_republisher_msgs/msg/TFArray)"
    ]
    await robot.drives(1, 2.0)
    [frame] = await client.sees(1)
    assert set(frame) == {"op", "topic", "msg"}
    assert (frame["topic"], set(frame["msg"])) == (FIRST, {"transforms"})
    assert arrays(client) == [{"base_link": 2.0, "laser": 3.0}]
    assert robot.bench.router.counts()["subscriptions"] == 0


async def test_a_topic_ends_with_its_last_subscription(robot: Robot, client: Socketless):
    call(client)
    for number in (1, 2):
        client.send(op="subscribe", id=number, topic=FIRST)
    client.send(op="unsubscribe", id=1, topic=FIRST)
    client.send(op="unsubscribe", id=1, topic=FIRST)
    assert client.statuses == [("not_found", f"not subscribed to {FIRST} with id 1")]
    await robot.drives(1, 2.0)
    await client.sees(1)
    client.send(op="unsubscribe", id=2, topic=FIRST)
    assert robot.bench.router.counts()["transforms"] == 0
    client.send(op="subscribe", id=3, topic=FIRST)
    text = f"topic {FIRST} does not exist: call /republish_tfs for a new one, and subscribe in time"
    assert client.statuses[1:] == [("not_found", text)]
    client.send(op="unsubscribe", topic=FIRST)
    assert client.statuses[2:] == [("not_found", f"not subscribed to {FIRST}")]


@pytest.mark.parametrize(
    ("asked", "seconds"), [({"secs": 3, "nsecs": 500_000_000}, 3.5), ({"sec": 1}, 1), ({}, 2)]
)
async def test_a_topic_without_subscriptions_ends_after_the_timeout(
    robot: Robot,
    client: Socketless,
    monkeypatch: pytest.MonkeyPatch,
    asked: dict[str, int],
    seconds: float,
):
    clock = StoppedClock(monkeypatch)
    counts = robot.bench.router.counts
    for _ in range(2):
        call(client, timeout=asked)
    client.send(op="subscribe", topic=FIRST)
    await clock.advance(seconds - 0.01)
    assert counts()["transforms"] == 2
    await clock.advance(0.02)
    assert counts()["transforms"] == 1
    robot.drive(1, 2.0)
    await robot.bench.settle()
    await clock.advance(0.1)
    assert arrays(client) == [{"base_link": 2.0, "laser": 3.0}]


async def test_when_a_client_leaves_its_topics_end(
    robot: Robot, client: Socketless, monkeypatch: pytest.MonkeyPatch
):
    clock = StoppedClock(monkeypatch)
    for _ in range(2):
        call(client)
    client.send(op="subscribe", topic=FIRST)
    robot.bench.router.leave(client.session)
    assert robot.bench.router.counts()["transforms"] == 0
    await clock.advance(10)
    assert robot.subscriptions


async def test_a_topic_is_that_of_one_client(robot: Robot, client: Socketless):
    call(client)
    client.send(op="subscribe", topic=FIRST)
    other = robot.bench.sender(op="subscribe", topic=FIRST)
    assert other.statuses[0][1].startswith(f"topic {FIRST} does not exist")
    await robot.drives(1, 2.0)
    await client.sees(1)
    assert other.messages == []


async def test_one_who_subscribes_again_gets_all_frames_under_each_name(
    robot: Robot, client: Socketless
):
    call(client)
    client.send(op="subscribe", topic=FIRST)
    await robot.drives(1, 2.0)
    await client.sees(1)
    client.send(op="subscribe", topic=FIRST[1:], fragment_size=100)
    await client.sees(2)
    assert [frame["topic"] for frame in client.of("publish")] == [FIRST, FIRST]
    assert client.of("fragment")


def test_requests_under_one_name_get_fragments_of_the_smallest_size_asked_for():
    topic = VirtualTopic(lone_session(), "/t", "std_msgs/msg/String")
    for size in (200, 100):
        topic.subscribe(Subscribe(topic="/t", id=size, fragment_size=size))
    fragments = unpacked(topic.frames(b'{"data":"' + b"x" * 300 + b'"}'))
    assert max(len(fragment["data"]) for fragment in fragments) == 100


async def test_options_that_such_a_topic_has_not_are_told(robot: Robot, client: Socketless):
    call(client)
    client.send(
        op="subscribe", topic=FIRST, throttle_rate=100, compression="cbor", fields=["a"], meta=True
    )
    text = f"throttle_rate, fields, meta, compression: not available on {FIRST}, sending plain JSON"
    assert client.statuses == [("bad_request", text)]


async def test_subscriptions_to_a_topic_are_limited(robot: Robot, client: Socketless):
    call(client)
    for number in range(LIMITS.max_subscriptions + 1):
        client.send(op="subscribe", id=number, topic=FIRST)
    client.send(op="subscribe", id=0, topic=FIRST)
    text = "at most 4 subscriptions per client: end one, or raise limits.max_subscriptions"
    assert client.statuses == [("limit_exceeded", text)]


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"timeout": {"secs": 61}}, "args.timeout: expected at most 60 s, got 61 s"),
        ({"timeout": {"secs": -1}}, "args.timeout.sec: expected at least 0, got -1"),
        ({"timeout": 2}, "args.timeout: expected an object, got 2"),
        ({"rate": 1000}, "args.rate: expected at most 200, got 1000"),
    ],
)
async def test_a_request_that_does_not_fit_is_refused_in_words(
    robot: Robot, client: Socketless, more: dict[str, Any], words: str
):
    response = call(client, **more)
    assert (response["values"], response["result"]) == (words, False)
    assert robot.bench.router.counts()["transforms"] == 0


async def test_a_node_that_provides_the_service_is_called(bench: Bench, client: Socketless):
    called = []
    node = bench.ros.add_service(
        "/republish_tfs", "std_srvs/srv/Trigger", lambda each: called.append(each)
    )
    client.send(op="call_service", id="c", service="/republish_tfs")
    await eventually(lambda: called != [])
    node.close()
    assert call(client)["values"] == {"topic_name": FIRST}


async def test_a_viewer_may_call_it_and_subscribe(robot: Robot):
    policy = Policy(AccessConfig())
    client = robot.bench.client(identity=Identity("tablet", policy.of("viewer")))
    assert call(client)["values"] == {"topic_name": FIRST}
    client.send(op="subscribe", topic=FIRST)
    await robot.drives(1, 2.0)
    await client.sees(1)


async def test_a_topic_that_ros_has_is_subscribed_to(bench: Bench, client: Socketless):
    bench.ros.add_publisher(FIRST, "std_msgs/msg/String")  # of a node, as its name is
    client.send(op="subscribe", topic=FIRST)
    assert client.statuses == []
    assert bench.router.counts()["subscriptions"] == 1


@pytest.mark.parametrize("end", [" a", "/", "x" * 200])
async def test_a_name_that_no_topic_may_have_is_refused(bench: Bench, client: Socketless, end: str):
    client.send(op="subscribe", topic=FIRST + end)
    assert [code for code, _ in client.statuses] == ["bad_name"]


async def test_nobody_guesses_the_topic_of_another_client(
    robot: Robot, client: Socketless, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.undo()
    names = {call(client)["values"]["topic_name"] for _ in range(2)}
    assert len(names) == 2
    assert all(re.fullmatch(r"/tf2_web_republisher/tf_repub_[0-9a-f]{16}", name) for name in names)
