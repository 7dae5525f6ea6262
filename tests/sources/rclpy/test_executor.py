# SPDX-License-Identifier: Apache-2.0
import os
import threading
import time
from collections.abc import Callable, Iterator
from threading import Thread
from types import SimpleNamespace

import pytest
from rclpy.context import Context

from gateway.sources.rclpy import executor as module
from gateway.sources.rclpy.executor import ExecutorThread
from tests.client import TIMEOUT_S


class Failing:
    """An executor whose callbacks raise, each time at once."""

    def spin_until_future_complete(self, future: object, timeout_sec: float) -> None:
        raise RuntimeError("callback failed")

    def wake(self) -> None: ...

    def shutdown(self) -> None: ...


class Stopping(threading.Event):
    """Records the pauses, waits for none, and is set after a few."""

    def __init__(self) -> None:
        super().__init__()
        self.pauses_s: list[float | None] = []

    def wait(self, timeout: float | None = None) -> bool:
        self.pauses_s.append(timeout)
        if len(self.pauses_s) == 3:
            self.set()
        return self.is_set()


@pytest.fixture
def stopping(monkeypatch: pytest.MonkeyPatch) -> Stopping:
    """Make every executor fail, and return what its thread waits for."""
    stopping = Stopping()
    monkeypatch.setattr(module, "events_executor", lambda context: Failing())
    monkeypatch.setattr(module, "threading", SimpleNamespace(Event=lambda: stopping, Thread=Thread))
    return stopping


def test_a_fault_that_comes_back_at_once_is_logged_once_a_second(stopping, caplog):
    context = Context()
    context.init(args=[], domain_id=int(os.environ["ROS_DOMAIN_ID"]))
    spinning = ExecutorThread(context)
    spinning._thread.join()
    context.try_shutdown()
    assert stopping.pauses_s == [1.0, 1.0, 1.0]
    assert caplog.messages == ["callback of ROS failed"] * 3


def test_a_fault_after_ros_was_shut_down_ends_the_thread(stopping, caplog):
    spinning = ExecutorThread(Context())
    spinning._thread.join()
    assert stopping.pauses_s == []
    assert caplog.messages == ["ROS was shut down by something else than the gateway"]
    assert [fault.severity for fault in spinning.faults()] == ["dead"]


@pytest.fixture(params=[False, True], ids=["events", "standard"])
def spinning(request: pytest.FixtureRequest) -> Iterator[ExecutorThread]:
    context = Context()
    context.init(args=[], domain_id=int(os.environ["ROS_DOMAIN_ID"]))
    spinning = ExecutorThread(context, standard=request.param)
    yield spinning
    spinning.close()
    context.try_shutdown()


def wait_until(condition: Callable[[], bool]) -> None:
    end_s = time.monotonic() + TIMEOUT_S
    while not condition():
        assert time.monotonic() < end_s
        time.sleep(0.01)


def test_a_callback_that_hangs_for_5_s_is_a_fault_until_it_has_ended(spinning, monkeypatch):
    now_s = 1000.0
    monkeypatch.setattr(module, "time", SimpleNamespace(monotonic=lambda: now_s))
    began, go_on = threading.Event(), threading.Event()
    spinning._executor.create_task(lambda: (began.set(), go_on.wait(20)))
    assert began.wait(TIMEOUT_S)
    assert spinning.faults() == ()  # nothing is known yet: this asks
    now_s += 5.0
    assert spinning.faults() == ()
    now_s += 0.6
    (fault,) = spinning.faults()
    assert (fault.severity, fault.text) == ("not ready", "callbacks of ROS have hung for 6 s")
    go_on.set()
    wait_until(lambda: spinning.faults() == ())


def test_an_idle_executor_answers_each_time(spinning, monkeypatch):
    monkeypatch.setattr(module, "STUCK_S", 0)
    for _ in range(3):
        assert spinning.faults() == ()
        wait_until(lambda: spinning._asked_s is None)


class AnswersMeanwhile(ExecutorThread):
    """Asked long ago. Answers as soon as it is looked at."""

    answers: Iterator[float | None] = iter(())

    @property
    def _asked_s(self) -> float | None:
        return next(self.answers, None)

    @_asked_s.setter
    def _asked_s(self, value: float | None) -> None: ...


def test_an_answer_that_arrives_during_the_search_is_not_a_failure() -> None:
    context = Context()
    context.init(args=[], domain_id=int(os.environ["ROS_DOMAIN_ID"]))
    spinning = AnswersMeanwhile(context)
    spinning.answers = iter([time.monotonic() - 60])
    assert [fault.text for fault in spinning.faults()] == ["callbacks of ROS have hung for 60 s"]
    assert spinning.faults() == ()
    spinning.close()
    context.try_shutdown()


def test_a_thread_that_has_ended_is_the_end() -> None:
    context = Context()
    context.init(args=[], domain_id=int(os.environ["ROS_DOMAIN_ID"]))
    spinning = ExecutorThread(context)
    spinning.close()
    assert [fault.severity for fault in spinning.faults()] == ["dead"]
    context.try_shutdown()
