# SPDX-License-Identifier: Apache-2.0
import threading
from threading import Thread
from types import SimpleNamespace

import pytest
from rclpy.context import Context

from gateway.ros import executor as module
from gateway.ros.executor import ExecutorThread


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


def test_a_fault_that_comes_back_at_once_is_logged_once_a_second(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    stopping = Stopping()
    monkeypatch.setattr(module.rclpy_private, "events_executor", lambda context: Failing())
    monkeypatch.setattr(module, "threading", SimpleNamespace(Event=lambda: stopping, Thread=Thread))
    spinning = ExecutorThread(Context())
    spinning._thread.join()
    assert stopping.pauses_s == [1.0, 1.0, 1.0]
    assert caplog.messages == ["callback of ROS failed"] * 3
