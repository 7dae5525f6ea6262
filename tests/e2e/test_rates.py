# SPDX-License-Identifier: Apache-2.0
"""The rates at which headsets, robots' joints and cameras publish: nothing is refused.

All that comes in some seconds is sent at once, which is harder than at its rate.
"""

import base64
import json
import os
import urllib.request
from typing import Any

from tests.client import TIMEOUT_S, Client, client
from tests.gateway_process import GatewayProcess, gateway_process

POSE = "geometry_msgs/msg/PoseStamped"
JOY = "sensor_msgs/msg/Joy"
JOINTS = "sensor_msgs/msg/JointState"
PICTURE = "sensor_msgs/msg/CompressedImage"
LARGE = ("--set", "limits.max_message_bytes=16777216")


def health(gateway: GatewayProcess) -> dict[str, Any]:
    url = gateway.url.replace("ws://", "http://").rstrip("/") + "/healthz"
    with urllib.request.urlopen(url, timeout=TIMEOUT_S) as response:  # noqa: S310  # ours
        return json.load(response)


async def publish_all(speaker: Client, messages: list[tuple[str, dict[str, Any]]]) -> None:
    """Publish messages to their topics, and insist that none is answered."""
    for topic, message in messages:
        await speaker.send(op="publish", topic=topic, msg=message)
    assert await speaker.sync() == []


async def test_head_hands_and_joystick_at_120_hz_are_all_published():
    async with gateway_process("serve") as gateway, client(gateway.url) as headset:
        topics = {"/head": POSE, "/left": POSE, "/right": POSE, "/joy": JOY}
        for topic, type_name in topics.items():
            await headset.send(op="advertise", topic=topic, type=type_name)
        pose = {"header": {"frame_id": "map"}, "pose": {"position": {"x": 1.5, "y": 0.1, "z": -2}}}
        joy = {"axes": [0.1, -0.2, 0, 1], "buttons": [0, 1, 0, 0]}
        second = [(topic, joy if topic == "/joy" else pose) for topic in topics] * 120
        await publish_all(headset, second * 3)
        counts = health(gateway)
        assert (counts["messages_in"], counts["refused"]) == (3 * 480 + 4 + 1, 0)


async def test_20_joint_topics_at_500_hz_are_all_published():
    async with gateway_process("serve") as gateway, client(gateway.url) as arm:
        joints = {"name": ["shoulder"], "position": [0.5], "velocity": [0.1], "effort": []}
        topics = [f"/joint{number}" for number in range(20)]
        for topic in topics:
            await arm.send(op="advertise", topic=topic, type=JOINTS)
        await publish_all(arm, [(topic, joints) for topic in topics] * 500)
        counts = health(gateway)
        assert (counts["messages_in"], counts["refused"]) == (20 * 501 + 1, 0)


async def test_pictures_of_1_mb_at_10_hz_are_all_published():
    async with gateway_process("serve", *LARGE) as gateway, client(gateway.url) as camera:
        await camera.send(op="advertise", topic="/camera", type=PICTURE)
        picture = {"format": "jpeg", "data": base64.b64encode(os.urandom(10**6)).decode()}
        await publish_all(camera, [("/camera", picture)] * 20)
        counts = health(gateway)
        assert (counts["messages_in"], counts["refused"]) == (22, 0)
