# SPDX-License-Identifier: Apache-2.0
"""The gateway's own /diagnostics, over the fake ROS."""

import logging
from collections.abc import Callable
from typing import Any

import pytest

from gateway import diagnostics
from gateway.codec.types import Types
from gateway.metrics.state import Summary
from gateway.sources.source import Qos, RosError, Sample
from schemas.installed import InstalledDefinitions
from tests.client import eventually
from tests.clock import StoppedClock
from tests.metrics.states import summary
from tests.sources.fake import FakePublisher, FakeRos

ARRAY = "diagnostic_msgs/msg/DiagnosticArray"
STRING = "std_msgs/msg/String"
TYPES = Types(InstalledDefinitions())


class Bench:
    """The publisher of /diagnostics, and its messages. It works while `publishing`."""

    def __init__(self, ros: FakeRos) -> None:
        self.ros = ros
        self.heard: list[Sample] = []
        self.asked = 0
        self.fault: Exception | None = None
        ros.add_subscription("/diagnostics", ARRAY, self.heard.extend)

    def summarize(self) -> Summary:
        self.asked += 1
        if self.fault is not None:
            raise self.fault
        return summary()

    def publishing(self) -> Any:
        return diagnostics.publishing(self.ros, self.ros.now_ns, TYPES, self.summarize, "robot")

    async def hears_more(self) -> None:
        count = len(self.heard)
        await eventually(lambda: len(self.heard) > count + 1)

    async def asks_more(self) -> None:
        count = self.asked
        await eventually(lambda: self.asked > count + 2)


@pytest.fixture
async def bench(monkeypatch: pytest.MonkeyPatch) -> Bench:
    monkeypatch.setattr(diagnostics, "PERIOD_S", 0.001)
    return Bench(FakeRos())


def errors(caplog: pytest.LogCaptureFixture) -> list[logging.LogRecord]:
    return [each for each in caplog.records if each.name == "gateway.diagnostics"]


async def test_components_are_published_again_and_again_under_the_name_of_the_node(bench: Bench):
    with bench.publishing():
        await bench.hears_more()
    message: Any = TYPES.get(ARRAY).decode(bench.heard[-1].cdr)
    assert "robot: event loop" in [each["name"] for each in message["status"]]
    (publisher,) = bench.ros.publishers
    assert publisher.node == "/ros2_gateway_debug"


async def test_a_client_that_has_the_topic_with_another_type_delays_it_only(
    bench: Bench, caplog: pytest.LogCaptureFixture
):
    other = bench.ros.subscribe("/diagnostics", STRING, Qos(), lambda _: None, lambda _: None)
    tries = 0
    advertise: Callable[..., FakePublisher] = bench.ros.advertise_own

    def count(*arguments: Any) -> FakePublisher:
        nonlocal tries
        tries += 1
        return advertise(*arguments)

    bench.ros.advertise_own = count  # type: ignore[method-assign]  # of this fake alone
    with bench.publishing():
        await eventually(lambda: tries > 2)
        other.close()
        await bench.hears_more()
    (record,) = errors(caplog)
    assert record.levelname == "WARNING"
    assert "is open here as std_msgs/msg/String" in record.getMessage()


async def test_a_fault_of_the_gateway_is_logged_once_and_ends_nothing(
    bench: Bench, caplog: pytest.LogCaptureFixture
):
    with bench.publishing():
        await bench.hears_more()
        bench.fault = ZeroDivisionError()
        await bench.asks_more()
        bench.fault = None
        await bench.hears_more()
        bench.fault = KeyError("x")
        await bench.asks_more()
    assert [each.levelname for each in errors(caplog)] == ["ERROR"] * 2
    assert all(each.exc_info for each in errors(caplog))


async def test_a_refusal_of_ros_is_logged_once(
    bench: Bench, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
):
    def fail(publisher: FakePublisher, cdr: bytes) -> None:
        raise RosError("internal", "no room")

    monkeypatch.setattr(FakePublisher, "publish", fail)
    with bench.publishing():
        await bench.asks_more()
    assert [each.getMessage() for each in errors(caplog)] == [
        "/diagnostics is not published: no room"
    ]


async def test_components_are_published_once_a_second(monkeypatch: pytest.MonkeyPatch):
    bench = Bench(FakeRos())
    clock = StoppedClock(monkeypatch)
    with bench.publishing():
        await clock.advance(0)
        assert bench.asked == 0
        for _ in range(100):
            await clock.advance(0.101)
    assert bench.asked == pytest.approx(10, abs=1)
