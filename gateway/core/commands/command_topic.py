# SPDX-License-Identifier: Apache-2.0
"""One command topic at run time: its drive, its publisher, its guard, and its clients."""

import logging
import time
from collections.abc import Callable, Hashable, Iterable
from typing import Any, Final

from gateway.access.audit import Audit
from gateway.codec.types import MessageType
from gateway.core.commands.clients import Driver, Watchers
from gateway.core.commands.drive_audit import DriveAudit, clock_offset_ms
from gateway.core.commands.drive_timer import DriveTimer
from gateway.core.commands.topic_guard import TopicGuard
from gateway.core.commands.twist_values import TwistValues
from gateway.core.errors import ProtocolError
from gateway.core.names import TopicName
from gateway.core.requests import Advertise, Publish, Request
from gateway.core.session import Session
from gateway.core.topic_counts import TopicCounts
from gateway.core.topic_events import warning
from gateway.drive import refusals
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
from gateway.drive.refusals import CAUSE_TEXTS
from gateway.drive.stop import LIFESPAN_NS
from gateway.drive.twist_cdr import COMMAND_TYPES, TWIST_STAMPED, encode
from gateway.drive.velocity import ZERO
from gateway.metrics.state import DriveState
from gateway.sources.guard import Guard
from gateway.sources.source import Publisher, Qos, Ros, RosError, TopicEvent

# Reliable, because a zero must arrive. Only the newest goes out, and not when it is old. Nothing is
# retained: a base that restarts must not get the last command from before.
COMMAND_QOS: Final = Qos("reliable", "volatile", "keep_last", 1, lifespan_ns=LIFESPAN_NS)

logger = logging.getLogger(__name__)


class CommandTopic:
    """It is open while clients use it or it is stopping.

    The guard prepares for it as soon as a type is known, because a zero reaches only a node that
    has discovered the guard's publisher. Its drive stays for as long as the gateway runs. So a
    stopped robot stays stopped, also for a client that reconnects.
    """

    def __init__(  # noqa: PLR0913  # one argument for each part that it shares
        self,
        name: TopicName,
        rules: Rules,
        ros: Ros,
        guard: Guard,
        audit: Audit,
        *,
        now_ns: Callable[[], int],
        counts: TopicCounts,
        report: Callable[[TopicEvent], None],
    ) -> None:
        self.name = name
        self._report = report
        self._counts = counts
        self.message_type: MessageType | None = None  # while it is open
        self.drivers: dict[Session, Driver] = {}
        self.watchers = Watchers(self._send_state)
        self._ros = ros
        self._guard = TopicGuard(name, guard, ros, self._on_guard)
        self._audit = DriveAudit(audit, name)
        self._now_ns = now_ns
        self._rules = rules
        self._drive = Drive(name, rules)
        self._publisher: Publisher | None = None
        self._frame_id = ""
        self._timer = DriveTimer(self._tick)

    @property
    def is_open(self) -> bool:
        """Return whether there is a publisher."""
        return self._publisher is not None

    @property
    def holder(self) -> Hashable | None:
        """The client that has control."""
        return self._drive.status.holder

    @property
    def type_name(self) -> str | None:
        """The type of the commands, once it is known."""
        return self._guard.type_name if self.message_type is None else self.message_type.name

    # Clients

    def open(self, message_type: MessageType) -> None:
        """Open the publisher, and have the guard open its own.

        Raises:
            RosError: ROS refuses it.
        """
        self._guard.prepare(message_type.name)
        publisher = self._ros.publishing.advertise(
            self.name, message_type.name, COMMAND_QOS, self._on_event
        )
        # before it is open: nobody drives yet, so a stop would close it
        self._guard.look_for_readers()
        self._publisher, self.message_type = publisher, message_type

    def _on_event(self, event: TopicEvent) -> None:
        """Log a subscription that no command reaches, and warn the clients that drive."""
        if event.code != "type_conflict":
            remedy = "make it volatile, without a deadline and a lease"
            reason = "the gateway never stores a command for later"
            event = event._replace(remedy=f"{reason}: {remedy}")
        self._report(event)
        logger.warning("%s", event.text, extra={"topic": self.name})
        for session in list(self.drivers):
            session.warn(warning(event, session), Advertise(topic=self.name, type=""))

    def on_graph_change(self, types: tuple[str, ...]) -> None:
        """Have the guard prepare for the listeners. *types* are those that ROS knows."""
        known = self._guard.type_name
        if known is not None and (self.is_open or types == (known,)):
            self._guard.look_for_readers()
        elif len(types) == 1 and types[0] in COMMAND_TYPES:
            self._guard.prepare(types[0])

    def driver(self, session: Session) -> Driver:
        """Return the part of a client in an open topic. A new client gets one."""
        return self.drivers.setdefault(session, Driver())

    def command(
        self, session: Session, values: TwistValues, request: Publish, waited_s: float
    ) -> None:
        """Take a command of a client, and answer it if it is refused."""
        now_ns = self._now_ns()
        driver = self.driver(session)
        age = driver.judge(request, now_ns, round(waited_s * 1e9), session.turns)
        command = Command(session, values.velocity, age, request)
        if session.turns.is_overtaken:
            if not values.velocity.is_zero:  # else the stop has done what it asks for
                self._refuse(refusals.overtaken(command, self.name))
            return
        self._frame_id = values.frame_id
        self._apply(self._drive.command(command, now_ns))

    def invalid(self, session: Session) -> None:
        """Note a message that does not fit the type."""
        self._apply(self._drive.invalid(session, self._now_ns()))

    def stop(self, session: Session) -> None:
        """Stop at a client's request."""
        self._audit.record("stop_requested", session)
        self._apply(self._drive.stop(session, self._now_ns()))

    def acquire(self, session: Session) -> None:
        """Give a client control, and send it the changes of the state from now on."""
        self.watchers.add(session)
        self._apply(self._drive.acquire(session, self._now_ns()))

    def release(self, session: Session) -> None:
        """Take control back from a client, if it has it."""
        self._apply(self._drive.release(session, self._now_ns()))

    def revoke(self, session: Session) -> None:
        """Stop a client that lost the permission to drive."""
        self._apply(self._drive.revoke(session, self._now_ns()))
        self.leave(session)

    def withdraw(self, session: Session) -> None:
        """End a client's advertisements, and stop what it moves."""
        self.release(session)
        self._forget(session)
        self._close_if_idle()

    def leave(self, session: Session) -> None:
        """Stop what a client moves, and forget it."""
        if session in self.drivers or self._drive.status.holder is session:
            self._apply(self._drive.leave(session, self._now_ns()))
        self.watchers.discard(session)
        self._forget(session)
        self._close_if_idle()

    def end_turn(self) -> None:
        """Send the newest command of the turn."""
        self._apply(self._drive.end_turn(self._now_ns()))

    def shut_down(self) -> None:
        """Stop, and refuse to move from now on."""
        self._apply(self._drive.shut_down(self._now_ns()))

    def close(self) -> None:
        """Send a last zero if a stop is under way, and release everything."""
        self.shut_down()
        self._timer.close()
        self.drivers.clear()
        self.watchers.close()
        if self._guard.is_watching:
            self._apply([Send(ZERO)])
            self._guard.rest()
        self._close()
        self._guard.close()

    def state(self, session: Session) -> dict[str, Any]:
        """Return the fields of a `control` frame for a client."""
        status = self._drive.status
        holder = None
        if status.holder is not None:
            holder = "you" if status.holder is session else "other"
        return {
            "topic": self.name,
            "state": status.motion,
            "tripped": status.is_tripped,
            "cause": status.cause,
            "holder": holder,
            "guard": status.guard if self._guard.type_name else None,
            "deadline_s": self._rules.deadline_ns / 1e9,
            "lease_s": self._rules.lease_ns / 1e9,
        }

    def drive_state(self) -> DriveState:
        """Return the state for operators."""
        status = self._drive.status
        return DriveState(
            topic=self.name,
            motion=status.motion,
            is_tripped=status.is_tripped,
            cause=None if status.cause is None else CAUSE_TEXTS[status.cause],
            is_leased=status.holder is not None,
            listeners=len(self._guard.readers),
            is_guarded=self._guard.type_name is not None and status.guard == "ready",
            stops=dict(self._audit.stops),
            clock_offset_ms=clock_offset_ms(status.holder),
        )

    def _send_state(self, session: Session) -> None:
        session.answer("control", None, **self.state(session))

    # The effects of the drive

    def _apply(self, effects: Iterable[Effect]) -> None:
        if self._drive.waits_for_proof:
            self._guard.prove(self._stamp_offset_ns(), self._frame_id)
        for effect in effects:
            try:
                self._carry_out(effect)
            except Exception:  # our bug: it delays nothing else, least of all another stop
                logger.exception("a command topic failed", extra={"topic": self.name})
        if not self._drive.needs_guard:
            self._guard.rest()
        self._close_if_idle()  # also after the zeros of a stop while nothing moved
        self._timer.set(self._drive.due_ns)

    def _carry_out(self, effect: Effect) -> None:
        match effect:
            case Send():
                self._publish(effect)
            case Refused():
                self._refuse(effect)
            case Clamped():
                self._tell_clamped(effect)
            case Stopped():
                self._audit.stop(effect)
            case Changed():
                self._audit.hold(self._drive.status.holder)
                self.watchers.notify()

    def _publish(self, effect: Send) -> None:
        if self._publisher is None or self.message_type is None:
            return
        publisher, type_name = self._publisher, self.message_type.name
        is_zero = effect.velocity.is_zero
        self._guard.announce(self._stamp_offset_ns(), self._frame_id, is_zero=is_zero)
        if not is_zero and publisher.new_matches():
            self._guard.look_for_readers()  # before the graph has reported it
        self._guard.will_send()
        stamp_ns = self._ros.now_ns() if type_name == TWIST_STAMPED else 0
        cdr = encode(type_name, effect.velocity, stamp_ns, self._frame_id)
        # The guard was found lost just now, a robot has joined, or the gateway stood still here and
        # the guard stopped the robot: so look at the clock again, as late as possible.
        if not is_zero and not self._drive.may_move(time.monotonic_ns()):
            return
        try:
            publisher.publish(cdr)
            self._guard.has_sent()
        except RosError as error:
            logger.error("%s", error, extra={"topic": self.name})
        if not is_zero and publisher.new_matches():
            self._guard.look_for_readers()  # one that was just found hears a zero at once

    def _stamp_offset_ns(self) -> int:
        """Return ROS time less the monotonic clock, if messages have a stamp."""
        is_stamped = self.type_name == TWIST_STAMPED
        return self._ros.now_ns() - time.monotonic_ns() if is_stamped else 0

    def _refuse(self, refused: Refused) -> None:
        session, request = refused.command.client, refused.command.request
        assert isinstance(session, Session)  # noqa: S101  # the clients of this drive are sessions
        error = ProtocolError(refused.code, refused.reason)
        if isinstance(request, Request) and self._is_to_be_answered(session, request, error.code):
            session.refuse(error, request)
        else:
            session.count_refused()

    def _tell_clamped(self, clamped: Clamped) -> None:
        session, request = clamped.command.client, clamped.command.request
        assert isinstance(session, Session)  # noqa: S101  # as above
        if not isinstance(request, Request):
            return
        if not self._is_to_be_answered(session, request, "clamped"):
            return
        if session in self.watchers:
            session.answer("control", request.id, **self.state(session), clamped=True)
        else:
            linear, angular = self._rules.max_linear, self._rules.max_angular
            text = f"topic {self.name}: too fast, clamped to {linear:g} m/s and {angular:g} rad/s"
            session.warn(ProtocolError("invalid_value", text), request)

    def _is_to_be_answered(self, session: Session, request: Request, code: str) -> bool:
        driver = self.drivers.get(session)  # None: it has withdrawn or left
        is_due = driver is not None and driver.is_due(code, self._now_ns())
        return is_due or request.id is not None

    def _forget(self, session: Session) -> None:
        driver = self.drivers.pop(session, None)
        if driver is not None:
            self._counts.publish(driver.commands)

    def _on_guard(self, state: GuardState) -> None:
        self._apply(self._drive.set_guard(state, self._now_ns()))

    def _tick(self, now_ns: int) -> None:
        self._apply(self._drive.tick(now_ns))

    def _close_if_idle(self) -> None:
        if self.is_open and not self.drivers and not self._drive.needs_guard:
            self._close()

    def _close(self) -> None:
        if self._publisher is not None:
            self._publisher.close()
        self._publisher = None
        self.message_type = None
