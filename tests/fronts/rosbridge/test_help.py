# SPDX-License-Identifier: Apache-2.0
import json

import pytest

from gateway.access.permissions import Identity, Policy
from gateway.config.access import AccessConfig, OperatorConfig
from gateway.fronts.rosbridge.help import DOCS
from gateway.fronts.rosbridge.operations import OPERATIONS
from tests.core.conftest import ODOMETRY, Bench


def tried(client):
    return list(client.of("help")[-1]["try"].values())


async def test_help_has_lines_to_try_and_where_the_docs_are(bench: Bench):
    client = bench.sender(op="help", id="h")
    (answer,) = client.frames
    assert (answer["id"], answer["docs"]) == ("h", DOCS)
    assert answer["operations"] == list(OPERATIONS)
    assert len(answer["try"]) >= 3


@pytest.mark.parametrize(
    "text",
    [b"help", b"?", b"h", b"HELP\r\n", b" Help ", b"/help", b"--help", b'"help"', b"help()"],
)
async def test_texts_of_a_person_who_asks_for_help_are_understood(bench: Bench, text):
    client = bench.client()
    client.send_raw(text)
    (answer,) = client.frames
    assert answer["op"] == "help"


async def test_other_text_is_refused_with_the_way_to_help(bench: Bench):
    client = bench.client()
    for text in (b"hullo", b"subscribe /odom", b"", b"help" + b" " * 20):  # it is short
        client.send_raw(text)
    assert [code for code, _ in client.statuses] == ["bad_json"] * 4
    assert all(message.endswith(": send help to see examples") for _, message in client.statuses)
    client.send_raw(b'{"op":')
    assert "help" not in client.statuses[-1][1]


async def test_each_frame_has_a_separate_line(bench: Bench):
    bench.ros.add_publisher("/odom", ODOMETRY)
    client = bench.sender(op="help")
    lines = client.wires[0].partition(b"{")[2].decode().splitlines()
    frames = tried(client)
    assert [json.loads(line) for line in lines if line.startswith('{"op"')] == frames


async def test_the_topic_to_try_is_one_of_the_robot_and_short(bench: Bench):
    for topic, type_name in [
        ("/camera/image_raw", "sensor_msgs/msg/Image"),
        ("/rosout", "rcl_interfaces/msg/Log"),
        ("/odom", ODOMETRY),
    ]:
        bench.ros.add_publisher(topic, type_name)
    bench.ros.add_subscription("/cmd_vel", "geometry_msgs/msg/Twist", lambda samples: None)
    client = bench.sender(op="help")
    assert {"op": "subscribe", "topic": "/odom", "throttle_rate": 1000} in tried(client)


@pytest.mark.parametrize("role", ["viewer", "operator", "admin"])
@pytest.mark.parametrize("has_robot", [True, False])
async def test_every_line_is_accepted(bench: Bench, role, has_robot):
    if has_robot:
        bench.ros.add_publisher("/odom", ODOMETRY)
    identity = Identity("tablet", Policy(AccessConfig()).of(role))
    client = bench.client(identity=identity)
    client.send(op="help")
    frames = tried(client)
    assert ("publish" in {frame["op"] for frame in frames}) == (role != "viewer")
    for frame in frames:
        client.send(**frame)
    await client.sees(1, "service_response")
    assert client.statuses == []
    assert client.of("service_response")[0]["result"]


async def test_a_topic_to_try_is_one_that_the_client_may_subscribe_to(bench: Bench):
    bench.ros.add_publisher("/odom", ODOMETRY)
    config = AccessConfig(operator=OperatorConfig(deny_subscribe=("/odom",)))
    client = bench.client(identity=Identity("tablet", Policy(config).of("operator")))
    client.send(op="help")
    assert "/odom" not in json.dumps(client.frames)


async def test_nothing_is_published_where_others_mean_something_by_it(bench: Bench):
    bench.ros.add_publisher("/chatter", "geometry_msgs/msg/Twist")
    client = bench.sender(op="help")
    assert "publish" not in {frame["op"] for frame in tried(client)}


async def test_the_parameters_to_try_are_those_of_a_node_that_has_some(bench: Bench):
    bench.ros.add_publisher("/odom", ODOMETRY, node="/robot")
    bench.ros.add_service(
        "/robot/list_parameters",
        "rcl_interfaces/srv/ListParameters",
        lambda request: None,
        node="/robot",
    )
    client = bench.sender(op="help")
    assert {"op": "list_parameters", "node": "/robot"} in tried(client)


async def test_an_action_is_described_and_gets_no_goal(bench: Bench):
    bench.ros.add_action_server(
        "/fib", "test_msgs/action/Fibonacci", lambda goal: None, lambda goal: None
    )
    client = bench.sender(op="help")
    assert {"op": "describe", "type": "/fib"} in tried(client)
    assert "send_action_goal" not in {frame["op"] for frame in tried(client)}
    viewer = bench.client(identity=Identity("screen", Policy(AccessConfig()).of("viewer")))
    viewer.send(op="help")
    assert "/fib" not in json.dumps(tried(viewer))


async def test_the_answer_is_bounded_whatever_the_graph_holds(bench: Bench):
    for number in range(300):
        bench.ros.add_publisher(f"/{'x' * 240}{number}", ODOMETRY)
    client = bench.sender(op="help")
    assert len(client.wires[0]) < 4096


async def test_a_client_without_its_token_is_asked_for_it(bench: Bench):
    client = bench.client(identity=None)
    client.send_raw(b"help")
    ((code, text),) = client.statuses
    assert code == "forbidden"
    assert '{"op":"auth","token":"TOKEN"}' in text
