# SPDX-License-Identifier: Apache-2.0
"""Unrequested statuses of the libraries: roslibpy takes every status for its own error."""

import pytest
from std_msgs.msg import String

from tests.client import client as connected
from tests.clients.driver import Connection
from tests.clients.robot import Robot
from tests.gateway_process import GatewayProcess

STRING = "std_msgs/String"

pytestmark = pytest.mark.asyncio(loop_scope="package")


async def make_mistakes(client: Connection) -> None:
    await client.publish(client.own("in"), STRING, {"date": "no such field"})
    await client.do("advertise", topic="/no/../name", type_name=STRING)
    await client.ask("get_nodes")  # is answered after all that


async def test_a_mistake_is_told_of(client: Connection):
    await make_mistakes(client)
    assert client.driver.take("warning")


async def test_events_of_its_topics_and_services_are_not_reported(
    client: Connection, gateway: GatewayProcess, robot: Robot
):
    topic, service = client.own("camera_state"), client.own("own")
    robot.publish(topic, String(data="x"))
    await client.subscribe(topic, STRING)
    await client.next("message", topic)
    await client.provide(service, "std_srvs/Trigger", {"success": True})
    await client.ask("get_nodes")
    async with connected(gateway.url) as other:
        await other.send(op="events")
        await other.receive(lambda frame: frame["op"] == "events")
        await other.send(op="advertise_service", service=service, type="std_srvs/Trigger")
        robot.close()
        await other.receive(
            lambda frame: (frame.get("topic"), frame.get("code")) == (topic, "publisher_gone")
        )
        await client.do("unadvertise_service", service=service)  # which is the other's by now
        await client.ask("get_nodes")
    assert client.driver.take("warning") == []


async def test_a_client_that_wants_no_status_gets_none(client: Connection):
    await client.do("set_status_level", level="none")
    await make_mistakes(client)
    assert client.driver.take("warning") == []
