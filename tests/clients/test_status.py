# SPDX-License-Identifier: Apache-2.0
"""What the libraries are told of, unasked: roslibpy takes every status for an error of its own."""

import pytest

from tests.clients.driver import Connection

STRING = "std_msgs/String"

pytestmark = pytest.mark.asyncio(loop_scope="package")


async def make_mistakes(client: Connection) -> None:
    await client.publish(client.own("in"), STRING, {"date": "no such field"})
    await client.do("advertise", topic="/no/../name", type_name=STRING)
    await client.ask("get_nodes")  # is answered after all that


async def test_a_mistake_is_told_of(client: Connection):
    await make_mistakes(client)
    assert client.driver.take("warning")


async def test_a_client_that_wants_no_status_gets_none(client: Connection):
    await client.do("set_status_level", level="none")
    await make_mistakes(client)
    assert client.driver.take("warning") == []
