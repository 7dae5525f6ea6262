# SPDX-License-Identifier: Apache-2.0
"""Two nodes of one name, warned of once."""

import asyncio
from collections.abc import Callable

import pytest

from gateway.sources import same_names
from gateway.sources.rclpy import RosOptions, open_ros
from gateway.sources.same_names import MAX_NAMED, SameNames
from tests.client import eventually
from tests.clock import StoppedClock
from tests.sources.outside import Outside

PERSISTS_S = 30.0
LATER = PERSISTS_S + 0.1


@pytest.fixture
async def clock(monkeypatch: pytest.MonkeyPatch) -> StoppedClock:
    return StoppedClock(monkeypatch)


Warned = Callable[[], list[str]]


@pytest.fixture
def warned(caplog: pytest.LogCaptureFixture) -> Warned:
    return lambda: [each.message for each in caplog.records if "several nodes" in each.message]


def watching(nodes: list[str]) -> SameNames:
    return SameNames(asyncio.get_running_loop(), lambda: nodes)


async def test_a_name_that_two_nodes_have_is_warned_of_once(clock: StoppedClock, warned: Warned):
    watch = watching(["/robot", "/robot", "/other"])
    for _ in range(3):
        watch.look()
        await clock.advance(LATER)
    (text,) = warned()
    assert watch.known == ("/robot",)
    assert text.startswith("several nodes are named /robot: ")
    assert "ROS_DOMAIN_ID" in text


async def test_a_killed_node_next_to_its_successor_does_not_count_as_a_second_one(clock, warned):
    nodes = ["/robot", "/robot"]
    watch = watching(nodes)
    watch.look()
    await clock.advance(20)
    nodes.pop()
    watch.look()
    await clock.advance(LATER)
    assert warned() == []


async def test_a_name_that_comes_later_is_warned_of_later_and_one_that_comes_back_again(
    clock: StoppedClock, warned: Warned
):
    nodes = ["/robot", "/robot"]
    watch = watching(nodes)
    watch.look()
    await clock.advance(PERSISTS_S / 2)
    nodes += ["/arm", "/arm"]
    watch.look()
    await clock.advance(PERSISTS_S / 2 + 0.1)
    assert [text.split(": ")[0] for text in warned()] == ["several nodes are named /robot"]
    await clock.advance(LATER)
    assert len(warned()) == 2
    nodes[:] = []
    nodes += ["/leg", "/leg"]
    watch.look()
    assert watch.known == ()
    await clock.advance(LATER)
    nodes += ["/robot", "/robot"]
    watch.look()
    await clock.advance(LATER)
    assert [text.split(": ")[0] for text in warned()[2:]] == [
        "several nodes are named /leg",
        "several nodes are named /robot",
    ]


async def test_hidden_nodes_and_those_without_a_name_yet_do_not_count(clock, warned):
    watch = watching(["/_ros2cli", "/_ros2cli", "/a/_b", "/a/_b", "_NODE_NAME_UNKNOWN_"] * 2)
    watch.look()
    await clock.advance(LATER)
    assert warned() == []


async def test_many_names_are_one_short_line(clock: StoppedClock, warned: Warned):
    watch = watching([f"/robot{number:02}" for number in range(MAX_NAMED + 2)] * 2)
    watch.look()
    await clock.advance(LATER)
    (text,) = warned()
    assert "/robot07 and 2 more: " in text
    assert "/robot08" not in text


async def test_after_closing_nothing_is_logged(clock: StoppedClock, warned: Warned):
    watch = watching(["/robot", "/robot"])
    watch.look()
    watch.close()
    await clock.advance(LATER)
    assert warned() == []


async def test_a_second_gateway_is_warned_of_at_once_and_the_rest_of_it_is_not_again(clock, warned):
    nodes = ["/gateway_debug", "/gateway_services"]
    watch = SameNames(asyncio.get_running_loop(), lambda: nodes, own=tuple(nodes))
    watch.look()
    assert warned() == []
    nodes.append("/gateway_debug")
    watch.look()
    (text,) = warned()
    assert text.startswith("several nodes are named /gateway_debug: a second robot or gateway")
    nodes.append("/gateway_services")
    watch.look()
    await clock.advance(LATER)
    assert len(warned()) == 1
    assert watch.known == ("/gateway_debug", "/gateway_services")
    nodes[2:] = []
    watch.look()
    nodes += nodes
    watch.look()
    assert len(warned()) == 2


async def test_two_gateways_in_one_domain_notice_each_other(monkeypatch, warned):
    monkeypatch.setattr(same_names, "PERSISTS_S", 1e6)
    async with open_ros(RosOptions()) as one, open_ros(RosOptions()) as other:
        await eventually(
            lambda: all("/ros2_gateway_debug" in ros.shared_names() for ros in (one, other))
        )
        assert len(warned()) == 2


async def test_two_nodes_of_ros_are_noticed(monkeypatch: pytest.MonkeyPatch, warned: Warned):
    monkeypatch.setattr(same_names, "PERSISTS_S", 0.1)
    async with open_ros(RosOptions()) as ros:
        assert ros.shared_names() == ()
        robots = [Outside("twin"), Outside("twin")]
        try:
            await eventually(lambda: ros.shared_names() == ("/twin",))
            assert any("named /twin" in text for text in warned())
        finally:
            for robot in robots:
                robot.close()
