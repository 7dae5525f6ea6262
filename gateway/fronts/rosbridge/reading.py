# SPDX-License-Identifier: Apache-2.0
"""One message becomes an operation, or a refusal with the reason."""

from typing import Final, NamedTuple

from pydantic import ValidationError

from gateway.codec import cbor_reader
from gateway.codec.error_text import JsonError, hint, truncate
from gateway.codec.json import loads
from gateway.core.errors import ProtocolError
from gateway.fronts.rosbridge.explain import explain
from gateway.fronts.rosbridge.operations import OPERATIONS, ClientOperation
from gateway.fronts.rosbridge.operations.base import MAX_ID_CHARACTERS
from gateway.fronts.rosbridge.operations.fragment import Fragment
from gateway.fronts.rosbridge.operations.gateway import Help

MAX_TEXT_CHARACTERS: Final = 4096  # of names and types, which are compared with known ones
# of a fragment, of a response that failed, of a ping
_LONG_TEXTS: Final = frozenset({"data", "values", "value"})

# texts of people who do not know what to send, none of them a JSON object
_HELP: Final = frozenset({b"help", b"?", b"h", b"/help", b"--help", b'"help"', b"help()"})
_MAX_HELP_BYTES: Final = 16  # of these, with blanks

# the operations whose failure has its own frame, and the key that names their subject
NAMED_BY: Final = {"call_service": "service", "send_action_goal": "action"}


class Asked(NamedTuple):
    """The parts of a malformed operation that a reply needs."""

    op: str | None = None
    id: str | int | None = None
    name: object = None  # of the service or action, if it is a string


def object_of(data: bytes, max_depth: int, max_items: int) -> dict[str, object]:
    """Return the object of a message, in JSON or CBOR, or raise ProtocolError."""
    load = cbor_reader.loads if cbor_reader.is_cbor(data) else loads
    try:
        values = load(data, max_depth=max_depth, max_items=max_items)
    except cbor_reader.CborError as error:
        raise ProtocolError("bad_json", str(error)) from error
    except JsonError as error:
        if _asks_for_help(data):
            return {"op": Help.op}
        raise not_json(data, error) from error
    return checked(data, values)


def expect_short_texts(values: dict[str, object]) -> None:
    """Refuse a name, a type or the like that is too long to be looked for."""
    for name, value in values.items():
        if isinstance(value, str) and len(value) > MAX_TEXT_CHARACTERS and name not in _LONG_TEXTS:
            text = f"{truncate(name)}: {len(value)} characters, at most {MAX_TEXT_CHARACTERS}"
            raise ProtocolError("bad_request", f"{text} are allowed: send a shorter text")


def not_json(data: bytes, error: JsonError) -> ProtocolError:
    """Return the refusal of a text that is not JSON, with advice."""
    return ProtocolError("bad_json", f"{error}{_hint(data)}")


def checked(data: bytes, values: object) -> dict[str, object]:
    """Return values that are an object, else raise ProtocolError."""
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


def readable(values: dict[str, object]) -> Asked:
    """Return the parts of a malformed operation that an answer needs."""
    op = values.get("op")
    if not isinstance(op, str):
        return Asked(id=_readable_id(values.get("id")))
    return Asked(truncate(op), _readable_id(values.get("id")), values.get(NAMED_BY.get(op, "")))


def model_of(op: object) -> type[ClientOperation | Fragment]:
    """Return the model of an operation, or raise ProtocolError if its name is unknown."""
    model = OPERATIONS.get(op) if isinstance(op, str) else None
    if model is None:
        raise _unknown(op)
    return model


def read(
    model: type[ClientOperation | Fragment], values: dict[str, object], misspelt: str
) -> ClientOperation | Fragment:
    """Return the operation, or raise ProtocolError if it is malformed."""
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
