# SPDX-License-Identifier: Apache-2.0
"""Services, both ways."""

import asyncio
from typing import Any

import pytest
from rclpy.task import Future
from std_srvs.srv import SetBool, Trigger

from tests.client import eventually
from tests.clients.driver import ROSLIB_2, Connection, RefusedError
from tests.clients.robot import Robot, result, until

SET_BOOL = "std_srvs/SetBool"
TRIGGER = "std_srvs/Trigger"

pytestmark = pytest.mark.asyncio(loop_scope="package")


def switch(request: Any, response: Any) -> Any:
    response.success = request.data
    response.message = "on" if request.data else "off"
    return response


async def known(client: Connection, service: str) -> None:
    """Wait until the gateway has discovered a service: before, a call fails."""

    async def has_type() -> bool:
        return bool(await client.ask("get_service_type", service))

    await until(has_type)


async def test_a_client_calls_a_service_of_a_robot(client: Connection, robot: Robot):
    service = client.own("switch")
    robot.serve(SetBool, service, switch)
    await known(client, service)
    answer = await client.call(service, SET_BOOL, {"data": True})
    assert answer == {"success": True, "message": "on"}


async def test_a_wrong_argument_fails_the_call_in_words(client: Connection, robot: Robot):
    service = client.own("switch")
    robot.serve(SetBool, service, switch)
    await known(client, service)
    with pytest.raises(RefusedError) as refused:
        await client.call(service, SET_BOOL, {"data": "yes"})
    assert "data: expected" in refused.value.reason


async def test_a_service_that_is_not_there_fails_the_call_in_words(client: Connection):
    service = client.own("nowhere")
    with pytest.raises(RefusedError) as refused:
        await client.call(service, SET_BOOL, {}, timeout_s=0.2)
    assert service in refused.value.reason


async def test_a_slow_service_holds_up_nothing_else(client: Connection, robot: Robot):
    slow, fast = client.own("slow"), client.own("fast")
    released = Future()

    async def wait(_: Any, response: Any) -> Any:
        await released
        return response

    robot.serve(Trigger, slow, wait)
    robot.serve(SetBool, fast, switch)
    await known(client, slow)
    await known(client, fast)
    async with asyncio.TaskGroup() as tasks:
        waiting = tasks.create_task(client.call(slow, TRIGGER, {}, timeout_s=0))
        await client.call(fast, SET_BOOL, {"data": False})
        assert not waiting.done()
        robot.release(released)
    assert waiting.result() == {"success": False, "message": ""}


async def test_thirty_calls_at_once_are_each_answered(client: Connection, robot: Robot):
    service = client.own("switch")
    robot.serve(SetBool, service, switch)
    await known(client, service)
    calls = (client.call(service, SET_BOOL, {"data": bool(number % 2)}) for number in range(30))
    answers = await asyncio.gather(*calls)
    assert [answer["success"] for answer in answers] == [False, True] * 15


async def test_a_robot_calls_a_service_of_a_client(client: Connection, robot: Robot):
    service = client.own("provided")
    values = {"success": True, "message": "done"}
    await client.provide(service, SET_BOOL, values)
    answer = await robot.call(SetBool, service, data=True)
    assert answer == SetBool.Response(success=True, message="done")
    assert (await client.next("request", service)) == {"data": True}


async def test_a_client_that_fails_a_request_keeps_no_robot_waiting(
    client: Connection, robot: Robot
):
    service = client.own("failing")
    await client.provide(service, SET_BOOL, {}, succeeds=False)
    assert (await robot.call(SetBool, service, data=True)).success is False


async def test_a_service_is_gone_from_the_graph_after_unadvertise(client: Connection, robot: Robot):
    service = client.own("provided")
    await client.provide(service, SET_BOOL, {})
    await eventually(lambda: robot.knows_service(service))
    await client.do("unadvertise_service", service=service)
    await eventually(lambda: not robot.knows_service(service))


@pytest.mark.parametrize("library", [ROSLIB_2], ids=str, indirect=True)
async def test_a_client_that_unadvertises_leaves_no_robot_waiting(client: Connection, robot: Robot):
    service = client.own("silent")
    await client.do("advertise_silent_service", service=service, type_name=TRIGGER)
    called = await robot.start_call(Trigger, service)
    await client.next("request", service)
    await client.do("unadvertise_service", service=service)
    assert (await result(called)).success is False
