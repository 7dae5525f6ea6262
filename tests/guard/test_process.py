# SPDX-License-Identifier: Apache-2.0
"""The guard process itself, with real ROS and a robot that listens."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator

import pytest

from gateway.codec.types import Types
from gateway.drive.effects import GuardState
from gateway.drive.twist_cdr import TWIST, TWIST_STAMPED
from gateway.guard import supervisor
from gateway.guard.supervisor import GuardProcess
from gateway.guard.watch import ZEROS
from gateway.sources.rclpy.graph import read_readers
from gateway.sources.source import Sample
from schemas.installed import InstalledDefinitions
from tests.client import TIMEOUT_S, eventually
from tests.e2e.faults.processes import segments_of
from tests.sources.outside import Outside

TOPIC = "/cmd_vel"


@pytest.fixture
def outside() -> Iterator[Outside]:
    outside = Outside()
    yield outside
    outside.close()


def readers(outside: Outside) -> frozenset[str]:
    """Return the ids of its subscriptions, which are the same in all processes."""
    return read_readers(outside.node, TOPIC)


def guard_process(deadline_s: float = 0.5) -> GuardProcess:
    node = {"name": "_test_guard", "namespace": "/", "domain_id": None}
    return GuardProcess("gateway.sources.rclpy.stand_alone:StandAlone", node, deadline_s=deadline_s)


async def test_the_end_of_the_pipe_stops_what_moves_with_the_stamp_and_frame_it_had(
    outside: Outside, monkeypatch
):
    monkeypatch.setattr(supervisor, "END_S", TIMEOUT_S)
    heard: list[Sample] = []
    outside.add_subscription(TOPIC, TWIST_STAMPED, heard.extend)
    states: list[GuardState] = []
    offset_ns = 10**18
    async with guard_process(TIMEOUT_S) as guard:
        guard.open(TOPIC, TWIST_STAMPED, readers(outside), states.append)
        guard.start()
        await eventually(lambda: states == ["prepared"])
        guard.moving(TOPIC, offset_ns, "base")
        before_ns = time.monotonic_ns()
    await eventually(lambda: len(heard) == ZEROS)
    decode = Types(InstalledDefinitions()).get(TWIST_STAMPED).decode
    for sample in heard:
        message = decode(bytes(sample.cdr))
        stamp = message["header"]["stamp"]
        assert message["header"]["frame_id"] == "base"
        assert stamp["sec"] * 10**9 + stamp["nanosec"] >= offset_ns + before_ns
        assert not any(message["twist"]["linear"].values())


async def test_the_guard_acts_for_a_silent_gateway_and_not_for_one_that_has_stopped(
    outside: Outside,
):
    heard: list[Sample] = []
    outside.add_subscription(TOPIC, TWIST, heard.extend)
    states: list[GuardState] = []
    async with guard_process() as guard:
        guard.open(TOPIC, TWIST, readers(outside), states.append)
        guard.start()
        await eventually(lambda: states == ["prepared"])
        guard.moving(TOPIC, 0, "")
        guard.rest(TOPIC)
        guard.moving(TOPIC, 0, "")
        await eventually(lambda: len(heard) == ZEROS)
        guard.moving(TOPIC, 0, "")
        guard.rest(TOPIC)
    assert len(heard) == ZEROS


async def test_signals_to_the_whole_group_do_not_end_the_guard_before_the_gateway(
    outside: Outside, monkeypatch
):
    monkeypatch.setattr(supervisor, "END_S", TIMEOUT_S)
    heard: list[Sample] = []
    outside.add_subscription(TOPIC, TWIST, heard.extend)
    states: list[GuardState] = []
    async with guard_process(TIMEOUT_S) as guard:
        guard.open(TOPIC, TWIST, readers(outside), states.append)
        guard.start()
        await eventually(lambda: states == ["prepared"])
        pid = guard.pid
        assert pid is not None
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGABRT):
            os.kill(pid, number)
        guard.moving(TOPIC, 0, "")
    await eventually(lambda: len(heard) > 0)
    assert states == ["prepared"]


async def test_a_type_that_is_not_there_cannot_be_guarded():
    states: list[GuardState] = []
    async with guard_process() as guard:
        guard.open(TOPIC, "no_msgs/msg/Such", (), states.append)
        guard.start()
        await eventually(lambda: states == ["lost"])


async def test_a_guard_is_ready_once_every_reliable_listener_has_a_zero(outside: Outside):
    heard: list[Sample] = []
    outside.add_subscription(TOPIC, TWIST, heard.extend)
    states: list[GuardState] = []
    async with guard_process() as guard:
        guard.open(TOPIC, TWIST, readers(outside), states.append)
        guard.start()
        await eventually(lambda: states == ["prepared"])
        assert heard == []
        guard.prove(TOPIC, 0, "")
        await eventually(lambda: states == ["prepared", "ready"])
        await eventually(lambda: bool(heard))


async def test_it_has_no_shared_memory() -> None:
    """A gateway that is killed may keep the mutex of a robot's port in shared memory for 1 s."""
    async with guard_process() as guard:
        guard.start()
        await eventually(lambda: guard.is_ready)
        assert guard.pid is not None
        assert segments_of(guard.pid) == set()


def test_a_guard_that_is_cut_off_sends_a_zero_before_it_leaves():
    options = {"class": "tests.guard.cut_off_node:CutOffNode", "node": {}, "silence_ns": 10**12}
    lines = [["open", TOPIC, TWIST, 1], ["moving", TOPIC, 0, ""]]
    ended = subprocess.run(
        [sys.executable, "-m", "gateway.guard", json.dumps(options)],
        input="".join(json.dumps(each) + "\n" for each in lines).encode(),
        capture_output=True,
        timeout=TIMEOUT_S,
        check=True,
    )
    assert ended.stderr == b"zero"
    assert json.loads(ended.stdout.splitlines()[-1]) == ["cut off"]
