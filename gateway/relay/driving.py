# SPDX-License-Identifier: Apache-2.0
"""The command topics of a relay: what its clients ask for goes to the robot's own gateway.

The robot decides, and its answers are passed on. A relay has no drive and no guard process. Nothing
here knows Zenoh: the link takes bytes, and brings some.
"""

import asyncio
from collections.abc import Callable, Hashable, Iterator
from typing import Final

from gateway.core.commands.relayed_counts import RelayedCounts
from gateway.core.commands.rules import named_topic, say_what_is_ignored
from gateway.core.errors import NothingThereError, ProtocolError
from gateway.core.names import TopicName, resolve_topic
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
from gateway.core.topic_types import TopicTypes
from gateway.metrics.state import ClientPublication, ControlState
from gateway.relay.command_sender import CommandSender, who_is
from gateway.relay.driver import OpenTopic, RemoteDriver, pass_on
from gateway.relay.driving_states import STATE_S, RobotStates
from gateway.relay.robot_link import RobotLink
from gateway.sources.zenoh.driving_wire import (
    MAX_NAME_CHARACTERS,
    Beat,
    RemoteOperation,
    RemoteStop,
    Told,
    ToldEvent,
)

_STOP_SILENT: Final = (
    "the robot's gateway does not answer. Its command timeout stops the robot: check that it"
    " stands, and use the emergency stop if not"
)
OpenLink = Callable[["RemoteCommands"], RobotLink]


class RemoteCommands:
    """Implements `gateway.core.commands.interface.CommandTopics` for a robot behind a router.

    *usual* are the names of command topics until the robot has said which it has.
    """

    publishers = 0

    def __init__(self, usual: tuple[str, ...], open_link: OpenLink, types: TopicTypes) -> None:
        self.relayed = RelayedCounts()
        self._types = types
        self._states = RobotStates(usual, self._name_of, self._listen)
        self._drivers: dict[Session, RemoteDriver] = {}
        self._by_name: dict[str, RemoteDriver] = {}
        self._names = 0
        self._is_over = False
        self._link = open_link(self)
        self._sender = CommandSender(self._link, types, self._hear_all, self.type_name)
        self._look()

    def __contains__(self, topic: TopicName) -> bool:
        """Return whether a topic moves the robot."""
        return topic in self._states.names

    def control_state(self) -> ControlState:
        """Return that there is nothing that this process guards."""
        return ControlState((), guard_is_ready=False, guard_losses=0)

    def client_publications(self) -> Iterator[ClientPublication]:
        """Yield the number of commands of each client, on each topic."""
        for session, driver in self._drivers.items():
            for name, topic in driver.topics.items():
                yield ClientPublication(session.client, name, topic.commands, 0)

    def is_driven_by(self, session: Session) -> bool:
        """Return whether a client has control of a topic."""
        driver = self._drivers.get(session)
        return driver is not None and self._states.is_held_by(driver.name)

    def holder(self, topic: str) -> Hashable | None:
        """Return the name of the client that has control of a topic."""
        state = self._states.of(topic)
        return None if state is None else state.holder

    def type_name(self, topic: str) -> str | None:
        """Return the type of a topic's commands, once the robot has said it."""
        state = self._states.of(topic)
        return None if state is None else state.type

    # Operations

    def advertise(self, session: Session, name: TopicName, request: Advertise) -> None:
        """Open a command topic at the robot.

        Raises:
            ProtocolError: the type is not known here.
        """
        message_type = self._types.named(request.type)
        driver = self._driver(session)
        topic = driver.topics.get(name)
        if topic is None:
            topic = driver.topics[name] = OpenTopic()
            say_what_is_ignored(session, request)
        topic.ids.add(request.id)
        self._sender.operate(driver, "advertise", request, name, message_type.name)

    def unadvertise(self, session: Session, name: TopicName, request: Unadvertise) -> None:
        """Withdraw one advertisement, or without an id all of the client's.

        Raises:
            ProtocolError: the client has not advertised it.
        """
        driver = self._drivers.get(session)
        topic = None if driver is None else driver.topics.get(name)
        if (
            driver is None
            or topic is None
            or (request.id is not None and request.id not in topic.ids)
        ):
            with_id = "" if request.id is None else f" with id {request.id!r}"
            raise NothingThereError(f"not advertised: {name}{with_id}")
        topic.ids.discard(request.id)
        if request.id is None or not topic.ids:
            del driver.topics[name]
            self._sender.operate(driver, "unadvertise", request, name)

    def publish(self, session: Session, name: TopicName, request: Publish) -> None:
        """Send one command on. While the robot does not know the client, the newest one waits.

        Raises:
            ProtocolError: the type or the message is wrong.
        """
        waited_s = session.turns.waited_s()
        driver = self._driver(session)
        topic = driver.topics.get(name)
        if topic is None:  # later ones may have another id each time
            topic = driver.topics[name] = OpenTopic()
            topic.ids.add(request.id)
        topic.count()
        self._sender.publish(driver, name, request, waited_s)

    def stop(self, session: Session, request: Stop) -> None:
        """Have the robot stop one command topic, or all. A topic that it does not know means all.

        This relay may know the topics of the robot too late, so the robot decides.
        """
        driver = self._drivers.get(session)
        if driver is not None:
            driver.drop_held()
        name, address = who_is(session)
        stop = RemoteStop(
            client=None if driver is None else driver.name,
            number=0 if driver is None else driver.next_number(),
            topic=_topic_of(session, request),
            name=name,
            address=address,
        )

        def on_told(told: Told | None) -> None:
            events = () if told is None else told.events
            answers = [each for each in events if each.number == stop.number]
            for each in answers:
                _pass_on_stop(session, request, each)
            if not answers:
                session.refuse(ProtocolError("timeout", _STOP_SILENT), request)

        self._link.ask(stop, on_told)

    def acquire(self, session: Session, request: AcquireControl) -> None:
        """Ask the robot for control.

        Raises:
            ProtocolError: the topic is not a command topic, or the client may not publish on it.
        """
        name = named_topic(session, request.topic, self._states.names)
        check_publish(session, name)
        driver = self._driver(session)
        self._states.watch(session, name)
        driver.find()  # a person asks for it
        self._sender.operate(driver, "acquire", request, name)

    def release(self, session: Session, request: ReleaseControl) -> None:
        """Give control back to the robot.

        Raises:
            ProtocolError: the topic is not a command topic.
        """
        name = named_topic(session, request.topic, self._states.names)
        driver = self._drivers.get(session)
        if driver is None:
            self._states.answer(session, request, name)
        else:
            self._sender.operate(driver, "release", request, name)

    def control(self, session: Session, request: Control) -> None:
        """Answer with the state of a topic, and begin or end to send its changes.

        Raises:
            ProtocolError: the topic is not a command topic.
        """
        name = named_topic(session, request.topic, self._states.names)
        if request.watch is True:
            self._states.watch(session, name)
        elif request.watch is False:
            self._states.unwatch(session, name)
        self._states.answer(session, request, name)

    def on_graph_change(self) -> None:
        """Do nothing: the robot follows its graph."""

    def revoke(self, session: Session) -> None:
        """Have the robot stop what a client moves."""
        self.leave(session)

    def leave(self, session: Session) -> None:
        """Have the robot stop what a client moves, and forget it."""
        self._states.leave(session)
        driver = self._drivers.pop(session, None)
        if driver is not None:
            driver.leave()
            del self._by_name[driver.name]
            self._link.hide(driver.name)
        self._listen()

    def shut_down(self) -> None:
        """Have the robot stop what the clients here move. From now on nothing goes out."""
        self._is_over = True
        for session in list(self._drivers):
            self.leave(session)

    def close(self) -> None:
        """Release everything."""
        self.shut_down()
        self._states.close()
        self._link.close()

    # From the robot

    def hear_beat(self, beat: Beat) -> None:
        """Note a sign of life. Those whom a former start of the robot knew are lost."""
        self._sender.hear_beat(beat)
        for driver in self._drivers.values():
            if driver.epoch not in {None, beat.epoch}:
                driver.lose()

    def hear(self, client: str, told: Told) -> None:
        """Take what the robot says to one client, or to all by the name ``""``."""
        driver = self._by_name.get(client)
        if not client:
            self._hear_all(told)
        elif driver is not None:
            for event in told.events:
                if event.what == "lost":
                    driver.lose()
                driver.hear(event)

    def _hear_all(self, told: Told) -> None:
        self.hear_beat(told.beat)
        if told.topics:  # a refusal has none
            self._states.note(told.topics)

    def _look(self) -> None:
        """Ask for the command topics until the robot answers: the first client may need them."""
        if not self._is_over:
            look = RemoteOperation(op="look", client=f"{self._link.relay}/0", number=0)
            self._link.ask(look, self._on_look)

    def _on_look(self, told: Told | None) -> None:
        if told is None:
            asyncio.get_running_loop().call_later(STATE_S, self._look)
        else:
            self._hear_all(told)

    def _driver(self, session: Session) -> RemoteDriver:
        if self._is_over:
            raise ProtocolError("tripped", "the gateway is shutting down")
        driver = self._drivers.get(session)
        if driver is None:
            self._names += 1
            driver = RemoteDriver(f"{self._link.relay}/{self._names}", session)
            self._drivers[session] = self._by_name[driver.name] = driver
            self._listen()
        return driver

    def _name_of(self, session: Session) -> str | None:
        driver = self._drivers.get(session)
        return None if driver is None else driver.name

    def _listen(self) -> None:
        self._link.listen(is_on=bool(self._drivers) or self._states.is_needed)


def _topic_of(session: Session, stop: Stop) -> TopicName | None:
    """Return the topic of a stop, or None for all, as also for what is not the name of a topic."""
    if not stop.topic:
        return None
    try:
        name = resolve_topic(stop.topic, session.limits.max_name_characters)
    except ProtocolError:
        return None
    return name if len(name) <= MAX_NAME_CHARACTERS else None


def _pass_on_stop(session: Session, request: Stop, event: ToldEvent) -> None:
    if event.what != "answer":
        pass_on(session, event, request)
        return
    topics = event.members.get("topics")
    stopped = [each for each in topics if isinstance(each, str)] if topics else []
    session.answer("stop", request.id, topics=list(filter(session.sees, stopped)))
