# SPDX-License-Identifier: Apache-2.0
"""The base of all message models, and the types of their fields.

The generated classes read these names as ``ros.Float64``, ``ros.Field`` and so on. A message
describes the JSON that a client may send: strict in type and range, unknown fields refused,
missing ones default. Pydantic's compiled core checks nearly all of it. It calls Python only where
a comment says so.
"""

import base64
import math
from collections.abc import Callable, Iterable, Mapping
from typing import Annotated, Any, ClassVar, Final, TypeAlias, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    FailFast,
    Field,
    GetCoreSchemaHandler,
    GetPydanticSchema,
    PlainSerializer,
    ValidationInfo,
    model_validator,
)
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from schemas.definition import FLOAT32_OVERFLOW
from schemas.json_forms import (
    MAX_WHOLE,
    NON_FINITE,
    Clock,
    OctetsError,
    duration,
    header,
    octets,
    time,
)

__all__ = [
    "Annotated",
    "Array",
    "Bool",
    "ClassVar",
    "DurationMessage",
    "Field",
    "Float32",
    "Float64",
    "HeaderMessage",
    "Int8",
    "Int16",
    "Int32",
    "Int64",
    "Message",
    "Octets",
    "String",
    "TimeMessage",
    "UInt8",
    "UInt16",
    "UInt32",
    "UInt64",
    "Utf8Bound",
    "Utf16Bound",
    "WString",
    "fresh",
]

_T = TypeVar("_T")


class Message(BaseModel):
    """A ROS 2 message as a frozen model. `schemas.naming.attribute` names its fields.

    ``model_validate(value, context={"now_ns": ...})`` takes a decoded JSON object and the ROS time
    for ``"now"`` and for headers without a stamp, or a function that returns it, called for each
    of them. Without the context ``"now"`` is refused and such headers keep the stamp 0.
    ``model_dump_json()`` writes what a client sends.
    """

    model_config = ConfigDict(
        strict=True,
        extra="forbid",
        frozen=True,
        allow_inf_nan=False,  # see `_as_non_finite`
        ser_json_inf_nan="strings",
        serialize_by_alias=True,
        protected_namespaces=(),  # attribute() keeps clear of what BaseModel uses
        defer_build=True,  # a module of 30 messages imports in the time of the few in use
    )

    ros_type: ClassVar[str]  # pkg/msg/Name
    ros_type_hash: ClassVar[str]  # REP-2011, "RIHS01_..."


def _whole(source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
    number = core_schema.float_schema(
        strict=True, ge=-MAX_WHOLE, le=MAX_WHOLE, multiple_of=1, allow_inf_nan=False
    )
    # In Python only if a float comes. Integers and what is refused are the core's.
    convert = core_schema.no_info_plain_validator_function(int)
    choices = [
        core_schema.int_schema(strict=True),
        core_schema.chain_schema([number, convert]),
        core_schema.any_schema(),
    ]
    forms = core_schema.union_schema(choices, mode="left_to_right")  # type: ignore[arg-type]  # a list is invariant
    return core_schema.chain_schema([forms, handler(source)])


def _non_finite(size: int) -> GetPydanticSchema:
    def schema(source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        # In Python only what is neither a finite number nor null.
        others = core_schema.with_info_plain_validator_function(_as_non_finite)
        return core_schema.union_schema(
            [handler(source), others],
            mode="left_to_right",
            custom_error_type=f"float{size}_type",
            custom_error_message=f"Input should be a number that float{size} holds",
        )

    return GetPydanticSchema(schema)


def _as_non_finite(value: object, info: ValidationInfo) -> float:
    if isinstance(value, str) and value in NON_FINITE:
        return NON_FINITE[value]
    # JSON text has no such number. An overflowing 1e999 must not become one.
    if info.mode == "python" and isinstance(value, float) and not math.isfinite(value):
        return value
    raise PydanticCustomError("float_type", "Input should be a valid number")


# A float without a fraction is an integer, as in JSON Schema.
_WHOLE: Final = GetPydanticSchema(_whole)

Bool: TypeAlias = bool
Int8: TypeAlias = Annotated[int, Field(ge=-(2**7), le=2**7 - 1), _WHOLE]
Int16: TypeAlias = Annotated[int, Field(ge=-(2**15), le=2**15 - 1), _WHOLE]
Int32: TypeAlias = Annotated[int, Field(ge=-(2**31), le=2**31 - 1), _WHOLE]
Int64: TypeAlias = Annotated[int, Field(ge=-(2**63), le=2**63 - 1), _WHOLE]
UInt8: TypeAlias = Annotated[int, Field(ge=0, le=2**8 - 1), _WHOLE]
UInt16: TypeAlias = Annotated[int, Field(ge=0, le=2**16 - 1), _WHOLE]
UInt32: TypeAlias = Annotated[int, Field(ge=0, le=2**32 - 1), _WHOLE]
UInt64: TypeAlias = Annotated[int, Field(ge=0, le=2**64 - 1), _WHOLE]


# null is NaN, which JSON does not have. NaN and infinities are strings. Integers pass as floats.
Float32: TypeAlias = Annotated[
    Annotated[float, Field(gt=-FLOAT32_OVERFLOW, lt=FLOAT32_OVERFLOW)] | None, _non_finite(32)
]
Float64: TypeAlias = Annotated[float | None, _non_finite(64)]

# CDR strings end at NUL. The pattern also refuses lone surrogates, which have no UTF-8.
String: TypeAlias = Annotated[str, Field(pattern=r"^[^\x00]*$")]
WString: TypeAlias = String


def Utf8Bound(limit: int) -> AfterValidator:  # noqa: N802  # reads as a type in annotations
    """Bound a ``string<=limit``, which counts the bytes of its UTF-8."""
    return _bound("utf-8", 1, limit, "bytes of UTF-8")


def Utf16Bound(limit: int) -> AfterValidator:  # noqa: N802  # reads as a type in annotations
    """Bound a ``wstring<=limit``, which counts the code units of its UTF-16."""
    return _bound("utf-16-le", 2, limit, "code units of UTF-16")


def _bound(encoding: str, unit: int, limit: int, units: str) -> AfterValidator:
    # In Python, because the core counts characters.
    def check(text: str) -> str:
        size = len(text.encode(encoding)) // unit
        if size > limit:
            raise PydanticCustomError(
                "string_too_long",
                "text has {size} {units}, at most {max_length} fit",
                {"size": size, "units": units, "max_length": limit},
            )
        return text

    return AfterValidator(check)


def _octets(value: object) -> bytes:
    # In Python, because the core decodes base64 only while it reads JSON text itself.
    try:
        return octets(value)
    except OctetsError as error:
        raise PydanticCustomError("octets", "{text}", {"text": str(error)}) from error


def _base64(value: bytes) -> str:
    return base64.b64encode(value).decode()  # the core's own is that of URLs


# uint8[], byte[] and char[].
Octets: TypeAlias = Annotated[
    bytes, BeforeValidator(_octets), PlainSerializer(_base64, when_used="json")
]


# One bad element is enough: collecting 100,000 errors about one frame takes 0.1 s.
Array: TypeAlias = Annotated[list[_T], FailFast()]


def fresh(values: Iterable[_T]) -> Callable[[], list[_T]]:
    """Return a factory of lists of *values*, so that no two messages share a default."""
    return list(values).copy


class DurationMessage(Message):
    """The base of builtin_interfaces/msg/Duration, which also takes the names of ROS 1."""

    @model_validator(mode="before")
    @classmethod
    def _rename(cls, value: object) -> object:
        return duration(value)


class TimeMessage(Message):
    """The base of builtin_interfaces/msg/Time: it also takes the names of ROS 1 and ``"now"``."""

    @model_validator(mode="before")
    @classmethod
    def _resolve(cls, value: object, info: ValidationInfo) -> object:
        now_ns = _clock(info)
        if now_ns is None:
            if value == "now":
                raise PydanticCustomError("no_clock", "no clock says what time is now")
            return duration(value)
        return time(value, now_ns)


class HeaderMessage(Message):
    """The base of std_msgs/msg/Header, which accepts and ignores the ``seq`` of ROS 1.

    A header without a ``stamp`` is stamped now, as in rosbridge.
    """

    @model_validator(mode="before")
    @classmethod
    def _stamp(cls, value: object, info: ValidationInfo) -> object:
        return header(value, _clock(info))


def _clock(info: ValidationInfo) -> Clock | None:
    context = info.context
    if not isinstance(context, Mapping):
        return None
    now_ns: Clock | None = context.get("now_ns")
    return now_ns
