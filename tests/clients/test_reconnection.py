# SPDX-License-Identifier: Apache-2.0
"""A gateway that is restarted, under the libraries' own ways to come back."""

import socket

import pytest
from std_msgs.msg import String
from std_srvs.srv import SetBool

from tests.client import eventually
from tests.clients.driver import Driver
from tests.clients.robot import Robot, until
from tests.gateway_process import gateway_process

STRING = "std_msgs/String"
SET_BOOL = "std_srvs/SetBool"

pytestmark = pytest.mark.asyncio(loop_scope="package")


def free_port() -> str:
    with socket.create_server(("127.0.0.1", 0)) as server:
        return str(server.getsockname()[1])


@pytest.mark.long
async def test_a_restart_of_the_gateway_is_survived(library: Driver, robot: Robot):
    client = library.connection()
    out, into, service = client.own("out"), client.own("in"), client.own("switch")
    port = free_port()
    robot.publish(out, String(data="here"))
    heard = robot.hear(String, into)
    provides = not library.library.is_javascript  # roslib does not advertise a service again
    async with gateway_process("serve", "--port", port) as gateway:
        await client.connect(gateway, again=True)
        await client.next("connected")
        await client.subscribe(out, STRING)
        await client.next("message", out)
        await client.is_awaited(into)
        await client.publish(into, STRING, {"data": "before"})
        await eventually(lambda: heard == [String(data="before")])
        if provides:
            await client.provide(service, SET_BOOL, {})
            await eventually(lambda: robot.knows_service(service))
    await client.next("closed")
    await eventually(lambda: not robot.knows_service(service))
    async with gateway_process("serve", "--port", port):
        await client.next("connected")
        assert await client.next("message", out) == {"data": "here"}

        async def is_heard() -> bool:
            await client.publish(into, STRING, {"data": "after"})
            return String(data="after") in heard

        await until(is_heard)
        if provides:
            assert await robot.call(SetBool, service, data=True) == SetBool.Response()
        await client.close()
    library.events.clear()  # with its warnings of the connections that were refused in the meantime
