# SPDX-License-Identifier: Apache-2.0
"""Nodes on the fake ROS that answer for their parameters as a test says, or not at all."""

import asyncio
from collections.abc import Callable, Mapping
from typing import Any

from gateway.codec.types import ServiceType, Types
from gateway.core.deadline import Deadline
from gateway.core.rosapi import Parameters
from gateway.core.service_clients import ServiceClients
from gateway.sources.services import ServiceRequest
from schemas.installed import InstalledDefinitions
from tests.sources.fake import FakeRos

Reply = Callable[[Mapping[str, Any]], Mapping[str, Any] | None]


class CountedCalls(ServiceClients):
    """Calls that are counted: which, with how much time, and how many at once."""

    def __init__(self, ros: FakeRos) -> None:
        super().__init__(ros)
        self.asked: list[str] = []
        self.timeouts_s: list[float] = []
        self.most_at_once = 0
        self._at_once = 0

    async def call(
        self, service: str, service_type: ServiceType, values: object, deadline: Deadline
    ) -> dict[str, object]:
        self.asked.append(service)
        self.timeouts_s.append(deadline.at_s - asyncio.get_running_loop().time())
        self._at_once += 1
        self.most_at_once = max(self.most_at_once, self._at_once)
        try:
            return await super().call(service, service_type, values, deadline)
        finally:
            self._at_once -= 1


class ScriptedNodes:
    """A fake ROS with such nodes, and what calls them."""

    def __init__(self, ros: FakeRos | None = None) -> None:
        self.ros = ros or FakeRos()
        self.types = Types(InstalledDefinitions())
        self.calls = CountedCalls(self.ros)
        self.parameters = Parameters(self.ros, self.types, self.calls)

    def offer(self, node: str, service: str, reply: Reply) -> None:
        """Offer one of the parameter services. If *reply* returns ``None``, it is silent."""
        type_name = "".join(part.capitalize() for part in service.split("_"))
        type_ = self.types.service(f"rcl_interfaces/srv/{type_name}")

        def on_request(request: ServiceRequest) -> None:
            values = reply(type_.request.decode(request.cdr))
            if values is not None:
                request.answer(type_.response.encode(values, 0))

        self.ros.add_service(f"{node}/{service}", type_.name, on_request, node=node)

    def add(self, node: str, *names: str) -> None:
        """Add a node with some parameters, all 0.5. Like rclcpp it is strict about others."""

        def of_each(request: Mapping[str, Any], item: Mapping[str, Any]) -> list[Any]:
            return [item for _ in request["names"]] if set(request["names"]) <= set(names) else []

        value = {"type": 3, "double_value": 0.5}
        self.offer(node, "list_parameters", lambda _: {"result": {"names": list(names)}})
        self.offer(node, "get_parameters", lambda asked: {"values": of_each(asked, value)})
        self.offer(
            node,
            "describe_parameters",
            lambda asked: {"descriptors": of_each(asked, {"type": 3})},
        )
        self.offer(
            node,
            "set_parameters",
            lambda asked: {
                "results": [{"successful": each["name"] in names} for each in asked["parameters"]]
            },
        )

    def add_silent(self, node: str) -> None:
        """Add a node that offers its parameters and does not spin."""
        for service in ("list_parameters", "get_parameters"):
            self.offer(node, service, lambda _: None)
