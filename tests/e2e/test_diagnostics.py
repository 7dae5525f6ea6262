# SPDX-License-Identifier: Apache-2.0
"""The gateway's own /diagnostics, as another process of ROS hears it."""

from typing import Any

from gateway.codec.types import Types
from gateway.sources.source import Qos, Sample
from schemas.installed import InstalledDefinitions
from tests.client import client, eventually
from tests.gateway_process import gateway_process
from tests.sources.outside import Outside

ARRAY = "diagnostic_msgs/msg/DiagnosticArray"
TWIST = "geometry_msgs/msg/Twist"
FORWARD = {"linear": {"x": 1}}
COMPONENTS = [
    "event loop",
    "clients",
    "delivery",
    "ROS entities",
    "ROS graph",
    "guard",
    "drive /cmd_vel",
]


class Monitor:
    """The gateway as a tool of ROS sees it."""

    def __init__(self, outside: Outside) -> None:
        self._decode = Types(InstalledDefinitions()).get(ARRAY).decode
        self.heard: list[Sample] = []
        outside.add_subscription("/diagnostics", ARRAY, self.heard.extend, Qos(depth=10))

    @property
    def newest(self) -> dict[str, dict[str, Any]]:
        if not self.heard:
            return {}
        message: Any = self._decode(self.heard[-1].cdr)
        return {status["name"]: status for status in message["status"]}

    def level(self, component: str) -> int | None:
        status = self.newest.get(f"ros2_gateway: {component}")
        return None if status is None else status["level"]

    def value(self, component: str, key: str) -> str:
        values = self.newest[f"ros2_gateway: {component}"]["values"]
        return next(each["value"] for each in values if each["key"] == key)


async def test_ros_tools_see_each_component_and_when_something_is_wrong(outside: Outside):
    monitor = Monitor(outside)
    outside.add_subscription("/cmd_vel", TWIST, lambda _: None)
    async with gateway_process("serve") as gateway:
        await eventually(lambda: monitor.level("guard") == 0)
        assert list(monitor.newest) == [f"ros2_gateway: {each}" for each in COMPONENTS]
        assert monitor.level("drive /cmd_vel") == 0
        async with client(gateway.url) as driver:
            await eventually(lambda: monitor.value("clients", "clients") == "1")
            while monitor.level("drive /cmd_vel") == 0:  # until it is guarded, and was left alone
                for _ in range(5):  # a single one is taken for one that a person typed
                    await driver.send(op="publish", topic="/cmd_vel", type=TWIST, msg=FORWARD)
                    await driver.sync()
                count = len(monitor.heard)
                await eventually(lambda count=count: len(monitor.heard) > count + 1)
        status = monitor.newest["ros2_gateway: drive /cmd_vel"]
        assert status["level"] == 1
        assert "send a zero command to drive again" in status["message"]
        await eventually(lambda: monitor.value("clients", "clients") == "0")


async def test_a_client_hears_of_the_gateway_as_of_any_node_and_no_entity_is_counted():
    async with gateway_process("serve") as gateway, client(gateway.url) as listener:
        await listener.send(op="subscribe", topic="/diagnostics", type=ARRAY)
        entities = ""
        while entities != "1":  # of this subscription, because one that has just ended may be heard
            message = await listener.message("/diagnostics")
            values = {status["name"]: status["values"] for status in message["status"]}
            counted = {each["key"]: each["value"] for each in values["ros2_gateway: ROS entities"]}
            entities = counted["ros_entities"]


async def test_no_diagnostics_are_published_if_the_setting_says_so():
    quiet = ("--set", "ros.diagnostics=false", "--set", "ros.node_prefix=quiet")
    async with (
        gateway_process("serve", *quiet) as gateway,
        gateway_process("serve", "--set", "ros.node_prefix=later") as later,
        client(gateway.url) as one,
    ):
        assert later.url
        publishers: list[str] = []
        while "/later_debug" not in publishers:
            await one.send(op="graph", id=1)
            graph = await one.receive(lambda frame: frame["op"] == "graph")
            found = (each for each in graph["topics"] if each["name"] == "/diagnostics")
            publishers = [node for each in found for node in each["publishers"]]
        assert "/quiet_debug" not in publishers
