# SPDX-License-Identifier: Apache-2.0
"""The command topics: what clients publish there moves a robot, if their drives let it."""

import asyncio
import time
from collections.abc import Hashable, Iterator
from functools import partial
from typing import Final, cast

from gateway.access.audit import Audit
from gateway.config.control import ControlConfig
from gateway.core.commands.command_topic import CommandTopic
from gateway.core.commands.relayed_counts import RelayedCounts
from gateway.core.commands.rules import check_type, named_topic, say_what_is_ignored
from gateway.core.commands.twist_values import read
from gateway.core.errors import NothingThereError, ProtocolError, unknown_topic
from gateway.core.missing_parts import Missing, refuse_part, require
from gateway.core.names import TopicName
from gateway.core.permission_checks import check_publish
from gateway.core.requests import (
    AcquireControl,
    Advertise,
    Control,
    Publish,
    ReleaseControl,
    Stop,
    Unadvertise,
)
from gateway.core.session import Session
from gateway.core.topic_counts import CountsByTopic
from gateway.core.topic_events import TopicEvents
from gateway.core.topic_types import TopicTypes
from gateway.drive.effects import Rules
from gateway.metrics.state import ClientPublication, ControlState
from gateway.sources.guard import Guard
from gateway.sources.source import Ros, RosError

# Two clients that take over from each other all the time would drive a robot back and forth.
TAKEOVER_NS: Final = 1_000_000_000


class Commands:
    """Carries out every operation on a command topic.

    The time is read once in a turn of the event loop, so commands that were read together have the
    same age.
    """

    def __init__(
        self,
        ros: Ros,
        config: ControlConfig,
        guard: Guard | None,
        audit: Audit,
        counts: CountsByTopic,
        events: TopicEvents,
        types: TopicTypes,
    ) -> None:
        self.relayed = RelayedCounts()
        self._ros = ros
        self._types = types
        self._guard = guard
        self._turn_ns: int | None = None
        self._taken_ns: dict[TopicName, int] = {}  # when control was taken over last
        rules = Rules(
            deadline_ns=round(config.deadline_s * 1e9),
            lease_ns=round(config.lease_s * 1e9),
            max_linear=config.max_linear_m_s,
            max_angular=config.max_angular_rad_s,
            first_command=config.first_command,
        )
        self._topics = {
            TopicName(name): CommandTopic(
                TopicName(name),
                rules,
                ros,
                guard or cast("Guard", Missing("guard")),
                audit,
                now_ns=self._now_ns,
                counts=counts.open(name),
                report=partial(events.report, name),
            )
            for name in config.topics
        }

    def __contains__(self, topic: TopicName) -> bool:
        """Return whether a topic moves a robot."""
        return topic in self._topics

    @property
    def publishers(self) -> int:
        """The number of open ROS publishers."""
        return sum(topic.is_open for topic in self._topics.values())

    def control_state(self) -> ControlState:
        """Return the state of each topic and of the guard. Without a guard no topic is driven."""
        if self._guard is None:
            return ControlState((), guard_is_ready=False, guard_losses=0)
        drives = tuple(topic.drive_state() for topic in self._topics.values())
        return ControlState(drives, self._guard.is_ready, self._guard.losses)

    def is_driven_by(self, session: Session) -> bool:
        """Return whether a client has control of a topic."""
        return any(topic.holder is session for topic in self._topics.values())

    def holder(self, topic: str) -> Hashable | None:
        """Return the client that has control of a topic."""
        return self._topics[TopicName(topic)].holder

    def type_name(self, topic: str) -> str | None:
        """Return the type of a topic's commands, once it is known."""
        return self._topics[TopicName(topic)].type_name

    def client_publications(self) -> Iterator[ClientPublication]:
        """Yield the number of commands of each client, on each topic."""
        for name, topic in self._topics.items():
            for session, driver in topic.drivers.items():
                yield ClientPublication(session.client, name, driver.commands, 0)

    def advertise(self, session: Session, name: TopicName, request: Advertise) -> None:
        """Open a command topic for a client.

        Raises:
            ProtocolError: the type is not one that moves a robot, or another one.
            RosError: ROS refuses it.
        """
        topic = self._opened(name, request.type)
        if session not in topic.drivers:
            say_what_is_ignored(session, request)
            session.inform(f"advertised {name}, a command topic", request)
        topic.driver(session).ids.add(request.id)

    def unadvertise(self, session: Session, name: TopicName, request: Unadvertise) -> None:
        """Withdraw one advertisement, or without an id all of the client's. Stop with the last.

        Raises:
            ProtocolError: the client has not advertised it.
        """
        topic = self._topics[name]
        driver = topic.drivers.get(session)
        if driver is None or (request.id is not None and request.id not in driver.ids):
            with_id = "" if request.id is None else f" with id {request.id!r}"
            raise NothingThereError(f"not advertised: {name}{with_id}")
        driver.ids.discard(request.id)
        if request.id is None or not driver.ids:
            topic.withdraw(session)

    def publish(self, session: Session, name: TopicName, request: Publish) -> None:
        """Take one command. Open the topic first if no client has.

        Raises:
            ProtocolError: the type or the message is wrong.
            RosError: ROS refuses to create the publisher.
        """
        topic = self._topics[name]
        waited_s = session.turns.waited_s()  # before the topic is opened, which takes some time
        if not topic.is_open or request.type is not None or session not in topic.drivers:
            topic = self._opened(name, request.type)
            if session not in topic.drivers:  # later ones may have another id each time
                topic.driver(session).ids.add(request.id)
        assert topic.message_type is not None  # noqa: S101  # it is open
        try:
            values = read(topic.message_type, request.msg)
        except ProtocolError:
            topic.invalid(session)
            raise
        topic.command(session, values, request, waited_s)

    def stop(self, session: Session, request: Stop) -> None:
        """Stop one command topic, or all with a known type. Never refused for its rate.

        Raises:
            ProtocolError: the topic is not a command topic.
        """
        chosen = [self._named(session, request.topic)] if request.topic else self._topics.values()
        stopped = []
        for topic in chosen:
            if not topic.is_open and not self._opens(topic):
                continue  # its type is still unknown
            topic.driver(session)
            topic.stop(session)
            stopped.append(topic.name)
        session.answer("stop", request.id, topics=list(filter(session.sees, stopped)))

    def acquire(self, session: Session, request: AcquireControl) -> None:
        """Give a client control of a topic.

        Raises:
            ProtocolError: the topic is not a command topic, the client may not publish on it, or
                control has just been taken over.
            RosError: the source has no guard.
        """
        topic = self._named(session, request.topic)
        check_publish(session, topic.name)
        self._require_guard()
        if topic.state(session)["holder"] == "other":
            self._check_takeover(topic.name)
        topic.acquire(session)
        session.answer(request.kind, request.id, **topic.state(session))

    def release(self, session: Session, request: ReleaseControl) -> None:
        """Take control of a topic back from a client.

        Raises:
            ProtocolError: the topic is not a command topic.
        """
        topic = self._named(session, request.topic)
        topic.release(session)
        session.answer(request.kind, request.id, **topic.state(session))

    def control(self, session: Session, request: Control) -> None:
        """Answer with the state of a topic, and begin or end to send its changes.

        Raises:
            ProtocolError: the topic is not a command topic.
        """
        topic = self._named(session, request.topic)
        if request.watch is True:
            topic.watchers.add(session)
        elif request.watch is False:
            topic.watchers.discard(session)
        session.answer(request.kind, request.id, **topic.state(session))

    def on_graph_change(self) -> None:
        """Have the guard prepare for the robots that are there."""
        if self._guard is None:
            return
        for topic in self._topics.values():
            topic.on_graph_change(self._types.known(topic.name))

    def revoke(self, session: Session) -> None:
        """Stop what a client moves, because it lost the permission."""
        for topic in self._topics.values():
            topic.revoke(session)

    def leave(self, session: Session) -> None:
        """Stop what a client moves, and forget it."""
        for topic in self._topics.values():
            topic.leave(session)

    def shut_down(self) -> None:
        """Stop every robot. From now on nothing moves."""
        for topic in self._topics.values():
            topic.shut_down()

    def close(self) -> None:
        """Release everything. A topic that is stopping gets a last zero."""
        for topic in self._topics.values():
            topic.close()

    def _check_takeover(self, name: TopicName) -> None:
        now_ns = self._now_ns()
        taken_ns = self._taken_ns.get(name)
        if taken_ns is not None and now_ns - taken_ns < TAKEOVER_NS:
            text = f"control of {name} was taken over less than 1 s ago: try again in a second"
            raise ProtocolError("limit_exceeded", f'{text}, or stop the robot with {{"op":"stop"}}')
        self._taken_ns[name] = now_ns

    def _named(self, session: Session, requested: str | None) -> CommandTopic:
        """Return a topic by its name, or the only one there is."""
        return self._topics[named_topic(session, requested, self._topics)]

    def _opened(self, name: TopicName, requested: str | int | None) -> CommandTopic:
        """Return a topic that is open, with the type asked for or the one that ROS knows."""
        self._require_guard()
        topic = self._topics[name]
        if topic.message_type is not None:
            if requested is None:
                return topic
            named = self._types.named(requested)
            if named.name != topic.message_type.name:
                raise ProtocolError(
                    "type_conflict",
                    f"topic {name} is advertised as {topic.message_type.name}, not {named.name}",
                )
            return topic
        message_type = self._types.on_topic(name, requested)
        if message_type is None:
            raise ProtocolError("not_found", unknown_topic(name))
        check_type(name, message_type)
        topic.open(message_type)
        if self._turn_ns is not None:  # or the command that opened it would be too old
            self._turn_ns = time.monotonic_ns()
        return topic

    def _require_guard(self) -> None:
        """Refuse to drive what nothing would stop if this process failed."""
        require(self._ros.publishing)
        if self._guard is None:
            refuse_part("guard")

    def _opens(self, topic: CommandTopic) -> bool:
        """Open a topic with the type that ROS knows. Return whether that succeeded."""
        try:
            self._opened(topic.name, None)
        except (ProtocolError, RosError):
            return False
        return True

    # Turns

    def _now_ns(self) -> int:
        if self._turn_ns is None:
            self._turn_ns = time.monotonic_ns()
            asyncio.get_running_loop().call_soon(self._end_turn)
        return self._turn_ns

    def _end_turn(self) -> None:
        # read again: a command from before a stop of this process must not go out after it
        self._turn_ns = time.monotonic_ns()
        try:
            for topic in self._topics.values():
                topic.end_turn()
        finally:  # or time would stand still
            self._turn_ns = None
