# SPDX-License-Identifier: Apache-2.0
"""The clients that a gateway has room for by default."""

import contextlib

from tests.client import client
from tests.gateway_process import ALL_TIME, gateway_process

STRING = "std_msgs/msg/String"


async def test_a_recorder_and_a_player_of_300_topics_have_room_among_100_clients():
    async with gateway_process("serve", *ALL_TIME) as gateway, contextlib.AsyncExitStack() as stack:
        clients = [await stack.enter_async_context(client(gateway.url)) for _ in range(100)]
        for each in clients:
            assert await each.sync() == []
        for each, op in zip(clients, ("subscribe", "advertise"), strict=False):
            for number in range(300):
                await each.send(op=op, topic=f"/t{number}", type=STRING)
            assert await each.sync() == []
