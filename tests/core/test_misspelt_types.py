# SPDX-License-Identifier: Apache-2.0
"""A type that is misspelt gets the one that was meant, whatever the operation."""

import pytest

from tests.core.conftest import Bench

MESSAGES = [
    ("geometry_msgs/msg/Twits", "geometry_msgs/msg/Twist"),
    ("geometry_mgs/Twist", "geometry_msgs/msg/Twist"),
    ("nav_msgs/Odom", "nav_msgs/msg/Odometry"),
    ("std_msgs/Strng", "std_msgs/msg/String"),
    ("std_msgs/string", "std_msgs/msg/String"),
    ("twist", "geometry_msgs/msg/Twist"),
    ("Twits", "geometry_msgs/msg/Twist"),
    ("LaserScn", "sensor_msgs/msg/LaserScan"),
]
SERVICES = [
    ("std_srvs/SetBol", "std_srvs/srv/SetBool"),
    ("std_srv/srv/SetBool", "std_srvs/srv/SetBool"),
    ("set_bool", "std_srvs/srv/SetBool"),
    ("SetBol", "std_srvs/srv/SetBool"),
]
ACTIONS = [
    ("test_msgs/Fibonaci", "test_msgs/action/Fibonacci"),
    ("test_mgs/action/Fibonacci", "test_msgs/action/Fibonacci"),
    ("fibonacci", "test_msgs/action/Fibonacci"),
]


def assert_meant(client, meant):
    (refused,) = client.of("status")
    assert refused["code"] == "bad_type"
    assert refused["msg"].endswith(f"; did you mean {meant}?")


@pytest.mark.parametrize(("requested", "meant"), MESSAGES)
@pytest.mark.parametrize(
    "operation",
    [
        {"op": "subscribe", "topic": "/t"},
        {"op": "advertise", "topic": "/t"},
        {"op": "publish", "topic": "/t", "msg": {}},
        {"op": "publish", "topic": "/cmd_vel", "msg": {}},
        {"op": "describe"},
    ],
    ids=lambda operation: operation["op"],
)
async def test_a_message_type(bench: Bench, operation, requested, meant):
    client = bench.sender(**operation, type=requested)
    assert_meant(client, meant)


@pytest.mark.parametrize(("requested", "meant"), SERVICES)
async def test_the_type_of_a_service_that_a_client_provides(bench: Bench, requested, meant):
    client = bench.sender(op="advertise_service", service="/s", type=requested)
    assert_meant(client, meant)


@pytest.mark.parametrize(("requested", "meant"), ACTIONS)
async def test_the_type_of_an_action_that_a_client_provides(bench: Bench, requested, meant):
    client = bench.sender(op="advertise_action", action="/a", type=requested)
    assert_meant(client, meant)


@pytest.mark.parametrize(
    ("requested", "meant"),
    [
        ("std_srvs/srv/SetBol", "std_srvs/srv/SetBool"),
        ("std_srvs/SetBol", "std_srvs/srv/SetBool"),
        ("test_msgs/action/Fibonaci", "test_msgs/action/Fibonacci"),
        ("test_msgs/Fibonaci", "test_msgs/action/Fibonacci"),
        ("set_bool", "std_srvs/srv/SetBool"),
    ],
)
async def test_a_service_or_an_action_to_describe(bench: Bench, requested, meant):
    client = bench.sender(op="describe", type=requested)
    assert_meant(client, meant)


async def test_the_type_of_a_call_is_refused_with_the_one_that_the_service_has(bench: Bench):
    bench.ros.add_service("/arm", "std_srvs/srv/SetBool", lambda request: None)
    client = bench.client()
    client.send(op="call_service", service="/arm", type="std_srvs/SetBol", args={"data": True})
    client.send(op="call_service", service="/arm", type="set_bool", args={"data": True})
    first, second = client.of("service_response")
    assert first["values"] == (
        "service /arm has type std_srvs/srv/SetBool, not std_srvs/srv/SetBol: "
        "use its type, or leave it out"
    )
    assert second["values"].endswith("did you mean std_srvs/srv/SetBool?")


async def test_the_type_of_a_goal_is_refused_with_the_one_that_the_action_has(bench: Bench):
    bench.ros.add_action_server(
        "/fib", "test_msgs/action/Fibonacci", lambda goal: None, lambda goal: None
    )
    client = bench.client()
    client.send(op="send_action_goal", id=1, action="/fib", action_type="test_msgs/Fibonaci")
    client.send(op="send_action_goal", id=2, action="/fib", action_type="fibonacci")
    first, second = client.of("action_result")
    assert "action /fib has type test_msgs/action/Fibonacci, not" in first["values"]
    assert second["values"].endswith("did you mean test_msgs/action/Fibonacci?")
