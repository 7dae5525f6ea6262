# SPDX-License-Identifier: Apache-2.0
"""Parameters of real nodes, asked for over real ROS."""

from collections.abc import AsyncIterator, Iterator
from typing import Any

import pytest

from gateway.codec.types import Types
from gateway.core.rosapi import Parameters
from gateway.core.rosapi.node_parameters import NODE_TIMEOUT_S
from gateway.core.service_clients import ServiceClients
from gateway.sources.rclpy import RosOptions, open_ros
from gateway.sources.source import Ros
from schemas.installed import InstalledDefinitions
from tests.client import TIMEOUT_S, eventually
from tests.core.rosapi.robot import NodeWithParameters, declare
from tests.core.rosapi.scripted import ScriptedNodes


@pytest.fixture
def robot() -> Iterator[NodeWithParameters]:
    robot = NodeWithParameters("robot")
    declare(robot.node)
    yield robot
    robot.close()


@pytest.fixture
def silent() -> Iterator[NodeWithParameters]:
    silent = NodeWithParameters("silent", silent=True)
    yield silent
    silent.close()


@pytest.fixture
async def ros() -> AsyncIterator[Ros]:
    async with open_ros(RosOptions()) as ros:
        yield ros


class UnhurriedParameters(Parameters):
    """`Parameters` that wait for nodes on a busy machine, but where a test says how long."""

    def _conversation(self, requested: str, timeout_s: float) -> Any:
        timeout_s = TIMEOUT_S if timeout_s == NODE_TIMEOUT_S else timeout_s
        return super()._conversation(requested, timeout_s)


@pytest.fixture
async def parameters(
    ros: Ros, robot: NodeWithParameters, monkeypatch: pytest.MonkeyPatch
) -> AsyncIterator[Parameters]:
    monkeypatch.setattr("gateway.core.rosapi.node_parameters.EACH_NODE_TIMEOUT_S", TIMEOUT_S)
    monkeypatch.setattr("gateway.core.rosapi.parameter_services.ALL_NODES_TIMEOUT_S", TIMEOUT_S)
    await discovered(ros, robot)
    calls = ServiceClients(ros)
    yield UnhurriedParameters(ros, Types(InstalledDefinitions()), calls)
    calls.close()


@pytest.fixture
async def nodes() -> AsyncIterator[ScriptedNodes]:
    nodes = ScriptedNodes()
    yield nodes
    nodes.calls.close()
    assert not nodes.ros.entity_count()


async def discovered(ros: Ros, *nodes: NodeWithParameters) -> None:
    """Wait until the gateway knows the nodes and their parameter services."""
    services = {f"{node.node.get_fully_qualified_name()}/set_parameters" for node in nodes}
    names = {node.node.get_fully_qualified_name() for node in nodes}
    await eventually(
        lambda: (
            names <= set(ros.graph().nodes)
            and services <= {service.name for service in ros.graph().services}
        )
    )
