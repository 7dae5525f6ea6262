# SPDX-License-Identifier: Apache-2.0
"""The recording of the simulated robot, as the libraries see it."""

from collections.abc import AsyncIterator
from typing import Any

import pytest
import pytest_asyncio

from gateway.sources.recording.controls import PLAYER_NODE, REFUSAL
from gateway.sources.recording.options import DEMO
from tests.clients.driver import ROSLIB_1, ROSLIB_2, ROSLIBPY_1, Connection, Driver, RefusedError
from tests.gateway_process import GatewayProcess, gateway_process

PLAYED = {
    "/joint_states": "sensor_msgs/JointState",
    "/odom": "nav_msgs/Odometry",
    "/tf": "tf2_msgs/TFMessage",
    "/scan": "sensor_msgs/LaserScan",
    "/battery_state": "sensor_msgs/BatteryState",
    "/camera/image_raw/compressed": "sensor_msgs/CompressedImage",
    "/clock": "rosgraph_msgs/Clock",
}
LATCHED = {
    "/map": "nav_msgs/OccupancyGrid",
    "/robot_description": "std_msgs/String",
    "/tf_static": "tf2_msgs/TFMessage",
}

pytestmark = pytest.mark.asyncio(loop_scope="package")


@pytest_asyncio.fixture(scope="module", loop_scope="package")
async def recording() -> AsyncIterator[GatewayProcess]:
    played = ("play", str(DEMO), "--paused")
    async with gateway_process(*played, module="tests.without_rclpy") as gateway:
        yield gateway


@pytest_asyncio.fixture(loop_scope="package")
async def viewer(library: Driver, recording: GatewayProcess) -> AsyncIterator[Connection]:
    connection = library.connection()
    await connection.connect(recording)
    yield connection
    await connection.close()
    library.events.clear()


async def control(viewer: Connection, name: str, **args: Any) -> Any:
    kind = name.title().replace("_", "")
    return await viewer.call(f"{PLAYER_NODE}/{name}", f"rosbag2_interfaces/{kind}", args)


async def test_topics_services_and_transforms_of_a_recording_are_there(viewer: Connection):
    found = await viewer.ask("get_topics")
    listed = found["topics"] if viewer.library.is_javascript else found
    assert {*PLAYED, *LATCHED} <= set(listed)
    assert f"{PLAYER_NODE}/seek" in await viewer.ask("get_services")
    assert await viewer.ask("get_topic_type", "/odom") == "nav_msgs/msg/Odometry"
    for topic, type_name in PLAYED.items():
        await viewer.subscribe(topic, type_name)
    assert (await control(viewer, "play"))["success"] is True
    follows_by_action = viewer.library == ROSLIB_2
    frames = {"fixedFrame" if viewer.library.is_javascript else "fixed_frame": "odom"}
    kind = "ROS2TFClient" if follows_by_action else "TFClient"
    about = {"kind": kind, "options": frames, "service": not follows_by_action}
    await viewer.do("follow", frame="base_scan", **about)
    for topic in PLAYED:
        await viewer.next("message", topic)
    moved = await viewer.next("transform", "base_scan")
    assert moved["translation"]["z"] == pytest.approx(0.132)
    await control(viewer, "pause")
    for topic, type_name in LATCHED.items():  # they came long ago
        await viewer.subscribe(topic, type_name)
        await viewer.next("message", topic)
    assert viewer.driver.take("warning") == []


async def test_nothing_in_a_recording_moves_and_each_library_says_why(viewer: Connection):
    await viewer.publish("/cmd_vel", "geometry_msgs/Twist", {"linear": {"x": 1}})
    told = await viewer.driver.event(lambda event: event.kind == "warning")
    assert REFUSAL in str(told.value) or not viewer.library.is_javascript  # roslibpy drops the text
    with pytest.raises(RefusedError, match="this is a recording"):
        await viewer.call("/reset", "std_srvs/Trigger", {})
    if viewer.library not in {ROSLIB_1, ROSLIBPY_1}:  # they know actions of ROS 1 alone
        goal = await viewer.send_goal("/turn", "example_interfaces/action/Fibonacci", {"order": 1})
        assert REFUSAL in str(await viewer.next("failure", goal))
