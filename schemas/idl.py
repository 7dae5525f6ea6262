# SPDX-License-Identifier: Apache-2.0
"""Definitions written in OMG IDL 4.2, as ROS packages may do instead of `.msg` files.

The grammar is the part of the standard (https://www.omg.org/spec/IDL/4.2) that rosidl reads:
modules, structs, typedefs, and constants in a module ``Name_Constants``. If rosidl
differs from the standard, this does as rosidl, which makes the code for the wire.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Final

from schemas.definition import INTEGER_RANGES, STRINGS, Constant, Definition, Field, FieldType
from schemas.definition_text import CONSTANT_NAME, FIELD_NAME
from schemas.idl_reader import Annotations, IdlReader, fitting, unexpected
from schemas.idl_tokens import IdlToken, PlaceError, shortened, with_place
from schemas.interface import ROLES, SEPARATOR, Interface, Role, part_name
from schemas.msg_text import msg_text

MAX_MODULES: Final = 8  # within each other. ROS has three
_MAX_NAMED: Final = 4  # structs in an error text

_BASES: Final = {
    "boolean": "bool",
    "octet": "byte",
    "char": "char",
    "float": "float32",
    "double": "float64",
    "short": "int16",
    "unsigned short": "uint16",
    "long": "int32",
    "unsigned long": "uint32",
    "long long": "int64",
    "unsigned long long": "uint64",
    **{name: name for name in INTEGER_RANGES if "int" in name},
}
_REFUSED: Final = {
    "long double": "ROS has no long double; use double",
    "wchar": "rosidl makes no code for wchar; use uint16",
    "fixed": "rosidl has no fixed-point numbers; use double",
    "enum": "rosidl has no enums; use an integer, and constants in a module NAME_Constants",
    "union": "rosidl has no unions; use a member for each of its cases",
    "struct": "rosidl has no struct in a struct; give it a file, and name it PACKAGE::msg::NAME",
    **dict.fromkeys(
        ("any", "bitmask", "bitset", "interface", "map", "native", "valuetype"),
        "rosidl does not read this; use structs, sequences and integers",
    ),
}
_KEYWORDS: Final = frozenset({"sequence", "unsigned", *STRINGS, *_BASES, *_REFUSED})
# IDL has no empty struct, so rosidl gives one without fields this.
_PLACEHOLDER: Final = (Field("structure_needs_at_least_one_member", FieldType("uint8")),)


def parse_idl_message(name: str, text: str, type_hash: str | None = None) -> Definition:
    """Parse the `.idl` file of the message ``pkg/msg/Name``. The result has `.msg` text.

    Raises:
        DefinitionError: the file is not IDL as rosidl reads it, or has no such message.
    """
    definition = _parse(name, text, [name])[name]
    return replace(definition, type_hash=type_hash)


def parse_idl_interface(name: str, text: str, hashes: Mapping[str, str] | None = None) -> Interface:
    """Parse the `.idl` file of a service or an action. The result has text as in `.srv` files.

    Raises:
        DefinitionError: as for `parse_idl_message`.
    """
    known = hashes or {}
    roles = ROLES[name.split("/")[1]]
    found = _parse(name, text, [part_name(name, role) for role in roles])
    parts: dict[Role, Definition] = {}
    for role in roles:
        part = found[part_name(name, role)]
        parts[role] = replace(part, type_hash=known.get(part.name))
    joined = f"{SEPARATOR}\n".join(part.text for part in parts.values())
    return Interface(name, MappingProxyType(parts), joined, known.get(name))


def _parse(name: str, text: str, expected: list[str]) -> dict[str, Definition]:
    text = text.removeprefix("\ufeff")
    try:
        parser = _Parser(text)
        parser.specification()
        return parser.definitions(expected)
    except PlaceError as error:
        raise with_place(name, text, error) from error


class _Parser(IdlReader):
    """Reads declarations."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self._modules: list[str] = []
        self._typedefs: dict[str, FieldType] = {}
        # as in rosidl by the innermost module alone
        self._constants: dict[str, dict[str, Constant]] = {}
        self._structs: dict[str, Definition] = {}

    def definitions(self, expected: list[str]) -> dict[str, Definition]:
        """Return the messages that the file has to define, and no others."""
        if set(self._structs) != set(expected):
            found = ", ".join([*map(shortened, self._structs)][:_MAX_NAMED]) or "none"
            raise PlaceError(
                self.next.offset,
                f"expected exactly the structs {', '.join(expected)}, got {found}; name modules and"
                " structs like the file",
            )
        return {name: self._with_constants(self._structs[name]) for name in expected}

    def _with_constants(self, struct: Definition) -> Definition:
        constants = self._constants.get(f"{struct.short_name}_Constants", {})
        found = replace(struct, constants=tuple(constants.values()))
        return replace(found, text=msg_text(found))

    def specification(self) -> None:
        """Read the whole file."""
        while self.next.kind != "end":
            if self.next.kind == "include":
                self.take()  # types are looked up by their names
            elif self._modules and self.takes("}"):
                self._modules.pop()
                self.expect(";")
            else:
                self._declaration()
        if self._modules:
            raise unexpected(f"}} at the end of module {shortened(self._modules[-1])}", self.next)

    def _declaration(self) -> None:
        annotations = self.annotations()
        word = self.take()
        match word.text:
            case "module":
                self._module()
                return
            case "struct":
                self._struct(annotations)
            case "const":
                self._constant(annotations)
            case "typedef":
                self._typedef()
            case refused if word.kind == "name" and refused in _REFUSED:
                raise PlaceError(word.offset, _REFUSED[refused])
            case _:
                raise unexpected("module, struct, const, typedef or #include", word)
        self.expect(";")

    def _module(self) -> None:
        name = self.name("the name of a module")
        if len(self._modules) == MAX_MODULES:
            raise PlaceError(name.offset, f"at most {MAX_MODULES} modules within each other")
        self._modules.append(name.text)
        self.expect("{")

    def _struct(self, annotations: Annotations) -> None:
        name = self.name("the name of a struct")
        if self.next.text == ";":
            return  # declared only
        if self.next.text == ":":
            raise PlaceError(self.next.offset, "rosidl has no inheritance; repeat the members")
        self.expect("{")
        fields: dict[str, Field] = {}
        while not self.takes("}"):
            for token, field in self._member():
                if field.name in fields:
                    raise PlaceError(token.offset, f"the second member {token}; rename it")
                fields[field.name] = field
        if not fields:
            raise PlaceError(
                name.offset,
                f"expected members in {name}; IDL has no empty struct, rosidl writes"
                f" uint8 {_PLACEHOLDER[0].name} into it",
            )
        found = tuple(fields.values())
        full_name = "/".join([*self._modules, name.text])
        if full_name in self._structs:
            raise PlaceError(name.offset, f"the second struct {name}; rename it")
        self._structs[full_name] = Definition(
            full_name, () if found == _PLACEHOLDER else found, (), annotations.comment
        )

    def _member(self) -> Iterator[tuple[IdlToken, Field]]:
        annotations = self.annotations()
        base = self._type()
        for name, kind in self._declarators(base):
            if not FIELD_NAME.fullmatch(name.text):
                raise PlaceError(name.offset, f"{name} is not a valid field name in ROS; rename it")
            default = annotations.default(kind)
            yield name, Field(name.text, kind, default, annotations.comment, annotations.is_key)
        self.expect(";")

    def _constant(self, annotations: Annotations) -> None:
        at = self.next
        kind = self._type()
        if kind.is_array or not kind.is_primitive:
            raise PlaceError(
                at.offset, f"expected a number, a boolean or a string, got {shortened(str(kind))}"
            )
        name = self.name("the name of a constant")
        if not CONSTANT_NAME.fullmatch(name.text):
            raise PlaceError(name.offset, f"{name} is not a valid constant name in ROS; rename it")
        self.expect("=")
        value = fitting(kind, *self.literal())
        module = self._constants.setdefault(self._modules[-1] if self._modules else "", {})
        if name.text in module:
            raise PlaceError(name.offset, f"the second constant {name}; rename it")
        module[name.text] = Constant(name.text, kind.base, value, annotations.comment)

    def _typedef(self) -> None:
        (name, kind), *others = self._declarators(self._type())
        if others:
            raise PlaceError(others[0][0].offset, "rosidl reads one name in a typedef; write two")
        if self._typedefs.setdefault(name.text, kind) != kind:
            raise PlaceError(name.offset, f"the second typedef {name}, of another type; rename it")

    def _declarators(self, base: FieldType) -> Iterator[tuple[IdlToken, FieldType]]:
        while True:
            name = self.name("a name")
            if self.takes("["):
                break
            yield name, base
            if not self.takes(","):
                return
        if base.is_array:
            raise PlaceError(
                name.offset, f"rosidl has no array of {shortened(str(base))}; use a struct for it"
            )
        yield name, replace(base, length=self.size())
        self.expect("]")
        # rosidl gives the names behind it the same size
        if self.next.text in {"[", ","}:
            raise unexpected("; behind an array of one dimension", self.next)

    def _type(self, *, is_element: bool = False) -> FieldType:
        word = self.next
        if word.text == "::":
            return self._named(is_element=is_element)
        if word.kind == "name" and word.text not in _KEYWORDS:
            return self._named(is_element=is_element)
        spelled = self._spelled()
        if spelled in STRINGS:
            bound = None
            if self.takes("<"):
                bound = self.size()
                self.expect(">")
            return FieldType(spelled, string_bound=bound)
        if spelled in _BASES:
            return FieldType(_BASES[spelled])
        if spelled == "sequence" and not is_element:
            return self._sequence()
        reason = _REFUSED.get(spelled, f"rosidl has no {spelled} here; use a struct for it")
        raise PlaceError(word.offset, reason)

    def _spelled(self) -> str:
        """Read the one, two or three words of a type that is built in."""
        words = [self.name("a type").text]
        if words == ["unsigned"]:
            if self.next.text not in {"short", "long"}:
                raise unexpected("short or long", self.next)
            words.append(self.take().text)
        if words[-1] == "long" and self.next.text in {"long", "double"}:
            words.append(self.take().text)
        return " ".join(words)

    def _sequence(self) -> FieldType:
        self.expect("<")
        element = self._type(is_element=True)
        bound = self.size() if self.takes(",") else None
        self.expect(">")
        return replace(element, is_sequence=True, bound=bound)

    def _named(self, *, is_element: bool) -> FieldType:
        """Read the name of a typedef or of a message."""
        offset = self.next.offset
        match self.scoped_name("a type"):
            case [name] if name in self._typedefs:
                found = self._typedefs[name]
            case [_, "msg", _] as names:
                found = FieldType("/".join(names))
            case names:
                spelled = IdlToken("name", "::".join(names), offset)
                raise unexpected("a type: a typedef from above, or PACKAGE::msg::NAME", spelled)
        if is_element and found.is_array:
            raise PlaceError(
                offset, f"rosidl has no sequence of {shortened(str(found))}; use a struct for it"
            )
        return found
