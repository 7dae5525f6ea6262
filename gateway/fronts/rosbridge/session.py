# SPDX-License-Identifier: Apache-2.0
"""One client's state: its limits, its fragments and its outbox."""

import itertools
import logging
from collections.abc import Callable, Generator, Hashable
from typing import Final, NamedTuple, TypeAlias

from pydantic import ValidationError

from gateway.access.permissions import UNLIMITED, Action, Identity
from gateway.codec import cbor_reader
from gateway.codec.error_text import hint, truncate
from gateway.codec.errors import JsonError
from gateway.codec.json import ascii_only, loads, loads_in_slices
from gateway.config.limits import Limits
from gateway.core.errors import Level, ProtocolError
from gateway.core.outbox import Outbox
from gateway.fronts.rosbridge import messages
from gateway.fronts.rosbridge.dialect import Dialect
from gateway.fronts.rosbridge.explain import explain
from gateway.fronts.rosbridge.fragments import Assembly
from gateway.fronts.rosbridge.operations import OPERATIONS, ClientOperation
from gateway.fronts.rosbridge.operations.base import MAX_ID_CHARACTERS, Operation
from gateway.fronts.rosbridge.operations.commands import Stop
from gateway.fronts.rosbridge.operations.fragment import Fragment
from gateway.fronts.rosbridge.operations.gateway import Auth, Help
from gateway.fronts.rosbridge.operations.topics import ImageFormat
from gateway.fronts.rosbridge.websocket_frames import text_frames
from gateway.metrics.histogram import Histogram

Reading: TypeAlias = Generator[None, None, ClientOperation | None]
"""Parses a long message, with pauses in which other clients can have their turn."""

MAX_TEXT_CHARACTERS: Final = 4096  # of names and types, which are compared with known ones
# of a fragment, of a response that failed, of a ping
_LONG_TEXTS: Final = frozenset({"data", "values", "value"})

SLICED_BYTES: Final = 64 * 1024  # a shorter text takes 2 ms at most, and has no long array

NOT_AUTHENTICATED: Final = (
    'authenticate first: {"op":"auth","token":"TOKEN"}, a header `Authorization: Bearer TOKEN`,'
    " or subprotocols `ros2-gateway, bearer.TOKEN`"
)

ROS_SHARP_FRAGMENT_SIZE: Final = 2**31 - 1  # only ROS# sends it, with every request

# texts of people who do not know what to send, none of them a JSON object
_HELP: Final = frozenset({b"help", b"?", b"h", b"/help", b"--help", b'"help"', b"help()"})
_MAX_HELP_BYTES: Final = 16  # of these, with blanks

# the operations whose failure has its own frame, and the key that names their subject
_NAMED_BY: Final = {"call_service": "service", "send_action_goal": "action"}

logger = logging.getLogger(__name__)


class Session:
    """The sans-I/O core of a connection.

    Give it every message in order (`receive`), carry out the operation that it returns, and send
    the content of its `outbox` whenever it calls *wake*.

    *identity* is ``None`` until the client has authenticated, if it must.
    """

    def __init__(
        self, limits: Limits, wake: Callable[[], None], identity: Identity | None = UNLIMITED
    ) -> None:
        self.limits = limits
        self.identity = identity
        self.address = "?"
        self.client = "?"  # address and number, for logs and metrics
        self.latency = Histogram()  # of what its topics sent, see `Queue.on_timed`
        # set if clients have to show a token
        self.authenticate: Callable[[Auth], None] = lambda request: None
        self.outbox = Outbox(limits.send_queue_bytes)
        self.wake = wake
        # takes what work for this client has taken from its time budget: seconds, and the time.
        # Returns whether something is left
        self.spend: Callable[[float, float], bool] = lambda spent_s, now_s: True
        # takes what a large message asks for: to read it has taken enough of this turn
        self.next_turn: Callable[[Callable[[], None]], None] = lambda work: work()
        # for how long the message at hand may have waited until we read it, in seconds
        self.waited_s: Callable[[], float] = lambda: 0.0
        # whether it has control of a command topic: then its input goes before that of others
        self.drives: Callable[[], bool] = lambda: False
        self.is_overtaken = False  # the message at hand, by a `stop` that came later
        self.received = 0
        self.refused = 0
        # called with each message that is neither JSON nor CBOR, once it is refused
        self.on_unreadable: Callable[[bytes], None] = lambda data: None
        self.read_bytes = 0  # of the newest one, put together
        self.is_ros_sharp = False  # it reads ASCII only, and `values` of the type only
        self.numbers = itertools.count(1)  # of the calls and goals passed on to this client
        # raises ProtocolError if the client may not have one more ROS entity
        self.check_share: Callable[[], None] = lambda: None
        # called with whatever the client's role forbids
        self.on_forbidden: Callable[[ProtocolError, Operation], None] = lambda *_: None
        self.image_format: ImageFormat = "jpeg"  # of pictures for which it asks for none
        self.is_behind = False  # its time budget is spent, and what it has sent waits
        self.replaced = 0  # of what it deferred, by something newer
        self.deferred: dict[Hashable, DeferredWork] = {}
        self._dialect = Dialect()
        self._assembly = Assembly(limits.max_message_bytes)
        # read for every message, and attributes of a pydantic model cost 40 ns more than others
        self._max_json_depth = limits.max_json_depth
        self._max_json_items = limits.max_json_items
        self._fragmented = 0

    def receive(self, data: bytes, now_ns: int) -> ClientOperation | Reading | None:
        """Parse one message. Return ``None`` if it was answered, or is a piece of an operation.

        Of a long one return what parses it.
        """
        self.received += 1
        if self._assembly:
            self._expire(now_ns)
        self.read_bytes = len(data)
        if len(data) > SLICED_BYTES and not cbor_reader.is_cbor(data):
            return self._read(data, now_ns)
        return self._put_together(self._parse(data), now_ns)

    def _put_together(
        self, operation: ClientOperation | Fragment | None, now_ns: int
    ) -> ClientOperation | Reading | None:
        """Return the operation, or of the last fragment what it completes."""
        if not isinstance(operation, Fragment):
            return operation
        if self.identity is None:  # whose pieces would take memory
            self.refuse(ProtocolError("forbidden", NOT_AUTHENTICATED), operation)
            return None
        try:
            whole = self._assembly.add(operation, now_ns)
        except ProtocolError as error:
            self.refuse(error, operation)
            return None
        if whole is None:
            return None
        self.read_bytes = len(whole)
        if len(whole) > SLICED_BYTES:
            return self._read(whole, None)
        return self._not_nested(self._parse(whole))

    def _not_nested(self, operation: ClientOperation | Fragment | None) -> ClientOperation | None:
        """Return an operation that came in fragments, unless it is itself a fragment."""
        if isinstance(operation, Fragment):
            self.refuse(ProtocolError("bad_request", "fragment: within a fragment"), operation)
            return None
        return operation

    def is_stop(self, data: bytes) -> bool:
        """Return whether a message is a `stop`, which may go before the ones that came earlier."""
        if self.identity is None:  # it may be about to authenticate
            return False
        try:
            return _object(data, self._max_json_depth, self._max_json_items).get("op") == Stop.op
        except ProtocolError:
            return False

    def defer(self, key: Hashable, operation: ClientOperation, work: Callable[[], None]) -> None:
        """Do *work* for an operation at the end of this turn, or before one of another kind.

        If another of the same key comes until then, that takes its place: of what is set many
        times only the newest counts.
        """
        self.replaced += key in self.deferred
        self.deferred[key] = DeferredWork(operation, work)

    @property
    def identity(self) -> Identity | None:
        """The client's identity, once it is known."""
        return self._identity

    @identity.setter
    def identity(self, identity: Identity | None) -> None:
        self._identity = identity
        # true if an operation may be forbidden, read for every operation
        self.is_restricted = identity is None or not identity.permissions.is_unlimited

    def may(self, action: Action, name: str) -> bool:
        """Return whether the client may do this with a resolved name."""
        if self.identity is None:
            return False
        return not self.is_restricted or self.identity.permissions.may(action, name)

    def sees(self, name: str) -> bool:
        """Return whether a resolved name exists for the client."""
        if self.identity is None:
            return False
        return not self.is_restricted or self.identity.permissions.sees(name)

    def refuse(self, error: ProtocolError, operation: Operation | None = None) -> None:
        """Answer an operation that failed. Without one, report the error alone.

        A call gets its response and a goal its result, as clients wait for these. Everything else
        gets a `status`.
        """
        asked = _Asked()
        if operation is not None:
            name = getattr(operation, _NAMED_BY.get(operation.op, ""), None)
            asked = _Asked(operation.op, operation.id, name)
            if error.code == "forbidden":
                self.on_forbidden(error, operation)
        self._refuse(error, asked)

    def set_level(self, level: Level) -> None:
        """Send only `status` frames of this severity or worse."""
        self._dialect.choose(level)

    def warn(self, error: ProtocolError, op: str, request_id: str | int | None) -> None:
        """Warn the client of something that may surprise it but is not a failure."""
        self._say("warning", str(error), error, op, request_id)

    def inform(self, text: str, op: str, request_id: str | int | None) -> None:
        """Report what was done to a client that asked for it (`set_level` info)."""
        self._say("info", text, None, op, request_id)

    def answer(self, op: str, request_id: str | int | None, **members: object) -> None:
        """Send the answer to an operation."""
        self.send(messages.answer(op, request_id, **members))

    def send(self, payload: bytes, fragment_size: int | None = None) -> None:
        """Send JSON ahead of everything that waits in queues.

        A text of more than *fragment_size* characters is sent in pieces of that size.
        """
        self.outbox.put_control(self.framed(payload, fragment_size))
        self.wake()

    def ask(self, payload: bytes) -> None:
        """Send a request to a client that provides a service or an action, as ASCII.

        ROS# reads only ASCII, and a client that only provides sends nothing that identifies ROS#.
        """
        self.send(ascii_only(payload))

    def framed(self, payload: bytes, fragment_size: int | None = None) -> bytes:
        """Return JSON as the wire bytes for this client. *fragment_size* is as for `send`."""
        text = ascii_only(payload) if self.is_ros_sharp else payload
        self._fragmented += fragment_size is not None
        return text_frames(text, fragment_size, f"answer:{self._fragmented}")

    def _parse(self, data: bytes) -> ClientOperation | Fragment | None:
        """Parse one operation, and answer it if it is malformed."""
        values: dict[str, object] = {}
        try:
            values = _object(data, self._max_json_depth, self._max_json_items)
            if len(data) > SLICED_BYTES:  # of CBOR
                _expect_short_texts(values)
            return self._operation(values)
        except ProtocolError as error:
            self._refuse_malformed(error, data, values)
        return None

    def _read(self, data: bytes, now_ns: int | None) -> Reading:
        """Parse one operation as `_parse` does. *now_ns* is ``None`` if it came in fragments."""
        depth, items = self._max_json_depth, self._max_json_items
        values: dict[str, object] = {}
        try:
            try:
                value = yield from loads_in_slices(data, max_depth=depth, max_items=items)
            except JsonError as error:
                raise _not_json(data, error) from error
            values = _checked(data, value)
            _expect_short_texts(values)
            operation = self._operation(values)
        except ProtocolError as error:
            self._refuse_malformed(error, b"" if now_ns is None else data, values)
            return None
        if now_ns is None:
            return self._not_nested(operation)
        whole = self._put_together(operation, now_ns)
        return (yield from whole) if isinstance(whole, Generator) else whole

    def _operation(self, values: dict[str, object]) -> ClientOperation | Fragment:
        if values.get("fragment_size") == ROS_SHARP_FRAGMENT_SIZE:
            self.is_ros_sharp = True
        model = _model(values.get("op"))
        misspelt = self._dialect.note(model.op, values)
        operation = _read(model, values, misspelt)
        if misspelt:
            self.warn(ProtocolError("bad_request", misspelt), operation.op, operation.id)
        return operation

    def _refuse_malformed(
        self, error: ProtocolError, data: bytes, values: dict[str, object]
    ) -> None:
        self._refuse(error, _readable(values))
        if error.code == "bad_json":
            self.on_unreadable(data)

    def _expire(self, now_ns: int) -> None:
        for fragment_id, progress in self._assembly.expire(now_ns):
            error = ProtocolError("limit_exceeded", f"fragment: {progress}")
            self._refuse(error, _Asked(Fragment.op, fragment_id))

    def _refuse(self, error: ProtocolError, asked: "_Asked") -> None:
        self.refused += 1
        text = str(error)
        values = {} if self.is_ros_sharp else text
        # some clients recognise a response by this name, so it is the name as requested
        name = asked.name if isinstance(asked.name, str) else ""
        match asked:
            case _Asked("call_service", request_id):
                self.send(messages.service_response(name, request_id, values, result=False))
            case _Asked("send_action_goal", request_id):
                self.send(messages.action_result(name, request_id, values, status=0, result=False))
            case _:
                self._say(error.level, text, error, asked.op, asked.id)

    def _say(
        self,
        level: Level,
        text: str,
        error: ProtocolError | None,
        op: str | None,
        request_id: str | int | None,
    ) -> None:
        if self._dialect.hears(level):
            code = error.code if error else None
            self.send(messages.status(level, text, code=code, request=op, request_id=request_id))
        elif error is not None:  # else it confirms what was asked for
            extra = {"client": self.client}
            logger.info("status not sent to this client: %s", text, extra=extra)


class DeferredWork(NamedTuple):
    """Work that is done at the end of a turn, and the operation that is answered if it fails."""

    operation: ClientOperation
    work: Callable[[], None]


class _Asked(NamedTuple):
    """The parts of a malformed operation that a reply needs."""

    op: str | None = None
    id: str | int | None = None
    name: object = None  # of the service or action, if it is a string


def _object(data: bytes, max_depth: int, max_items: int) -> dict[str, object]:
    read = cbor_reader.loads if cbor_reader.is_cbor(data) else loads
    try:
        values = read(data, max_depth=max_depth, max_items=max_items)
    except cbor_reader.CborError as error:
        raise ProtocolError("bad_json", str(error)) from error
    except JsonError as error:
        if _asks_for_help(data):
            return {"op": Help.op}
        raise _not_json(data, error) from error
    return _checked(data, values)


def _expect_short_texts(values: dict[str, object]) -> None:
    """Refuse a name, a type or the like that is too long to be looked for."""
    for name, value in values.items():
        if isinstance(value, str) and len(value) > MAX_TEXT_CHARACTERS and name not in _LONG_TEXTS:
            text = f"{truncate(name)}: {len(value)} characters, at most {MAX_TEXT_CHARACTERS}"
            raise ProtocolError("bad_request", f"{text} are allowed: send a shorter text")


def _not_json(data: bytes, error: JsonError) -> ProtocolError:
    return ProtocolError("bad_json", f"{error}{_hint(data)}")


def _checked(data: bytes, values: object) -> dict[str, object]:
    if not isinstance(values, dict):
        if _asks_for_help(data):
            return {"op": Help.op}
        example = '{"op":"subscribe","topic":"/odom"}'
        raise ProtocolError("bad_request", f"expected a JSON object such as {example}, or help")
    return values


def _hint(data: bytes) -> str:
    """Return advice about a frame that is not JSON."""
    if b"\x80" <= data[:1] < b"\xa0":  # the first byte of an array of CBOR, and of no UTF-8
        return ": CBOR must begin with a map"
    return "" if data[:64].lstrip()[:1] in {b"{", b"["} else ": send help to see examples"


def _asks_for_help(data: bytes) -> bool:
    return len(data) <= _MAX_HELP_BYTES and data.strip().lower() in _HELP


def _readable_id(value: object) -> str | int | None:
    """Return an id that can be echoed, even if the operation itself is malformed."""
    if isinstance(value, str):
        return value[:MAX_ID_CHARACTERS]
    return value if isinstance(value, int) and not isinstance(value, bool) else None


def _readable(values: dict[str, object]) -> _Asked:
    op = values.get("op")
    if not isinstance(op, str):
        return _Asked(id=_readable_id(values.get("id")))
    return _Asked(truncate(op), _readable_id(values.get("id")), values.get(_NAMED_BY.get(op, "")))


def _model(op: object) -> type[ClientOperation | Fragment]:
    model = OPERATIONS.get(op) if isinstance(op, str) else None
    if model is None:
        raise _unknown(op)
    return model


def _read(
    model: type[ClientOperation | Fragment], values: dict[str, object], misspelt: str
) -> ClientOperation | Fragment:
    try:
        return model.read(values)
    except ValidationError as error:
        hint_ = f"; {misspelt}" if misspelt else ""
        raise ProtocolError("bad_request", f"{explain(error)}{hint_}") from error


def _unknown(op: object) -> ProtocolError:
    if op is None:
        return ProtocolError("bad_request", "op: missing, add the name of the operation")
    if not isinstance(op, str):
        return ProtocolError("bad_request", "op: expected a string")
    text = f"op: {truncate(op)!r} is unknown{hint(op.lower(), OPERATIONS)}"
    return ProtocolError("unknown_op", text)
