# SPDX-License-Identifier: Apache-2.0
import pytest

from gateway.access.permissions import Identity, Policy
from gateway.config.access import AccessConfig, ViewerConfig
from tests.core.conftest import FIBONACCI, SET_BOOL, TRIGGER, Bench


@pytest.fixture
def robot(bench: Bench) -> Bench:
    bench.ros.add_publisher("/odom", "nav_msgs/msg/Odometry")
    bench.ros.add_publisher("/camera/front/image_raw", "sensor_msgs/msg/Image")
    bench.ros.add_service("/power", SET_BOOL, lambda request: None)
    bench.ros.add_action_server("/fib", FIBONACCI, lambda goal: None, lambda goal: None)
    return bench


@pytest.mark.parametrize(
    ("requested", "name", "type_name", "parts"),
    [
        ("/odom", "/odom", "nav_msgs/msg/Odometry", ["header", "child_frame_id", "pose", "twist"]),
        ("odom", "/odom", "nav_msgs/msg/Odometry", ["header", "child_frame_id", "pose", "twist"]),
        ("/power", "/power", SET_BOOL, ["request", "response"]),
        ("power", "/power", SET_BOOL, ["request", "response"]),
        ("/fib", "/fib", FIBONACCI, ["goal", "result", "feedback"]),
    ],
)
async def test_anything_with_a_type_is_described_by_its_name(
    robot: Bench, requested, name, type_name, parts
):
    client = robot.client()
    client.send(op="describe", id=1, type=requested)
    (described,) = client.frames
    assert (described["id"], described["name"], described["type"]) == (1, name, type_name)
    assert list(described["schema"]["properties"]) == parts


async def test_examples_are_for_what_was_asked_for(robot: Bench):
    client = robot.client()
    for requested in ("/odom", "nav_msgs/Odometry", "/power", SET_BOOL, "/fib", FIBONACCI):
        client.send(op="describe", type=requested)
    topic, message, *services, first, second = [frame["example"] for frame in client.frames]
    assert (topic["topic"], message["topic"]) == (
        "/odom",
        "/example/nav_msgs/msg/Odometry",
    )
    call = {"op": "call_service", "service": "/power", "type": SET_BOOL, "args": {"data": False}}
    assert services == [call, call]
    assert first == second
    assert (first["op"], first["action"], first["action_type"], first["args"]) == (
        "send_action_goal",
        "/fib",
        FIBONACCI,
        {"order": 0},
    )


async def test_an_example_has_a_separate_line(robot: Bench):
    client = robot.client()
    client.send(op="describe", id="d", type="/power")
    lines = client.wires[0].partition(b"{")[2].splitlines()
    call = '{"op":"call_service","service":"/power","type":"%s","args":{"data":false}}'
    assert lines[1].decode() == call % SET_BOOL


async def test_a_service_that_nobody_provides_has_no_example(robot: Bench):
    client = robot.client()
    client.send(op="describe", type=TRIGGER)
    assert "example" not in client.frames[0]


@pytest.mark.parametrize(
    ("requested", "code", "text"),
    [
        ("/odm", "not_found", "no topic, service or action is called /odm; did you mean /odom?"),
        ("/pwr", "not_found", "no topic, service or action is called /pwr; did you mean /power?"),
        ("/camera", "not_found", "called /camera; did you mean /camera/front/image_raw?"),
        ("/Odometry", "not_found", "; did you mean nav_msgs/msg/Odometry?"),
        ("/xyzzy", "not_found", "no topic, service or action is called /xyzzy"),
        ("xyzzy", "bad_type", "is not a valid message type: expected pkg/msg/Name"),
        ("/" + "x" * 5000, "not_found", "..."),
    ],
)
async def test_an_unknown_name_is_refused_with_a_suggestion(robot: Bench, requested, code, text):
    client = robot.client()
    client.send(op="describe", type=requested)
    ((got, message),) = client.statuses
    assert got == code
    assert message.endswith(text) or text in message
    assert len(message) < 300


async def test_a_topic_of_two_types_has_to_be_described_by_one(robot: Bench):
    robot.ros.add_publisher("/odom", "std_msgs/msg/String")
    client = robot.client()
    client.send(op="describe", type="/odom")
    assert client.statuses == [
        (
            "type_conflict",
            "/odom has types nav_msgs/msg/Odometry and std_msgs/msg/String: describe one",
        )
    ]


async def test_a_hidden_name_does_not_exist(robot: Bench):
    hiding = AccessConfig(viewer=ViewerConfig(deny_subscribe=("/odom",)))
    client = robot.client(identity=Identity("tablet", Policy(hiding).of("viewer")))
    client.send(op="describe", type="/odom")
    client.send(op="describe", type="/odm")
    client.send(op="describe", type=SET_BOOL)
    absent = "no topic, service or action is called"
    assert client.statuses == [("not_found", f"{absent} /odom"), ("not_found", f"{absent} /odm")]
    assert "example" not in client.frames[2]  # as it may not call the service
