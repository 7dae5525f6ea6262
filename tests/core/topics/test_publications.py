# SPDX-License-Identifier: Apache-2.0
from collections.abc import Sequence

import pytest

from gateway.sources.source import Sample
from tests.client import eventually
from tests.core.conftest import STRING, TWIST, Bench


def listen(bench: Bench, topic: str, type_name: str) -> list[dict]:
    heard: list[dict] = []
    decode = bench.types.get(type_name).decode

    def note(samples: Sequence[Sample]) -> None:
        heard.extend(decode(sample.cdr) for sample in samples)

    bench.ros.add_subscription(topic, type_name, note)
    return heard


async def test_a_published_message_reaches_ros_with_defaults_filled_in(bench: Bench):
    heard = listen(bench, "/cmd_vel", TWIST)
    client = bench.sender(op="advertise", topic="/cmd_vel", type=TWIST)
    client.send(op="publish", topic="/cmd_vel", msg={"linear": {"x": 0.25}})
    await eventually(lambda: len(heard) == 1)
    assert heard[0]["linear"] == {"x": 0.25, "y": 0, "z": 0}
    assert client.frames == []


async def test_publishing_without_advertising_takes_the_type_given_or_known(bench: Bench):
    heard = listen(bench, "/known", STRING)
    client = bench.sender(op="publish", topic="known", msg={"data": "by the graph"})
    client.send(op="publish", topic="/new", type=STRING, msg={"data": "by name"})
    await eventually(lambda: len(heard) == 1)
    assert {own.topic for own in bench.ros.publishers} == {"/known", "/new"}


async def test_publishing_on_a_topic_without_type_is_refused(bench: Bench):
    client = bench.sender(op="publish", id="p", topic="/new", msg={})
    assert client.of("status")[0]["id"] == "p"
    assert client.statuses[0][0] == "not_found"
    assert bench.ros.entity_count() == 0


@pytest.mark.parametrize(
    ("type_name", "msg", "words"),
    [
        (TWIST, {"linear": {"x": "fast"}}, "msg.linear.x: expected a number, got a string"),
        (TWIST, {"lineal": {}}, "msg.lineal: unknown field"),
        (TWIST, 5, "msg: expected an object, got 5"),
        ("std_msgs/msg/UInt8", {"data": 300}, "300 is out of range for uint8 (0 to 255)"),
        ("std_msgs/msg/Float32", {"data": 1e39}, "out of range for float32"),
        ("std_msgs/msg/UInt8MultiArray", {"data": "@@@@"}, "base64"),
    ],
)
async def test_a_message_that_does_not_fit_its_type_is_refused_with_its_path(
    bench: Bench, type_name, msg, words
):
    heard = listen(bench, "/t", type_name)
    client = bench.sender(op="publish", topic="/t", type=type_name, msg=msg)
    ((code, text),) = client.statuses
    assert code == "invalid_value"
    assert words in text
    await bench.settle()
    assert heard == []


async def test_a_type_that_contradicts_the_topic_is_refused(bench: Bench):
    bench.ros.add_publisher("/odom", STRING)
    client = bench.sender(op="advertise", topic="/odom", type=TWIST)
    client.send(op="publish", topic="/odom", type=TWIST, msg={})
    client.send(op="advertise", topic="/mine", type=STRING)
    client.send(op="advertise", topic="/mine", type=TWIST)
    client.send(op="publish", topic="/mine", type=TWIST, msg={})
    assert [code for code, _ in client.statuses] == ["type_conflict"] * 4


async def test_a_publisher_stays_until_its_last_advertisement_is_taken_back(bench: Bench):
    client = bench.sender(op="advertise", id="a", topic="/t", type=STRING)
    client.send(op="advertise", id="b", topic="/t", type=STRING)
    assert bench.ros.entity_count() == 1
    client.send(op="unadvertise", id="a", topic="/t")
    assert bench.ros.entity_count() == 1
    client.send(op="unadvertise", id="b", topic="/t")
    assert bench.ros.entity_count() == 0
    client.send(op="unadvertise", topic="/t")
    assert client.statuses == [("not_found", "not advertised: /t")]


async def test_publishers_go_with_their_client(bench: Bench):
    client = bench.sender(op="advertise", topic="/a", type=STRING)
    client.send(op="publish", topic="/b", type=STRING, msg={"data": ""})
    assert bench.ros.entity_count() == 2
    bench.router.leave(client.session)
    assert bench.ros.entity_count() == 0


@pytest.mark.parametrize(
    ("extra", "durability", "depth"),
    [
        ({}, "transient_local", 100),
        ({"queue_size": 3}, "transient_local", 3),
        ({"queue_size": 10**6}, "transient_local", 1024),
        ({"qos": {"durability": "volatile"}}, "volatile", 100),
        ({"latch": True, "queue_size": 100}, "transient_local", 1),
        ({"qos": {"durability": "transient_local", "depth": 7}}, "transient_local", 7),
    ],
)
async def test_latch_queue_size_and_qos_shape_the_publisher(bench: Bench, extra, durability, depth):
    client = bench.sender(op="advertise", topic="/t", type=STRING, **extra)
    client.send(op="publish", topic="/u", type=STRING, msg={}, **extra)
    for publisher in bench.ros.publishers:
        assert (publisher.qos.durability, publisher.qos.depth) == (durability, depth)
    assert len(bench.ros.publishers) == 2


async def test_options_of_a_publisher_are_also_validated_in_publish(bench: Bench):
    client = bench.client()
    for extra in ({"qos": {"depht": 1}}, {"queue_size": -1}, {"latch": "yes"}):
        client.send(op="publish", topic="/t", type=STRING, msg={}, **extra)
    assert [code for code, _ in client.statuses] == ["bad_request"] * 3
    assert bench.ros.publishers == []


async def test_the_publish_that_opens_a_publisher_is_an_advertisement_with_its_id(bench: Bench):
    client = bench.sender(op="publish", id="first", topic="/t", type=STRING, msg={})
    client.send(op="publish", id="second", topic="/t", msg={})
    client.send(op="unadvertise", id="second", topic="/t")
    assert client.statuses == [("not_found", "not advertised: /t with id 'second'")]
    assert bench.ros.entity_count() == 1
    client.send(op="unadvertise", id="first", topic="/t")
    assert bench.ros.entity_count() == 0


async def test_advertisements_are_limited_per_client(bench: Bench):
    client = bench.client()
    for number in range(4):
        client.send(op="advertise", topic=f"/t{number}", type=STRING)
    text = "at most 3 advertisements per client: end one, or raise limits.max_advertisements"
    assert client.statuses == [("limit_exceeded", text)]


@pytest.mark.parametrize(
    ("stamp", "relayed"),
    [
        ({"sec": 0, "nanosec": 0}, {"sec": 0, "nanosec": 0}),
        ({"secs": 0, "nsecs": 0}, {"sec": 0, "nanosec": 0}),
        ({"sec": -1, "nanosec": 10**9}, {"sec": -1, "nanosec": 10**9}),
        ({"sec": 1, "nanosec": 2**32 - 1}, {"sec": 1, "nanosec": 2**32 - 1}),
    ],
)
async def test_a_stamp_is_relayed_as_it_is(bench: Bench, stamp, relayed):
    heard = listen(bench, "/t", "std_msgs/msg/Header")
    client = bench.sender(op="publish", topic="/t", msg={"stamp": stamp, "frame_id": "a"})
    await eventually(lambda: len(heard) == 1)
    assert heard[0]["stamp"] == relayed
    assert client.frames == []


@pytest.mark.parametrize("stamp", [{"stamp": "now"}, {"stamp": {}}, {}])
async def test_now_is_the_time_of_ros(bench: Bench, stamp):
    heard = listen(bench, "/t", "std_msgs/msg/Header")
    bench.sender(op="publish", topic="/t", msg={**stamp, "frame_id": "a", "seq": 5})
    await eventually(lambda: len(heard) == 1)
    assert heard[0]["stamp"]["sec"] == 1_700_000_000
