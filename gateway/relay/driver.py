# SPDX-License-Identifier: Apache-2.0
"""One client of a relay that drives, or waits for control, as its relay knows it."""

import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Final, NamedTuple, get_args

from gateway.core.advertisement_ids import AdvertisementIds
from gateway.core.commands.clients import Driver
from gateway.core.errors import NothingThereError, ProtocolError, StatusCode
from gateway.core.names import TopicName
from gateway.core.requests import Advertise, Publish, Request
from gateway.core.session import Session
from gateway.sources.zenoh.driving_wire import ToldEvent

# Commands whose clients want to hear of each. The robot answers within a second
MAX_ASKED: Final = 256

_CODES: Final[Mapping[str, StatusCode]] = {code: code for code in get_args(StatusCode)}
# The fields of the answers to operations on command topics
_MEMBERS: Final = frozenset(
    {
        *("topic", "state", "tripped", "cause", "holder", "guard", "deadline_s", "lease_s"),
        *("clamped", "topics"),
    }
)


class HeldCommand(NamedTuple):
    """The newest command of a client that the robot does not know yet."""

    topic: TopicName
    request: Publish
    waited_s: float
    at_s: float


@dataclass(slots=True)
class OpenTopic:
    """A command topic that a client has open."""

    type_name: str | None = None
    ids: AdvertisementIds = field(default_factory=AdvertisementIds)
    commands: int = 0

    def learn(self, type_name: str) -> None:
        """Note the type of the client's commands."""
        self.type_name = type_name

    def count(self) -> None:
        """Count a command."""
        self.commands += 1


@dataclass(slots=True, eq=False)
class RemoteDriver:
    """Such a client, by its *name* at the robot.

    It has an epoch as long as the robot knows it. Once it *is_lost*, only a zero command lets it
    drive on.
    """

    name: str
    session: Session
    epoch: int | None = None
    is_entering: bool = False
    is_lost: bool = False
    is_gone: bool = False
    held: HeldCommand | None = None
    topics: dict[TopicName, OpenTopic] = field(default_factory=dict)
    answered: Driver = field(default_factory=Driver)  # when, by the code
    newest: Request | None = None
    _asked: dict[int, Request] = field(default_factory=dict)  # the oldest first
    _number: int = 0

    def next_number(self) -> int:
        """Return the number of the next command or operation."""
        self._number += 1
        return self._number

    def remember(self, number: int, request: Publish) -> None:
        """Note a command, to which the robot may say something."""
        self.newest = request
        if request.id is not None:
            self._asked[number] = request
            if len(self._asked) > MAX_ASKED:
                del self._asked[next(iter(self._asked))]

    def begin(self) -> None:
        """Note that the robot gets to know it, by an operation that is under way."""
        self.is_entering = True

    def enter(self, epoch: int) -> None:
        """Note that the robot knows it."""
        self.epoch = epoch

    def lose(self) -> None:
        """Note that the robot does not know it any more."""
        self.epoch, self.is_lost = None, True

    def lose_place(
        self, events: Iterable[ToldEvent], request: Request, held: HeldCommand | None
    ) -> None:
        """Note that the robot does not take it, and pass on why, also for what waited."""
        self.lose()
        if isinstance(request, Advertise):
            self.withdraw(request)
        asked = [request]
        if held is not None and held.request is not request:
            asked.append(held.request)
        for event in events:
            error = ProtocolError(_CODES.get(event.code, "internal"), event.text)
            for each in asked if event.what == "refusal" else ():
                self.refuse(error, each, time.monotonic_ns())

    def find(self) -> None:
        """Note that its operator has seen that it was lost."""
        self.is_lost = False

    def hold(self, command: HeldCommand) -> None:
        """Let a command wait, in place of an older one."""
        self.session.count_replaced(self.held is not None)
        self.held = command

    def take_held(self) -> HeldCommand | None:
        """Return the command that waits, and forget it. No operation is under way."""
        held, self.held, self.is_entering = self.held, None, False
        return held

    def withdraw(self, request: Advertise) -> None:
        """Forget an advertisement that the robot has refused."""
        for name, topic in list(self.topics.items()):
            topic.ids.discard(request.id)
            if not topic.ids:
                del self.topics[name]

    def drop_held(self) -> None:
        """Forget the command that waits, because a stop overtakes it."""
        self.held = None

    def leave(self) -> None:
        """Note that the client is gone."""
        self.is_gone = True

    def refuse(self, error: ProtocolError, request: Request, now_ns: int) -> None:
        """Refuse a command. Without an id, the same is said once a second."""
        if self.answered.is_due(error.code, now_ns) or request.id is not None:
            self.session.refuse(error, request)
        else:
            self.session.count_refused()

    def hear(self, event: ToldEvent, operation: tuple[int, Request] | None = None) -> None:
        """Pass on what the robot says, to the *operation* with its number or to a command."""
        request = self._asked.get(event.number or 0, self.newest)
        is_of_operation = operation is not None and event.number == operation[0]
        if operation is not None and is_of_operation:
            request = operation[1]
        if request is None:
            return
        if event.what != "answer":
            pass_on(self.session, event, request)
            return
        members = {key: value for key, value in event.members.items() if key in _MEMBERS}
        if is_of_operation:
            self.session.answer(request.kind, request.id, **members)
        elif "clamped" in members:  # the only answer to a command
            asked_by = None if event.number is None else request.id
            self.session.answer("control", asked_by, **members)


def pass_on(session: Session, event: ToldEvent, request: Request) -> None:
    """Say to a client what the robot says about its request."""
    code = _CODES.get(event.code, "internal")
    match event.what:
        case "refusal" if event.is_warning:
            session.refuse(NothingThereError(event.text), request)
        case "refusal":
            session.refuse(ProtocolError(code, event.text), request)
        case "warning":
            session.warn(ProtocolError(code, event.text), request)
        case "info":
            session.inform(event.text, request)
