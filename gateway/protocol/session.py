# SPDX-License-Identifier: Apache-2.0
"""One client's state: what it may send, what it subscribed to, what waits for it."""

import difflib
from collections.abc import Callable

from pydantic import ValidationError

from gateway.codec.json import JsonError, loads
from gateway.codec.words import cut
from gateway.protocol import frames
from gateway.protocol.errors import ProtocolError
from gateway.protocol.explain import explain
from gateway.protocol.framing import text_frame
from gateway.protocol.limits import Limits
from gateway.protocol.operations import MAX_ID_CHARACTERS, OPERATIONS, ClientOperation
from gateway.protocol.outbox import Outbox
from gateway.protocol.rate import TokenBucket


class Session:
    """The sans-I/O core of a connection.

    Give it every message in order (`receive`), carry out what it returns, send what its
    `outbox` holds whenever it calls *wake*.
    """

    def __init__(self, limits: Limits, now_ns: int, wake: Callable[[], None]) -> None:
        self.limits = limits
        self.outbox = Outbox(limits.send_queue_bytes)
        self.wake = wake
        self.received = 0
        self.refused = 0
        self._level: frames.Level = "warning"
        self._operations = TokenBucket(limits.operations_per_s, limits.operations_burst, now_ns)

    def receive(self, data: bytes, now_ns: int) -> ClientOperation | None:
        """Parse one message; a message that is no operation is answered and gives ``None``."""
        self.received += 1
        op: str | None = None
        request_id: str | int | None = None
        try:
            values = _object(data, self.limits)
            request_id = _readable_id(values.get("id"))
            op = _readable_op(values)
            self._check_rate(now_ns)
            return _parse(op, values)
        except ProtocolError as error:
            self.refuse(error, op, request_id)
        return None

    def refuse(self, error: ProtocolError, op: str | None, request_id: str | int | None) -> None:
        """Answer an operation that failed."""
        self.refused += 1
        self._say("error", str(error), error, op, request_id)

    def set_level(self, level: frames.Level) -> None:
        """Send only `status` frames of this severity and worse."""
        self._level = level

    def warn(self, error: ProtocolError, op: str, request_id: str | int | None) -> None:
        """Tell the client about something that may surprise it but is no failure."""
        self._say("warning", str(error), error, op, request_id)

    def inform(self, text: str, op: str, request_id: str | int | None) -> None:
        """Tell a client that asked for it (`set_level` info) what was done."""
        self._say("info", text, None, op, request_id)

    def answer(self, op: str, request_id: str | int | None, **members: object) -> None:
        """Send the answer to an operation."""
        self.send(frames.answer(op, request_id, **members))

    def send(self, payload: bytes) -> None:
        """Send a frame ahead of everything that waits in lanes."""
        self.outbox.put_control(text_frame(payload))
        self.wake()

    def _check_rate(self, now_ns: int) -> None:
        if not self._operations.allow(now_ns):
            limit = self.limits.operations_per_s
            raise ProtocolError("rate_limited", f"at most {limit:g} operations per second")

    def _say(
        self,
        level: frames.Level,
        text: str,
        error: ProtocolError | None,
        op: str | None,
        request_id: str | int | None,
    ) -> None:
        if frames.SEVERITY[level] <= frames.SEVERITY[self._level]:
            code = error.code if error else None
            self.send(frames.status(level, text, code=code, request=op, request_id=request_id))


def _object(data: bytes, limits: Limits) -> dict[str, object]:
    try:
        values = loads(data, max_depth=limits.json_depth, max_items=limits.json_items)
    except JsonError as error:
        raise ProtocolError("bad_json", str(error)) from error
    if not isinstance(values, dict):
        example = '{"op":"subscribe","topic":"/odom"}'
        raise ProtocolError("bad_request", f"expected a JSON object such as {example}")
    return values


def _readable_id(value: object) -> str | int | None:
    """Return an id that can be echoed, also where the operation itself is unreadable."""
    if isinstance(value, str):
        return value[:MAX_ID_CHARACTERS]
    return value if isinstance(value, int) and not isinstance(value, bool) else None


def _readable_op(values: dict[str, object]) -> str:
    op = values.get("op")
    if op is None:
        raise ProtocolError("bad_request", "op: missing; it names the operation")
    if not isinstance(op, str):
        raise ProtocolError("bad_request", "op: expected a string")
    return cut(op)


def _parse(op: str, values: dict[str, object]) -> ClientOperation:
    model = OPERATIONS.get(op)
    if model is None:
        near = difflib.get_close_matches(op, OPERATIONS, n=1)
        hint = f"; did you mean {near[0]}?" if near else f"; known are {', '.join(OPERATIONS)}"
        raise ProtocolError("unknown_op", f"op: {op!r} is unknown{hint}")
    try:
        return model.model_validate(values)
    except ValidationError as error:
        raise ProtocolError("bad_request", explain(error)) from error
