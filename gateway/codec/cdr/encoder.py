# SPDX-License-Identifier: Apache-2.0
"""Decoded JSON to CDR, checked on the way.

A client decides what a message costs, so the cost is in proportion to what the client wrote. No
object is made per message, and an empty element is a run of bytes that is known already. A bound
on fields and on bytes is checked before each element.
"""

from collections.abc import Callable, Sequence
from functools import cache
from struct import pack
from typing import Final, TypeAlias

from typing_extensions import assert_never

from gateway.codec.cdr.arrays import listed, packed
from gateway.codec.cdr.defaults import DefaultBytes, default_elements, default_value
from gateway.codec.cdr.encoder_runs import RunWriter
from gateway.codec.cdr.layout import (
    ALIGNMENTS,
    CODES,
    HEADER_BYTES,
    Elements,
    Fixed,
    Member,
    Numbers,
    Path,
    Slot,
    Text,
    flatten,
    item_path,
)
from gateway.codec.cdr.misfits import (
    BOOLS,
    INTEGERS,
    LENIENT_INTEGERS,
    LENIENT_NUMBERS,
    MAX_CDR_BYTES,
    MAX_FIELDS,
    NUMBERS,
    LenientError,
    MisfitError,
    count_fields,
    misfit,
    refuse_size,
)
from gateway.codec.cdr.source import SourceCode, variable
from gateway.codec.cdr.text import wide
from schemas.definition import Definition
from schemas.installed import InstalledDefinitions
from schemas.json_forms import FORMS, NON_FINITE, Clock, octets, whole, wholes

Encoder: TypeAlias = Callable[[object, Clock], bytes]

_CDR_LE: Final = b"\0\1\0\0"  # RTPS 2.5, 10.2. The options stay 0


def compile_encoder(definition: Definition, definitions: InstalledDefinitions) -> Encoder:
    """Compile a function from a decoded JSON object to little-endian CDR, header included.

    It takes what `schemas.message.Message` describes, and the ROS time for ``"now"`` and for
    headers without a stamp. For a float it also takes what `NON_FINITE` names, for an integer a
    float that is one (`whole`). Padding is zero. A value that does not fit raises one of `MISFITS`,
    without saying where. `gateway.codec.validation` does.

    It raises `TooManyFieldsError` for a message beyond the bounds of `gateway.codec.cdr.misfits`.

    Raises:
        UnknownTypeError: a nested type is not installed.
    """
    members = flatten(definition, definitions)
    title = f"CDR encoder of {definition.name}"
    strict = _EncoderWriter(definition, definitions, is_lenient=False).write(members, title)

    @cache
    def lenient() -> Encoder:
        writer = _EncoderWriter(definition, definitions, is_lenient=True)
        return writer.write(members, f"{title}, lenient")

    def encode(message: object, now_ns: Clock) -> bytes:
        try:
            return strict(message, now_ns)
        except LenientError:
            return lenient()(message, now_ns)

    return encode


class _EncoderWriter(RunWriter):
    """Writes the source of one encoder: ``out`` grows, run by run.

    The lenient encoder accepts other forms of numbers, such as ``None`` as a float. A check at
    every number would slow down all messages for the sake of few, so the strict encoder runs first
    and the lenient one if it fails.
    """

    def __init__(
        self, definition: Definition, definitions: InstalledDefinitions, *, is_lenient: bool
    ) -> None:
        super().__init__(SourceCode(), is_lenient=is_lenient)
        self._definitions = definitions
        self._messages: dict[Path, Definition] = {(): definition}
        self._objects: dict[Path, str] = {}  # those that a variable holds already

    def write(self, members: Sequence[Member], title: str) -> Encoder:
        source = self._source
        with source.block("def encode(message, now_ns):"):
            if any(isinstance(member, Elements) for member in members):
                source.line(f"left = {MAX_FIELDS}")
            self._open((), "message")
            self._members(members)
            self._flush()
            source.line("return bytes(out)")
        names = {
            "BOOLS": BOOLS,
            "CDR_LE": _CDR_LE,
            "EMPTY": {},
            "INTEGERS": LENIENT_INTEGERS if self._is_lenient else INTEGERS,
            "LENIENT_INTEGERS": LENIENT_INTEGERS,
            "LENIENT_NUMBERS": LENIENT_NUMBERS,
            "Misfit": MisfitError,
            "NON_FINITE": NON_FINITE,
            "NUL": b"\0",
            "NUMBERS": LENIENT_NUMBERS if self._is_lenient else NUMBERS,
            "listed": listed,
            "misfit": misfit,
            "octets": octets,
            "pack": pack,
            "packed": packed,
            "refuse_size": refuse_size,
            "whole": whole,
            "wholes": wholes,
            "wide": wide,
        }
        encode: Encoder = source.compile("encode", title, names)
        return encode

    def _members(self, members: Sequence[Member]) -> None:
        for member in members:
            match member:
                case Fixed():
                    self._fixed(member)
                case Text():
                    self._text(member)
                case Numbers():
                    self._numbers(member)
                case Elements():
                    self._elements(member)
                case _:
                    assert_never(member)

    # One method for each kind of member

    def _fixed(self, member: Fixed) -> None:
        if not member.wanted:  # the octet of a message without fields
            self._object(member.path)
            self._put_padding(member)
            return
        name = self._value(member)
        if member.length is None:
            self._put_number(member, name)
        elif member.is_octets:
            self._expect_octets(member, name)
            self._put(Slot("s", member.length), name)
        else:
            self._convert(name, "listed", member)
            self._expect_numbers(member, name)
            self._put(Slot(CODES[member.base], member.length), self._unpacked(member, name))

    def _text(self, member: Text) -> None:
        self._write_text(member, self._value(member))

    def _write_text(self, member: Text, name: str) -> None:
        if member.is_wide:
            self._source.line(f"{name} = wide({name})")
            self._count(f"len({name}) // 4", member.bound)
        else:
            self._source.line(f"{name} = {name}.encode()")
            self._raise_misfit_if(f"NUL in {name}")
            self._count(f"len({name}) + 1", member.bound, terminators=1)
        self._flush()
        self._source.line(f"out += {name}")
        if not member.is_wide:
            self._source.line("out += NUL")
        self._residue = None

    def _numbers(self, member: Numbers) -> None:
        source = self._source
        name = self._value(member)
        if member.is_octets:
            self._expect_octets(member, name)
        else:
            self._convert(name, "packed", member)
        if member.length is None:
            self._count(f"len({name})", member.bound)
        self._flush()
        with source.block(f"if {name}:"):  # without elements there is no padding
            # after its count an array is aligned to 4
            if member.size > (1 if member.length is not None else 4):
                source.line(f"out += bytes(({HEADER_BYTES} - len(out)) % {member.size})")
            if member.is_octets:
                source.line(f"out += {name}")
            else:
                with source.block(f"if type({name}) is list:"):
                    self._expect_numbers(member, name)
                    unpacked = self._unpacked(member, name)
                    source.line(f'out += pack(f"<{{len({name})}}{CODES[member.base]}", {unpacked})')
                with source.block("else:"):
                    source.line(f"out += {name}")
        self._residue = None

    def _elements(self, member: Elements) -> None:
        source = self._source
        name = variable(member.path)
        default = source.constant("ELEMENTS", default_elements(member), f"of {name}")
        source.line(f"{name} = {self._get(member.path, default)}")
        self._expect_list(name, member.length)
        if member.length is None:
            self._count(f"len({name})", member.bound)
        self._flush()
        self._residue = None
        element = variable(item_path(member.path))
        outer = self._objects
        self._objects = {}
        with source.block(f"for {element} in {name}:"):
            if member.definition is None:
                self._spend(count_fields(member.members))
                (item,) = member.members
                assert isinstance(item, Text)  # noqa: S101  # arrays of numbers are no `Elements`
                self._write_text(item, element)
            else:
                self._element(member, member.definition, element)
            self._flush()
        self._objects = outer
        self._residue = None

    def _element(self, member: Elements, definition: Definition, element: str) -> None:
        source = self._source
        with source.block(f"if {element} == EMPTY:"):
            empty = source.constant("EMPTY", DefaultBytes(member.members), definition.name)
            source.line(f"out += {empty}[len(out) & {ALIGNMENTS - 1}]")
            self._spend(1)
            source.line("continue")
        self._spend(count_fields(member.members))
        # The paths of an element's fields begin with the array's own.
        self._messages[member.path] = definition
        self._open(member.path, element)
        self._members(member.members)

    def _spend(self, fields: int) -> None:
        """Write the check of the bounds."""
        self._source.line(f"left -= {fields}")
        with self._source.block(f"if left < 0 or len(out) > {MAX_CDR_BYTES}:"):
            self._source.line("refuse_size()")

    # Values, and the objects that hold them

    def _value(self, member: Fixed | Numbers | Text) -> str:
        """Assign the value of a field to a variable, and return it."""
        name = variable(member.path)
        default = default_value(member)
        text = repr(default)
        if isinstance(default, (list, bytes, float)):  # NaN and infinities have no literal
            text = self._source.constant("DEFAULT", default, f"of {name}")
        value = self._get(member.path, text)
        if not isinstance(member, Text) and member.is_octets:
            value = f"octets({value})"
        self._source.line(f"{name} = {value}")
        return name

    def _get(self, path: Path, default: str) -> str:
        """Return the expression for a field, given that for its default."""
        return f"{self._object(path[:-1])}.get({path[-1]!r}, {default})"

    def _object(self, path: Path) -> str:
        """Return the variable of the message at *path*. The first call assigns it."""
        if path not in self._objects:
            outer, key = self._object(path[:-1]), repr(path[-1])
            definition = self._definitions.get(self._type_of(path))
            self._messages[path] = definition
            name = variable(path)
            if definition.name in FORMS:
                form = self._form(definition, f"{outer}[{key}]")
                self._source.line(f"{name} = {form} if {key} in {outer} else EMPTY")
            else:
                self._source.line(f"{name} = {outer}.get({key}, EMPTY)")
            self._expect_known(definition, name)
            self._objects[path] = name
        return self._objects[path]

    def _open(self, path: Path, name: str) -> None:
        """Begin a message that the variable *name* holds."""
        definition = self._messages[path]
        if definition.name in FORMS:
            self._source.line(f"{name} = {self._form(definition, name)}")
        self._expect_known(definition, name)
        self._objects[path] = name

    def _type_of(self, path: Path) -> str:
        fields = self._messages[path[:-1]].fields
        return next(field.type.base for field in fields if field.name == path[-1])

    def _form(self, definition: Definition, value: str) -> str:
        form = self._source.constant("FORM", FORMS[definition.name], definition.name)
        return f"{form}({value}, now_ns)"

    # Checks

    def _expect_known(self, definition: Definition, name: str) -> None:
        """Write the check that a message has no unknown fields."""
        test = f"{name} != EMPTY"  # without fields, nothing else finds out that it is not an object
        if definition.fields:
            names = frozenset(field.name for field in definition.fields)
            known = self._source.constant("FIELDS", names, definition.name)
            test = f"not {known}.issuperset({name})"
        self._raise_misfit_if(test)

    def _expect_list(self, name: str, length: int | None) -> None:
        # a string or an object also has a length and elements
        test = f"type({name}) is not list"
        self._raise_misfit_if(test if length is None else f"{test} or len({name}) != {length}")

    def _convert(self, name: str, function: str, member: Fixed | Numbers) -> None:
        """Write the conversion of another value than a list, such as a `NumberArray`."""
        with self._source.block(f"if type({name}) is not list:"):
            self._source.line(f"{name} = {function}({name}, {member.base!r})")
        if member.length is not None:
            self._raise_misfit_if(f"len({name}) != {member.length}")

    def _expect_octets(self, member: Fixed | Numbers, name: str) -> None:
        if member.length is not None:
            self._raise_misfit_if(f"len({name}) != {member.length}")

    def _count(self, count: str, bound: int | None, terminators: int = 0) -> None:
        """Write the uint32 count of an array or string, which ends a run."""
        if bound is not None:
            self._raise_misfit_if(f"{count} > {bound + terminators}")
        self._put(Slot("I"), count)

    def _raise_misfit_if(self, test: str) -> None:
        with self._source.block(f"if {test}:"):
            self._source.line("raise Misfit")
