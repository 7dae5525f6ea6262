# SPDX-License-Identifier: Apache-2.0
"""Libraries that others wrote, at a gateway that asks for tokens."""

from collections.abc import AsyncIterator
from pathlib import Path

import pytest
import pytest_asyncio

from gateway.access import token_file
from gateway.access.tokens import make_token
from tests.clients.driver import Driver, RefusedError
from tests.gateway_process import GatewayProcess, gateway_process

STRING = "std_msgs/msg/String"
TEXT, TOKEN = make_token("tablet", "operator", "2026-01-02T03:04:05+00:00")

pytestmark = pytest.mark.asyncio(loop_scope="package")


@pytest_asyncio.fixture(scope="package", loop_scope="package")
async def closed_gateway(
    tmp_path_factory: pytest.TempPathFactory,
) -> AsyncIterator[GatewayProcess]:
    path: Path = tmp_path_factory.mktemp("access") / "tokens.json"
    token_file.change(path, lambda tokens: tokens.added(TOKEN))
    keys = ("access.authentication=token", f"access.token_file={path}")
    settings = (argument for key in keys for argument in ("--set", key))
    async with gateway_process("serve", *settings) as gateway:
        yield gateway


async def test_with_a_token_topics_and_services_work_both_ways(
    library: Driver, closed_gateway: GatewayProcess
):
    connection = library.connection()
    await connection.connect(closed_gateway, token=TEXT)
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
