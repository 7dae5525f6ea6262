# SPDX-License-Identifier: Apache-2.0
"""A gateway whose rclpy has none of what came after Humble."""

from tests.client import client
from tests.demonstration import until_it_can_be_driven
from tests.gateway_process import gateway_process


async def test_a_gateway_serves_drives_and_calls_without_what_came_after_humble() -> None:
    async with (
        gateway_process("demo", "--no-browser", module="tests.without_iron") as gateway,
        client(gateway.url) as driving,
    ):
        await until_it_can_be_driven(driving)
        await driving.send(op="subscribe", topic="/odom")
        first = (await driving.message("/odom"))["pose"]["pose"]["position"]["x"]
        await driving.send(
            op="call_service", id="t", service="/rosapi/topic_type", args={"topic": "/odom"}
        )
        answer = await driving.receive(lambda frame: frame.get("id") == "t")
        assert answer["values"]["type"] == "nav_msgs/msg/Odometry"
        moved = first
        while moved <= first:
            await driving.send(op="publish", topic="/cmd_vel", msg={"linear": {"x": 0.2}})
            moved = (await driving.message("/odom"))["pose"]["pose"]["position"]["x"]
        await driving.send(op="call_service", id="p", service="/simulated_robot/list_parameters")
        answer = await driving.receive(lambda frame: frame.get("id") == "p")
        assert answer["result"] is True, answer
    assert "Traceback" not in "".join(gateway.log)
