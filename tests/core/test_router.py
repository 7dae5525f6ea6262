# SPDX-License-Identifier: Apache-2.0
from functools import partial
from typing import get_args

import pytest

from gateway.core import requests
from gateway.core.errors import ProtocolError
from gateway.core.requests import AnyRequest, Publish, Request
from gateway.sources.source import RosError
from tests.core.conftest import Bench
from tests.sources.fake_services import FakeService


def test_the_union_that_mypy_checks_the_router_against_has_each_request():
    classes = {each for each in vars(requests).values() if isinstance(each, type)}
    made = {each for each in classes if issubclass(each, Request) and hasattr(each, "kind")}
    assert set(get_args(AnyRequest)) == made


async def test_hello_says_who_answers(bench: Bench):
    client = bench.sender(op="hello", id=1)
    (hello,) = client.frames
    assert (hello["server"], hello["version"], hello["id"]) == ("ros2-json-gateway", "test", 1)
    assert hello["ros_distro"] == "jazzy"
    assert hello.items() >= bench.ros.network.items()
    assert hello["limits"]["subscriptions"] == 4


async def test_ping_returns_the_value_and_both_clocks(bench: Bench):
    client = bench.sender(op="ping", value={"t": [1.5, None]})
    (pong,) = client.frames
    assert pong["value"] == {"t": [1.5, None]}
    assert pong["ros_time"] == {"sec": 1_700_000_000, "nanosec": 0}
    assert pong["gateway_time"]["sec"] > 1_700_000_000


async def test_describe_has_schema_definition_number_and_hash(bench: Bench):
    client = bench.sender(op="describe", type="geometry_msgs/Twist")
    (described,) = client.frames
    assert described["type"] == "geometry_msgs/msg/Twist"
    assert described["number"] == 1
    assert "Vector3" in described["definition"]
    assert described["type_hash"].startswith("RIHS01_")
    assert "linear" in described["schema"]["properties"]


async def test_describe_of_a_type_outside_the_table_has_no_number(bench: Bench):
    client = bench.sender(op="describe", type="test_msgs/msg/Nested")
    assert client.frames[0]["number"] is None


async def test_the_graph_names_topics_with_types_and_nodes(bench: Bench):
    bench.ros.add_publisher("/odom", "nav_msgs/msg/Odometry", node="/robot")
    client = bench.sender(op="graph", id="g")
    (graph,) = client.frames
    assert graph["id"] == "g"
    assert {
        "name": "/odom",
        "types": ["nav_msgs/msg/Odometry"],
        "publishers": ["/robot"],
        "subscribers": [],
    } in graph["topics"]
    assert "/robot" in graph["nodes"]


async def test_a_watched_graph_sends_what_changed_and_nothing_else(bench: Bench):
    client = bench.sender(op="graph", id="g", watch=True)
    publisher = bench.ros.add_publisher("/odom", "nav_msgs/msg/Odometry", node="/robot")
    frames = await client.sees(2, "graph")
    assert [topic["name"] for topic in frames[1]["changes"]["topics"]] == ["/odom"]
    assert frames[1]["changes"]["nodes"] == ["/robot"]
    bench.router._on_graph_change()  # which was of nothing that is in it
    bench.ros.remove_publisher(publisher)
    frames = await client.sees(3, "graph")
    assert frames[2]["changes"] == {"gone_topics": ["/odom"], "gone_nodes": ["/robot"]}
    client.send(op="graph", watch=False)
    bench.ros.add_publisher("/odom", "nav_msgs/msg/Odometry")
    await bench.settle()
    assert len(client.of("graph")) == 4  # the answer to the last operation was the last one


async def test_a_watched_topic_that_changes_is_sent_again(bench: Bench):
    client = bench.client()
    bench.ros.add_publisher("/odom", "nav_msgs/msg/Odometry", node="/robot")
    client.send(op="graph", id="g", watch=True)
    bench.ros.add_publisher("/odom", "nav_msgs/msg/Odometry", node="/other")
    frames = await client.sees(2, "graph")
    (topic,) = frames[1]["changes"]["topics"]
    assert topic["publishers"] == ["/other", "/robot"]


async def test_a_refusal_of_ros_comes_back_truncated(bench: Bench, monkeypatch):
    def refuse(*_: object) -> None:
        raise RosError("internal", "x" * 1000)

    monkeypatch.setattr(bench.ros, "subscribe", refuse)
    client = bench.sender(op="subscribe", topic="/odom", type="nav_msgs/Odometry")
    assert client.statuses == [("internal", "x" * 125 + "...")]


async def test_the_graph_knows_the_rate_of_received_topics(bench: Bench):
    client = bench.listener("/chatter", "std_msgs/msg/String")
    for count in range(1, 4):
        bench.ros.publish("/chatter", bench.cdr("std_msgs/msg/String"))
        await client.sees(count)
    client.send(op="graph")
    (graph,) = client.of("graph")
    (topic,) = [topic for topic in graph["topics"] if topic["name"] == "/chatter"]
    assert topic["rate_hz"] > 0


@pytest.mark.parametrize(
    ("data", "code"),
    [
        (b"nonsense", "bad_json"),
        (b'{"op":"hello"', "bad_json"),
        (b'\xff{"op":"hello"}', "bad_json"),
        (b'{"op":"ping","value":nan}', "bad_json"),
        (b'{"op":"hello","op":"ping"}', "bad_json"),
        (b'{"op":"ping","value":' + b"[" * 40 + b"]" * 40 + b"}", "bad_json"),
        (b'{"op":"ping","value":["",' + b"0," * 100_001 + b"0]}", "bad_json"),
        (b"5", "bad_request"),
        (b"[]", "bad_request"),
        (b"null", "bad_request"),
        (b"{}", "bad_request"),
        (b'{"op":[]}', "bad_request"),
        (b'{"op":"subscribe"}', "bad_request"),
        (b'{"op":"subscribe","topic":null}', "bad_request"),
        (b'{"op":"publish","topic":"/t"}', "bad_request"),
        (b'{"op":"advertise","topic":"/t","type":true}', "bad_request"),
        (b'{"op":"subscrib","topic":"/odom"}', "unknown_op"),
        (b'{"op":"call_servic","service":"/x"}', "unknown_op"),
    ],
)
async def test_an_unknown_operation_gets_a_status_and_the_next_one_works(bench: Bench, data, code):
    client = bench.client()
    client.send_raw(data)
    assert [status[0] for status in client.statuses] == [code]
    client.send(op="hello")
    assert client.frames[-1]["op"] == "hello"


async def test_a_refusal_carries_the_id_whatever_else_is_wrong(bench: Bench):
    client = bench.sender(op="subscribe", id="mine", topic=5)
    client.send(op="nonsense", id=17)
    client.send(op=5, id="other")
    assert [frame["id"] for frame in client.frames] == ["mine", 17, "other"]


async def test_old_clients_extras_are_ignored(bench: Bench):
    client = bench.client()
    client.send(
        op="subscribe",
        id=None,
        topic="/t",
        type="std_msgs/String",
        compression="none",
        throttle_rate=0,
        queue_length=0,
        fragment_size=2147483647,
        anything={"else": 1},
    )
    client.send(op="auth", mac="x")
    client.send(op="set_level", level="error", id="l")
    assert client.frames == []
    assert bench.ros.entity_count() == 1


async def test_set_level_decides_which_statuses_come(bench: Bench):
    client = bench.sender(op="set_level", level="none")
    client.send(op="nonsense")
    client.send(op="set_level", level="info")
    client.send(op="subscribe", id="s", topic="/t", type="std_msgs/String")
    (status,) = client.frames
    assert status["level"] == "info"
    assert status["msg"] == "subscribed to /t (std_msgs/msg/String)"


PUBLISH = Publish(topic="/t", msg={})


async def test_of_deferred_work_with_one_key_the_newest_is_done_at_the_end_of_the_turn(
    bench: Bench,
):
    client = bench.client()
    done: list[str] = []
    for key, name in (("/a", "a1"), ("/b", "b1"), ("/a", "a2")):
        client.session.defer(key, PUBLISH, partial(done.append, name))
    assert done == []
    bench.router.end_turn(client.session)
    assert done == ["a2", "b1"]
    bench.router.end_turn(client.session)
    assert done == ["a2", "b1"]


async def test_deferred_work_is_done_before_an_operation_of_another_kind(bench: Bench):
    client = bench.client()
    done: list[str] = []
    client.session.defer("/a", PUBLISH, partial(done.append, "deferred"))
    client.send(op="publish", topic="/t", type="std_msgs/String", msg={"data": ""})
    assert done == []
    client.send(op="ping")
    assert done == ["deferred"]


async def test_deferred_work_that_fails_is_answered_and_the_rest_is_done(bench: Bench):
    client = bench.client()
    done: list[str] = []

    def refuse(error: Exception) -> None:
        raise error

    client.session.defer("/a", PUBLISH, partial(refuse, ProtocolError("invalid_value", "x")))
    client.session.defer("/b", PUBLISH, partial(refuse, RosError("internal", "y")))
    client.session.defer("/c", PUBLISH, partial(done.append, "c"))
    bench.router.end_turn(client.session)
    assert client.statuses == [("invalid_value", "x"), ("internal", "y")]
    assert done == ["c"]


async def test_a_client_that_leaves_takes_everything_along(bench: Bench):
    stays, leaves = bench.client(), bench.client()
    stays.send(op="subscribe", topic="/t", type="std_msgs/String")
    for operation in (
        {"op": "subscribe", "topic": "/t", "type": "std_msgs/String", "throttle_rate": 1000},
        {"op": "subscribe", "topic": "/unknown"},
        {"op": "advertise", "topic": "/a", "type": "std_msgs/String"},
        {"op": "advertise_service", "service": "/s", "type": "std_srvs/Trigger"},
        {"op": "advertise_action", "action": "/f", "type": "test_msgs/Fibonacci"},
        {"op": "graph", "watch": True},
    ):
        leaves.send(**operation)
    bench.router.leave(leaves.session)
    assert bench.ros.entity_count() == 1
    count = len(leaves.frames)
    bench.ros.add_publisher("/unknown", "std_msgs/msg/String")
    bench.ros.add_publisher("/t", "std_msgs/msg/String").publish(bench.cdr("std_msgs/msg/String"))
    await stays.sees(1)
    assert len(leaves.frames) == count
    counts = {name: count for name, count in bench.router.counts().items() if count}
    assert counts == {"clients": 1, "ros_entities": 1, "subscriptions": 1}


@pytest.mark.parametrize("request_id", ['"\n', "ü" * 256, -(2**53)])
async def test_an_id_comes_back_as_it_was(bench: Bench, request_id):
    client = bench.sender(op="subscribe", topic='/"', id=request_id)
    client.send(op="nonsense", id=request_id)
    assert [frame["id"] for frame in client.frames] == [request_id] * 2


@pytest.mark.parametrize(
    "operation",
    [
        {"op": "x" * 100_000},
        {"op": "subscribe", "topic": "/t", "type": "x" * 100_000},
        {"op": "subscribe", "topic": "/t", "id": "x" * 100_000},
        {"op": "subscribe", "topic": "/t", "type": "std_msgs/String", "compression": "x" * 100_000},
        {"op": "subscribe", "topic": "/t", "type": "std_msgs/String", "fields": ["x" * 100_000]},
        {"op": "set_level", "level": "x" * 100_000},
        {"op": "publish", "topic": "/t", "type": "std_msgs/String", "msg": {"x" * 100_000: 1}},
    ],
    ids=lambda operation: f"{operation['op'][:9]}-{list(operation)[-1]}",
)
async def test_a_clients_own_words_come_back_short(bench: Bench, operation):
    client = bench.sender(**operation)
    assert all(len(wire) < 1000 for wire in client.wires)
    assert client.wires


async def test_a_failure_to_close_keeps_nothing_else_open(bench: Bench, monkeypatch):
    client = bench.sender(op="subscribe", topic="/t", type="std_msgs/String")
    client.send(op="advertise_service", service="/s", type="std_srvs/Trigger")
    client.send(op="advertise_action", action="/f", type="test_msgs/Fibonacci")

    def refuse(_):
        raise RosError("internal", "it will not close")

    with monkeypatch.context() as broken:
        broken.setattr(FakeService, "close", refuse)
        with pytest.raises(RosError):
            bench.router.leave(client.session)
    assert bench.ros.entity_count() == 1
    bench.ros.service_servers.clear()


async def test_the_first_watcher_of_the_graph_hears_of_the_first_change(bench: Bench):
    first, second = bench.client(), bench.client()
    first.send(op="graph", watch=True)
    bench.ros.add_service("/s", "std_srvs/srv/Trigger", lambda request: None)
    second.send(op="graph", watch=True)  # which knows it already
    await first.sees(2, "graph")
    (change,) = [frame["changes"] for frame in first.of("graph") if "changes" in frame]
    assert [service["name"] for service in change["services"]] == ["/s"]
    bench.ros.service_servers[0].close()
    await second.sees(3, "graph")
    assert second.of("graph")[-1]["changes"]["gone_services"] == ["/s"]
