# SPDX-License-Identifier: Apache-2.0
"""The gateway's side of the guard process, with stand-ins for the process."""

import asyncio
import contextlib
import errno
import os
import signal
import subprocess
import sys
from collections.abc import AsyncIterator
from pathlib import Path
from types import SimpleNamespace

import orjson
import pytest

from gateway.drive.effects import GuardState
from gateway.guard import MARGIN_S, MAX_LINE_BYTES, REPEAT_S, supervisor
from gateway.guard.supervisor import GuardProcess
from tests.client import eventually
from tests.transport.timers import Timers

TOPIC, TWIST = "/cmd_vel", "geometry_msgs/msg/Twist"

# Guards that open what they are asked to, and then answer, do not answer, end, or write nonsense.
OBEDIENT = """
import json, os, sys
def say(*message):
    try:  # by the descriptor: what a stream could not write it would write again at its end
        os.write(1, json.dumps(message).encode() + b"\\n")
    except BrokenPipeError:
        pass  # the gateway's side is closed first
say("ready")
for line in sys.stdin:
    verb, *rest = json.loads(line)
    if verb == "open":
        number = rest[2]
    print(line, end="", file=sys.stderr, flush=True)
    if verb == "open":
        say("opened", rest[0], number)
    {then}
"""
ANSWERS = OBEDIENT.format(then='say("heard")')
SILENT = OBEDIENT.format(then="pass")
SLOW = OBEDIENT.format(then='if verb == "moving": say("opened", rest[0], 0)')
ENDS = OBEDIENT.format(then='if verb == "moving": break')
A_LINE_OF_NONSENSE = OBEDIENT.format(then='if verb == "moving": print("x", flush=True)')
NONSENSE = OBEDIENT.format(then='if verb == "moving": print("x" * 9000, end="", flush=True)')


class Clock:
    """The supervisor's clock, in the test's hand."""

    def __init__(self) -> None:
        self.now_s = 1000.0

    def monotonic(self) -> float:
        return self.now_s

    def monotonic_ns(self) -> int:
        return round(self.now_s * 1e9)


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(supervisor, "time", clock)
    return clock


@contextlib.asynccontextmanager
async def supervised(source: str) -> AsyncIterator[tuple[GuardProcess, list[GuardState]]]:
    """Run a stand-in, and yield its supervisor and the states of one topic."""
    states: list[GuardState] = []
    async with GuardProcess("", {}, deadline_s=0.5) as guard:
        guard.command = (sys.executable, "-c", source)
        guard.start()
        guard.open(TOPIC, TWIST, ["b", "a"], states.append)
        yield guard, states


def is_running(pid: int | None) -> bool:
    return Path(f"/proc/{pid}").exists()


def is_stopped(pid: int | None) -> bool:
    return "State:\tT" in Path(f"/proc/{pid}/status").read_text()


async def test_a_topic_that_was_opened_before_the_guard_was_ready_is_opened_then():
    async with supervised(ANSWERS) as (guard, states):
        await eventually(lambda: states == ["prepared"])
        pid = guard.pid
        assert pid is not None
    assert not is_running(pid)


async def test_a_guard_that_is_cut_off_counts_as_lost(caplog):
    async with supervised("print('[\"cut off\"]', flush=True); input()") as (guard, states):
        await eventually(lambda: states == ["lost"])
        assert guard.losses == 1
    assert "commands do not get through to the robot" in caplog.text


async def test_an_answer_to_an_earlier_question_says_nothing_about_newer_listeners():
    async with supervised(SLOW) as (guard, states):
        await eventually(lambda: states == ["prepared"])
        guard.open(TOPIC, TWIST, ["c"], states.append)
        await eventually(lambda: states == ["prepared"] * 2)
        guard.moving(TOPIC, 0, "")  # to which it answers as if to the first
        others: list[GuardState] = []
        guard.open("/other", TWIST, [], others.append)
        await eventually(lambda: others == ["prepared"])
        assert states == ["prepared"] * 2


async def test_a_line_has_room_for_100_listeners(capfd):
    async with supervised(ANSWERS) as (guard, states):
        await eventually(lambda: states == ["prepared"])
        guard.open(f"/{'t' * 249}", TWIST, [f"{n:032x}" for n in range(200)], states.append)
        await eventually(lambda: states == ["prepared"] * 2)
    line = capfd.readouterr().err.splitlines()[-1]
    assert len(orjson.loads(line)) == 4 + 100
    assert len(line) < MAX_LINE_BYTES


async def test_messages_reach_the_guard_and_repetitions_within_20_ms_do_not(capfd, clock: Clock):
    async with supervised(ANSWERS) as (guard, states):
        await eventually(lambda: states == ["prepared"])
        for after_ms in (0, 12, 19, 20):
            clock.now_s = 2000.0 + after_ms / 1000
            guard.moving(TOPIC, after_ms, "base")
        guard.rest(TOPIC)
        guard.close(TOPIC)
    heard = capfd.readouterr().err.splitlines()
    moving = [f'["moving","{TOPIC}",{after_ms},"base"]' for after_ms in (0, 20)]
    expected = [f'["open","{TOPIC}","{TWIST}",0,"a","b"]', *moving]
    assert heard == [*expected, f'["rest","{TOPIC}"]', f'["close","{TOPIC}"]']


@pytest.mark.parametrize("source", [ENDS, NONSENSE, A_LINE_OF_NONSENSE])
async def test_a_guard_that_is_lost_is_replaced(source: str):
    async with supervised(source) as (guard, states):
        await eventually(lambda: states == ["prepared"])
        first = guard.pid
        guard.moving(TOPIC, 0, "")
        await eventually(lambda: states == ["prepared", "lost"])
        await eventually(lambda: states == ["prepared", "lost", "prepared"])
        assert guard.pid != first
        assert first is not None
        await eventually(lambda: not is_running(first))


@pytest.mark.parametrize("verb", ["moving", "prove"])
async def test_a_guard_that_answers_nothing_for_a_second_while_a_client_drives_is_lost(
    clock: Clock, verb: str
):
    async with supervised(SILENT) as (guard, states):
        await eventually(lambda: states == ["prepared"])
        for number in range(100):
            getattr(guard, verb)(TOPIC, 0, "")
            assert ("lost" in states) == (number > 33)
            clock.now_s += 0.03


async def test_a_guard_that_gets_no_message_owes_no_answer(clock: Clock):
    async with supervised(SILENT) as (guard, states):
        await eventually(lambda: states == ["prepared"])
        for _ in range(3):
            guard.moving(TOPIC, 0, "")
            clock.now_s += 10
        assert states == ["prepared"]


async def test_a_guard_that_cannot_be_started_is_tried_again():
    async with GuardProcess("", {}, deadline_s=0.5) as guard:
        guard._restart_s = 0.01
        guard.command = ("/nowhere/python",)
        guard.start()
        await eventually(lambda: guard.losses >= 3)
        assert guard.pid is None


def test_a_guard_that_ran_for_a_minute_is_replaced_at_once_and_another_after_30_s_at_most(
    monkeypatch,
):
    timers = Timers(monkeypatch, supervisor)
    ran_s = 0.0

    def lost_after_a_while(*_: object, **__: object) -> None:
        timers.take(ran_s)
        raise OSError(errno.ENOENT, "no such file")

    pipes = SimpleNamespace(Popen=lost_after_a_while, PIPE=subprocess.PIPE)
    monkeypatch.setattr(supervisor, "subprocess", pipes)
    GuardProcess("", {}, deadline_s=0.5).start()
    assert [timers.next_turn() for _ in range(8)] == [0.5, 1, 2, 4, 8, 16, 30, 30]
    ran_s = 60.0  # not long enough, from now on
    timers.next_turn()
    assert timers.next_turn() == 30
    ran_s = 61.0
    timers.next_turn()
    assert timers.next_turn() == 0.5


async def test_a_guard_that_does_not_end_is_killed(monkeypatch):
    monkeypatch.setattr(supervisor, "END_S", 0.05)
    stubborn = "import time\nprint('[\"ready\"]', flush=True)\ntime.sleep(600)"
    async with GuardProcess("", {}, deadline_s=0.5) as guard:
        guard.command = (sys.executable, "-c", stubborn)
        guard.start()
        pid = guard.pid
        assert pid is not None
    assert not is_running(pid)


def test_the_guard_acts_after_the_time_that_is_promised():
    assert REPEAT_S < MARGIN_S  # a command may follow the last `moving` by REPEAT_S
    page = (Path(__file__).parents[2] / "docs/reference/reaction-times.md").read_text()
    assert f"The guard process waits after the command timeout | {MARGIN_S * 1000:g} ms |" in page


@pytest.mark.parametrize("deadline_s", [0.1, 0.5, 2.0])
def test_the_guard_waits_for_the_configured_deadline_and_its_margin(deadline_s: float):
    guard = GuardProcess("", {}, deadline_s=deadline_s)
    silence_s = orjson.loads(guard.command[-1])["silence_ns"] / 1e9
    assert silence_s == pytest.approx(deadline_s + MARGIN_S)


async def test_a_lost_guard_is_a_fault_until_another_is_ready():
    async with supervised(ANSWERS) as (guard, states):
        await eventually(lambda: states == ["prepared"])
        assert guard.faults() == ()
        assert guard.pid is not None
        os.kill(guard.pid, signal.SIGKILL)
        await eventually(lambda: states == ["prepared", "lost"])
        (fault,) = guard.faults()
        assert fault.severity == "degraded"
        assert fault.text.startswith("the guard process has ended: commands to move are refused")
        await eventually(lambda: states == ["prepared", "lost", "prepared"])
        assert guard.faults() == ()


async def test_a_topic_that_is_opened_while_no_guard_is_there_is_told_so():
    async with GuardProcess("", {}, deadline_s=0.5) as guard:
        guard.command = ("/nowhere/python",)
        guard.start()
        states: list[GuardState] = []
        guard.open(TOPIC, TWIST, [], states.append)
        assert states == ["lost"]


async def test_a_guard_that_hangs_while_it_opens_another_topic_is_replaced(monkeypatch):
    async with supervised(ANSWERS) as (guard, states):
        await eventually(lambda: states == ["prepared"])
        assert guard._overdue is None
        monkeypatch.setattr(supervisor, "PREPARE_S", 0.01)
        os.kill(guard.pid or 0, signal.SIGSTOP)
        guard.open("/other", TWIST, [], lambda _: None)
        await eventually(lambda: states == ["prepared", "lost"])
        assert "has not opened a topic within" in guard.faults()[0].text
        monkeypatch.undo()  # the next one gets its time


@pytest.mark.parametrize("what", ["become ready", "opened a topic"])
async def test_a_guard_that_hangs_while_it_prepares_is_replaced(
    monkeypatch, caplog, tmp_path: Path, what: str
):
    # the first one is stopped, as by a debugger, before it is ready or while it opens a topic
    begun = "" if what == "become ready" else 'say("ready")\nsys.stdin.readline()\n'
    first = f"import os, signal\n{begun}os.kill(os.getpid(), signal.SIGSTOP)\n"
    mark = tmp_path / "first"
    is_first = (
        f"import os\nis_first = not os.path.exists({str(mark)!r})\nopen({str(mark)!r}, 'w')\n"
    )
    source = ANSWERS.replace('say("ready")', f"if is_first:\n    exec({first!r})\nsay('ready')")
    async with supervised(is_first + source) as (guard, states):
        pid = guard.pid
        await eventually(lambda: is_stopped(pid) and guard.is_ready is bool(begun))
        assert guard._overdue is not None
        left_s = guard._overdue.when() - asyncio.get_running_loop().time()
        assert 0 < left_s <= 30.0
        with monkeypatch.context() as patch:  # the rest of the test does not take 30 s
            patch.setattr(supervisor, "PREPARE_S", 0.01)
            guard._expect()
            await eventually(lambda: states == ["lost"])
        why = f"the guard process has not {what} within 0.01 s: commands to move are refused"
        assert guard.faults()[0].text.startswith(why)
        assert why in caplog.text
        await eventually(lambda: states == ["lost", "prepared"])
        assert guard._overdue is None
        assert not is_running(pid)
