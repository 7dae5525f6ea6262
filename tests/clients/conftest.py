# SPDX-License-Identifier: Apache-2.0
"""One gateway and one process per library for all tests here, a connection for each test."""

from collections.abc import AsyncIterator, Iterator
from pathlib import Path

import pytest
import pytest_asyncio
from rclpy.node import Node

from gateway.access import token_file
from gateway.access.tokens import make_token
from tests import dds_domain
from tests.clients.driver import INSTALLED, LIBRARIES, Connection, Driver, driver
from tests.clients.robot import Robot
from tests.gateway_process import GatewayProcess, gateway_process
from tests.sources.outside import Outside

TOKEN, _STORED = make_token("tablet", "operator", "2026-01-02T03:04:05+00:00")
MANY = (
    *("--set", "limits.max_clients=100"),
    *("--set", "limits.max_clients_per_address=100"),
)


@pytest.fixture(scope="package", autouse=True)
def clients() -> None:
    """Skip everything here where there are no clients to drive."""
    if not (INSTALLED / ".ready").exists():
        pytest.skip(f"no clients in {INSTALLED}: `sh tools/make-clients.sh VENV` installs them")


@pytest_asyncio.fixture(scope="package", loop_scope="package")
async def gateway() -> AsyncIterator[GatewayProcess]:
    async with gateway_process("serve", *MANY) as gateway:
        yield gateway


@pytest_asyncio.fixture(scope="package", loop_scope="package")
async def closed_gateway(tmp_path_factory: pytest.TempPathFactory) -> AsyncIterator[GatewayProcess]:
    """Run one that asks for tokens, alone: of nodes with one name ROS tells the services of one."""
    path: Path = tmp_path_factory.mktemp("access") / "tokens.json"
    token_file.change(path, lambda tokens: tokens.added(_STORED))
    keys = ("access.authentication=token", f"access.token_file={path}")
    settings = (argument for key in keys for argument in ("--set", key))
    async with gateway_process(
        "serve", *settings, "--domain-id", str(dds_domain.claim())
    ) as gateway:
        yield gateway


@pytest.fixture(scope="package")
def outside() -> Iterator[Outside]:
    outside = Outside("robot")
    yield outside
    outside.close()


@pytest.fixture(scope="package")
def settings(outside: Outside) -> Iterator[Node]:
    """Return another node, which has parameters."""
    node = Node("settings", context=outside.context)
    for name, value in {"speed": 0.5, "turn": 0.0, "name": "burger", "wheels": [1, 2]}.items():
        node.declare_parameter(name, value)
    outside._executor.add_node(node)
    yield node
    node.destroy_node()


@pytest.fixture
def robot(outside: Outside) -> Iterator[Robot]:
    robot = Robot(outside)
    yield robot
    robot.close()


@pytest_asyncio.fixture(scope="package", loop_scope="package", params=LIBRARIES, ids=str)
async def library(request: pytest.FixtureRequest) -> AsyncIterator[Driver]:
    """Run each library in turn."""
    async with driver(request.param) as running:
        yield running


@pytest_asyncio.fixture(loop_scope="package")
async def client(
    library: Driver, gateway: GatewayProcess, robot: Robot
) -> AsyncIterator[Connection]:
    """A connection of each library in turn, which has nothing to complain about."""
    del robot
    connection = library.connection()
    await connection.connect(gateway)
    yield connection
    await connection.close()
    assert library.take("warning") == []  # roslibpy takes each status for its own error
    library.events.clear()
