# SPDX-License-Identifier: Apache-2.0
"""The rules of a drive, one by one. Times are milliseconds here."""

from collections.abc import Callable, Iterable

import pytest

from gateway.drive.burst import BACKLOG
from gateway.drive.drive import Drive
from gateway.drive.effects import (
    Changed,
    Clamped,
    Command,
    Effect,
    GuardState,
    Refused,
    Rules,
    Send,
    Stopped,
)
from gateway.drive.freshness import Age
from gateway.drive.velocity import ZERO, Velocity

MS = 1_000_000
AHEAD = Velocity(linear_x=0.2)


class contains(str):  # noqa: N801  # it reads as a word
    """Equal to each text that it is a part of."""

    __slots__ = ()
    __hash__ = str.__hash__

    def __eq__(self, other: object) -> bool:
        return isinstance(other, str) and str(self) in other


class Bench:
    """A drive, its clock, and what came out of it."""

    def __init__(self, guard: GuardState = "ready", **rules: object) -> None:
        self.drive = Drive("/cmd_vel", Rules(**rules), guard)  # type: ignore[arg-type]
        self.now = 1_000_000 * MS
        self.out: list[Effect] = []

    def take(self, effects: Iterable[Effect]) -> None:
        self.out += effects

    def command(self, velocity: Velocity = AHEAD, client: str = "a", age: Age = "unknown") -> None:
        """Send one command in a separate turn."""
        self.take(self.drive.command(Command(client, velocity, age), self.now))
        self.end_turn()

    def burst(self, velocities: Iterable[Velocity], client: str = "a") -> None:
        """Send commands in one turn."""
        for velocity in velocities:
            self.take(self.drive.command(Command(client, velocity), self.now))
        self.end_turn()

    def end_turn(self) -> None:
        self.take(self.drive.end_turn(self.now))

    def wait(self, milliseconds: float) -> None:
        """Let time pass as a loop does: `tick` is called when something is due."""
        end = self.now + round(milliseconds * MS)
        while (due := self.drive.due_ns) is not None and due <= end:
            self.now = max(self.now, due)
            self.take(self.drive.tick(self.now))
        self.now = end

    def freeze(self, milliseconds: float) -> None:
        """Let time pass without anything being called."""
        self.now += round(milliseconds * MS)

    def stream(self, count: int = 10, velocity: Velocity = AHEAD, client: str = "a") -> None:
        """Send commands at 20 Hz."""
        for _ in range(count):
            self.command(velocity, client)
            self.wait(50)

    def sent(self) -> list[Velocity]:
        sent = [each.velocity for each in self.out if isinstance(each, Send)]
        self.out = []
        return sent

    def refusals(self) -> list[str]:
        return [each.code for each in self.out if isinstance(each, Refused)]

    def reasons(self) -> list[str]:
        return [each.reason for each in self.out if isinstance(each, Refused)]

    def causes(self) -> list[str]:
        return [each.cause for each in self.out if isinstance(each, Stopped)]

    def reset(self) -> None:
        """Reset the latch as an operator does."""
        self.command(ZERO)
        self.wait(300)
        self.out = []

    @property
    def moves(self) -> bool:
        return self.drive.status.motion == "moving"


@pytest.fixture
def bench() -> Bench:
    return Bench()


def tripped() -> Bench:
    bench = Bench()
    bench.stream()
    bench.wait(1000)
    assert bench.causes() == ["deadline"]
    assert bench.drive.status.is_tripped
    bench.out = []
    return bench


# Deadline and stop


def test_a_command_moves_at_once(bench: Bench):
    bench.command()
    assert bench.sent() == [AHEAD]


def test_after_the_deadline_five_zeros_come_within_250_ms_and_then_nothing(bench: Bench):
    bench.command()
    bench.wait(499)
    assert bench.sent() == [AHEAD]
    bench.wait(1)
    assert bench.sent() == [ZERO]
    bench.wait(249)
    assert bench.sent() == [ZERO] * 4
    bench.wait(10_000)
    assert bench.sent() == []
    assert bench.drive.status.motion == "stopped"


def test_each_command_starts_the_deadline_again(bench: Bench):
    bench.command()
    bench.wait(400)
    bench.command()
    bench.wait(499)
    assert ZERO not in bench.sent()
    bench.wait(1)
    assert bench.sent() == [ZERO]


def test_a_zero_stops_at_once_and_the_client_may_drive_on(bench: Bench):
    bench.stream()
    bench.sent()
    bench.command(ZERO)
    assert bench.sent() == [ZERO]
    bench.command()
    assert bench.sent() == [AHEAD]
    assert bench.moves


def test_the_zeros_of_a_stop_do_not_hold_back_a_client_that_drives_on_at_once(bench: Bench):
    bench.stream()
    bench.command(ZERO)
    bench.sent()
    bench.stream(5)
    assert bench.sent() == [AHEAD] * 5


def test_zeros_of_a_robot_that_stands_pass(bench: Bench):
    bench.stream(3, ZERO)
    assert bench.sent() == [ZERO] * 3


def test_the_newest_of_a_turn_goes_out(bench: Bench):
    bench.command()
    bench.sent()
    bench.burst([AHEAD, Velocity(linear_x=0.3), Velocity(linear_x=0.1)])
    assert bench.sent() == [Velocity(linear_x=0.1)]


# The latch


def test_after_a_stop_by_the_deadline_only_a_zero_and_quiet_let_it_move_again():
    bench = tripped()
    bench.stream(20)
    assert set(bench.refusals()) == {"tripped"}
    assert bench.sent() == []
    bench.command(ZERO)
    bench.wait(249)
    bench.command()
    assert bench.sent() == [ZERO]  # too early, and the zero is spent
    bench.wait(1000)
    bench.command()
    assert bench.sent() == []
    bench.command(ZERO)
    bench.wait(250)
    bench.command()
    assert bench.sent() == [ZERO, AHEAD]


def test_a_refusal_says_what_to_send():
    bench = tripped()
    bench.command()
    (refused,) = [each for each in bench.out if isinstance(each, Refused)]
    assert 'send a zero command ("msg":{})' in refused.reason
    assert "commands stopped arriving" in refused.reason


def test_a_stream_of_zeros_resets_while_it_lasts():
    bench = tripped()
    bench.stream(6, ZERO)
    bench.command()
    assert bench.sent()[-1] == AHEAD


@pytest.mark.parametrize("stopped_after_ms", [500, 1500, 4000, 20_000])
def test_a_backlog_does_not_move_the_robot_though_there_are_zeros_in_it(stopped_after_ms: int):
    bench = Bench()
    bench.stream()
    bench.sent()
    bench.wait(stopped_after_ms)
    backlog = [AHEAD] * 30 + [ZERO] * 5 + [AHEAD] * 30
    for velocity in backlog:
        bench.command(velocity)
        bench.wait(0.06)
    bench.stream(20)
    assert set(bench.sent()) == {ZERO}
    bench.reset()
    bench.command()
    assert bench.sent() == [AHEAD]


def test_a_gateway_that_stood_still_judges_the_deadline_before_what_has_piled_up(bench: Bench):
    bench.stream()
    bench.sent()
    bench.freeze(3000)
    bench.command()
    assert bench.causes() == ["deadline"]
    bench.burst([AHEAD] * 10 + [ZERO] + [AHEAD])
    bench.command()
    bench.wait(100)
    assert set(bench.sent()) == {ZERO}


def test_a_reset_that_ends_late_begins_again_because_commands_may_wait():
    bench = tripped()
    bench.command(ZERO)
    bench.freeze(3000)
    bench.burst([AHEAD] * 3)
    assert bench.refusals() == ["tripped"] * 3
    assert bench.sent() == [ZERO]


@pytest.mark.parametrize("count", [1, 5])
def test_a_command_of_a_turn_during_which_the_gateway_stood_still_does_not_go_out(
    bench: Bench, count: int
):
    for _ in range(count):
        bench.take(bench.drive.command(Command("a", AHEAD), bench.now))
    bench.freeze(600)
    bench.end_turn()
    assert bench.sent() == [ZERO]


def test_many_commands_at_once_after_a_silence_are_a_backlog(bench: Bench):
    bench.burst([AHEAD] * (BACKLOG + 1))
    assert bench.causes() == ["backlog"]
    assert set(bench.sent()) == {ZERO}
    bench.command()
    assert bench.refusals() == ["tripped"]


@pytest.mark.parametrize("silent_ms", [300, 4000])
@pytest.mark.parametrize(
    ("segments", "gap_ms"),
    [((12, 24, 48), 20), ((12, 24, 48), 50), ((10, 20, 40, 10), 20), ((6, 12, 24, 48), 5)],
)
def test_a_backlog_in_segments_does_not_move_a_robot_that_stood_still(
    bench: Bench, segments: tuple[int, ...], gap_ms: int, silent_ms: int
):
    bench.stream()
    bench.stream(5, ZERO)
    bench.wait(silent_ms)
    bench.out = []
    for count in segments:
        bench.burst([AHEAD] * count)
        bench.wait(gap_ms)
    bench.wait(1000)
    assert bench.causes() == ["backlog"]
    assert set(bench.sent()) == {ZERO}
    assert bench.drive.status.is_tripped


def test_a_backlog_whose_first_segment_is_one_command_moves_until_the_next_one_comes(bench: Bench):
    bench.command()
    bench.wait(20)
    bench.burst([AHEAD] * (BACKLOG + 4))
    assert bench.causes() == ["backlog"]
    assert bench.sent()[:2] == [AHEAD, ZERO]
    assert bench.drive.status.is_tripped


def test_a_few_commands_at_once_after_a_silence_go_out_when_time_has_explained_them(bench: Bench):
    bench.burst([AHEAD] * BACKLOG)
    assert bench.sent() == []
    bench.wait((BACKLOG - 1) * 1000 / 120 - 0.1)
    assert bench.sent() == []
    bench.wait(0.1)
    assert bench.sent() == [AHEAD]
    bench.wait(408.2)  # half a second after they came
    assert bench.moves
    bench.wait(0.2)
    assert bench.causes() == ["deadline"]
    assert bench.drive.status.is_tripped  # nobody types so fast


def test_a_client_that_sends_zeros_all_day_moves_at_once_after_many_of_them(bench: Bench):
    bench.burst([ZERO] * 400)
    bench.wait(50)
    bench.stream(10, ZERO)
    bench.sent()
    bench.command()
    assert bench.sent() == [AHEAD]


def test_no_command_waits_for_longer_than_a_backlog_is_ahead(bench: Bench):
    bench.burst([ZERO] * 400)
    bench.wait(1)
    bench.sent()
    bench.command()
    bench.wait(BACKLOG * 1000 / 120 - 1.1)
    assert bench.sent() == []
    bench.wait(0.1)
    assert bench.sent() == [AHEAD]


def test_an_invalid_message_behind_a_command_of_its_turn_stops_and_trips(bench: Bench):
    bench.take(bench.drive.command(Command("a", AHEAD), bench.now))
    bench.take(bench.drive.invalid("a", bench.now))
    bench.end_turn()
    assert bench.causes() == ["invalid_value"]
    assert set(bench.sent()) == {ZERO}
    assert bench.drive.status.is_tripped


def test_an_invalid_message_takes_back_a_command_that_waits(bench: Bench):
    bench.command()
    bench.wait(5000)
    bench.out = []
    bench.command()
    bench.wait(250 - 1)
    bench.freeze(2)  # it is due
    bench.take(bench.drive.invalid("a", bench.now))
    assert bench.causes() == ["invalid_value"]
    bench.wait(1000)
    assert set(bench.sent()) == {ZERO}


def test_a_backlog_that_a_slow_turn_takes_is_one(bench: Bench):
    for _ in range(50):
        bench.take(bench.drive.command(Command("a", AHEAD), bench.now))
    bench.freeze(300)
    bench.end_turn()
    assert bench.causes() == ["backlog"]
    assert set(bench.sent()) == {ZERO}


@pytest.mark.parametrize("hz", [20, 50, 60, 90, 120])
@pytest.mark.parametrize("stall_ms", [100, 260, 300, 400, 480])
def test_a_robot_that_moves_goes_on_when_its_link_has_hesitated(hz: int, stall_ms: int):
    bench = Bench()
    for _ in range(hz):
        bench.command()
        bench.wait(1000 / hz)
    bench.wait(stall_ms - 1000 / hz)
    bench.burst([AHEAD] * (hz * stall_ms // 1000))
    assert bench.refusals() == []
    assert bench.causes() == []
    assert bench.moves


def test_a_backlog_that_ends_with_a_zero_is_one_as_well(bench: Bench):
    bench.burst([AHEAD] * 30 + [ZERO])
    bench.wait(20)
    bench.command()
    assert bench.causes() == ["zero", "backlog"]
    bench.wait(1000)
    assert set(bench.sent()) == {ZERO}


def test_a_backlog_is_one_though_another_client_has_sent_zeros_in_between(bench: Bench):
    bench.stream(40, ZERO, client="page")
    bench.out = []
    for count in (12, 24, 48):
        bench.burst([AHEAD] * count, client="operator")
        bench.wait(20)
    assert bench.causes() == ["backlog"]
    assert set(bench.sent()) == {ZERO}


def test_a_backlog_behind_stale_commands_is_one(bench: Bench):
    bench.stream(5, ZERO)
    bench.wait(4000)
    bench.out = []
    for _ in range(10):
        bench.command(age="stale")
    for count in (12, 24, 48):
        bench.wait(5)
        bench.burst([AHEAD] * count)
    assert bench.causes() == ["backlog"]
    assert set(bench.sent()) == {ZERO}


def test_a_backlog_that_waits_for_the_guard_is_one():
    bench = Bench("starting")
    bench.burst([ZERO] + [AHEAD] * 48)
    bench.wait(50)
    bench.take(bench.drive.set_guard("ready", bench.now))
    bench.wait(1000)
    assert set(bench.sent()) <= {ZERO}
    bench = Bench("starting")
    bench.burst([AHEAD] * 12)
    bench.wait(1)
    bench.take(bench.drive.set_guard("ready", bench.now))
    bench.wait(19)
    assert bench.sent() == []
    bench.burst([AHEAD] * 24)
    bench.wait(1000)
    assert set(bench.sent()) == {ZERO}


@pytest.mark.parametrize("late_ms", [0, 20])
def test_a_zero_takes_back_what_waits_though_it_is_due(bench: Bench, late_ms: int):
    bench.burst([AHEAD] * 3)
    bench.freeze(2 * 1000 / 120 + late_ms)
    bench.command(ZERO)
    bench.wait(1000)
    assert set(bench.sent()) == {ZERO}


def test_a_zero_goes_out_with_its_turn_though_a_command_before_it_waited_for_time(bench: Bench):
    bench.burst([AHEAD] * 3)
    bench.command(ZERO)
    bench.wait(20)
    bench.sent()
    bench.take(bench.drive.command(Command("a", ZERO), bench.now))
    bench.take(bench.drive.tick(bench.now))
    assert bench.sent() == []
    bench.end_turn()
    assert bench.sent() == [ZERO]


@pytest.mark.parametrize(
    "end",
    [
        lambda bench: bench.drive.leave("a", bench.now),
        lambda bench: bench.drive.revoke("a", bench.now),
        lambda bench: bench.drive.release("a", bench.now),
        lambda bench: bench.drive.stop("b", bench.now),
        lambda bench: bench.drive.acquire("b", bench.now),
        lambda bench: bench.drive.invalid("a", bench.now),
        lambda bench: bench.drive.set_guard("lost", bench.now),
        lambda bench: bench.drive.shut_down(bench.now),
    ],
    ids=["leave", "revoke", "release", "stop", "takeover", "invalid", "guard", "end"],
)
def test_each_end_of_a_motion_takes_back_a_command_that_waits_though_it_is_due(
    bench: Bench, end: Callable[[Bench], Iterable[Effect]]
):
    bench.burst([AHEAD] * 3)
    bench.freeze(20)
    bench.take(end(bench))
    bench.wait(1000)
    assert set(bench.sent()) == {ZERO}


def test_a_command_that_is_proved_fresh_waits_for_nothing(bench: Bench):
    for _ in range(2 * BACKLOG):
        bench.take(bench.drive.command(Command("a", AHEAD, "fresh"), bench.now))
    bench.end_turn()
    assert bench.sent() == [AHEAD]


def test_a_stream_goes_on_at_once_behind_a_few_commands_that_came_together(bench: Bench):
    bench.burst([Velocity(linear_x=0.1)] * 3)
    bench.wait(16)
    assert bench.sent() == []
    bench.wait(34)
    bench.stream(3)
    assert bench.sent() == [Velocity(linear_x=0.1), *[AHEAD] * 3]
    assert bench.refusals() == []


def test_a_command_that_is_proved_fresh_takes_the_place_of_one_that_waits(bench: Bench):
    bench.take(bench.drive.command(Command("a", AHEAD), bench.now))
    bench.take(bench.drive.command(Command("a", Velocity(linear_x=0.1), "fresh"), bench.now))
    bench.end_turn()
    bench.wait(100)
    assert bench.sent() == [Velocity(linear_x=0.1)]


def test_120_commands_a_second_are_not_a_backlog_however_busy_the_loop_is(bench: Bench):
    for count in (12, 6, 1, 3, 12, 9, 6, 3, 3, 12):
        bench.burst([AHEAD] * count)
        bench.wait(count * 1000 / 120)
    assert bench.refusals() == []
    assert bench.moves


def test_a_stream_that_goes_on_is_not_a_backlog(bench: Bench):
    for _ in range(200):  # at 500 Hz
        bench.command()
        bench.wait(2)
    bench.burst([AHEAD] * 10 * BACKLOG)
    assert bench.refusals() == []
    assert bench.sent() == [AHEAD] * 201


# A single command, typed by hand


def test_a_single_command_may_be_sent_again_after_its_deadline(bench: Bench):
    bench.command()
    bench.wait(5000)
    assert not bench.drive.status.is_tripped
    bench.sent()
    bench.command()
    bench.wait(249)
    assert bench.sent() == []
    bench.wait(1)
    assert bench.sent() == [AHEAD]
    bench.wait(499)
    assert bench.sent() == []
    bench.wait(1)
    assert bench.sent() == [ZERO]


def test_single_commands_may_be_sent_one_after_another(bench: Bench):
    for _ in range(3):
        bench.command()
        bench.wait(5000)
    assert bench.refusals() == []
    assert bench.sent().count(AHEAD) == 3


def test_a_single_command_closely_behind_a_zero_does_not_wait_and_ends_the_reset(bench: Bench):
    bench.command()
    bench.wait(5000)
    bench.command(ZERO)
    bench.wait(100)
    bench.sent()
    bench.command()
    assert bench.refusals() == ["tripped"]
    bench.wait(1000)
    bench.command()
    assert bench.sent() == []


@pytest.mark.parametrize("gap_ms", [0.1, 2.9])
def test_a_single_command_that_is_followed_closely_was_in_a_backlog(bench: Bench, gap_ms: float):
    bench.command()
    bench.wait(5000)
    bench.sent()
    bench.command()
    bench.wait(gap_ms)
    bench.command()
    assert bench.refusals() == ["tripped", "tripped"]
    bench.wait(300)
    bench.stream(5)
    assert bench.sent() == []


def test_a_stream_that_follows_a_single_command_begins_a_little_later(bench: Bench):
    bench.command()
    bench.wait(5000)
    bench.sent()
    bench.stream(10)
    assert bench.refusals() == []
    assert bench.sent() == [AHEAD] * 6


def test_an_uneven_stream_of_120_hz_behind_a_single_command_is_not_a_backlog(bench: Bench):
    bench.command()
    bench.wait(5000)
    for late_ms in (0, 5) * 60:
        bench.command()
        bench.wait(1000 / 120 - 2.5 + late_ms)
    assert bench.refusals() == []
    assert bench.moves


def test_a_command_that_waits_for_the_guard_as_well_waits_no_longer_than_a_second(bench: Bench):
    bench.command()
    bench.wait(5000)
    bench.take(bench.drive.set_guard("starting", bench.now))
    bench.sent()
    bench.command()
    bench.wait(999)
    assert bench.refusals() == []
    bench.wait(1)
    assert bench.refusals() == ["tripped"]
    bench.take(bench.drive.set_guard("ready", bench.now))
    bench.wait(100)
    assert bench.sent() == []


def test_a_zero_takes_back_the_command_that_waits(bench: Bench):
    bench.command()
    bench.wait(5000)
    bench.sent()
    bench.command()
    bench.wait(100)
    bench.command(ZERO)
    bench.wait(1000)
    assert set(bench.sent()) == {ZERO}


def test_two_commands_are_a_stream(bench: Bench):
    bench.stream(2)
    bench.wait(1000)
    assert bench.drive.status.is_tripped


def test_a_client_that_sends_its_time_gets_no_single_command(bench: Bench):
    bench.command(age="fresh")
    bench.wait(5000)
    assert bench.drive.status.is_tripped


def test_a_command_that_waited_while_the_gateway_stood_still_does_not_go_out(bench: Bench):
    bench.command()
    bench.wait(5000)
    bench.sent()
    bench.command()
    bench.freeze(600)
    bench.take(bench.drive.tick(bench.now))
    assert bench.refusals() == ["tripped"]
    assert bench.sent() == []


@pytest.mark.parametrize(
    "event",
    [
        lambda bench: bench.drive.leave("a", bench.now),
        lambda bench: bench.drive.release("a", bench.now),
        lambda bench: bench.drive.stop("b", bench.now),
        lambda bench: bench.drive.acquire("b", bench.now),
        lambda bench: bench.drive.set_guard("lost", bench.now),
        lambda bench: bench.drive.shut_down(bench.now),
    ],
)
def test_a_command_that_waits_does_not_go_out_with_the_event_that_takes_it_back(bench, event):
    bench.command()
    bench.wait(5000)
    bench.sent()
    bench.command()
    bench.freeze(260)  # it is due, and nobody has looked
    bench.take(event(bench))
    assert AHEAD not in bench.sent()


# Freshness


def test_a_stale_command_is_refused_and_does_not_hold_off_the_deadline(bench: Bench):
    bench.stream()
    for _ in range(20):
        bench.command(age="stale")
        bench.wait(50)
    assert set(bench.refusals()) == {"stale_command"}
    assert bench.causes() == ["deadline"]


def test_a_fresh_zero_resets_at_once_and_a_stale_one_stops_but_does_not_reset():
    bench = tripped()
    bench.command(ZERO, age="stale")
    bench.wait(1000)
    bench.command(age="fresh")
    assert bench.sent() == []
    bench.command(ZERO, age="fresh")
    bench.command(age="fresh")
    assert bench.sent() == [ZERO, AHEAD]
    bench.command(ZERO, age="stale")
    assert bench.sent() == [ZERO]


# The lease


def test_a_client_that_drives_keeps_others_out_until_it_is_silent_for_the_lease(bench: Bench):
    bench.stream()
    bench.command(client="b")
    bench.command(ZERO, client="b")
    assert bench.refusals() == ["not_lease_holder"] * 2
    assert bench.moves
    bench.command(ZERO)
    bench.wait(1999)
    assert bench.drive.status.holder == "a"
    bench.wait(1)
    assert bench.drive.status.holder is None
    bench.sent()
    bench.command(client="b")
    assert bench.sent() == [AHEAD]


@pytest.mark.parametrize("how", ["zero", "silence", "leaves", "acquires"])
def test_a_stick_that_was_held_before_the_lease_ended_does_not_move_the_robot(
    bench: Bench, how: str
):
    bench.stream()
    bench.command(ZERO)
    for _ in range(30):  # its hand is on the stick, and stays there
        bench.command(client="b")
        bench.wait(100)
    assert bench.drive.status.holder is None
    bench.wait(399)
    bench.command(client="b")
    assert bench.refusals() == ["not_lease_holder"] * 31
    bench.out = []
    match how:
        case "zero":
            bench.command(ZERO, client="b")
        case "silence":
            bench.wait(500)
        case "leaves":
            bench.take(bench.drive.leave("b", bench.now))
        case "acquires":
            bench.take(bench.drive.acquire("b", bench.now))
    bench.command(client="b")
    assert bench.refusals() == []
    assert bench.sent()[-1] == AHEAD


def test_a_client_that_lets_go_while_another_drives_may_push_when_its_lease_is_over(bench: Bench):
    bench.stream()
    bench.command(client="b")
    bench.command(ZERO, client="b")
    bench.take(bench.drive.release("a", bench.now))
    bench.out = []
    bench.command(client="b")
    assert bench.sent() == [AHEAD]


def test_a_client_that_only_sends_zeros_does_not_keep_a_driver_out(bench: Bench):
    bench.stream(30, ZERO)
    bench.sent()
    bench.command(client="b")
    assert bench.sent() == [AHEAD]
    bench.command(ZERO)
    assert bench.refusals() == ["not_lease_holder"]
    assert bench.moves


def test_a_client_that_has_driven_keeps_others_out_by_zeros_for_the_lease_alone(bench: Bench):
    bench.command()
    bench.stream(39, ZERO)
    bench.command(client="b")
    assert bench.refusals() == ["not_lease_holder"]
    bench.stream(1, ZERO)
    bench.sent()
    bench.command(client="c")
    assert bench.sent() == [AHEAD]


def test_control_that_was_asked_for_is_kept_by_zeros(bench: Bench):
    bench.take(bench.drive.acquire("a", bench.now))
    bench.stream(100, ZERO)
    bench.command(client="b")
    assert bench.refusals() == ["not_lease_holder"]


def test_taking_control_stops_the_robot_first(bench: Bench):
    bench.stream()
    bench.sent()
    bench.take(bench.drive.acquire("b", bench.now))
    assert bench.causes() == ["takeover"]
    assert bench.sent() == [ZERO]
    bench.command()
    bench.command(client="b")
    assert bench.refusals() == ["not_lease_holder", "tripped"]
    bench.command(ZERO, client="b")
    bench.wait(250)
    bench.command(client="b")
    assert bench.sent()[-1] == AHEAD


def test_a_zero_of_the_former_driver_does_not_reset_for_the_next_one():
    bench = tripped()
    bench.command(ZERO)
    bench.wait(100)
    bench.take(bench.drive.acquire("b", bench.now))
    bench.wait(200)
    bench.command(client="b")
    assert bench.refusals() == ["tripped"]


def test_releasing_control_stops_the_robot_as_asked(bench: Bench):
    bench.stream()
    bench.sent()
    bench.take(bench.drive.release("b", bench.now))
    assert bench.moves
    bench.take(bench.drive.release("a", bench.now))
    assert bench.sent() == [ZERO]
    bench.command(client="b")
    assert bench.sent() == [AHEAD]


def test_if_the_first_command_must_be_zero_nothing_else_takes_control():
    bench = Bench(first_command="zero")
    bench.command()
    assert bench.refusals() == ["tripped"]
    bench.reset()
    bench.command()
    assert bench.sent() == [AHEAD]
    bench.command(client="b")
    assert bench.refusals() == ["not_lease_holder"]


def test_if_the_first_command_must_be_zero_a_push_does_not_trip_a_client_that_sent_it():
    bench = Bench(first_command="zero")
    bench.stream(10, ZERO)
    bench.command(client="b")
    assert bench.refusals() == ["not_lease_holder"]
    bench.sent()
    bench.command()
    assert bench.sent() == [AHEAD]


def changes_on_command(bench: Bench, **how: object) -> bool:
    """Send a command to move. Return whether it changed what watchers see, as they were told."""
    before, bench.out = bench.drive.status, []
    bench.command(**how)  # type: ignore[arg-type]
    is_told = any(isinstance(effect, Changed) for effect in bench.out)
    assert is_told == (bench.drive.status != before)
    return is_told


def test_watchers_hear_that_a_refused_command_has_set_the_latch():
    bench = Bench(first_command="zero")
    assert changes_on_command(bench)
    assert not changes_on_command(bench)


def test_watchers_hear_that_the_single_command_that_was_left_is_no_more(bench: Bench):
    bench.command()
    bench.take(bench.drive.leave("a", bench.now))
    assert not bench.drive.status.is_tripped
    assert changes_on_command(bench, client="b", age="fresh")
    assert bench.drive.status.is_tripped


# Other stops


@pytest.mark.parametrize(
    ("event", "cause"),
    [
        (lambda bench: bench.drive.leave("a", bench.now), "disconnect"),
        (lambda bench: bench.drive.revoke("a", bench.now), "permission"),
        (lambda bench: bench.drive.invalid("a", bench.now), "invalid_value"),
        (lambda bench: bench.drive.stop("b", bench.now), "stop"),
        (lambda bench: bench.drive.set_guard("lost", bench.now), "guard"),
        (lambda bench: bench.drive.set_guard("starting", bench.now), "reader"),
        (lambda bench: bench.drive.shut_down(bench.now), "shutdown"),
    ],
)
def test_a_stop_that_the_driver_did_not_ask_for_trips(bench: Bench, event, cause: str):
    bench.stream()
    bench.sent()
    bench.take(event(bench))
    assert bench.causes() == [cause]
    assert bench.sent() == [ZERO]
    bench.command()
    bench.wait(220)
    assert "tripped" in bench.refusals()
    assert bench.sent() == [ZERO] * 4


@pytest.mark.parametrize("event", ["leave", "revoke", "invalid", "release"])
def test_other_clients_events_do_not_stop_the_robot(bench: Bench, event: str):
    bench.stream()
    bench.sent()
    bench.take(getattr(bench.drive, event)("b", bench.now))
    assert bench.sent() == []
    assert bench.moves


def test_a_stop_of_the_driver_itself_does_not_trip(bench: Bench):
    bench.stream()
    bench.sent()
    bench.take(bench.drive.stop("a", bench.now))
    assert bench.sent() == [ZERO]
    bench.command()
    assert bench.sent() == [AHEAD]


def test_a_stop_is_published_although_the_robot_stands(bench: Bench):
    bench.take(bench.drive.stop("a", bench.now))
    bench.wait(250)
    assert bench.sent() == [ZERO] * 5


def test_a_shut_down_drive_stays_shut(bench: Bench):
    bench.take(bench.drive.shut_down(bench.now))
    bench.reset()
    bench.command()
    assert bench.refusals() == ["tripped"]
    assert bench.sent() == []


# The guard


def test_a_command_waits_for_the_guard_for_a_second_and_moves_then_for_a_whole_deadline():
    bench = Bench(guard="starting")
    bench.command()
    bench.wait(900)
    bench.command(Velocity(linear_x=0.1))
    bench.wait(900)
    assert bench.sent() == []
    bench.take(bench.drive.set_guard("ready", bench.now))
    bench.end_turn()
    assert bench.sent() == [Velocity(linear_x=0.1)]
    bench.wait(499)
    assert bench.sent() == []
    bench = Bench(guard="starting")
    bench.command()
    bench.wait(1000)
    assert bench.reasons() == [contains("is starting: send the command again")]
    bench.take(bench.drive.set_guard("ready", bench.now))
    bench.end_turn()
    assert bench.sent() == []


def test_a_command_whose_time_was_over_before_the_guard_was_ready_is_refused():
    bench = Bench(guard="starting")
    bench.command()
    bench.now += 1_001_000_000  # a turn of the event loop that was late
    bench.take(bench.drive.set_guard("ready", bench.now))
    bench.end_turn()
    assert bench.refusals() == ["tripped"]
    assert bench.sent() == []


def test_the_last_command_of_a_stick_waits_for_the_guard_for_a_deadline():
    bench = Bench(guard="starting")
    for _ in range(20):  # longer than one of them may wait
        bench.command()
        bench.wait(50)
    assert bench.refusals() == []
    bench.wait(449)
    assert bench.refusals() == []
    bench.wait(1)
    assert bench.refusals() == ["tripped"]
    bench.take(bench.drive.set_guard("ready", bench.now))
    bench.end_turn()
    assert bench.sent() == []


def test_a_command_that_waits_for_the_guard_gets_no_younger_by_other_events():
    bench = Bench(guard="starting")
    bench.command()
    for _ in range(20):
        bench.wait(50)
        bench.take(bench.drive.tick(bench.now))
    assert bench.refusals() == ["tripped"]
    bench.take(bench.drive.set_guard("ready", bench.now))
    bench.end_turn()
    assert bench.sent() == []


def test_a_guard_that_has_discovered_the_robot_is_asked_for_a_proof_once_a_command_waits():
    bench = Bench(guard="starting")
    bench.command()
    assert not bench.drive.waits_for_proof
    bench.take(bench.drive.set_guard("prepared", bench.now))
    assert bench.drive.waits_for_proof
    assert bench.sent() == []
    bench.take(bench.drive.set_guard("ready", bench.now))
    assert not bench.drive.waits_for_proof
    assert bench.sent() == [AHEAD]
    bench.wait(5000)
    bench.take(bench.drive.set_guard("prepared", bench.now))
    assert not bench.drive.waits_for_proof


@pytest.mark.parametrize("guard", ["ready", "prepared"])
def test_a_robot_that_starts_does_not_move_until_the_stick_is_let_go(guard: GuardState):
    bench = Bench(guard)
    bench.command()
    bench.take(bench.drive.set_guard("starting", bench.now))
    bench.take(bench.drive.set_guard("ready", bench.now))
    bench.sent()
    bench.stream()
    assert set(bench.sent()) == {ZERO}
    bench.command()
    assert bench.reasons() == [contains("another node began to listen")]
    bench.reset()
    bench.command()
    assert bench.sent() == [AHEAD]


def test_a_client_that_asks_for_control_brings_back_no_command_that_a_stop_took_back(bench: Bench):
    bench.stream(2)
    bench.take(bench.drive.set_guard("prepared", bench.now))
    bench.command()  # waits for the guard
    bench.freeze(500)  # and nobody looks at the deadline
    bench.take(bench.drive.acquire("a", bench.now))
    assert bench.causes() == ["deadline"]
    bench.sent()
    bench.take(bench.drive.set_guard("ready", bench.now))
    assert bench.sent() == []
    assert bench.drive.status.is_tripped


@pytest.mark.parametrize(
    ("event", "why"),
    [
        (lambda bench: bench.drive.set_guard("lost", bench.now), "ended or hung, and another"),
        (lambda bench: bench.drive.set_guard("starting", bench.now), "another node began"),
        (lambda bench: bench.drive.acquire("b", bench.now), "another client took control"),
        (lambda bench: bench.drive.shut_down(bench.now), "the gateway is shutting down"),
    ],
)
def test_a_command_that_waited_is_refused_for_an_event_in_between(event, why: str):
    bench = Bench(guard="starting")
    bench.command()
    bench.take(event(bench))
    assert bench.reasons() == [contains(why)]


def test_a_command_to_move_that_the_lost_guard_refuses_ends_the_reset_all_the_same():
    bench = tripped()
    bench.take(bench.drive.set_guard("lost", bench.now))
    bench.command(ZERO)
    bench.wait(100)
    bench.command()
    bench.wait(200)
    bench.take(bench.drive.set_guard("ready", bench.now))
    bench.out = []
    bench.command()
    assert bench.refusals() == ["tripped"]
    assert bench.sent() == []


def test_without_the_guard_commands_to_move_are_refused_and_zeros_pass():
    bench = Bench(guard="lost")
    bench.command()
    bench.command(ZERO)
    assert bench.refusals() == ["tripped"]
    assert bench.sent() == [ZERO]


def test_the_guard_is_needed_from_the_first_command_until_the_last_zero(bench: Bench):
    assert not bench.drive.needs_guard
    bench.command()
    assert bench.drive.needs_guard
    bench.wait(699)
    assert bench.drive.needs_guard
    bench.wait(1)
    assert not bench.drive.needs_guard


# Values


def test_a_command_that_is_too_fast_is_clamped_and_its_client_told():
    bench = Bench(max_linear=0.5)
    bench.command(Velocity(linear_x=1e308))
    (clamped,) = [each for each in bench.out if isinstance(each, Clamped)]
    assert clamped.velocity == Velocity(linear_x=0.5)
    assert bench.sent() == [Velocity(linear_x=0.5)]


def test_changes_are_reported_once_each(bench: Bench):
    bench.command()
    bench.out = []
    bench.wait(50)
    bench.command()
    assert not [each for each in bench.out if isinstance(each, Changed)]
