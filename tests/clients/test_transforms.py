# SPDX-License-Identifier: Apache-2.0
"""Frames followed by the libraries' own clients of transforms, which ask tf2_web_republisher."""

import asyncio
import contextlib
import json
import urllib.request
from collections.abc import AsyncIterator

import pytest

from tests.clients.driver import (
    ROSLIB_1,
    ROSLIB_2,
    ROSLIBPY_1,
    ROSLIBPY_2,
    ROSLIBPY_2_ASYNCIO,
    Connection,
)
from tests.clients.robot import LATCHED, POLL_S, Robot, until
from tests.gateway_process import GatewayProcess
from tests.transforms import tf_message, to_cdr

pytestmark = pytest.mark.asyncio(loop_scope="package")

in_javascript = pytest.mark.parametrize("library", [ROSLIB_1, ROSLIB_2], ids=str, indirect=True)
by_service = pytest.mark.parametrize(
    "library", [ROSLIB_1, ROSLIBPY_1, ROSLIBPY_2, ROSLIBPY_2_ASYNCIO], ids=str, indirect=True
)
by_action = pytest.mark.parametrize("library", [ROSLIB_2], ids=str, indirect=True)


class Base:
    """A base that moves along x, with a laser on it."""

    def __init__(self, client: Connection, robot: Robot) -> None:
        self.odom, self.base, self.laser = (
            f"{client.name}_{frame}" for frame in ("odom", "base_link", "laser")
        )
        self.x = 1.0
        self._node = robot.node
        self._moving = self._node.create_publisher(tf_message(), "/tf", 10)
        self._fixed = self._node.create_publisher(tf_message(), "/tf_static", LATCHED)
        self._fixed.publish(self._array(self.base, self.laser, 0.5))

    async def drive(self) -> None:
        """Say where the base is, again and again."""
        try:
            while True:
                self._moving.publish(self._array(self.odom, self.base, self.x))
                await asyncio.sleep(POLL_S)
        finally:
            for publisher in (self._moving, self._fixed):
                self._node.destroy_publisher(publisher)

    def _array(self, parent: str, child: str, x: float) -> bytes:
        stamp = {"sec": 1, "nanosec": round(self.x * 1000)}
        return to_cdr(
            {
                "header": {"stamp": stamp, "frame_id": parent},
                "child_frame_id": child,
                "transform": {"translation": {"x": x}},
            }
        )


@contextlib.asynccontextmanager
async def moving(client: Connection, robot: Robot) -> AsyncIterator[Base]:
    base = Base(client, robot)
    driving = asyncio.create_task(base.drive())
    try:
        yield base
    finally:
        driving.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await driving


async def follows_frames(
    client: Connection,
    robot: Robot,
    gateway: GatewayProcess,
    kind: str = "TFClient",
    *,
    service: bool = False,
) -> None:
    async with moving(client, robot) as base:
        if client.library.is_javascript:
            options = {"fixedFrame": base.odom, "angularThres": 0.01, "rate": 50}
        else:
            options = {"fixed_frame": base.odom, "angular_threshold": 0.01, "rate": 50}
        about = {"kind": kind, "options": options, "service": service}
        await client.do("follow", frame=base.laser, **about)
        first = await client.next("transform", base.laser)
        assert first["translation"] == {"x": 1.5, "y": 0.0, "z": 0.0}
        assert first["rotation"] == {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
        # one frame more: the client ends what it has asked for, and asks for both
        await client.do("follow", frame=base.base, **about)
        assert (await client.next("transform", base.base))["translation"]["x"] == 1.0
        base.x = 3.0
        while (await client.next("transform", base.base))["translation"]["x"] != 3.0:
            pass
        while (await client.next("transform", base.laser))["translation"]["x"] != 3.5:
            pass
        await client.do("dispose", kind=kind)
        # a disposed transform is not sent any more, though its client is still connected
        await until(lambda: has_ended(gateway))


async def has_ended(gateway: GatewayProcess) -> bool:
    """Return whether no client follows a transform."""
    url = gateway.url.replace("ws:", "http:").rstrip("/") + "/healthz"
    with await asyncio.to_thread(urllib.request.urlopen, url) as response:
        return bool(json.load(response)["transforms"] == 0)


@in_javascript
async def test_frames_are_followed_by_the_topics_of_an_action_of_ros_1(
    client: Connection, robot: Robot, gateway: GatewayProcess
):
    await follows_frames(client, robot, gateway)


@by_service
async def test_frames_are_followed_by_a_service(
    client: Connection, robot: Robot, gateway: GatewayProcess
):
    await follows_frames(client, robot, gateway, service=True)


@by_action
async def test_frames_are_followed_by_an_action(
    client: Connection, robot: Robot, gateway: GatewayProcess
):
    await follows_frames(client, robot, gateway, "ROS2TFClient")
