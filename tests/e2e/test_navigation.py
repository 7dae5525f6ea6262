# SPDX-License-Identifier: Apache-2.0
"""A client sends the simulated robot somewhere, by the action of Nav2, as the README shows."""

import asyncio
import math
from collections.abc import AsyncIterator
from typing import Any

import pytest
import pytest_asyncio

from tests.client import TIMEOUT_S, Client, Frame, client
from tests.demonstration import POLL_S, demonstration

pytestmark = pytest.mark.asyncio(loop_scope="module")

ACTION = "/navigate_to_pose"
TWIST = "geometry_msgs/msg/Twist"
BESIDE_THE_PARTITION = (1.65, 0.85)
BEHIND_THE_PARTITION = (2.15, 0.85)
SUCCEEDED, CANCELED, ABORTED = 4, 5, 6


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def url() -> AsyncIterator[str]:
    async with demonstration() as gateway:
        async with client(gateway.url) as speaker:
            await until_provided(speaker)
        yield gateway.url


async def until_provided(speaker: Client) -> None:
    async with asyncio.timeout(TIMEOUT_S):
        while True:
            await speaker.send(op="graph")
            graph = await speaker.receive(lambda frame: frame["op"] == "graph")
            if [each for each in graph["actions"] if each["name"] == ACTION]:
                return
            await asyncio.sleep(POLL_S)


@pytest_asyncio.fixture(loop_scope="module")
async def operator(url: str) -> AsyncIterator["Operator"]:
    """Yield a separate client, with the robot back at its start."""
    async with client(url) as speaker:
        operator = Operator(speaker)
        await operator.reset()
        await speaker.send(op="subscribe", topic="/odom", type="nav_msgs/msg/Odometry")
        await speaker.send(op="subscribe", topic="/rosout", type="rcl_interfaces/msg/Log")
        await speaker.message("/odom")
        yield operator


class Operator:
    """A person with a client."""

    def __init__(self, speaker: Client) -> None:
        self.speaker = speaker

    async def reset(self) -> None:
        await self.speaker.send(op="call_service", service="/reset")
        await self.speaker.receive(lambda frame: frame["op"] == "service_response")

    async def place(self, x: float, y: float) -> None:
        pose = {"pose": {"position": {"x": x, "y": y}, "orientation": {"w": 1.0}}}
        message = {"header": {"frame_id": "map"}, "pose": pose}
        while (await self.odometry())["pose"]["pose"]["position"]["x"] != x:
            await self.speaker.send(
                op="publish",
                topic="/initialpose",
                type="geometry_msgs/msg/PoseWithCovarianceStamped",
                msg=message,
            )
            await asyncio.sleep(POLL_S)

    async def send_to(self, x: Any, y: Any, frame_id: str = "map", **more: Any) -> None:
        pose = {"position": {"x": x, "y": y}, "orientation": {"w": 1.0}}
        args = {"pose": {"header": {"frame_id": frame_id}, "pose": pose}}
        more = {"id": "go", "feedback": True, **more}
        await self.speaker.send(op="send_action_goal", action=ACTION, args=args, **more)

    async def feedback(self, goal: str = "go") -> Any:
        frame = await self.speaker.receive(
            lambda frame: frame["op"] == "action_feedback" and frame["id"] == goal
        )
        return frame["values"]

    async def result(self, goal: str = "go") -> Frame:
        return await self.speaker.receive(
            lambda frame: frame["op"] == "action_result" and frame["id"] == goal
        )

    async def odometry(self) -> Any:
        return await self.speaker.message("/odom")

    async def until_it_moves(self) -> None:
        while (await self.odometry())["twist"]["twist"]["linear"]["x"] < 0.05:
            pass

    async def until_it_stands(self) -> None:
        while any((await self.odometry())["twist"]["twist"]["linear"].values()):
            pass

    async def logged(self, text: str) -> None:
        def is_it(frame: Frame) -> bool:
            return frame.get("topic") == "/rosout" and text in frame["msg"]["msg"]

        if not any(map(is_it, self.speaker.seen)):
            await self.speaker.receive(is_it)


async def test_a_goal_around_the_partition_succeeds_with_feedback(operator: Operator):
    await operator.place(*BESIDE_THE_PARTITION)
    await operator.send_to(*BEHIND_THE_PARTITION)
    first = await operator.feedback()
    straight = math.dist(BESIDE_THE_PARTITION, BEHIND_THE_PARTITION)
    assert first["distance_remaining"] > 1.1 * straight
    assert first["current_pose"]["header"]["frame_id"] == "map"
    assert first["current_pose"]["pose"]["position"]["x"] == pytest.approx(1.65, abs=0.05)
    assert first["number_of_recoveries"] == 0
    result = await operator.result()
    assert (result["status"], result["result"]) == (SUCCEEDED, True)
    assert result["values"] == {"error_code": 0, "error_msg": ""}
    last = [frame for frame in operator.speaker.seen if frame["op"] == "action_feedback"][-1]
    values = last["values"]
    assert values["distance_remaining"] < 0.2
    duration = values["navigation_time"]
    assert duration["sec"] >= 3, "the robot's speed has its limits"
    position = (await operator.odometry())["pose"]["pose"]["position"]
    assert math.dist((position["x"], position["y"]), BEHIND_THE_PARTITION) < 0.06


async def test_a_goal_that_is_canceled_stops_the_robot(operator: Operator):
    await operator.send_to(2.0, 0.0)
    await operator.until_it_moves()
    await operator.speaker.send(op="cancel_action_goal", action=ACTION, id="go")
    result = await operator.result()
    assert (result["status"], result["result"]) == (CANCELED, True)
    await operator.until_it_stands()


async def test_the_goal_of_a_client_that_leaves_is_canceled(operator: Operator, url: str):
    async with client(url) as leaving:
        await Operator(leaving).send_to(2.0, 0.0)
        await operator.until_it_moves()
    await operator.until_it_stands()
    await operator.logged("goal given up, as asked for")


async def test_a_goal_that_cannot_be_is_rejected_and_logged(operator: Operator):
    await operator.send_to(9.0, 9.0)
    result = await operator.result()
    assert (result["status"], result["result"]) == (0, False)
    assert "rejected" in result["values"]
    await operator.logged(
        "navigate_to_pose goal rejected: no room for the robot at x 9.00, y 9.00 m"
    )
