# SPDX-License-Identifier: Apache-2.0
"""Parameters of other nodes, by the names that rosapi gives them: ``/node:parameter``."""

import contextlib
from typing import Any

import pytest
import pytest_asyncio
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node
from rclpy.parameter import Parameter

from tests.clients.driver import ROSLIB_2, Connection, RefusedError
from tests.clients.robot import until

pytestmark = pytest.mark.asyncio(loop_scope="package")


@pytest_asyncio.fixture(loop_scope="package")
async def there(client: Connection, settings: Node) -> Node:
    """Wait until the gateway knows the node."""

    async def is_listed() -> bool:
        return "/settings:speed" in await client.ask("get_params")

    await until(is_listed)
    return settings


def reads_reasons(client: Connection) -> bool:
    """Return whether the library reads ``successful``. The others take any answer for success."""
    return client.library == ROSLIB_2


def refusal(client: Connection) -> contextlib.AbstractContextManager[object]:
    """Expect what the library makes of a refusal."""
    return pytest.raises(RefusedError) if reads_reasons(client) else contextlib.nullcontext()


@pytest.mark.parametrize(
    ("name", "value"), [("speed", 0.5), ("name", "burger"), ("wheels", [1, 2])]
)
async def test_a_parameter_is_read(client: Connection, there: Node, name: str, value: Any):
    read: list[object] = []

    async def is_read() -> bool:
        with contextlib.suppress(RefusedError):
            read.append(await client.do("get_param", name=f"/settings:{name}"))
        return read[-1:] not in ([], [None])  # if a busy node took longer than the gateway waits

    await until(is_read)
    assert read[-1] == value


async def test_a_parameter_is_set(client: Connection, there: Node):
    there.set_parameters([Parameter("turn", value=0.0)])
    await client.do("set_param", name="/settings:turn", value=-1.5)
    assert there.get_parameter("turn").value == -1.5


async def test_a_parameter_that_is_not_there_has_no_value(client: Connection, there: Node):
    if reads_reasons(client):
        with pytest.raises(RefusedError, match="colour"):
            await client.do("get_param", name="/settings:colour")
    else:
        assert await client.do("get_param", name="/settings:colour") is None


async def test_a_node_that_is_not_there_has_no_parameters(client: Connection):
    if reads_reasons(client):
        with pytest.raises(RefusedError, match="/nobody"):
            await client.do("get_param", name="/nobody:speed")
    else:
        assert await client.do("get_param", name="/nobody:speed") is None


async def test_a_value_of_another_type_is_refused(client: Connection, there: Node):
    with refusal(client):
        await client.do("set_param", name="/settings:name", value=[1, 2])
    assert there.get_parameter("name").value == "burger"


async def test_a_parameter_is_deleted(client: Connection, there: Node):
    name = client.name
    there.declare_parameter(name, 1, ParameterDescriptor(dynamic_typing=True))
    await client.do("delete_param", name=f"/settings:{name}")
    assert not there.has_parameter(name)


async def test_a_parameter_that_must_stay_is_not_deleted(client: Connection, there: Node):
    with refusal(client):
        await client.do("delete_param", name="/settings:speed")
    assert there.has_parameter("speed")
