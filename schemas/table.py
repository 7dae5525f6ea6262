# SPDX-License-Identifier: Apache-2.0
"""The list of message types: their number, their direction and their purpose.

It also lists the services and actions that have models in this package, without numbers.
"""

import re
from collections.abc import Container, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Final, Literal, TypeVar, get_args

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError
from typing_extensions import Self

from schemas.backports import tomllib
from schemas.interface import InterfaceKind

TABLE_PATH: Final = Path(__file__).with_name("messages.toml")

_TYPE_SPELLING: Final = re.compile(
    r"(?P<package>[a-z][a-z0-9_]*)/(?:msg/)?(?P<name>[A-Z][A-Za-z0-9]*)"
)
_INTERFACE_SPELLING: Final = re.compile(
    r"(?P<package>[a-z][a-z0-9_]*)/(?:(?P<kind>srv|action)/)?(?P<name>[A-Z][A-Za-z0-9]*)"
)
# types that rosidl derives for topics: the feedback of an action, the events of a service
_DERIVED_SPELLING: Final = re.compile(
    r"[a-z][a-z0-9_]*/(?:action/[A-Z][A-Za-z0-9]*_(?:FeedbackMessage|(?:SendGoal|GetResult)_Event)"
    r"|srv/[A-Z][A-Za-z0-9]*_Event)"
)
_ANY_SPELLING: Final = re.compile(r"[a-z][a-z0-9_]*/(?P<kind>msg|srv|action)/[A-Z][A-Za-z0-9]*")
_A: Final = {"msg": "a message", "srv": "a service", "action": "an action"}
# Ten times the digits that a table will ever need. int() of very many digits is slow.
_NUMBER: Final = re.compile(r"[0-9]{1,9}", re.ASCII)

_R = TypeVar("_R", bound=BaseModel)


class TableError(ValueError):
    """A list of message types cannot be used. The text names the file and the reason."""


class TypeNameError(ValueError):
    """A client's text does not name a type. The exception's text says what was expected.

    *requested* is that text, empty if nobody can guess what it means, and *kind* what was expected.
    """

    def __init__(
        self, reason: str, requested: str = "", kind: Literal["msg", "srv", "action"] = "msg"
    ) -> None:
        super().__init__(reason)
        self.requested = requested
        self.kind: Literal["msg", "srv", "action"] = kind


class Row(BaseModel):
    """One type of the table. Its number is part of the API."""

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid")

    number: Annotated[int, Field(ge=0)]
    name: Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*/msg/[A-Z][A-Za-z0-9]*$")]
    directions: Literal["both", "subscribe", "publish"]
    purpose: Annotated[str, Field(min_length=1)]


class InterfaceRow(BaseModel):
    """One service or action of the table."""

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid")

    name: Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*/(srv|action)/[A-Z][A-Za-z0-9]*$")]
    purpose: Annotated[str, Field(min_length=1)]


@dataclass(frozen=True, slots=True)
class Table:
    """The rows in the order of the file, the messages' also by number and name."""

    rows: tuple[Row, ...]
    by_number: Mapping[int, Row]
    by_name: Mapping[str, Row]
    interfaces: tuple[InterfaceRow, ...] = ()

    @classmethod
    def of(cls, rows: Iterable[Row], interfaces: Iterable[InterfaceRow] = ()) -> Self:
        """Build the table of some rows.

        Raises:
            TableError: two rows share a number or a name.
        """
        kept = tuple(rows)
        kept_interfaces = tuple(interfaces)
        by_number: dict[int, Row] = {}
        by_name: dict[str, Row] = {}
        for row in kept:
            other = by_number.setdefault(row.number, row)
            if other is not row:
                raise TableError(f"number {row.number} has two rows, {other.name} and {row.name}")
            if by_name.setdefault(row.name, row) is not row:
                raise TableError(f"{row.name} has two rows")
        names = [row.name for row in kept_interfaces]
        for name in names:
            if names.count(name) > 1:
                raise TableError(f"{name} has two rows")
        return cls(kept, MappingProxyType(by_number), MappingProxyType(by_name), kept_interfaces)

    @classmethod
    def load(cls, path: Path = TABLE_PATH) -> Self:
        """Read a table. Without *path*, the one in this package.

        Raises:
            TableError: the file is not TOML, a row is malformed, or two rows collide.
            OSError: the file cannot be read.
        """
        try:
            content = tomllib.loads(path.read_text(encoding="utf-8"))
            return cls.of(
                _rows(_ROWS, "messages", content.get("messages")),
                _rows(_INTERFACE_ROWS, "interfaces", content.get("interfaces", [])),
            )
        except ValueError as error:
            raise TableError(f"{path}: {error}") from error


_ROWS: Final = TypeAdapter(list[Row])
_INTERFACE_ROWS: Final = TypeAdapter(list[InterfaceRow])


def _rows(adapter: TypeAdapter[list[_R]], key: str, value: object) -> list[_R]:
    try:
        return adapter.validate_python(value)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = "".join(f"[{part}]" for part in first["loc"])
        raise TableError(f"{key}{where}: {first['msg']}") from error


def resolve_type(requested: str | int, table: Table) -> str:
    """Return ``pkg/msg/Name`` for a type as requested.

    Clients write ``pkg/Name``, ``pkg/msg/Name``, or a number of *table*, as a number or as text,
    or a type that only topics of actions and services have, such as
    ``pkg/action/Name_FeedbackMessage``. The type need not be installed.

    Raises:
        TypeNameError: it has none of these forms, or the table does not have the number.
    """
    match requested:
        case bool():  # JSON's true is not a number, but Python's is
            pass
        case int():
            return _numbered(requested, table)
        case str() if _NUMBER.fullmatch(requested):
            return _numbered(int(requested), table)
        case str() if match := _TYPE_SPELLING.fullmatch(requested):
            return f"{match['package']}/msg/{match['name']}"
        case str() if _DERIVED_SPELLING.fullmatch(requested):
            return requested
    _refuse_other_kind(requested, "msg")
    raise TypeNameError(
        f"{requested!r} is not a valid message type: expected pkg/msg/Name, pkg/Name or a table"
        " number",
        requested if isinstance(requested, str) else "",
    )


def resolve_interface(requested: str, kind: InterfaceKind) -> str:
    """Return ``pkg/srv/Name`` for the type of a service as requested. Likewise for actions.

    Clients write ``pkg/Name`` or ``pkg/srv/Name``. The type need not be installed.

    Raises:
        TypeNameError: it has neither form.
    """
    match = _INTERFACE_SPELLING.fullmatch(requested)
    if match is None or match["kind"] not in {None, kind}:
        _refuse_other_kind(requested, kind)
        called = "service" if kind == "srv" else "action"
        raise TypeNameError(
            f"{requested!r} is not a valid {called} type: expected pkg/{kind}/Name or pkg/Name",
            requested,
            kind,
        )
    return f"{match['package']}/{kind}/{match['name']}"


def resolve_any(requested: str | int, table: Table, known: Container[str]) -> str:
    """Return the full name of the message, the service or the action that *requested* means.

    ``pkg/Name`` is the first of the three that is *known*, or a message if none is.

    Raises:
        TypeNameError: it is not a type name, or the table does not have the number.
    """
    text = str(requested)
    for kind in get_args(InterfaceKind):
        if f"/{kind}/" in text:
            return resolve_interface(text, kind)
    if not (_NUMBER.fullmatch(text) or _TYPE_SPELLING.fullmatch(text)):
        forms = "pkg/msg/Name, pkg/srv/Name, pkg/action/Name, pkg/Name or a table number"
        raise TypeNameError(f"{requested!r} is not a valid type: expected {forms}", text)
    message = resolve_type(requested, table)
    if message in known or not _INTERFACE_SPELLING.fullmatch(text):
        return message
    interfaces = (resolve_interface(text, kind) for kind in get_args(InterfaceKind))
    return next((name for name in interfaces if name in known), message)


def _refuse_other_kind(requested: str | int, kind: str) -> None:
    """Refuse the name of a type of another kind with a specific text."""
    match = _ANY_SPELLING.fullmatch(requested) if isinstance(requested, str) else None
    if match is not None and match["kind"] != kind:
        raise TypeNameError(f"{requested!r} is {_A[match['kind']]} type, not {_A[kind]} type")


def _numbered(number: int, table: Table) -> str:
    row = table.by_number.get(number)
    if row is None:
        raise TypeNameError(f"the message table has no number {number}")
    return row.name
