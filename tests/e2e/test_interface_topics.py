# SPDX-License-Identifier: Apache-2.0
"""Topics whose types rosidl derives from an action or a service, read by clients."""

import asyncio
import contextlib
from collections.abc import AsyncIterator, Iterator

import pytest
import pytest_asyncio
from rclpy.qos import QoSProfile
from rclpy.service_introspection import ServiceIntrospectionState
from std_srvs.srv import SetBool

from tests.client import client
from tests.clients.robot import Robot
from tests.gateway_process import gateway_process
from tests.sources.outside import Outside

ACTION, SERVICE = "/fib", "/arm"


pytestmark = pytest.mark.asyncio(loop_scope="module")


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def url() -> AsyncIterator[str]:
    async with gateway_process("serve") as gateway:
        yield gateway.url


@pytest.fixture(scope="module")
def robot() -> Iterator[Robot]:
    outside = Outside("robot")
    robot = Robot(outside)
    robot.provide_fibonacci(ACTION)
    node = outside.node
    service = node.create_service(SetBool, SERVICE, lambda request, response: response)
    contents = ServiceIntrospectionState.CONTENTS
    service.configure_introspection(node.get_clock(), QoSProfile(depth=100), contents)
    yield robot
    node.destroy_service(service)
    robot.close()
    outside.close()


@pytest.mark.parametrize(
    ("topic", "type_name", "operation", "fields"),
    [
        (
            f"{ACTION}/_action/feedback",
            "test_msgs/action/Fibonacci_FeedbackMessage",
            {"op": "send_action_goal", "action": ACTION, "args": {"order": 5}},
            {"goal_id", "feedback"},
        ),
        (
            f"{ACTION}/_action/status",
            "action_msgs/msg/GoalStatusArray",
            {"op": "send_action_goal", "action": ACTION, "args": {"order": 5}},
            {"status_list"},
        ),
        (
            f"{SERVICE}/_service_event",
            "std_srvs/srv/SetBool_Event",
            {"op": "call_service", "service": SERVICE, "args": {"data": True}},
            {"info", "request", "response"},
        ),
    ],
)
@pytest.mark.parametrize("is_named", [False, True])
async def test_topics_of_an_action_or_a_service_are_read(
    url, robot, topic, type_name, operation, fields, is_named
):
    named = {"type": type_name} if is_named else {}
    async with client(url) as reader:
        await reader.send(op="subscribe", topic=topic, **named)

        async def ask() -> None:  # until discovery has both ends
            while True:
                await reader.send(**operation)
                await asyncio.sleep(0.5)

        asking = asyncio.create_task(ask())
        try:
            assert set(await reader.message(topic)) == fields
        finally:
            asking.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await asking
