# SPDX-License-Identifier: Apache-2.0
"""Messages that a client publishes: nearly right values for any type, and any JSON."""

import struct
from typing import Any

import pybase64

from gateway.codec.cdr.misfits import MAX_CDR_BYTES, TooManyFieldsError
from gateway.codec.error_text import CodecError
from gateway.codec.json import dumps, loads
from gateway.codec.validation import InvalidValueError
from schemas.definition import FLOATS, INTEGER_RANGES, STRINGS, Definition, FieldType
from schemas.json_forms import FORMS
from tests.fuzz import types
from tests.fuzz.choices import Choices
from tests.fuzz.target import Target, check
from tests.fuzz.targets.cdr_decoder import SEEDED
from tests.messages import normalized, to_json

NOW_NS = 1_700_000_000_123_456_789
WRONG: tuple[Any, ...] = (
    *(None, True, 0, -1, 1.5, 1e39, 1e308, 2**64, "", "x", "now", "\0", "\ud83d", "AAA="),
    *([], [None], {}, {"secs": 1}, {"sec": 1, "nanosec": 10**9}, {"x": {}}, [[]], "é" * 30),
)
MAX_DEPTH = 6


def run(data: bytes) -> None:
    """Take the type from the first two bytes, then JSON or decisions."""
    message_type = types.chosen(data)
    choices = Choices(data[2:])
    if choices.byte() % 2:
        value = a_value(choices, message_type.definition, 0)
    else:
        try:
            value = loads(choices.rest())
        except CodecError:
            return
    try:
        cdr = message_type.encode(value, lambda: NOW_NS)
    except InvalidValueError as error:
        check(str(error).startswith("msg"), str(error))
        check(error.path.startswith("msg"), error.path)
        return
    except TooManyFieldsError as error:
        check("at once" in str(error))
        return
    check(len(cdr) <= MAX_CDR_BYTES + 4)
    decoded = message_type.decode(cdr)
    check_kept(value, normalized(decoded), message_type.definition)
    text = dumps(decoded)
    if b"null" in text:  # NaN was null, and infinities become it
        return
    again = message_type.encode(loads(text, max_items=10**6), lambda: NOW_NS)
    check(again == cdr, "does not come back")


def check_kept(value: Any, decoded: Any, definition: Definition) -> None:
    """See that each field says what the client said. Times and headers also have other forms."""
    if definition.name in FORMS:
        return
    check(type(value) is dict and value.keys() <= decoded.keys(), value)
    for field in definition.fields:
        if field.name not in value or field.type.is_octets:
            continue
        said, kept = value[field.name], decoded[field.name]
        if field.type.is_array:
            check(type(said) is list and len(said) == len(kept), said, kept)
        else:
            said, kept = [said], [kept]
        for one, other in zip(said, kept, strict=True):
            if not field.type.is_primitive:
                check_kept(one, other, types.definitions().get(field.type.base))
            elif field.type.base in FLOATS:
                check(one is None or is_rounded(one, other, field.type.base), one, other)
            else:
                check(type(one) is type(other) and one == other, field.name, one, other)


def is_rounded(said: float, kept: float, base: str) -> bool:
    return type(said) in {float, int} and (
        float(said) == kept
        if base == "float64"
        else struct.pack("<f", said) == struct.pack("<f", kept)
    )


def a_value(choices: Choices, definition: Definition, depth: int) -> Any:
    """Return an object with some of the fields, most of them right."""
    if depth > MAX_DEPTH or choices.happens(8):
        return choices.pick(WRONG) if choices.happens(16) else {}
    values = {
        field.name: a_field(choices, field.type, depth)
        for field in definition.fields
        if not choices.happens(64)
    }
    if choices.happens(4):
        values[choices.pick(("x", "stamp", "seq", "header", ""))] = choices.pick(WRONG)
    return values


def a_field(choices: Choices, kind: FieldType, depth: int) -> Any:
    if choices.happens(6):
        return choices.pick(WRONG)
    if not kind.is_array:
        return a_scalar(choices, kind, depth)
    length = kind.length if kind.length is not None else choices.below(kind.bound or 5)
    if choices.happens(8):
        length += 1
    if kind.is_octets and choices.happens(128):
        return pybase64.b64encode(choices.take(length).ljust(length, b"\0")).decode()
    items = [a_scalar(choices, kind, depth) for _ in range(min(length, 4))]
    return items + items[-1:] * (length - len(items))


def a_scalar(choices: Choices, kind: FieldType, depth: int) -> Any:
    base = kind.base
    if choices.happens(4):
        return choices.pick(WRONG)
    if base == "bool":
        return choices.happens(128)
    if base in INTEGER_RANGES:
        low, high = INTEGER_RANGES[base]
        value = choices.integer()
        return value if choices.happens(8) else low + value % (high - low + 1)
    if base in FLOATS:
        value = choices.number()
        return None if value != value or abs(value) > 1e38 else value
    if base in STRINGS:
        text = choices.text()
        return text if choices.happens(8) else text.replace("\0", "")[: kind.string_bound]
    return a_value(choices, types.definitions().get(base), depth + 1)


def corpus() -> list[bytes]:
    texts = [types.numbered(name) + b"\0" + dumps(to_json(types.example(name))) for name in SEEDED]
    return [text for text in texts if len(text) < 2000] + [
        *(types.numbered(name) + b"\1" + bytes(range(7, 60)) for name in SEEDED),
        types.numbered("test_msgs/msg/UnboundedSequences") + b'\0{"bool_values":[1,0]}',
        types.numbered("std_msgs/msg/Header") + b'\0{"seq":1,"stamp":"now"}',
        types.numbered("std_msgs/msg/Header") + b'\0{"stamp":{"secs":1,"nsecs":2}}',
        types.numbered("nav_msgs/msg/Path") + b'\0{"poses":[{},{},{"header":{}}]}',
    ]


TARGET = Target("values become CDR that decodes to them, or are refused with a path", run, corpus)
