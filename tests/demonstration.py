# SPDX-License-Identifier: Apache-2.0
"""The gateway with the simulated robot, for tests that talk to the robot."""

import asyncio
import contextlib
from collections.abc import AsyncIterator, Sequence

from tests.client import Client, client
from tests.gateway_process import GatewayProcess, gateway_process

ROBOT = "/simulated_robot"
POLL_S = 0.05  # well below the operations that a client may send

_SERVICES = {"/motor_power", "/reset", f"{ROBOT}/list_parameters"}


@contextlib.asynccontextmanager
async def demonstration(
    *arguments: str, module: str = "tests.patient_gateway", before: Sequence[str] = ()
) -> AsyncIterator[GatewayProcess]:
    """Run ``ros2-gateway demo`` until the context ends, and enter once the robot is known.

    *before* is as for `gateway_process`.

    And once it is known alone: a robot that an earlier test has killed stays in the graph for 20 s.
    """
    async with gateway_process("demo", *arguments, module=module, before=before) as gateway:
        await _wait_for_the_robot(gateway.url)
        yield gateway


async def until_it_can_be_driven(speaker: Client) -> None:
    """Wait until the guard process has discovered the robot: until then nothing moves it."""
    state = None
    while state != "ready":
        await asyncio.sleep(POLL_S)
        await speaker.send(op="control", topic="/cmd_vel")
        state = (await speaker.receive(lambda frame: frame["op"] == "control"))["guard"]


async def _wait_for_the_robot(url: str) -> None:
    async with client(url) as speaker:
        await speaker.send(op="subscribe", topic="/odom", type="nav_msgs/msg/Odometry")
        await speaker.message("/odom")
        await until_it_can_be_driven(speaker)
        provided: set[str] = set()
        while not provided >= _SERVICES:
            await asyncio.sleep(POLL_S)
            await speaker.send(op="graph")
            graph = await speaker.receive(lambda frame: frame["op"] == "graph")
            provided = {each["name"] for each in graph["services"] if each["nodes"] == [ROBOT]}
