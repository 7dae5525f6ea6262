# SPDX-License-Identifier: Apache-2.0
"""A network that comes after the start is reported, if ROS should use one."""

from pathlib import Path

import pytest

from gateway.faults import Fault
from gateway.sources.rclpy.network import NetworkAtStart

TITLES = "Iface\tDestination\tGateway\n"
ROUTE = f"{TITLES}eth0\t00000000\t0102000A\n"
LATE = "the network came after the start, so ROS does not use it: restart the gateway"


@pytest.fixture
def routes(tmp_path: Path) -> Path:
    routes = tmp_path / "route"
    routes.write_text(TITLES)
    return routes


def test_a_network_that_comes_late_is_a_fault(routes: Path, caplog: pytest.LogCaptureFixture):
    network = NetworkAtStart({}, routes)
    assert "connect the network and restart the gateway" in caplog.text
    assert network.faults() == ()
    routes.write_text(ROUTE)
    assert network.faults() == (Fault("degraded", LATE),)


@pytest.mark.parametrize(
    "environment",
    [
        {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"},
        {"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"},
        {"ROS_LOCALHOST_ONLY": "1"},
        {"RMW_IMPLEMENTATION": "rmw_zenoh_cpp"},
    ],
)
def test_a_robot_here_or_behind_a_router_needs_no_network(routes: Path, environment, caplog):
    network = NetworkAtStart(environment, routes)
    routes.write_text(ROUTE)
    assert network.faults() == ()
    assert caplog.text == ""


def test_a_network_that_was_there_may_go_and_come(routes: Path, caplog):
    routes.write_text(ROUTE)
    network = NetworkAtStart({"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}, routes)
    routes.write_text(TITLES)
    routes.write_text(ROUTE)
    assert network.faults() == ()
    assert caplog.text == ""


def test_a_system_without_the_file_has_a_network(tmp_path: Path):
    assert NetworkAtStart({}, tmp_path / "none").faults() == ()
