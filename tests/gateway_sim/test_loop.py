# SPDX-License-Identifier: Apache-2.0
"""The loop calls tasks in time and ends when told. Its contexts share memory for pictures."""

import os
import signal
import threading
import time
import xml.etree.ElementTree as ET
from types import SimpleNamespace

import pytest

from gateway_sim import loop as module
from gateway_sim.loop import PROFILE, Loop, ros_context, stopped_by_signals
from tests.gateway_sim.ros import TIMEOUT_S

PICTURE_BYTES = 640 * 480 * 3


@pytest.fixture
def loop(monkeypatch):
    monkeypatch.setenv("FASTRTPS_DEFAULT_PROFILES_FILE", str(PROFILE))
    with ros_context() as context:
        loop = Loop(context)
        yield loop
        loop.close()


def test_periods_do_not_drift(loop):
    stop = threading.Event()
    times_ns = []

    def task():
        times_ns.append(time.monotonic_ns())
        if len(times_ns) == 20:
            stop.set()

    loop.every(10_000_000, task)
    loop.run(stop)
    # each call is at or after its instant, however late those before it were
    assert times_ns == sorted(times_ns)
    assert times_ns[-1] - times_ns[0] >= 18.5 * 10_000_000


def test_a_late_call_does_not_make_the_later_ones_late(loop, monkeypatch):
    now_ns = 0
    late_ns = 1_000_000
    times_ns = []
    stop = threading.Event()

    def turn(timeout_s):
        nonlocal now_ns
        now_ns += round(timeout_s * 1e9) + late_ns

    def task():
        times_ns.append(now_ns)
        if len(times_ns) == 20:
            stop.set()

    monkeypatch.setattr(module, "time", SimpleNamespace(monotonic_ns=lambda: now_ns))
    monkeypatch.setattr(loop, "turn", turn)
    loop.every(10_000_000, task)
    loop.run(stop)
    assert times_ns == [0, *(number * 10_000_000 + late_ns for number in range(1, 20))]


def test_missed_periods_are_skipped(loop, monkeypatch):
    now_ns = 0
    stop = threading.Event()
    calls = []

    def turn(timeout_s):
        nonlocal now_ns
        now_ns += round(timeout_s * 1e9)

    def slow():
        nonlocal now_ns
        calls.append("slow")
        now_ns += 30_000_000
        if len(calls) >= 9:
            stop.set()

    monkeypatch.setattr(module, "time", SimpleNamespace(monotonic_ns=lambda: now_ns))
    monkeypatch.setattr(loop, "turn", turn)
    loop.every(1_000_000, slow)
    loop.every(1_000_000, lambda: calls.append("other"))
    loop.run(stop)
    assert calls == ["slow", "other"] * 5, "the other task gets its turn each time"


def test_a_stop_ends_a_loop_that_has_nothing_to_do(loop):
    stop = threading.Event()
    thread = threading.Thread(target=loop.run, args=(stop,))
    thread.start()
    stop.set()
    thread.join(TIMEOUT_S)
    assert not thread.is_alive()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signals_set_the_stop_and_are_given_back(number):
    before = signal.getsignal(number)
    stop = threading.Event()
    with stopped_by_signals(stop):
        os.kill(os.getpid(), number)
        assert stop.wait(TIMEOUT_S)
    assert signal.getsignal(number) == before


def test_fast_dds_finds_the_robots_profile(monkeypatch):
    names = ("FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE")
    for name in names:
        monkeypatch.setenv(name, "")  # so that what follows is undone
        monkeypatch.delenv(name)
    with ros_context():
        found = [os.environ[name] for name in names if name in os.environ]
        assert found == [str(PROFILE)]


def test_the_profiles_segment_holds_many_pictures():
    names = {"p": "http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles"}
    root = ET.parse(PROFILE).getroot()  # noqa: S314  # our own file
    segment = root.find(".//p:segment_size", names)
    assert int(segment.text) > 30 * PICTURE_BYTES
