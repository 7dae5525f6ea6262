# SPDX-License-Identifier: Apache-2.0
"""Publishers of real ROS, beyond what the contract says."""

import asyncio

from gateway.sources.rclpy import RosOptions, open_ros, publishers
from gateway.sources.source import Qos

INT32 = "std_msgs/msg/Int32"


async def test_subscribers_are_asked_for_once_however_many_publishers_a_turn_opens(monkeypatch):
    asked: list[str] = []

    def read_requests(_: object, topic: str) -> list[object]:
        asked.append(topic)
        return []

    async with open_ros(RosOptions()) as ros:
        monkeypatch.setattr(publishers, "read_requests", read_requests)
        opened = [ros.advertise("/t", INT32, Qos(), lambda _: None) for _ in range(9)]
        assert asked == []
        await asyncio.sleep(0)
        assert asked == ["/t"]
        opened.append(ros.advertise("/t", INT32, Qos(), lambda _: None))
        await asyncio.sleep(0)
        assert asked == ["/t", "/t"]
        for publisher in opened:
            publisher.close()
