# SPDX-License-Identifier: Apache-2.0
"""Libraries that others wrote, at a gateway that asks for tokens."""

import pytest

from tests.clients.conftest import TOKEN
from tests.clients.driver import Driver, RefusedError
from tests.gateway_process import GatewayProcess

STRING = "std_msgs/msg/String"

pytestmark = pytest.mark.asyncio(loop_scope="package")


async def test_with_a_token_topics_and_services_work_both_ways(
    library: Driver, closed_gateway: GatewayProcess
):
    connection = library.connection()
    await connection.connect(closed_gateway, token=TOKEN)
    topic = connection.own("chatter")
    await connection.subscribe(topic, STRING)
    await connection.is_awaited(topic)
    await connection.publish(topic, STRING, {"data": "hello"})
    assert await connection.next("message", topic) == {"data": "hello"}
    version = await connection.call("/rosapi/get_ros_version", "rosapi/GetROSVersion", {})
    assert version["version"] == 2
    await connection.close()
    assert library.take("warning") == []
    library.events.clear()


async def test_without_a_token_the_library_is_told_why(
    library: Driver, closed_gateway: GatewayProcess
):
    connection = library.connection()
    await connection.connect(closed_gateway)
    with pytest.raises(RefusedError, match="authenticate first"):
        await connection.call("/rosapi/get_ros_version", "rosapi/GetROSVersion", {})
    await connection.close()
    library.take("warning")
    library.events.clear()
