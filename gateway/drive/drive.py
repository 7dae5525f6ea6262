# SPDX-License-Identifier: Apache-2.0
"""The state machine of one command topic: the order of the events that each call causes.

The states, events, and actions are in tables: `MOTION`, `LATCH`, `WAITING`, `LEASE`, and those of
`gateway.drive.decisions`. A robot moves only while the holder of the lease commands it to, in time:

- The deadline is checked before each command, by a time that is read once per turn of the event
  loop. So after a silence of the gateway or the network, it stops the robot before it looks at the
  commands that have piled up. Of the commands of one turn the newest goes out.
- Many commands at once after a silence are a backlog, a few wait to be explained (`Burst`).
- A client that pushed while another one drove must release the joystick first (`RefusedDrivers`).
"""

from collections.abc import Hashable

from gateway.drive import refusals
from gateway.drive.burst import Burst
from gateway.drive.decisions import MOVES, STOPS, Reason, is_alone
from gateway.drive.effects import (
    Cause,
    Changed,
    Clamped,
    Command,
    Effects,
    GuardState,
    Refused,
    Rules,
    Send,
    Status,
    Stopped,
)
from gateway.drive.freshness import LATE
from gateway.drive.lease import TAKING, ZEROS, Lease, LeaseEvent
from gateway.drive.motion import MOVING, STARTS, Motion
from gateway.drive.refused_drivers import RefusedDrivers
from gateway.drive.stop import Zeros
from gateway.drive.trip_latch import QUIET_NS, LatchEvent, TripLatch
from gateway.drive.waiting import WaitingCommand, WaitingEvent


class Drive:
    """One command topic: who drives, how fast, and whether at all.

    Call `end_turn` at the end of each turn of the event loop in which there was a command, and
    `tick` at `due_ns`. Times are those of a monotonic clock.
    """

    def __init__(self, topic: str, rules: Rules, guard: GuardState = "starting") -> None:
        self._topic = topic
        self._rules = rules
        self._guard: GuardState = guard
        self._is_over = False  # the gateway shuts down
        self._motion = Motion()
        self._latch = TripLatch()
        self._waiting = WaitingCommand()
        self._lease = Lease()
        self._zeros = Zeros()
        self._burst = Burst()
        self._refused_drivers = RefusedDrivers()
        self._cause: Cause | None = None  # of the last stop
        self._has_moved = False  # in this turn something was to move the robot

    @property
    def status(self) -> Status:
        """The state, for clients that ask."""
        return Status(
            "moving" if self._motion.is_moving else "stopping" if self._zeros.left else "stopped",
            self._lease.holder,
            self._cause,
            self._latch.is_tripped,
            "ready" if self._guard == "prepared" else self._guard,
        )

    def may_move(self, now_ns: int) -> bool:
        """Return whether the last command was one to move, and its deadline has not passed."""
        return self._motion.is_in_time(now_ns, self._rules.deadline_ns)

    @property
    def needs_guard(self) -> bool:
        """Return whether the guard must stop the robot if this process ends now."""
        return self._motion.is_moving or self._zeros.left > 0

    @property
    def waits_for_proof(self) -> bool:
        """Return whether a command waits until the guard has proved that its zeros arrive."""
        return self._waiting.state != "none" and self._guard == "prepared"

    @property
    def due_ns(self) -> int | None:
        """The time at which `tick` has something to do."""
        times = [self._latch.due_ns]
        if self._motion.is_moving:
            times.append(self._motion.accepted_ns + self._rules.deadline_ns)
        if self._zeros.left:
            times.append(self._zeros.next_ns)
        if self._motion.state == "burst":
            times.append(self._burst.explained_ns)
        if self._waiting.state != "none":
            times.append(self._waiting.due_ns)
        if self._lease.state != "free":
            times.append(self._lease.renewed_ns + self._rules.lease_ns)
        return min((time for time in times if time is not None), default=None)

    # Commands

    def command(self, command: Command, now_ns: int) -> Effects:
        """Take a command of a client."""
        out = self._advance(now_ns)
        silence_ns = self._rules.deadline_ns if self._motion.state in MOVING else QUIET_NS
        claim = self._lease.claim(command, now_ns, self._rules)
        if (refused := self._check(command, claim, now_ns)) is not None:
            if claim == "own_zero":
                self._stop("late_zero", now_ns, out)  # late, but never too late
            if command.age in LATE:  # one that follows closely may be of the same backlog
                self._burst.hear(command.client, now_ns, silence_ns)
            return [*out, refused]
        count = self._burst.hear if command.age == "fresh" else self._burst.add
        gap_ns = count(command.client, now_ns, silence_ns)
        if claim in ZEROS:
            self._zero(command, claim, now_ns, out)
        else:
            self._move(command, claim, gap_ns, now_ns, out)
        return out

    def invalid(self, client: Hashable, now_ns: int) -> Effects:
        """Note that a client has sent a message that does not fit the type."""
        is_waiting, out = self._waiting.take_back(client), self._advance(now_ns)
        if self._lease.holder == client:
            self._stop("invalid_while_waiting" if is_waiting else "invalid_value", now_ns, out)
        return out

    def end_turn(self, now_ns: int) -> Effects:
        """Send the newest command of the turn, or let it wait for what came with it."""
        out = self._advance(now_ns)
        has_moved, self._has_moved = self._has_moved, False
        if self._burst.end_turn() and has_moved:
            waiting = self._waiting.command or self._motion.pending
            self._stop("backlog", now_ns, out)
            if waiting:
                out.append(self._refusal(waiting))
        else:
            self._send(now_ns, out)
        return out

    # Other events. Those that end something first take back a command that waits

    def tick(self, now_ns: int) -> Effects:
        """Do what is due."""
        out = self._advance(now_ns)
        if self._motion.state == "burst":
            self._send(now_ns, out)
        return out

    def _advance(self, now_ns: int, *, may_go: bool = True) -> Effects:
        """Do what is due first. A command that waits goes out only if it *may_go*."""
        out: Effects = []
        motion, lease = self._motion, self._lease
        if motion.state in MOVING and now_ns - motion.accepted_ns >= self._rules.deadline_ns:
            self._stop("single_deadline" if motion.is_single else "deadline", now_ns, out)
        if lease.state != "free" and now_ns - lease.renewed_ns >= self._rules.lease_ns:
            self._on_waiting("refuse", now_ns, out)
            self._stop("lease", now_ns, out)
            out += lease.end()
        waiting = self._waiting
        if may_go and waiting.command and (event := waiting.due_event(now_ns, self._guard)):
            self._on_waiting(event, now_ns, out)
        if self._latch.due_ns is not None:
            out += self._latch.tick(now_ns)
        if self._zeros.left:
            out += self._zeros.tick(now_ns)
        return out

    def leave(self, client: Hashable, now_ns: int) -> Effects:
        """Stop what a client has moved, because it is gone."""
        is_single = self._motion.is_single
        return self._lose(client, "single_disconnect" if is_single else "disconnect", now_ns)

    def revoke(self, client: Hashable, now_ns: int) -> Effects:
        """Stop what a client has moved, because it lost the permission."""
        return self._lose(client, "permission", now_ns)

    def release(self, client: Hashable, now_ns: int) -> Effects:
        """Take control from a client that gives it back. Ignored if it has none."""
        return self._lose(client, "release", now_ns)

    def stop(self, client: Hashable, now_ns: int) -> Effects:
        """Stop at the request of any client, also a robot that seems to stand."""
        self._waiting.on("take_back")
        out = self._advance(now_ns)
        is_own = self._lease.holder in {None, client}
        self._stop("own_stop" if is_own else "stop", now_ns, out)
        return out

    def acquire(self, client: Hashable, now_ns: int) -> Effects:
        """Give control to a client. If another one moves the robot, stop it first."""
        answers: Effects = []
        if self._waiting.client != client:
            self._on_waiting("hand_over", now_ns, answers)
        self._refused_drivers.forget(client)
        out = self._advance(now_ns, may_go=False) + answers
        if self._lease.holder in {None, client}:
            self._lease.on("acquire", client, now_ns)
        else:
            self._stop("takeover", now_ns, out)
            self._hand_over(now_ns, out)
            self._lease.on("other_acquire", client, now_ns)
        out.append(Changed())
        return out

    def set_guard(self, guard: GuardState, now_ns: int) -> Effects:
        """Follow the guard process: without it nothing moves.

        It starts again for each new listener: a robot must stand until the joystick is released.
        """
        is_changed, self._guard = guard != self._guard, guard
        out = self._advance(now_ns)
        if is_changed:
            out.append(Changed())
        if guard == "ready":
            self._on_waiting("ready", now_ns, out)
        elif guard != "prepared":
            _, waiting = self._waiting.on("refuse")
            reader: Reason = "reader_while_waiting" if waiting else "reader"
            self._stop("guard" if guard == "lost" else reader, now_ns, out)
            if waiting:
                out.append(self._refusal(waiting))
        return out

    def shut_down(self, now_ns: int) -> Effects:
        """Stop, and refuse to move from now on."""
        self._is_over = True
        _, waiting = self._waiting.on("refuse")
        out = self._advance(now_ns)
        if waiting:
            out.append(self._refusal(waiting))
        self._stop("shutdown", now_ns, out)
        return out

    # Rules

    def _check(self, command: Command, claim: LeaseEvent, now_ns: int) -> Refused | None:
        if not self._lease.admits(claim):
            self._refused_drivers.refuse(command, now_ns)
            return refusals.not_holder(command, self._topic, self._rules)
        if self._refused_drivers.still_pushes(command, now_ns, self._rules.deadline_ns):
            return refusals.still_pushes(command, self._topic, self._rules)
        if command.age in LATE:
            return refusals.stale(command, self._topic)
        return None

    def _zero(self, command: Command, claim: LeaseEvent, now_ns: int, out: Effects) -> None:
        self._take_lease(command, claim, now_ns, out)
        self._waiting.on("take_back")
        if not self._stop("zero", now_ns, out):
            event: LatchEvent = "fresh_zero" if command.age == "fresh" else "zero"
            out += self._latch.on(event, None, now_ns)
            self._motion.keep(command)

    def _move(
        self, command: Command, claim: LeaseEvent, gap_ns: int | None, now_ns: int, out: Effects
    ) -> None:
        guard: GuardState = "lost" if self._is_over else self._guard
        if claim == "barred_move" and guard != "lost":
            out += self._latch.on("first", "start")
        decision = MOVES[self._latch.state][guard]
        if decision == "single" and not is_alone(command.age, gap_ns):
            decision = "refuse"
        if decision == "refuse":
            out += self._latch.on("move")  # it can still be one of a backlog behind a zero
            self._on_waiting("refuse", now_ns, out)
            out.append(self._refusal(command))
            return
        self._take_lease(command, claim, now_ns, out)
        clamped = command.clamped(self._rules)
        if clamped is not command:
            out.append(Clamped(command, clamped.velocity))
            command = clamped
        self._has_moved = True
        match decision:
            case "single":
                self._waiting.single(command, now_ns)
            case "unready":
                self._waiting.unready(command, now_ns, self._rules.deadline_ns)
            case "accept":
                out += self._motion.move(command, now_ns)

    def _on_waiting(self, event: WaitingEvent, now_ns: int, out: Effects) -> None:
        action, command = self._waiting.on(event)
        if command is None:
            return
        if action == "send":
            out += self._latch.on("go")
            out += self._motion.move(command, now_ns)
            self._send(now_ns, out)
        elif action == "refuse":
            out.append(self._refusal(command, event))

    def _send(self, now_ns: int, out: Effects) -> None:
        """Send what is pending, unless it starts a motion and what came with it is unexplained."""
        motion, command = self._motion, self._motion.pending
        if motion.state in STARTS and now_ns < self._burst.explained_ns and not motion.is_proved:
            motion.on("wait")
            return
        if motion.on("send") == "drive":
            self._zeros.end()
        if command is not None:
            out.append(Send(command.velocity))

    def _take_lease(self, command: Command, claim: LeaseEvent, now_ns: int, out: Effects) -> None:
        """Take or renew the lease. `_check` has found nothing against it."""
        action = self._lease.on(claim, command.client, now_ns)
        if action in TAKING:
            if action == "hand_over":
                self._hand_over(now_ns, out)
            out.append(Changed())

    def _lose(self, client: Hashable, reason: Reason, now_ns: int) -> Effects:
        """Stop what a client moves, and end its lease."""
        self._waiting.take_back(client)
        self._refused_drivers.forget(client)
        out = self._advance(now_ns)
        if self._lease.holder == client:
            self._stop(reason, now_ns, out)
            out += self._lease.end()
        return out

    def _hand_over(self, now_ns: int, out: Effects) -> None:
        """End a lease that another client takes: no command of the former holder goes out."""
        self._on_waiting("hand_over", now_ns, out)
        self._motion.on("hand_over")
        out += self._latch.on("move")

    def _stop(self, reason: Reason, now_ns: int, out: Effects) -> bool:
        """Stop by the table of `STOPS`, and return whether there was something to stop."""
        cause, event, trip = STOPS[reason]
        if self._motion.on(event) != "stop":
            return False
        self._waiting.on("take_back")
        self._cause = cause
        if trip is not None:
            self._latch.on(trip, cause)
        out.append(Stopped(cause, self._lease.holder, self._latch.is_tripped))
        out.append(Changed())
        out += self._zeros.begin(now_ns)
        return True

    def _refusal(self, command: Command, event: WaitingEvent = "refuse") -> Refused:
        if self._is_over:
            return refusals.shutting_down(command, self._topic)
        return refusals.waited(event, command, self._topic, self._latch.cause, self._guard)
