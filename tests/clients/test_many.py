# SPDX-License-Identifier: Apache-2.0
"""Many clients at once, and clients that end without a word."""

import asyncio
import contextlib

import pytest
from action_msgs.msg import GoalStatus
from std_msgs.msg import String
from std_srvs.srv import Trigger
from test_msgs.action import Fibonacci

from tests.client import eventually
from tests.clients.driver import LIBRARIES, ROSLIB_2, Library, driver
from tests.clients.robot import ENDLESS, Robot, result, until
from tests.gateway_process import GatewayProcess

STRING = "std_msgs/String"
EACH = 6

pytestmark = pytest.mark.asyncio(loop_scope="package")


async def test_thirty_connections_at_once_all_get_everything(gateway: GatewayProcess, robot: Robot):
    async with contextlib.AsyncExitStack() as stack:
        drivers = [await stack.enter_async_context(driver(each)) for each in LIBRARIES]
        clients = [each.connection() for each in drivers for _ in range(EACH)]
        assert len(clients) == 30
        await asyncio.gather(*(client.connect(gateway) for client in clients))
        await asyncio.gather(*(client.subscribe("/many", STRING) for client in clients))
        robot.publish("/many", *(String(data=str(number)) for number in range(10)))
        for client in clients:
            while await client.next("message", "/many") != {"data": "9"}:
                pass
        heard = robot.hear(String, "/back", 100)
        await clients[0].is_awaited("/back")
        for client in clients:
            await client.publish("/back", STRING, {"data": client.name})
        await eventually(lambda: len(heard) == len(clients))
        assert {message.data for message in heard} == {client.name for client in clients}


@pytest.mark.parametrize("version", LIBRARIES, ids=str)
async def test_a_client_that_is_killed_leaves_nothing(
    version: Library, gateway: GatewayProcess, robot: Robot
):
    async with driver(version) as running:
        client = running.connection()
        topics, service = [client.own("in"), client.own("out")], client.own("service")
        await client.connect(gateway)
        await client.do("advertise", topic=topics[0], type_name=STRING)
        await client.subscribe(topics[1], STRING)
        await client.provide(service, "std_srvs/Trigger", {})
        await eventually(lambda: all(map(robot.knows_topic, topics)))
        await eventually(lambda: robot.knows_service(service))
        running.process.kill()
        await eventually(lambda: not any(map(robot.knows_topic, topics)))
        await eventually(lambda: not robot.knows_service(service))


async def test_requests_to_a_killed_client_are_answered(gateway: GatewayProcess, robot: Robot):
    async with driver(ROSLIB_2) as running:
        client = running.connection()
        service, action = client.own("silent"), client.own("fibonacci")
        await client.connect(gateway)
        await client.do("advertise_silent_service", service=service, type_name="std_srvs/Trigger")
        await client.do("advertise_action", action=action, type_name="test_msgs/Fibonacci")
        called = await robot.start_call(Trigger, service)
        sender = await robot.action_client(action)
        goal = await result(sender.send_goal_async(Fibonacci.Goal(order=1)))
        await client.next("request", service)
        await client.next("goal", action)
        ending = goal.get_result_async()
        running.process.kill()
        assert (await result(called)).success is False
        assert (await result(ending)).status == GoalStatus.STATUS_ABORTED


async def test_a_goal_of_a_client_that_is_killed_is_cancelled(
    gateway: GatewayProcess, robot: Robot
):
    async with driver(ROSLIB_2) as running:
        client = running.connection()
        action = client.own("fibonacci")
        ended = robot.provide_fibonacci(action)
        await client.connect(gateway)

        async def is_listed() -> bool:
            return action in await client.ask("get_action_servers")

        await until(is_listed)
        goal = await client.send_goal(action, "test_msgs/Fibonacci", {"order": ENDLESS})
        await client.next("feedback", goal)
        running.process.kill()
        await eventually(lambda: ended == [GoalStatus.STATUS_CANCELED])
