# SPDX-License-Identifier: Apache-2.0
"""The way of one client's commands from a relay to the robot.

A command goes out with the newest beat of the robot. The newest one waits while the robot gets to
know its client.
"""

import time
from collections.abc import Callable
from functools import partial
from typing import Final, Literal

from gateway.codec.types import MessageType
from gateway.core.commands.rules import check_type
from gateway.core.commands.twist_values import TwistValues, read
from gateway.core.errors import ProtocolError, unknown_topic
from gateway.core.names import TopicName
from gateway.core.requests import Advertise, Publish, Request
from gateway.core.session import Session
from gateway.core.tasks import FAILURES, refuse
from gateway.core.topic_types import TopicTypes
from gateway.drive import refusals
from gateway.drive.effects import Command
from gateway.drive.twist_cdr import COMMAND_TYPES
from gateway.relay.driver import HeldCommand, OpenTopic, RemoteDriver
from gateway.relay.driving_states import SILENT
from gateway.relay.robot_link import RobotLink
from gateway.sources.zenoh.driving_wire import (
    MAX_NAME_CHARACTERS,
    Beat,
    RemoteCommand,
    RemoteOperation,
    Told,
)

# The robot refuses a command whose beat is older, so it is not sent.
BEAT_S: Final = 0.3

_NO_BEAT: Final = (
    "nothing has come from the robot for over 0.3 s: check the network, and send a new command"
)
_LOST: Final = (
    "the robot's gateway does not know this client, because the connection was lost or there was no"
    ' room: send a zero command ("msg":{}), and drive on'
)

Op = Literal["enter", "acquire", "release", "advertise", "unadvertise"]


class CommandSender:
    """Sends commands and operations, and gives the answers to their clients.

    *on_told* gets each answer for the sake of all. *type_name* returns the type of a topic, once
    the robot has said it.
    """

    def __init__(
        self,
        link: RobotLink,
        types: TopicTypes,
        on_told: Callable[[Told], None],
        type_name: Callable[[str], str | None],
    ) -> None:
        self._link, self._types = link, types
        self._on_told, self._type_name = on_told, type_name
        self._beat: Beat | None = None
        self._beat_s = 0.0

    def hear_beat(self, beat: Beat) -> None:
        """Note a sign of life."""
        self._beat, self._beat_s = beat, time.monotonic()

    def publish(
        self, driver: RemoteDriver, name: TopicName, request: Publish, waited_s: float
    ) -> None:
        """Send a command, or let it wait until the robot knows the client.

        Raises:
            ProtocolError: the type or the message is wrong.
        """
        if driver.epoch is None and not driver.is_lost:
            self._hold(driver, HeldCommand(name, request, waited_s, time.monotonic()))
        else:
            self._send(driver, name, request, waited_s)

    def operate(
        self,
        driver: RemoteDriver,
        op: Op,
        request: Request,
        topic: TopicName | None = None,
        type_name: str | None = None,
    ) -> None:
        """Send an operation. The robot gets to know the client by the first one."""
        if driver.epoch is None and not driver.is_entering:
            self._link.show(driver.name)
        driver.begin()
        name, address = who_is(driver.session)
        number = driver.next_number()
        operation = RemoteOperation(
            op=op,
            client=driver.name,
            number=number,
            name=name,
            address=address,
            topic=topic,
            type=type_name,
        )
        self._link.ask(operation, partial(self._hear, driver, number, request))

    def _hear(self, driver: RemoteDriver, number: int, request: Request, told: Told | None) -> None:
        held = driver.take_held()
        if driver.is_gone:
            return
        if told is None:
            driver.session.refuse(ProtocolError("timeout", SILENT), request)
            return
        self._on_told(told)
        if any(event.what == "lost" for event in told.events):
            driver.lose_place(told.events, request, held)
            self._link.hide(driver.name)
            return
        driver.enter(told.epoch)
        for event in told.events:
            driver.hear(event, (number, request))
        if isinstance(request, Advertise) and any(e.what == "refusal" for e in told.events):
            driver.withdraw(request)
        if held is not None:
            waited_s = held.waited_s + time.monotonic() - held.at_s
            try:
                self._send(driver, held.topic, held.request, waited_s)
            except FAILURES as error:
                refuse(driver.session, held.request, error)

    def _hold(self, driver: RemoteDriver, command: HeldCommand) -> None:
        driver.hold(command)
        if not driver.is_entering:
            self.operate(driver, "enter", command.request)

    def _send(
        self, driver: RemoteDriver, name: TopicName, request: Publish, waited_s: float
    ) -> None:
        message_type = self._type(driver, name, request)
        try:
            values = read(message_type, request.msg)
        except ProtocolError:
            self._put(driver, name, request, message_type.name, None, waited_s)
            raise
        if len(values.frame_id) > MAX_NAME_CHARACTERS:
            text = f"msg.header.frame_id: at most {MAX_NAME_CHARACTERS} characters: shorten it"
            raise ProtocolError("invalid_value", text)
        refusal = self._refusal(driver, name, values)
        if refusal is not None:
            driver.refuse(refusal, request, time.monotonic_ns())
        elif driver.session.turns.is_overtaken:
            return  # the stop has done what a zero command asks for
        elif driver.epoch is None:  # lost, and a zero command
            driver.find()
            self._hold(driver, HeldCommand(name, request, waited_s, time.monotonic()))
        else:
            self._put(driver, name, request, message_type.name, values, waited_s)

    def _refusal(
        self, driver: RemoteDriver, name: TopicName, values: TwistValues
    ) -> ProtocolError | None:
        """Return why a command to move does not go out. A zero command always does."""
        if values.velocity.is_zero:
            return None
        if driver.session.turns.is_overtaken:
            refused = refusals.overtaken(Command(driver, values.velocity), name)
            return ProtocolError(refused.code, refused.reason)
        if driver.is_lost:
            return ProtocolError("tripped", f"topic {name}: {_LOST}")
        if time.monotonic() - self._beat_s > BEAT_S:
            return ProtocolError("stale_command", f"topic {name}: {_NO_BEAT}")
        return None

    def _put(
        self,
        driver: RemoteDriver,
        name: TopicName,
        request: Publish,
        type_name: str,
        values: TwistValues | None,
        waited_s: float,
    ) -> None:
        if driver.epoch is None or self._beat is None:
            return
        number = driver.next_number()
        if values is not None:
            driver.remember(number, request)
        command = RemoteCommand(
            epoch=driver.epoch,
            number=number,
            beat_ns=self._beat.time_ns,
            topic=name,
            type=type_name,
            values=None if values is None else values.velocity,
            frame_id="" if values is None else values.frame_id,
            monotonic_ms=request.monotonic_ms,
            waited_ms=waited_s * 1000,
            is_behind=driver.session.turns.is_behind,
            wants_answer=values is not None and request.id is not None,
        )
        self._link.send(driver.name, command)

    def _type(self, driver: RemoteDriver, name: TopicName, request: Publish) -> MessageType:
        """Return the type of a command: as asked for, as advertised, or as the robot says."""
        topic = driver.topics.get(name) or OpenTopic()
        requested = request.type or topic.type_name or self._type_name(name)
        if requested is None:
            raise ProtocolError("not_found", unknown_topic(name))
        message_type = self._types.named(requested)
        known = self._type_name(name)
        if message_type.name not in {known, *COMMAND_TYPES} and known is not None:
            text = f"topic {name} has type {known}, not {message_type.name}"
            raise ProtocolError("type_conflict", text)
        check_type(name, message_type)
        topic.learn(message_type.name)
        return message_type


def who_is(session: Session) -> tuple[str, str]:
    """Return the name and the address of a client, for the audit log of the robot."""
    name = "" if session.identity is None else session.identity.name
    return name[:MAX_NAME_CHARACTERS], session.address[:MAX_NAME_CHARACTERS]
