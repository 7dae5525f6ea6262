# SPDX-License-Identifier: Apache-2.0
"""The clients of relays that drive this robot, decided as for its own clients.

Each of them has a session in the core of this gateway. So control, the command timeout, the limits,
takeovers, stops and the guard process are the same. This adds what a relay in between needs: no
command from before a loss of the router, none out of order, and none that was on its way for long.

Nothing here knows Zenoh. A key and bytes come in, bytes go out.
"""

import logging
import secrets
import time
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from typing import Final

from gateway.access.permissions import Identity
from gateway.core import requests
from gateway.core.commands.twist_values import TwistValues
from gateway.core.errors import ProtocolError, StatusCode, over_limit
from gateway.core.names import TopicName
from gateway.core.requests import AnyRequest
from gateway.core.router import Router
from gateway.core.token_bucket import TokenBucket
from gateway.drive.velocity import Velocity
from gateway.sources.zenoh.driving_wire import (
    MAX_TEXT_CHARACTERS,
    Beat,
    RemoteCommand,
    RemoteOperation,
    RemoteStop,
    Told,
    ToldEvent,
    TopicControl,
    client_of,
    read_command,
    read_operation,
    read_stop,
)
from gateway.sources.zenoh.keys import WireError
from gateway.uplink.driving_session import RemoteSession
from gateway.uplink.driving_states import ControlObserver

# Between a beat and the command that carries it. Over a network that is well they are 26 to 45 ms
# apart, and what a stall of 0.8 s holds back at least 850 ms.
MAX_ECHO_NS: Final = 300_000_000
# The token of a client comes before its first operation, but another way.
TOKEN_NS: Final = 1_000_000_000
IDLE_NS: Final = 10_000_000_000  # then a client without control makes room for another one
MAX_TOKENS: Final = 1024  # that are remembered. The clients of others lose control after `TOKEN_NS`
UNKNOWN_PER_S: Final = 20.0  # answers to commands of clients that are not known

_ANOTHER_START: Final = (
    "the robot's gateway has started again or had lost the router since this command was made: send"
    " a zero command, and drive on"
)
_OUT_OF_ORDER: Final = "a newer command or operation overtook this one: send a new one"
_LOST: Final = ToldEvent(what="lost")
# for the log: as of one client, so that a flood of lines is limited
OF_RELAYS: Final = {"client": "relays"}

logger = logging.getLogger(__name__)

Tell = Callable[[str, bytes], None]


class RemoteDrivers:
    """The clients of relays that have entered, by their names there.

    *tell* gets what a client is to be told, and for the client ``""`` what all relays are to be
    told. It must not wait.
    """

    def __init__(
        self,
        router: Router,
        identity: Identity,
        tell: Tell,
        now_ns: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        self._router = router
        self._identity = identity
        self._tell = tell
        self._now_ns = now_ns
        self._clients: dict[str, RemoteSession] = {}
        self._tokens: set[str] = set()
        self._unknown = TokenBucket(UNKNOWN_PER_S, 1, now_ns())
        self.counts = router.commands.relayed
        self._new_epoch()
        self._observer = ControlObserver(router, identity, self.tell_states)

    @property
    def clients(self) -> int:
        """The number of clients that have entered."""
        return len(self._clients)

    @property
    def beat(self) -> Beat:
        """A sign of life, now."""
        return Beat(self._epoch, self._now_ns())

    # What relays send

    def operate(self, data: bytes) -> bytes:
        """Carry out an operation. Return the answer."""
        try:
            operation = read_operation(data)
        except WireError as error:
            self._note_malformed(error)
            return self._told(events=(_refusal("bad_request", str(error)),)).packed
        if operation.op == "look":
            return self._told(topics=self.states()).packed
        try:
            session = self._entered(operation.client, operation.name, operation.address)
        except ProtocolError as error:
            refusal = _refusal(error.code, str(error), operation.number)
            return self._told(events=(refusal, _LOST)).packed
        is_newest = session.is_newest(operation.number)
        request = _request_of(operation)
        if isinstance(request, requests.AcquireControl) and not is_newest:
            session.refuse(ProtocolError("stale_command", _OUT_OF_ORDER), request)
        elif request is not None:
            self._router.carry_out(session, request)
        return self._told(topics=self.states(), events=session.take_events()).packed

    def stop(self, data: bytes) -> bytes:
        """Stop, whatever is wrong with the message and with its age. Return the answer.

        A topic that is not a command topic means all of them.
        """
        try:
            stop = read_stop(data)
        except WireError as error:
            self._note_malformed(error)
            stop = RemoteStop()
        with self._stopping(stop) as session:
            name = TopicName(stop.topic or "")
            is_known = name in self._router.commands and session.sees(name)
            request = requests.Stop(id=stop.number, topic=name if is_known else None)
            session.is_newest(stop.number)
            self._router.carry_out(session, request)
            events = session.take_events()
        return self._told(topics=self.states(), events=events).packed

    def command(self, key: str, data: bytes) -> None:
        """Take a command of a client. A refusal goes out as a separate message."""
        try:
            client = client_of(key)
            session = self._clients.get(client)
            if session is None:
                self._tell_lost(client)
                return
            if not session.has_budget(self._now_ns()):
                session.count_refused()
                return
            command = read_command(data)
        except WireError as error:
            self._note_malformed(error)
            return
        self._command(session, command)
        self._tell_events(client, session)

    def follow_token(self, key: str, *, is_there: bool) -> None:
        """Follow the token of a client. A client whose token is gone leaves."""
        try:
            client = client_of(key)
        except WireError as error:
            self._note_malformed(error)
            return
        session = self._clients.get(client)
        if not is_there:
            self._tokens.discard(client)
            if session is not None:
                self._leave(client)
            return
        if len(self._tokens) < MAX_TOKENS:
            self._tokens.add(client)
        elif client not in self._tokens:
            self.counts.refuse_token()
        if session is not None:
            session.follow_token(is_there=True)

    # What happens here

    def cut_off(self) -> None:
        """End all clients, because the router is gone. No command from before counts any more."""
        for client in list(self._clients):
            self._leave(client)
        self._tokens.clear()
        self._new_epoch()

    def tick(self) -> None:
        """End the clients whose token has not come in time, and tell what came up since."""
        oldest_ns = self._now_ns() - TOKEN_NS
        for client, session in list(self._clients.items()):
            if not session.has_token and session.entered_ns < oldest_ns:
                self._leave(client)
            else:
                self._tell_events(client, session)

    def tell_states(self) -> None:
        """Tell all relays the states of the topics."""
        self._tell("", self._told(topics=self.states()).packed)

    def states(self) -> tuple[TopicControl, ...]:
        """Return the states of the topics that the role may see."""
        by_session: dict[Hashable, str] = {each: name for name, each in self._clients.items()}
        commands = self._router.commands

        def holder(topic: str) -> str | None:
            session = commands.holder(topic)
            return None if session is None else by_session.get(session, "other")

        return tuple(
            TopicControl(
                topic=topic, type=commands.type_name(topic), holder=holder(topic), members=members
            )
            for topic, members in self._observer.states().items()
        )

    def close(self) -> None:
        """End all clients."""
        for client in list(self._clients):
            self._leave(client)
        self._router.leave(self._observer)

    def _entered(self, client: str, name: str, address: str) -> RemoteSession:
        session = self._clients.get(client)
        if session is None:
            self._make_room()
            session = self._clients[client] = self._new_session(client, name, address)
            session.follow_token(is_there=client in self._tokens)
        session.note_active(self._now_ns())
        return session

    def _make_room(self) -> None:
        """Let the client go that has been idle the longest, if all places are taken."""
        most = self._router.limits.max_clients
        if len(self._clients) < most:
            return
        since_ns = self._now_ns() - IDLE_NS
        idle = [
            (session.active_ns, client)
            for client, session in self._clients.items()
            if session.active_ns < since_ns and not session.drives
        ]
        if not idle:
            raise over_limit(most, "clients of relays that drive or wait", "max_clients")
        _, client = min(idle)
        self._leave(client)
        self._tell(client, self._told(events=(_LOST,)).packed)

    def _new_session(self, client: str, name: str, address: str) -> RemoteSession:
        who = Identity(name or self._identity.name, self._identity.permissions)
        session = RemoteSession(self._router, client, who, address, self._now_ns())
        self._router.enter(session)
        return session

    @contextmanager
    def _stopping(self, stop: RemoteStop) -> Iterator[RemoteSession]:
        """Lend the session of the client, or one for this stop alone: a stop needs no room."""
        session = self._clients.get(stop.client or "")
        if session is not None:
            yield session
            return
        session = self._new_session(stop.client or "?", stop.name, stop.address)
        try:
            yield session
        finally:
            self._router.leave(session)

    def _command(self, session: RemoteSession, command: RemoteCommand) -> None:
        number = command.number if command.wants_answer else None
        values = None if command.values is None else Velocity(*command.values)
        request = requests.Publish(
            id=number,
            topic=command.topic,
            type=command.type,
            msg=None if values is None else TwistValues(values, command.frame_id),
            monotonic_ms=command.monotonic_ms,
        )
        if TopicName(command.topic) not in self._router.commands:  # never another in this way
            error = ProtocolError("not_found", f"{command.topic} is not a command topic")
        elif command.epoch != self._epoch:
            error = ProtocolError("stale_command", _ANOTHER_START)
        elif not session.is_newest(command.number):
            error = ProtocolError("stale_command", _OUT_OF_ORDER)
        else:
            age_ns = self._now_ns() - command.beat_ns
            session.of_commands.take(command, is_delayed=not 0 <= age_ns <= MAX_ECHO_NS)
            self._router.carry_out(session, request)
            return
        session.refuse(error, request)

    def _tell_lost(self, client: str) -> None:
        if self._unknown.allow(self._now_ns()):
            self._tell(client, self._told(events=(_LOST,)).packed)

    def _tell_events(self, client: str, session: RemoteSession) -> None:
        if events := session.take_events():
            self._tell(client, self._told(events=events).packed)

    def _leave(self, client: str) -> None:
        self._router.leave(self._clients.pop(client))

    def _new_epoch(self) -> None:
        self._epoch = secrets.randbits(62)

    def _told(
        self, topics: tuple[TopicControl, ...] = (), events: tuple[ToldEvent, ...] = ()
    ) -> Told:
        epoch, time_ns = self.beat
        return Told(epoch=epoch, time_ns=time_ns, topics=topics, events=events)

    def _note_malformed(self, error: WireError) -> None:
        self.counts.note_malformed()
        logger.warning("a message that no relay sends is left out: %s", error, extra=OF_RELAYS)


def _request_of(operation: RemoteOperation) -> AnyRequest | None:
    """Return the request of an operation. None: to enter was all."""
    number, topic = operation.number, operation.topic
    match operation.op:
        case "acquire":
            return requests.AcquireControl(id=number, topic=topic)
        case "release":
            return requests.ReleaseControl(id=number, topic=topic)
        case "advertise" if topic is not None and operation.type is not None:
            return requests.Advertise(id=number, topic=topic, type=operation.type)
        case "unadvertise" if topic is not None:
            return requests.Unadvertise(topic=topic)
    return None


def _refusal(code: StatusCode, text: str, number: int | None = None) -> ToldEvent:
    return ToldEvent(what="refusal", number=number, code=code, text=text[:MAX_TEXT_CHARACTERS])
