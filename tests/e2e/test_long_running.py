# SPDX-License-Identifier: Apache-2.0
"""A gateway's process behaves after an hour as after a minute."""

import asyncio

import pytest

from tests.client import Client, client
from tests.gateway_process import ALL_TIME, gateway_process

STRING = "std_msgs/msg/String"
FIBONACCI = "test_msgs/action/Fibonacci"
MORE_THAN_FAST_DDS_KEEPS = 5001  # samples
AT_ONCE = 8  # goals
# DDS' handshake with a new reader, which nothing tells of. A shorter wait could only hide a loss.
HANDSHAKE_S = 0.3


async def test_messages_of_a_client_reach_one_that_subscribes_late():
    async with gateway_process("serve", *ALL_TIME) as gateway, client(gateway.url) as old:
        await old.send(op="advertise", topic="/old", type=STRING)
        for number in range(MORE_THAN_FAST_DDS_KEEPS):
            await old.send(op="publish", topic="/old", msg={"data": str(number)})
        await old.sync()
        async with client(gateway.url) as late:
            await late.send(op="subscribe", topic="/old", type=STRING)
            await late.sync()
            await asyncio.sleep(HANDSHAKE_S)
            await old.send(op="publish", topic="/old", msg={"data": "late"})
            assert await late.message("/old") == {"data": "late"}


async def test_goals_reach_an_action_that_is_advertised_again():
    async with gateway_process("serve", *ALL_TIME) as gateway, client(gateway.url) as caller:
        async with client(gateway.url) as first:
            await _carry_out_goals(caller, first, MORE_THAN_FAST_DDS_KEEPS)
        async with client(gateway.url) as second:
            await _carry_out_goals(caller, second, 1)


async def _carry_out_goals(caller: Client, server: Client, count: int) -> None:
    await server.send(op="advertise_action", action="/count", type=FIBONACCI)
    await server.sync()
    await asyncio.sleep(HANDSHAKE_S)
    for first in range(0, count, AT_ONCE):
        numbers = range(first, min(first + AT_ONCE, count))
        for number in numbers:
            goal = {"action": "/count", "args": {"order": number}}
            await caller.send(op="send_action_goal", id=str(number), **goal)
        for _ in numbers:
            try:
                goal = await server.receive(lambda frame: frame["op"] == "send_action_goal")
            except TimeoutError:
                pytest.fail(f"goals are missing, and their sender got {await caller.sync()}")
            values = {"sequence": [goal["args"]["order"]]}
            done = {"action": "/count", "status": 4, "result": True, "values": values}
            await server.send(op="action_result", id=goal["id"], **done)
        ended = [
            await caller.receive(lambda frame: frame["op"] == "action_result") for _ in numbers
        ]
        assert {each["id"]: each["values"] for each in ended} == {
            str(number): {"sequence": [number]} for number in numbers
        }
