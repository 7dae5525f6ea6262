# SPDX-License-Identifier: Apache-2.0
"""Events in any order never move a robot that must not move.

The model keeps a history and judges each command that goes out by reading back in it. It knows the
rules in words, none of the drive's state.
"""

import itertools
import sys
from dataclasses import dataclass, replace

from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from gateway.drive.decisions import BACKLOG_GAP_NS
from gateway.drive.drive import Drive
from gateway.drive.effects import Changed, Command, Effect, Refused, Rules, Send, Stopped
from gateway.drive.stop import ZEROS
from gateway.drive.trip_latch import QUIET_NS
from gateway.drive.velocity import ZERO, Velocity
from gateway.drive.waiting import GUARD_WAIT_NS, HOLD_NS

MS = 1_000_000
RULES = Rules(500 * MS, 2000 * MS, max_linear=1.0, max_angular=2.0, first_command="any")
ASKED = {"zero", "release"}
CLIENTS = st.sampled_from("abc")
AGES = st.sampled_from(["unknown", "unknown", "unknown", "fresh", "stale"])
VELOCITIES = st.sampled_from(
    [ZERO, Velocity(linear_x=0.2), Velocity(linear_x=-1e300, angular_z=9.0), Velocity(angular_z=2)]
)


@dataclass(frozen=True)
class Event:
    """A line of the history."""

    at_ns: int
    kind: str  # command, asked, gone, sent, trip, stop
    client: str = ""
    velocity: Velocity = ZERO
    age: str = "unknown"


class Driving(RuleBasedStateMachine):
    """Clients, a guard, and a clock that sometimes leaps."""

    def __init__(self) -> None:
        super().__init__()
        self.drive = Drive("/cmd_vel", RULES, "ready")
        self.now = 10**12
        self.history: list[Event] = []
        self.guard = "ready"
        self.is_over = False
        self.told = self.drive.status  # when watchers asked
        self.zeros_due: list[int] = []  # times of those sent since a stop that nothing has ended

    # What happens

    @rule(client=CLIENTS, velocity=VELOCITIES, age=AGES)
    def command(self, client: str, velocity: Velocity, age) -> None:
        # do what was due first, as the drive does, so that the history is in its order
        self.judge(self.drive.tick(self.now))
        self.history.append(Event(self.now, "command", client, velocity, age))
        self.judge(self.drive.command(Command(client, velocity, age), self.now))

    @rule(client=CLIENTS, velocity=VELOCITIES, count=st.integers(1, 30), gap_ms=st.integers(0, 60))
    def stream(self, client: str, velocity: Velocity, count: int, gap_ms: int) -> None:
        for _ in range(count):
            self.command(client, velocity, "unknown")
            if gap_ms:
                self.judge(self.drive.end_turn(self.now))
                self.wait(gap_ms)

    @rule(client=CLIENTS, gaps_ms=st.lists(st.integers(1, 400), min_size=1, max_size=4))
    def an_operator_who_lets_go_and_pushes(self, client: str, gaps_ms: list[int]) -> None:
        """Stream and fall silent, then a zero, then commands to move after some times."""
        self.stream(client, Velocity(linear_x=0.2), 3, 50)
        self.wait(700)
        self.command(client, ZERO, "unknown")
        for gap_ms in gaps_ms:
            self.wait(gap_ms)
            self.command(client, Velocity(linear_x=0.2), "unknown")
        self.wait(1)

    @rule()
    def turn_ends(self) -> None:
        self.judge(self.drive.end_turn(self.now))

    @rule(milliseconds=st.integers(0, 3000))
    def wait(self, milliseconds: int) -> None:
        self.judge(self.drive.end_turn(self.now))
        end = self.now + milliseconds * MS
        while (due := self.drive.due_ns) is not None and due <= end:
            self.now = max(self.now, due)
            self.judge(self.drive.tick(self.now))
        self.now = end

    @rule(milliseconds=st.integers(0, 5000))
    def freeze(self, milliseconds: int) -> None:
        self.now += milliseconds * MS

    @rule(client=CLIENTS)
    def leave(self, client: str) -> None:
        self.history.append(Event(self.now, "gone", client))
        self.judge(self.drive.leave(client, self.now))

    @rule(client=CLIENTS)
    def revoke(self, client: str) -> None:
        self.history.append(Event(self.now, "gone", client))
        self.judge(self.drive.revoke(client, self.now))

    @rule(client=CLIENTS, method=st.sampled_from(["stop", "acquire", "release", "invalid"]))
    def operate(self, client: str, method: str) -> None:
        over = {"stop": "abc", "acquire": "abc".replace(client, "")}.get(method, client)
        self.history += [Event(self.now, "gone", each) for each in over]  # their commands
        if method == "acquire":
            self.history.append(Event(self.now, "asked", client))
        self.judge(getattr(self.drive, method)(client, self.now))

    @rule(guard=st.sampled_from(["starting", "prepared", "ready", "ready", "lost"]))
    def guard_changes(self, guard) -> None:
        self.guard = guard
        self.judge(self.drive.set_guard(guard, self.now))

    @rule(chance=st.integers(0, 20))
    def shut_down(self, chance: int) -> None:
        if not chance:
            self.is_over = True
            self.judge(self.drive.shut_down(self.now))

    # What must hold

    def judge(self, effects: list[Effect]) -> None:
        is_told = any(isinstance(effect, Changed) for effect in effects)
        assert is_told or self.drive.status == self.told, "changed, and watchers do not know"
        self.told = self.drive.status
        for effect in effects:
            match effect:
                case Send(velocity) if velocity.is_zero:
                    self.zeros_due.append(self.now)
                case Send(velocity):
                    self.judge_motion(velocity)
                    self.zeros_due = []
                    self.history.append(Event(self.now, "sent", velocity=velocity))
                case Stopped(cause, client):
                    self.zeros_due = []
                    is_asked = cause in ASKED or (cause == "stop" and client is None)
                    own_stop = cause == "stop" and not effect.is_tripped
                    kind = "stop" if is_asked or own_stop else "trip"
                    self.history.append(Event(self.now, kind))
                case Refused(refused, "not_lease_holder") if self.is_newest(refused):
                    # it was nobody's business
                    self.history[-1] = replace(self.history[-1], kind="refused")

    def is_newest(self, command: Command) -> bool:
        """Return whether a command is the last event: one that waited before is not."""
        last = self.history[-1]
        return (last.kind, last.client, last.age) == ("command", command.client, command.age)

    def judge_motion(self, velocity: Velocity) -> None:
        assert velocity.is_finite
        assert abs(velocity.linear_x) <= 1
        assert abs(velocity.angular_z) <= 2
        assert not self.is_over
        assert self.guard == "ready"
        index, command = self.newest_command()
        # alive: nothing of a client that has left, and only the holder's
        assert command.client == self.drive.status.holder
        assert not [e for e in self.history[index:] if e == Event(e.at_ns, "gone", command.client)]
        assert command.velocity.clamped(1, 2) == velocity
        assert command.age != "stale"
        assert self.has_let_go(command), (self.history, self.now)
        # in time: one that waited has done so for the guard, or for twice the hold at most
        assert self.now - command.at_ns < max(GUARD_WAIT_NS, 2 * HOLD_NS + 1)
        # armed
        trips = [number for number, e in enumerate(self.history) if e.kind == "trip"]
        if trips:
            self.judge_reset(trips[-1], index, command)

    def has_let_go(self, command: Event) -> bool:
        """Return whether nobody else drove when its client began to push, or it has asked since."""
        own = [e for e in self.history if e.client == command.client]
        newest = own.index(command)
        for event, later in itertools.pairwise(reversed(own[: newest + 1])):
            if event.kind == "gone" or event.velocity.is_zero:
                return True
            if later.kind == "refused" and later.velocity != ZERO:
                return event.at_ns - later.at_ns >= RULES.deadline_ns
        return True

    def newest_command(self) -> tuple[int, Event]:
        """Return the newest command to move that the holder has sent and that was not stale."""
        holder = self.drive.status.holder
        for index in reversed(range(len(self.history))):
            event = self.history[index]
            is_own = event.kind == "command" and event.client == holder
            if is_own and event.age != "stale" and not event.velocity.is_zero:
                return index, event
        raise AssertionError("nobody has commanded this")

    def judge_reset(self, trip: int, index: int, command: Event) -> None:
        """Find what has reset the latch after a trip."""
        since = self.history[trip + 1 : index]
        if any(e.kind == "sent" for e in since):
            return  # judged then
        for number, event in enumerate(since):
            if event.kind == "command" and event.velocity.is_zero and event.age != "stale":
                if event.age == "fresh":
                    return
                later = [
                    e
                    for e in since[number + 1 :]
                    if e.kind == "command"
                    and not e.velocity.is_zero
                    and e.client == event.client
                    and e.age != "stale"
                ]
                next_at_ns = later[0].at_ns if later else command.at_ns
                if next_at_ns - event.at_ns >= QUIET_NS:
                    return
        assert self.is_single(trip, since, command), (self.history, self.now)

    def is_single(self, trip: int, since: list[Event], command: Event) -> bool:
        """Return whether the motion had one command, and those after it came one by one."""
        before = self.history[:trip]
        starts = [n for n, e in enumerate(before) if e.kind in {"trip", "stop"}]
        motion = before[starts[-1] if starts else 0 :]
        sent = sum(e.kind == "sent" for e in motion)
        waited = [
            e
            for e in [*since, command]
            if e.kind == "command" and e.client == command.client and not e.velocity.is_zero
        ]
        gaps = [b.at_ns - a.at_ns for a, b in itertools.pairwise(waited)]
        return sent <= 1 and all(gap >= BACKLOG_GAP_NS for gap in gaps[-1:])

    @invariant()
    def a_stop_is_followed_by_its_zeros(self) -> None:
        if self.drive.status.motion == "stopping":
            assert self.zeros_due
            assert self.drive.due_ns is not None
            if len(self.zeros_due) > 1 and len(self.zeros_due) <= ZEROS:
                assert self.zeros_due[-1] <= self.now

    @invariant()
    def it_knows_no_more_than_a_command_and_a_lease(self) -> None:
        assert not any(isinstance(v, list | dict | set) for v in vars(self.drive).values())
        assert sys.getsizeof(self.drive.__dict__) < 10_000
        assert len(self.drive._refused_drivers) <= len("abc")

    @invariant()
    def a_robot_that_moves_has_a_holder_a_guard_and_a_deadline(self) -> None:
        status = self.drive.status
        if status.motion == "moving":
            assert status.holder is not None
            assert not status.is_tripped
            assert self.drive.needs_guard
            assert self.drive.due_ns is not None


TestDriving = Driving.TestCase
