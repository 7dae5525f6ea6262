# SPDX-License-Identifier: Apache-2.0
"""The loop of the guard process, with a pipe, a clock and a ROS of the test's own."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import orjson
import pytest

from gateway.drive.twist_cdr import TWIST
from gateway.guard import MARGIN_S, supervisor
from gateway.guard import __main__ as guard_module
from gateway.guard.__main__ import GuardLoop
from gateway.guard.watch import ZEROS

TOPIC = "/cmd_vel"
ANSWERS = 7  # a descriptor
S = 1_000_000_000


class Publisher:
    """Notes its zeros, which are acknowledged as *is_acknowledged* says."""

    def __init__(self, now_s: Callable[[], float], is_acknowledged: Callable[[], bool]) -> None:
        self._now_s = now_s
        self._is_acknowledged = is_acknowledged
        self.zeros_s: list[float] = []

    @property
    def is_acknowledged(self) -> bool:
        return self._is_acknowledged()

    @property
    def zeros(self) -> int:
        return len(self.zeros_s)

    def publish(self, cdr: bytes) -> None:
        self.zeros_s.append(self._now_s())


class Pipe:
    """The lines of the gateway and the answers of the guard. Time passes only in `poll`."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.began_ns = self._now_ns = 10 * S
        self.written: list[tuple[float, list[object]]] = []  # and after how many seconds
        self.end_s = 0.0
        self.answers: list[tuple[float, list[Any]]] = []
        self.polls = 0
        self.flushes: list[float] = []
        self.found_s = {"robot": float("inf")}  # when discovery finds whom
        self.acknowledges_after_s = 0.0
        self.cut_off_s = float("inf")
        self.publisher = Publisher(
            lambda: self.now_s, lambda: self.now_s >= self.acknowledges_after_s
        )
        clock = SimpleNamespace(monotonic_ns=lambda: self._now_ns, sleep=self._pass_s)
        poll = SimpleNamespace(register=lambda *_: None, poll=self._poll)
        monkeypatch.setattr(guard_module, "time", clock)
        monkeypatch.setattr(guard_module, "select", SimpleNamespace(poll=lambda: poll, POLLIN=1))
        monkeypatch.setattr(guard_module, "os", SimpleNamespace(read=self._read, write=self._write))

    @property
    def now_s(self) -> float:
        return (self._now_ns - self.began_ns) / S

    def run(self) -> None:
        """Run a guard until the pipe has ended, and everything stands."""
        pipe = self

        class Node(SimpleNamespace):
            @property
            def is_cut_off(self) -> bool:
                return pipe.now_s >= pipe.cut_off_s

        ros = Node(
            advertise=lambda *_: self.publisher,
            flush=self.flushes.append,
            moves=lambda _: None,
            readers=lambda _: {who for who, at_s in self.found_s.items() if self.now_s >= at_s},
        )
        GuardLoop(ros, round((0.5 + MARGIN_S) * S), ANSWERS).run()  # type: ignore[arg-type]

    def answered(self, verb: str) -> list[float]:
        """Return the times of one kind of answer."""
        return [seconds for seconds, answer in self.answers if answer[0] == verb]

    def _due_s(self) -> float:
        return self.written[0][0] if self.written else self.end_s

    def _pass_s(self, seconds: float) -> None:
        self._now_ns += round(seconds * S)

    def _poll(self, timeout_ms: float | None) -> list[int]:
        self.polls += 1
        due_s = max(0.0, self._due_s() - self.now_s)
        wait_s = due_s if timeout_ms is None else min(due_s, timeout_ms / 1000)
        self._pass_s(wait_s)
        return [0] if wait_s == due_s else []

    def _read(self, descriptor: int, size: int) -> bytes:
        assert descriptor == 0
        return orjson.dumps(self.written.pop(0)[1]) + b"\n" if self.written else b""

    def _write(self, descriptor: int, data: bytes) -> None:
        assert descriptor == ANSWERS
        self.answers.append((self.now_s, orjson.loads(data)))


@pytest.fixture
def pipe(monkeypatch: pytest.MonkeyPatch) -> Pipe:
    return Pipe(monkeypatch)


def opening(*readers: str, after_s: float = 0.0, number: int = 1) -> tuple[float, list[Any]]:
    return (after_s, ["open", TOPIC, TWIST, number, *readers])


def test_a_guard_that_gets_messages_all_the_time_answers_ten_times_a_second(pipe: Pipe) -> None:
    pipe.written = [(turn * 0.02, ["rest", TOPIC]) for turn in range(500)]
    pipe.end_s = 10.0
    pipe.run()
    assert len(pipe.answered("heard")) == 100


def test_a_topic_whose_readers_are_not_discovered_is_open_after_4_s(pipe: Pipe) -> None:
    pipe.written = [opening("robot")]
    pipe.end_s = 60.0
    pipe.run()
    # an announcement that is lost is repeated after 3 s
    assert pipe.answered("opened") == [pytest.approx(4.0, abs=0.021)]


def test_the_guard_looks_for_readers_50_times_a_second(pipe: Pipe) -> None:
    pipe.written = [opening("robot")]
    pipe.end_s = 60.0
    pipe.found_s["robot"] = 2.0
    pipe.run()
    (opened_s,) = pipe.answered("opened")
    assert opened_s - 2.0 <= 0.021
    assert 90 <= pipe.polls <= 105


def test_the_guard_waits_for_a_robot_that_comes_up_next_to_other_listeners(pipe: Pipe) -> None:
    pipe.written = [
        opening("recorder", number=1),
        opening("recorder", "robot", after_s=10.0, number=2),
        opening("recorder", "robot", after_s=20.0, number=3),
    ]
    pipe.end_s = 60.0
    pipe.found_s = {"recorder": 0.0, "other": 0.0, "robot": 12.0}
    pipe.run()
    times_s = [pytest.approx(seconds, abs=0.021) for seconds in (0.0, 12.0, 20.0)]
    assert pipe.answered("opened") == times_s
    assert [answer[2] for _, answer in pipe.answers if answer[0] == "opened"] == [1, 2, 3]


PROVE = ["prove", TOPIC, 0, ""]


def test_the_proof_ends_once_all_readers_have_acknowledged_a_zero(pipe: Pipe) -> None:
    pipe.written = [opening(), (1.0, PROVE), (1.1, PROVE)]
    pipe.end_s = 60.0
    pipe.acknowledges_after_s = 1.23
    pipe.run()
    assert pipe.answered("proved") == [pytest.approx(1.23, abs=0.006)]
    # sent again in time: a lifespan of 250 ms that ends would count as acknowledged
    assert pipe.publisher.zeros_s == [pytest.approx(1 + n / 10, abs=0.021) for n in range(3)]
    assert pipe.polls < 60


def test_a_listener_that_was_killed_and_never_acknowledges_delays_for_1_5_s(pipe: Pipe) -> None:
    pipe.written = [opening(), (1.0, PROVE)]
    pipe.end_s = 60.0
    pipe.acknowledges_after_s = 100.0
    pipe.run()
    assert pipe.answered("proved") == [pytest.approx(2.5, abs=0.006)]


def test_a_robot_that_joins_ends_the_proof_for_those_before(pipe: Pipe) -> None:
    pipe.written = [opening(number=1), (1.0, PROVE), opening("robot", after_s=1.1, number=2)]
    pipe.end_s = 60.0
    pipe.acknowledges_after_s = 1.2
    pipe.run()
    assert pipe.answered("proved") == []


def test_a_stop_goes_on_until_the_robot_is_discovered_and_has_it_though_others_have(
    pipe: Pipe,
) -> None:
    pipe.written = [opening("recorder", "robot"), (0.1, ["moving", TOPIC, 0, ""])]
    pipe.end_s = 0.2
    pipe.found_s = {"recorder": 0.0, "robot": 1.0}
    pipe.acknowledges_after_s = 2.0
    pipe.run()
    assert sum(at_s >= 2.0 for at_s in pipe.publisher.zeros_s) == ZEROS
    assert pipe.publisher.zeros_s[-1] == pytest.approx(2.2, abs=0.06)


def test_the_guard_waits_for_the_last_zero_within_the_time_that_the_gateway_has(pipe: Pipe) -> None:
    pipe.written = [opening("robot"), (0.1, ["moving", TOPIC, 0, ""])]
    pipe.end_s = pipe.found_s["robot"] = 0.2
    pipe.run()
    assert pipe.publisher.zeros == ZEROS
    assert pipe.flushes == [0.5]
    assert pipe.flushes[0] < supervisor.END_S


def test_a_line_has_4096_bytes_at_most(pipe: Pipe) -> None:
    longest = ["moving", f"/{'t' * 249}", -(2**63), "\0" * 256]  # a \\u0000 each
    assert len(orjson.dumps(longest)) < 4096
    guard = GuardLoop(SimpleNamespace(), S, ANSWERS)  # type: ignore[arg-type]
    guard._take(b"x" * 4096)
    with pytest.raises(SystemExit):
        guard._take(b"x")


def test_a_guard_that_is_cut_off_from_the_robot_sends_a_zero_says_so_and_ends(pipe: Pipe) -> None:
    pipe.written = [opening("robot"), (0.1, ["moving", TOPIC, 0, ""])]
    pipe.end_s = 60.0
    pipe.cut_off_s = 0.1
    pipe.run()
    assert pipe.answered("cut off") == [pytest.approx(0.1, abs=0.021)]
    assert pipe.publisher.zeros_s == [pytest.approx(0.1, abs=0.021)]
