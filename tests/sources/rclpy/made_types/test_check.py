# SPDX-License-Identifier: Apache-2.0
"""How long ROS has to take types that are made. `test_message_classes.py` tries it with ROS."""

from types import SimpleNamespace

import pytest

from gateway.sources.rclpy.made_types import check
from gateway.sources.rclpy.made_types.check import Calls


class Clock:
    """A clock that goes on by `sleep` alone."""

    def __init__(self) -> None:
        self.now_s = 0.0

    def monotonic(self) -> float:
        return self.now_s

    def sleep(self, seconds: float) -> None:
        self.now_s += seconds


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(check, "time", clock)
    return clock


def test_a_sample_that_never_arrives_is_looked_for_200_times_a_second_and_for_50_s(
    clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    steps: list[float] = []
    topics = SimpleNamespace(
        is_over=False, fault="nothing has come", step=lambda: steps.append(clock.now_s)
    )
    for name in ("Context", "Node", "InstalledDefinitions", "MadeTypes"):
        monkeypatch.setattr(check, name, lambda *_, **__: None)
    monkeypatch.setattr(check, "rclpy", SimpleNamespace(init=lambda **_: None))
    monkeypatch.setattr(check, "_Topics", lambda *_: topics)
    monkeypatch.setattr(check, "open_calls", lambda *_: [])
    assert check._exchange() == "nothing has come"
    assert clock.now_s == pytest.approx(50, abs=0.01)
    assert len(steps) == pytest.approx(10_000, abs=2)


def test_a_request_that_is_lost_is_sent_again_after_200_ms(clock: Clock) -> None:
    calls = Calls.__new__(Calls)
    sent: list[object] = []
    calls._number = None
    calls._calling = SimpleNamespace(to_request=lambda cdr: cdr)  # type: ignore[assignment]
    calls._send = lambda request: sent.append(request) or len(sent)
    for seconds, count in ((0.0, 1), (0.19, 1), (0.02, 2), (0.19, 2), (0.02, 3)):
        clock.sleep(seconds)
        calls._call()
        assert len(sent) == count
