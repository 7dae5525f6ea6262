# SPDX-License-Identifier: Apache-2.0
"""A client of rosbridge: what it sends becomes operations, what it is told becomes frames."""

import logging
from collections.abc import Generator
from typing import Any, Final, TypeAlias

from gateway.codec import cbor_reader
from gateway.codec.error_text import JsonError
from gateway.codec.json import ascii_only, loads_in_slices
from gateway.codec.nonfinite import named
from gateway.core import requests
from gateway.core.errors import Level, ProtocolError, StatusCode
from gateway.core.peer import Peer
from gateway.core.requests import Request, RequestId
from gateway.core.session import Core
from gateway.fronts.rosbridge import messages
from gateway.fronts.rosbridge.dialect import Dialect
from gateway.fronts.rosbridge.fragments import Assembly
from gateway.fronts.rosbridge.operations import ClientOperation
from gateway.fronts.rosbridge.operations.actions import SendActionGoal
from gateway.fronts.rosbridge.operations.commands import Stop
from gateway.fronts.rosbridge.operations.fragment import Fragment
from gateway.fronts.rosbridge.operations.services import CallService
from gateway.fronts.rosbridge.publish_frames import text_frames
from gateway.fronts.rosbridge.reading import (
    NAMED_BY,
    Asked,
    checked,
    expect_short_texts,
    model_of,
    not_json,
    object_of,
    read,
    readable,
)
from gateway.transport.front import ClientSession

Reading: TypeAlias = Generator[None, None, ClientOperation | None]
"""Parses a long message, with pauses in which other clients can have their turn."""

SLICED_BYTES: Final = 64 * 1024  # a shorter text takes 2 ms at most, and has no long array

NOT_AUTHENTICATED: Final = (
    'authenticate first: {"op":"auth","token":"TOKEN"}, a header `Authorization: Bearer TOKEN`,'
    " or subprotocols `ros2-gateway, bearer.TOKEN`"
)

ROS_SHARP_FRAGMENT_SIZE: Final = 2**31 - 1  # only ROS# sends it, with every request

logger = logging.getLogger(__name__)


class RosbridgeSession(ClientSession):
    """The sans-I/O core of a connection that speaks rosbridge's protocol.

    Give it every message in order (`receive`), and carry out the operation that it returns.
    """

    NOT_AUTHENTICATED = NOT_AUTHENTICATED

    def __init__(self, core: Core, peer: Peer) -> None:
        super().__init__(core, peer)
        self.read_bytes = 0  # of the newest message, put together
        self._dialect = Dialect()
        if peer.level is not None:
            self.set_level(peer.level)
        self._assembly = Assembly(core.limits.max_message_bytes)
        # read for every message, and attributes of a pydantic model cost 40 ns more than others
        self._max_json_depth = core.limits.max_json_depth
        self._max_json_items = core.limits.max_json_items
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
            self._refuse_fragment(ProtocolError("forbidden", NOT_AUTHENTICATED), operation)
            return None
        try:
            whole = self._assembly.add(operation, now_ns)
        except ProtocolError as error:
            self._refuse_fragment(error, operation)
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
            error = ProtocolError("bad_request", "fragment: within a fragment")
            self._refuse_fragment(error, operation)
            return None
        return operation

    def is_stop(self, data: bytes) -> bool:
        """Return whether a message is a `stop`, which may go before the ones that came earlier."""
        if self.identity is None:  # it may be about to authenticate
            return False
        try:
            return object_of(data, self._max_json_depth, self._max_json_items).get("op") == Stop.op
        except ProtocolError:
            return False

    def send_refusal(self, error: ProtocolError, request: Request | None) -> None:
        """Send a call its response and a goal its result, as clients wait for these.

        Everything else gets a `status`.
        """
        asked = Asked()
        if request is not None:
            name = getattr(request, NAMED_BY.get(request.kind, ""), None)
            asked = Asked(request.kind, request.id, name)
        self._send_refusal(error, asked)

    def set_level(self, level: Level) -> None:
        """Send only `status` frames of this severity or worse."""
        self._dialect.choose(level)

    def warn(self, error: ProtocolError, request: Request) -> None:
        """Send a `status`, unless the client hears errors alone."""
        self._say("warning", str(error), error, request.kind, request.id)

    def inform(self, text: str, request: Request) -> None:
        """Send a `status` to a client that asked for it (`set_level` info)."""
        self._say("info", text, None, request.kind, request.id)

    def alert(self, code: StatusCode, text: str, request: Request) -> None:
        """Send a `status`, whatever `set_level` says."""
        level: Level = "warning" if code == "stale" else "info"
        self.send(
            messages.status(level, text, code=code, request=request.kind, request_id=request.id)
        )

    def answer(self, kind: str, request_id: RequestId, **members: Any) -> None:
        """Send the answer to an operation of the gateway's own."""
        self.send(messages.answer(kind, request_id, **members))

    def describe(
        self, request_id: RequestId, example: dict[str, Any] | None, members: dict[str, Any]
    ) -> None:
        """Send the answer to `describe`."""
        self.send(messages.description(request_id, example, members))

    def respond(self, request: requests.CallService, values: dict[str, Any]) -> None:
        """Send a `service_response`."""
        asked = _form(request.form)
        named_values = named(values, asked.nonfinite)
        frame = messages.service_response(request.service, request.id, named_values, result=True)
        self.send(frame, asked.fragment_size)

    def finish(self, request: requests.SendActionGoal, values: dict[str, Any], status: int) -> None:
        """Send an `action_result`."""
        asked = _form(request.form)
        named_values = named(values, asked.nonfinite)
        frame = messages.action_result(
            request.action, request.id, named_values, status=status, result=True
        )
        self.send(frame, asked.fragment_size)

    def feedback_frame(self, request: requests.SendActionGoal, values: dict[str, Any]) -> bytes:
        """Return the frames of an `action_feedback`."""
        asked = _form(request.form)
        frame = messages.action_feedback(request.action, request.id, named(values, asked.nonfinite))
        return self.framed(frame, asked.fragment_size)

    def transform_frame(self, request_id: RequestId, transform: bytes) -> bytes:
        """Return the frame of a `lookup_transform`."""
        return self.framed(messages.transform(request_id, transform))

    # The forms of the ids are rosbridge's: ROS# parses them.

    def pass_call(self, service: str, name: str, args: object) -> str:
        """Send a `call_service` to the client that provides the service."""
        call_id = f"service_request:{service}:{next(self._numbers)}"
        self._ask(messages.call_service(name, call_id, args))
        return call_id

    def pass_goal(self, action: str, name: str, type_name: str, args: object) -> str:
        """Send a `send_action_goal` to the client that provides the action."""
        goal_id = f"action_goal:{action}:{next(self._numbers)}"
        self._ask(messages.send_action_goal(name, goal_id, type_name, args))
        return goal_id

    def pass_cancel(self, name: str, goal_id: str) -> None:
        """Send a `cancel_action_goal` to the client that provides the action."""
        self._ask(messages.cancel_action_goal(name, goal_id))

    def send(self, payload: bytes, fragment_size: int | None = None) -> None:
        """Send JSON ahead of everything that waits in queues.

        A text of more than *fragment_size* characters is sent in pieces of that size.
        """
        self.outbox.put_control(self.framed(payload, fragment_size))
        self.wake()

    def _ask(self, payload: bytes) -> None:
        """Send a request to a client that provides a service or an action, as ASCII.

        ROS# reads only ASCII, and a client that only provides sends nothing that identifies ROS#.
        """
        self.send(ascii_only(payload))

    def framed(self, payload: bytes, fragment_size: int | None = None) -> bytes:
        """Return JSON as the wire bytes for this client. *fragment_size* is as for `send`."""
        text = ascii_only(payload) if self.reads_ascii_only else payload
        self._fragmented += fragment_size is not None
        return text_frames(text, fragment_size, f"answer:{self._fragmented}")

    def _parse(self, data: bytes) -> ClientOperation | Fragment | None:
        """Parse one operation, and answer it if it is malformed."""
        values: dict[str, object] = {}
        try:
            values = object_of(data, self._max_json_depth, self._max_json_items)
            if len(data) > SLICED_BYTES:  # of CBOR
                expect_short_texts(values)
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
                raise not_json(data, error) from error
            values = checked(data, value)
            expect_short_texts(values)
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
            self.reads_ascii_only = True
        model = model_of(values.get("op"))
        misspelt = self._dialect.note(model.op, values)
        operation = read(model, values, misspelt)
        if misspelt:
            error = ProtocolError("bad_request", misspelt)
            self._say("warning", misspelt, error, operation.op, operation.id)
        return operation

    def _refuse_malformed(
        self, error: ProtocolError, data: bytes, values: dict[str, object]
    ) -> None:
        self._refuse(error, readable(values))
        if error.code == "bad_json":
            self.peer.on_unreadable(data)

    def _refuse_fragment(self, error: ProtocolError, fragment: Fragment) -> None:
        self._refuse(error, Asked(fragment.op, fragment.id))

    def _expire(self, now_ns: int) -> None:
        for fragment_id, progress in self._assembly.expire(now_ns):
            error = ProtocolError("limit_exceeded", f"fragment: {progress}")
            self._refuse(error, Asked(Fragment.op, fragment_id))

    def _refuse(self, error: ProtocolError, asked: "Asked") -> None:
        self.count_refused()
        self._send_refusal(error, asked)

    def _send_refusal(self, error: ProtocolError, asked: "Asked") -> None:
        text = str(error)
        values = {} if self.reads_ascii_only else text
        # some clients recognise a response by this name, so it is the name as requested
        name = asked.name if isinstance(asked.name, str) else ""
        match asked:
            case Asked("call_service", request_id):
                self.send(messages.service_response(name, request_id, values, result=False))
            case Asked("send_action_goal", request_id):
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


def _form(form: object) -> CallService | SendActionGoal:
    """Return the operation that a request was made of."""
    assert isinstance(form, CallService | SendActionGoal)  # noqa: S101  # they set it
    return form
