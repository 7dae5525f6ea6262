# SPDX-License-Identifier: Apache-2.0
"""Two hundred clients that vanish in the middle of things leave nothing behind."""

import asyncio
import json
import random
import signal
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed, InvalidMessage
from websockets.frames import CloseCode

from gateway.sources.actions import CANCELED, GoalRequest
from gateway.sources.services import ServiceRequest
from tests.client import TIMEOUT_S, client, eventually
from tests.e2e.discovery import until_discovered
from tests.gateway_process import GatewayProcess, gateway_process
from tests.sources.outside import Outside

CLIENTS = 200
AT_ONCE = 10
FIBONACCI = "test_msgs/action/Fibonacci"
SEQUENCE = b"\0\1\0\0\0\0\0\0"  # an empty one


def operations(number: int) -> Iterator[dict[str, Any]]:
    """All that opens something, each with separate names and shared ones.

    Transforms are left out: the gateway listens to them for half a minute after the last lookup.
    """
    for name in (f"own_{number}", "shared"):
        yield {"op": "subscribe", "topic": f"/{name}", "type": "std_msgs/String"}
        yield {"op": "advertise", "topic": f"/{name}", "type": "std_msgs/String"}
        yield {"op": "advertise_service", "service": f"/{name}_srv", "type": "std_srvs/SetBool"}
        yield {"op": "advertise_action", "action": f"/{name}_act", "type": "test_msgs/Fibonacci"}
    yield {"op": "subscribe", "topic": "/never_published"}
    yield {"op": "subscribe", "topic": "/shared", "throttle_rate": 60_000, "id": "slow"}
    yield {"op": "call_service", "service": "/silent", "id": "c", "timeout": 600}
    yield {"op": "call_service", "service": "/shared_srv", "id": "d", "timeout": 600}
    yield {"op": "call_service", "service": "/rosapi/get_param_names", "id": "e"}
    yield {"op": "send_action_goal", "action": "/slow", "id": "g", "args": [9], "feedback": True}
    yield {"op": "send_action_goal", "action": "/shared_act", "id": "h", "args": [9]}
    yield {"op": "get_parameters", "node": "/ros2_gateway_debug", "id": "p"}
    yield {"op": "graph", "watch": True}
    yield {"op": "subscribe", "topic": "/shared", "id": "png", "compression": "png"}
    yield {"op": "subscribe", "topic": f"/cbor_{number}", "type": 9, "compression": "cbor"}
    yield {"op": "fragment", "id": "f", "num": 0, "total": 2, "data": '{"op":'}


async def vanish(url: str, number: int) -> bool:
    """Connect, start everything in some order, and cut the connection at some point.

    Return false if there was no room, as the gateway has not noticed yet that others are gone.
    """
    chance = random.Random(number)
    sending = list(operations(number))
    chance.shuffle(sending)
    try:
        async with connect(url, compression=None, proxy=None, max_size=None) as socket:
            for operation in sending[: chance.randint(len(sending) // 2, len(sending))]:
                await socket.send(json.dumps(operation))
            for _ in range(chance.randint(0, 3)):
                await socket.send('{"op":"ping"}')  # nothing else is sure to be answered
                await socket.recv()
            socket.transport.abort()
    except InvalidMessage:  # closed before the handshake
        return False
    except ConnectionClosed as error:
        if error.rcvd is None or error.rcvd.code != CloseCode.TRY_AGAIN_LATER:
            raise
        return False
    return True


def health(url: str) -> dict[str, Any]:
    port = url.split(":")[2].split("/")[0]
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/healthz", timeout=TIMEOUT_S) as response:
        return json.load(response)


def left_behind(gateway: GatewayProcess) -> dict[str, int]:
    """Count what clients have opened, and what the process has."""
    found = health(gateway.url)
    process = Path(f"/proc/{gateway.process.pid}")
    return {name: found[name] for name in (*OPENED, "tasks")} | {
        "descriptors": len(list((process / "fd").iterdir())),
        "threads": len(list((process / "task").iterdir())),
    }


OPENED = (
    *("clients", "subscriptions", "publishers", "services", "action_servers"),
    *("service_clients", "action_clients", "calls", "goals", "ros_entities"),
)


async def at_rest(gateway: GatewayProcess, most: dict[str, int] | None = None) -> dict[str, int]:
    """Wait until nothing is open that a client opened, and no more of the rest than *most*."""
    loop = asyncio.get_running_loop()
    async with asyncio.timeout(TIMEOUT_S):
        while True:
            found = await loop.run_in_executor(None, left_behind, gateway)
            if not any(found[name] for name in OPENED) and (
                most is None or all(found[name] <= most[name] for name in found)
            ):
                return found
            await asyncio.sleep(0.2)  # asking opens a connection


async def test_everything_that_rough_clients_had_open_is_closed_and_forgotten(
    outside: Outside,
) -> None:
    """Also of ROS nodes that never answer, and of each other."""
    requests: list[ServiceRequest] = []
    goals: list[GoalRequest] = []
    cancelled: list[GoalRequest] = []

    def cancel(goal: GoalRequest) -> None:
        cancelled.append(goal)
        goal.finish(CANCELED, SEQUENCE)

    outside.add_service("/silent", "std_srvs/srv/SetBool", requests.append)
    outside.add_action_server("/slow", FIBONACCI, goals.append, cancel)
    async with gateway_process("serve") as gateway:
        async with client(gateway.url) as first:  # loads what stays loaded
            for operation in operations(-1):
                await first.send(**operation)
            await first.sync()
        before = await at_rest(gateway)
        numbers = iter(range(CLIENTS))

        async def some() -> None:
            for number in numbers:
                while not await vanish(gateway.url, number):  # noqa: ASYNC110  # of a process
                    await asyncio.sleep(0.2)

        await asyncio.gather(*(some() for _ in range(AT_ONCE)))
        assert requests
        await at_rest(gateway, most=before)
        assert goals
        await eventually(lambda: len(cancelled) == len(goals))  # nobody waits for them any more
        assert not [line for line in gateway.log if "Traceback" in line]


# a warning of the robot's own rclpy when it answers a gateway that has left
@pytest.mark.filterwarnings("ignore:failed to send response")
async def test_a_gateway_that_is_stopped_cancels_its_clients_goals(outside: Outside) -> None:
    """A robot must not drive on for a client that can no longer stop it."""
    goals: list[GoalRequest] = []
    cancelled: list[GoalRequest] = []
    outside.add_action_server("/slow", FIBONACCI, goals.append, cancelled.append)
    async with gateway_process("serve") as gateway, client(gateway.url) as driver:
        await until_discovered(driver, "action_type", "/slow")
        for number in range(3):
            await driver.send(op="send_action_goal", action="/slow", id=number, args=[9])
        await eventually(lambda: len(goals) == 3)
        assert await gateway.stop(signal.SIGTERM) == 0
        await eventually(lambda: len(cancelled) == 3)
