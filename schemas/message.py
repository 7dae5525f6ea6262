# SPDX-License-Identifier: Apache-2.0
"""The base of all message models, and the types of their fields.

The generated classes read these names as ``ros.Float64``, ``ros.Field`` and so on. A message
describes the JSON that a client may send: strict in type and range, unknown fields refused,
missing ones default. Pydantic's compiled core checks nearly all of it; it calls Python only where
a comment says so.
"""

from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from typing import Annotated, ClassVar, Final, TypeAlias, TypeVar

import pybase64
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    FailFast,
    Field,
    ValidationInfo,
    model_validator,
)
from pydantic_core import PydanticCustomError

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
    "Nanoseconds",
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

Clock: TypeAlias = int | Callable[[], int]
"""ROS time in nanoseconds, or a function that returns it."""


class Message(BaseModel):
    """A ROS 2 message as a frozen model; fields are named by `schemas.naming.attribute`.

    ``model_validate(value, context={"now_ns": ...})`` takes a decoded JSON object and the ROS time
    for ``"now"`` and for headers without a stamp, or a function that returns it, called for each
    of them. Without the context ``"now"`` is refused and such headers keep the stamp 0.
    """

    model_config = ConfigDict(
        strict=True,
        extra="forbid",
        frozen=True,
        allow_inf_nan=False,  # JSON has neither; an overflowing 1e999 must not become one
        protected_namespaces=(),  # attribute() keeps clear of what BaseModel uses
        defer_build=True,  # a module of 30 messages imports in the time of the few in use
    )

    ros_type: ClassVar[str]  # pkg/msg/Name
    ros_type_hash: ClassVar[str]  # REP-2011, "RIHS01_..."


Bool: TypeAlias = bool
Int8: TypeAlias = Annotated[int, Field(ge=-(2**7), le=2**7 - 1)]
Int16: TypeAlias = Annotated[int, Field(ge=-(2**15), le=2**15 - 1)]
Int32: TypeAlias = Annotated[int, Field(ge=-(2**31), le=2**31 - 1)]
Int64: TypeAlias = Annotated[int, Field(ge=-(2**63), le=2**63 - 1)]
UInt8: TypeAlias = Annotated[int, Field(ge=0, le=2**8 - 1)]
UInt16: TypeAlias = Annotated[int, Field(ge=0, le=2**16 - 1)]
UInt32: TypeAlias = Annotated[int, Field(ge=0, le=2**32 - 1)]
UInt64: TypeAlias = Annotated[int, Field(ge=0, le=2**64 - 1)]

# The nanosec of Time and Duration. The uint32 would hold four times as much, but their
# definitions say "valid in the range [0, 1e9)", and readers of an invalid one disagree.
Nanoseconds: TypeAlias = Annotated[int, Field(ge=0, le=10**9 - 1)]

# The first double that rounds to infinity in single precision. The largest float32 is a
# little below, but prints as 3.4028235e38, which must come back in.
_FLOAT32_OVERFLOW: Final = 2.0**128 - 2.0**103

# null is NaN, which JSON does not have; integers pass as floats.
Float32: TypeAlias = Annotated[float, Field(gt=-_FLOAT32_OVERFLOW, lt=_FLOAT32_OVERFLOW)] | None
Float64: TypeAlias = float | None

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


def _octets(value: object) -> object:
    # In Python, because the core decodes base64 only while it reads JSON text itself.
    match value:
        case str():
            try:
                return pybase64.b64decode(value, validate=True)
            except ValueError as error:
                raise PydanticCustomError("base64", "text is no valid base64") from error
        case list():
            return _octets_of_list(value)
        case bytes() | bytearray() | memoryview():
            return bytes(value)
    raise PydanticCustomError("octets_type", "expected base64 text or an array of integers")


def _octets_of_list(items: list[object]) -> bytes:
    # bytes() would take True for 1. Checking the types as a set is five times as fast as checking
    # each item, which happens only if something is wrong.
    if set(map(type, items)) <= {int}:
        with suppress(ValueError):
            return bytes(items)  # type: ignore[arg-type]  # the line above saw integers only
    index = next(
        index for index, item in enumerate(items) if type(item) is not int or not 0 <= item <= 255
    )
    raise PydanticCustomError("octet", "item {index} is no integer from 0 to 255", {"index": index})


# uint8[], byte[] and char[].
Octets: TypeAlias = Annotated[bytes, BeforeValidator(_octets)]


# One bad element is enough: collecting 100,000 errors about one frame takes 0.1 s.
Array: TypeAlias = Annotated[list[_T], FailFast()]


def fresh(values: Iterable[_T]) -> Callable[[], list[_T]]:
    """Return a factory of lists of *values*, so that no two messages share a default."""
    return list(values).copy


class DurationMessage(Message):
    """The base of builtin_interfaces/msg/Duration, which takes the names of ROS 1, too."""

    @model_validator(mode="before")
    @classmethod
    def _rename(cls, value: object) -> object:
        return _with_ros2_names(value)


class TimeMessage(Message):
    """The base of builtin_interfaces/msg/Time: it takes the names of ROS 1 and ``"now"``, too."""

    @model_validator(mode="before")
    @classmethod
    def _resolve(cls, value: object, info: ValidationInfo) -> object:
        if value == "now":
            now_ns = _clock(info)
            if now_ns is None:
                raise PydanticCustomError("no_clock", "no clock says what time is now")
            sec, nanosec = divmod(now_ns if isinstance(now_ns, int) else now_ns(), 10**9)
            return {"sec": sec, "nanosec": nanosec}
        return _with_ros2_names(value)


class HeaderMessage(Message):
    """The base of std_msgs/msg/Header, which accepts and ignores the ``seq`` of ROS 1.

    A header without a ``stamp`` is stamped now, as in rosbridge.
    """

    @model_validator(mode="before")
    @classmethod
    def _stamp(cls, value: object, info: ValidationInfo) -> object:
        if not isinstance(value, dict) or ("stamp" in value and "seq" not in value):
            return value
        header = {key: item for key, item in value.items() if key != "seq"}
        if _clock(info) is not None:
            header.setdefault("stamp", "now")
        return header


_ROS1_NAMES: Final = {"secs": "sec", "nsecs": "nanosec"}


def _with_ros2_names(value: object) -> object:
    if not isinstance(value, dict) or not ("secs" in value or "nsecs" in value):
        return value
    # If both names are given, the old one stays and is refused as unknown.
    return {
        key if _ROS1_NAMES.get(key, key) in value else _ROS1_NAMES.get(key, key): item
        for key, item in value.items()
    }


def _clock(info: ValidationInfo) -> Clock | None:
    context = info.context
    if not isinstance(context, Mapping):
        return None
    now_ns: Clock | None = context.get("now_ns")
    return now_ns
