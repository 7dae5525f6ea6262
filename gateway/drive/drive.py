# SPDX-License-Identifier: Apache-2.0
"""The state machine of one command topic.

It moves the robot only while its holder commands it to, in time:

- The deadline is checked before each command, by a time that is read once per turn of the event
  loop. So after a silence of the gateway or the network, it stops the robot before it looks at the
  commands that have piled up. Of the commands of one turn the newest goes out.
- A stop is some commands of zero, then silence (`Zeros`).
- After a stop that the client did not ask for, the `TripLatch` refuses commands to move.
- Many commands at once after a silence are a backlog, a few wait to be explained (`Crowd`).
- A client that pushed while another one drove must release the joystick first (`TurnedAway`).
"""

from collections.abc import Hashable
from typing import Final

from gateway.drive import refusals
from gateway.drive.crowd import Crowd
from gateway.drive.effects import (
    Cause,
    Changed,
    Clamped,
    Command,
    Effects,
    GuardState,
    Motion,
    Refused,
    Rules,
    Send,
    Status,
    Stopped,
)
from gateway.drive.freshness import LATE
from gateway.drive.held import HOLD_NS, Held, for_guard
from gateway.drive.lease import Lease
from gateway.drive.stop import Zeros
from gateway.drive.trip_latch import QUIET_NS, TripLatch
from gateway.drive.turned_away import TurnedAway

CROWD_GAP_NS: Final = 3_000_000  # XR's 120 Hz are 8 ms apart


class Drive:
    """One command topic: who drives, how fast, and whether at all.

    Call `end_turn` at the end of each turn of the event loop in which there was a command, and
    `tick` at `due_ns`. Times are those of a monotonic clock.
    """

    def __init__(self, topic: str, rules: Rules, guard: GuardState = "starting") -> None:
        self._topic = topic
        self._rules = rules
        self._guard: GuardState = guard
        self._latch = TripLatch()
        self._lease: Lease | None = None
        self._turned_away = TurnedAway()
        self._cause: Cause | None = None
        self._is_over = False  # the gateway shuts down
        # the motion
        self._moves = False
        self._accepted_ns = 0
        self._commands = 0
        self._is_by_hand = True  # no command had the time of its client
        self._pending: Command | None = None  # goes out at the end of this turn, or
        self._waits = False  # later, as it starts a motion with others that came at once
        self._is_under_way = False  # a command of this motion has gone out
        self._held: Held | None = None
        self._crowd = Crowd()
        self._has_moved = False  # in this turn something was to move the robot
        self._zeros = Zeros()

    @property
    def status(self) -> Status:
        """The state, for clients that ask."""
        motion: Motion = "moving" if self._moves else "stopping" if self._zeros.left else "stopped"
        return Status(
            motion,
            self._lease.holder if self._lease else None,
            self._cause,
            self._latch.is_set and not self._latch.allows_single,
            "ready" if self._guard == "prepared" else self._guard,
        )

    def may_move(self, now_ns: int) -> bool:
        """Return whether the last command was one to move, and its deadline has not passed."""
        return self._moves and now_ns - self._accepted_ns < self._rules.deadline_ns

    @property
    def needs_guard(self) -> bool:
        """Return whether the guard must stop the robot if this process ends now."""
        return self._moves or self._zeros.left > 0

    @property
    def waits_for_proof(self) -> bool:
        """Return whether a command waits until the guard has proved that its zeros arrive."""
        return self._held is not None and self._guard == "prepared"

    @property
    def due_ns(self) -> int | None:
        """The time at which `tick` has something to do."""
        times = [self._latch.due_ns]
        if self._moves:
            times.append(self._accepted_ns + self._rules.deadline_ns)
        if self._zeros.left:
            times.append(self._zeros.next_ns)
        if self._waits and self._pending:
            times.append(self._crowd.explained_ns)
        if self._held:
            times.append(self._held.due_ns)
        if self._lease:
            times.append(self._lease.renewed_ns + self._rules.lease_ns)
        return min((time for time in times if time is not None), default=None)

    # Commands

    def command(self, command: Command, now_ns: int) -> Effects:
        """Take a command of a client."""
        out = self._advance(now_ns)
        silence_ns = self._rules.deadline_ns if self._moves else QUIET_NS
        if (refused := self._check(command, now_ns)) is not None:
            is_stop = command.velocity.is_zero and self._has_lease(command.client)
            if self._moves and is_stop:  # late, but never too late
                self._stop("zero", now_ns, out, is_asked=True)
            if command.age in LATE:  # one that follows closely may be of the same backlog
                self._crowd.hear(command.client, now_ns, silence_ns)
            return [*out, refused]
        count = self._crowd.hear if command.age == "fresh" else self._crowd.add
        gap_ns = count(command.client, now_ns, silence_ns)
        if command.velocity.is_zero:
            self._zero(command, now_ns, out)
        else:
            self._move(command, gap_ns, now_ns, out)
        return out

    def invalid(self, client: Hashable, now_ns: int) -> Effects:
        """Note that a client has sent a message that does not fit the type."""
        is_held, out = self._take_back(client), self._advance(now_ns)
        if (self._moves or is_held) and self._has_lease(client):
            self._stop("invalid_value", now_ns, out)
        return out

    def end_turn(self, now_ns: int) -> Effects:
        """Send the newest command of the turn, or let it wait for what came with it."""
        out = self._advance(now_ns)
        has_moved, self._has_moved = self._has_moved, False
        if self._crowd.end_turn() and has_moved:
            waiting = self._held.command if self._held else self._pending
            self._stop("backlog", now_ns, out)
            if waiting:
                out.append(self._tripped(waiting))
        else:
            self._send_pending(now_ns, out)
        return out

    # Other events. Those that end something first take back a command that waits

    def tick(self, now_ns: int) -> Effects:
        """Do what is due."""
        out = self._advance(now_ns)
        if self._waits:
            self._send_pending(now_ns, out)
        return out

    def _advance(self, now_ns: int) -> Effects:
        """Do what is due first. A command that waits can still be taken back."""
        out: Effects = []
        if self._moves and not self.may_move(now_ns):
            self._stop("deadline", now_ns, out, allows_single=self._is_single)
        if self._lease and self._lease.is_over(now_ns, self._rules.lease_ns):
            if self._moves:
                self._stop("lease", now_ns, out)
            self._lease = None
            out.append(Changed())
        if self._held:
            self._tick_held(self._held, now_ns, out)
        if self._latch.tick(now_ns):
            out.append(Changed())
        return out + self._zeros.tick(now_ns)

    def leave(self, client: Hashable, now_ns: int) -> Effects:
        """Stop what a client has moved, because it is gone."""
        return self._end_lease(client, "disconnect", now_ns, allows_single=self._is_single)

    def revoke(self, client: Hashable, now_ns: int) -> Effects:
        """Stop what a client has moved, because it lost the permission."""
        return self._end_lease(client, "permission", now_ns)

    def release(self, client: Hashable, now_ns: int) -> Effects:
        """Take control from a client that gives it back. Ignored if it has none."""
        return self._end_lease(client, "release", now_ns, is_asked=True)

    def stop(self, client: Hashable, now_ns: int) -> Effects:
        """Stop at the request of any client, also a robot that seems to stand."""
        self._held = None
        out = self._advance(now_ns)
        is_asked = self._lease is None or self._lease.holder == client
        self._stop("stop", now_ns, out, is_asked=is_asked)
        return out

    def acquire(self, client: Hashable, now_ns: int) -> Effects:
        """Give control to a client. If another one moves the robot, stop it first."""
        held, self._held = self._held, None
        self._turned_away.forget(client)
        out = self._advance(now_ns)
        if held and held.command.client == client:
            self._held = None if self.status.is_tripped else held  # a stop has taken it back
        elif held:
            out.append(refusals.taken_over(held.command, self._topic))
        if self._lease and self._lease.holder != client:
            if self._moves:
                self._stop("takeover", now_ns, out)
            self._hand_over(out)
        if self._lease is None:
            self._lease = Lease(client, now_ns)
        self._lease.is_asked_for = True
        self._lease.renewed_ns = now_ns
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
        held = self._held
        if guard == "ready":
            if held and held.until_ns is None:
                self._send_held(held, now_ns, out)
        elif guard != "prepared":
            if self._moves or (held and guard == "starting"):
                self._stop("guard" if guard == "lost" else "reader", now_ns, out)
            self._held = None
            if held:
                out.append(self._tripped(held.command))
        return out

    def shut_down(self, now_ns: int) -> Effects:
        """Stop, and refuse to move from now on."""
        self._is_over = True
        held, self._held = self._held, None
        out = self._advance(now_ns)
        if held:
            out.append(self._tripped(held.command))
        if self._moves:
            self._stop("shutdown", now_ns, out)
        return out

    # Rules

    @property
    def _is_single(self) -> bool:
        return self._commands == 1 and self._is_by_hand

    def _check(self, command: Command, now_ns: int) -> Refused | None:
        if self._lease and not self._lease.admits(command, now_ns, self._rules):
            self._turned_away.refuse(command, now_ns)
            return refusals.not_holder(command, self._topic, self._rules)
        if self._turned_away.still_pushes(command, now_ns, self._rules.deadline_ns):
            return refusals.still_pushes(command, self._topic, self._rules)
        if command.age in LATE:
            return refusals.stale(command, self._topic)
        return None

    def _has_lease(self, client: Hashable) -> bool:
        return self._lease is not None and self._lease.holder == client

    def _zero(self, command: Command, now_ns: int, out: Effects) -> None:
        self._take_lease(command, now_ns, out)
        self._held = None  # the client has taken back what waited
        if self._moves:
            self._stop("zero", now_ns, out, is_asked=True)
        else:
            was_set = self._latch.is_set
            self._latch.zero(command.age, now_ns)
            if was_set != self._latch.is_set:
                out.append(Changed())
            self._pending = command

    def _move(self, command: Command, gap_ns: int | None, now_ns: int, out: Effects) -> None:
        if self._is_over or self._guard == "lost":
            out += self._latch.spoil()  # it can still be one of a backlog behind a zero
            out.append(self._tripped(command))
            return
        is_new = not self._has_lease(command.client)
        if is_new and self._rules.first_command == "zero" and not self._latch.is_set:
            self._latch.trip("start")
            out.append(Changed())
        if self._latch.is_set and not self._may_be_single(command, gap_ns):
            out += self._latch.spoil()
            held, self._held = self._held, None
            if held:
                out.append(self._tripped(held.command))
            out.append(self._tripped(command))
            return
        self._take_lease(command, now_ns, out)
        clamped = command.clamped(self._rules)
        if clamped is not command:
            out.append(Clamped(command, clamped.velocity))
            command = clamped
        self._has_moved = True
        if self._latch.is_set:
            until_ns = self._held.until_ns if self._held else now_ns + HOLD_NS
            self._held = Held(command, now_ns, until_ns or now_ns + HOLD_NS)
        elif self._guard != "ready":
            self._held = for_guard(command, now_ns, self._held, self._rules.deadline_ns)
        else:
            self._accept(command, now_ns, out)

    def _may_be_single(self, command: Command, gap_ns: int | None) -> bool:
        """Return whether a command after a motion of a single one may wait to go out."""
        if not self._latch.allows_single or self._latch.is_resetting or command.age != "unknown":
            return False
        return gap_ns is None or gap_ns >= CROWD_GAP_NS

    def _tick_held(self, held: Held, now_ns: int, out: Effects) -> None:
        if held.until_ns is None:
            if now_ns >= held.due_ns:  # else `set_guard` sends it
                self._held = None
                out.append(refusals.unguarded(held.command, self._topic, self._guard))
        elif now_ns - held.until_ns >= HOLD_NS:
            self._held = None
            out.append(refusals.stood_still(held.command, self._topic))
        elif now_ns >= held.until_ns:
            if self._guard == "ready":
                self._send_held(held, now_ns, out)
            else:
                held.until_ns = None  # the guard comes in time, or it is too late

    def _take_back(self, client: Hashable) -> bool:
        """Drop what a client has waiting, and return whether there was something."""
        is_held = self._held is not None and self._held.command.client == client
        self._held = None if is_held else self._held
        return is_held

    def _send_held(self, held: Held, now_ns: int, out: Effects) -> None:
        self._held = None
        self._latch = TripLatch()
        self._accept(held.command, now_ns, out)
        self._send_pending(now_ns, out)

    def _accept(self, command: Command, now_ns: int, out: Effects) -> None:
        self._pending, self._waits = command, False
        self._accepted_ns = now_ns
        if not self._moves:
            self._moves = True
            self._commands = 0
            self._is_by_hand = True
            self._is_under_way = False
            out.append(Changed())
        self._commands += 1
        self._is_by_hand &= command.age == "unknown"

    def _send_pending(self, now_ns: int, out: Effects) -> None:
        """Send what is pending, unless it starts a motion and what came with it is unexplained."""
        pending = self._pending
        if pending is None:
            return
        is_start = self._moves and not self._is_under_way and pending.age == "unknown"
        self._waits = is_start and now_ns < self._crowd.explained_ns
        if self._waits:
            return
        if self._moves:
            self._is_under_way = True
            self._zeros.left = 0
        self._pending = None
        out.append(Send(pending.velocity))

    def _take_lease(self, command: Command, now_ns: int, out: Effects) -> None:
        """Take or renew the lease. `_check` has found nothing against it."""
        if self._lease and self._lease.holder != command.client:
            self._hand_over(out)
        if self._lease is None:
            self._lease = Lease(command.client, now_ns)
            out.append(Changed())
        self._lease.renewed_ns = now_ns
        if not command.velocity.is_zero:
            self._lease.driven_ns = now_ns

    def _end_lease(self, client: Hashable, cause: Cause, now_ns: int, **how: bool) -> Effects:
        self._take_back(client)
        self._turned_away.forget(client)
        out = self._advance(now_ns)
        if self._lease and self._lease.holder == client:
            if self._moves:
                self._stop(cause, now_ns, out, **how)
            self._lease = None
            out.append(Changed())
        return out

    def _hand_over(self, out: Effects) -> None:
        """End a lease that another client takes: no command of the former holder goes out."""
        held, self._held = self._held, None
        if held:
            out.append(refusals.taken_over(held.command, self._topic))
        self._pending = None
        out += self._latch.spoil()
        self._lease = None

    def _stop(
        self,
        cause: Cause,
        now_ns: int,
        out: Effects,
        *,
        is_asked: bool = False,
        allows_single: bool = False,
    ) -> None:
        self._moves = self._waits = False
        self._pending = self._held = None
        self._cause = cause
        if not is_asked:
            self._latch.trip(cause, allows_single=allows_single)
        holder = self._lease.holder if self._lease else None
        out.append(Stopped(cause, holder, self._latch.is_set and not self._latch.allows_single))
        out.append(Changed())
        out += self._zeros.begin(now_ns)

    def _tripped(self, command: Command) -> Refused:
        if self._is_over:
            return refusals.shutting_down(command, self._topic)
        return refusals.tripped(command, self._topic, self._latch.cause, self._guard)
