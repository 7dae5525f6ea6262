# SPDX-License-Identifier: Apache-2.0
"""Frames of the simulated robot, looked up through a gateway's process."""

from collections.abc import AsyncIterator, Iterator
from typing import Any

import pytest
import pytest_asyncio
from rclpy.qos import DurabilityPolicy, QoSProfile

from tests.client import Client, Frame, client
from tests.demonstration import until_it_can_be_driven
from tests.gateway_process import GatewayProcess, gateway_process
from tests.sources.outside import Outside
from tests.transforms import tf_message, to_cdr

pytestmark = pytest.mark.asyncio(loop_scope="module")

TWIST = "geometry_msgs/msg/Twist"


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def demo() -> AsyncIterator[GatewayProcess]:
    async with gateway_process("demo") as demo:
        async with client(demo.url) as speaker:
            await speaker.send(op="subscribe", topic="/odom", type="nav_msgs/msg/Odometry")
            await speaker.message("/odom")
            await until_it_can_be_driven(speaker)
        yield demo


@pytest_asyncio.fixture(loop_scope="module")
async def speaker(demo: GatewayProcess) -> AsyncIterator[Client]:
    async with client(demo.url) as speaker:
        yield speaker


@pytest.fixture
def outside() -> Iterator[Outside]:
    outside = Outside()
    yield outside
    outside.close()


async def found(speaker: Client, request_id: str) -> Any:
    def is_answer(frame: Frame) -> bool:
        return (frame["op"], frame.get("id")) == ("lookup_transform", request_id)

    return (await speaker.receive(is_answer))["transform"]


async def test_the_place_of_the_laser_on_the_map_takes_one_question(speaker: Client):
    await speaker.send(
        op="lookup_transform", id="a", target_frame="map", source_frame="base_scan", timeout=60
    )
    transform = await found(speaker, "a")
    assert (transform["header"]["frame_id"], transform["child_frame_id"]) == ("map", "base_scan")
    assert transform["header"]["stamp"]["sec"] > 0
    assert transform["transform"]["translation"]["z"] == pytest.approx(0.132)


async def test_a_driving_robot_is_followed_at_a_rate(speaker: Client):
    await speaker.send(
        op="lookup_transform", id="b", target_frame="odom", source_frame="base_link", rate=30
    )
    start = (await found(speaker, "b"))["transform"]["translation"]
    await speaker.send(op="publish", topic="/cmd_vel", type=TWIST, msg={"linear": {"x": 0.2}})
    moved = start
    while abs(moved["x"] - start["x"]) + abs(moved["y"] - start["y"]) < 0.02:
        moved = (await found(speaker, "b"))["transform"]["translation"]
    await speaker.send(op="cancel_transform", id="b")
    await speaker.sync()
    assert await speaker.sync() == []


async def test_a_frame_that_is_not_there_is_told_with_the_one_that_was_meant(speaker: Client):
    await speaker.send(
        op="lookup_transform", id="ready", target_frame="map", source_frame="base_link", timeout=60
    )
    await found(speaker, "ready")
    await speaker.send(
        op="lookup_transform", id="c", target_frame="map", source_frame="bas_link", timeout=0.1
    )
    status = await speaker.status()
    assert (status["id"], status["code"]) == ("c", "not_found")
    assert status["msg"] == "frame 'bas_link' is unknown; did you mean base_link?"


async def test_a_late_client_gets_the_fixed_frames_of_all_publishers(
    demo: GatewayProcess, speaker: Client, outside: Outside
):
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    more = {"tripod", "lens"}
    for child in sorted(more):  # two more publishers than the robot's own
        publisher = outside.node.create_publisher(tf_message(), "/tf_static", latched)
        publisher.publish(to_cdr({"header": {"frame_id": "map"}, "child_frame_id": child}))
    await speaker.send(op="subscribe", topic="/tf_static")
    seen: set[str] = set()
    while not (more | {"base_scan", "imu_link"}) <= seen:
        message = await speaker.message("/tf_static")
        seen |= {transform["child_frame_id"] for transform in message["transforms"]}
    async with client(demo.url) as late:
        await late.send(op="subscribe", topic="/tf_static")
        told: set[str] = set()
        while not seen <= told:
            message = await late.message("/tf_static")
            told |= {transform["child_frame_id"] for transform in message["transforms"]}
        assert await late.sync() == []
