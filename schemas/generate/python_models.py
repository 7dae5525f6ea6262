# SPDX-License-Identifier: Apache-2.0
"""Write Pydantic models: a module per package, a class per message type.

The parts of services and actions are classes like the others, with rosidl's names
(``SetBool_Request``). No message has an underscore in its name.
`schemas.build` executes the same text, one class at a time, for types outside the table.
"""

import json
import math
from collections.abc import Iterable, Mapping
from typing import Final

from schemas.definition import Constant, Definition, Field, FieldType, Scalar, Value
from schemas.generate.catalogue import GENERATED, Catalogue, by_package
from schemas.naming import attribute, class_name, constant_attribute, module_name

_LINE_LENGTH: Final = 100

_TYPES: Final = {
    "bool": "ros.Bool",
    "byte": "ros.UInt8",
    "char": "ros.UInt8",
    "float32": "ros.Float32",
    "float64": "ros.Float64",
    "int8": "ros.Int8",
    "int16": "ros.Int16",
    "int32": "ros.Int32",
    "int64": "ros.Int64",
    "uint8": "ros.UInt8",
    "uint16": "ros.UInt16",
    "uint32": "ros.UInt32",
    "uint64": "ros.UInt64",
    "string": "ros.String",
    "wstring": "ros.WString",
}
_STRING_BOUNDS: Final = {"string": "ros.Utf8Bound", "wstring": "ros.Utf16Bound"}
_ZEROS: Final[Mapping[str, Scalar]] = {
    "bool": False,
    "float32": 0.0,
    "float64": 0.0,
    "string": "",
    "wstring": "",
}

# The types with special rules, written by hand in schemas.message.
_BASES: Final = {
    "builtin_interfaces/msg/Duration": "ros.DurationMessage",
    "builtin_interfaces/msg/Time": "ros.TimeMessage",
    "std_msgs/msg/Header": "ros.HeaderMessage",
}


def write(catalogue: Catalogue) -> dict[str, str]:
    """Return the module of each package, and the ``__init__`` of the package around them."""
    head = f"# SPDX-License-Identifier: Apache-2.0\n# {GENERATED}\n"
    files = {"schemas/models/__init__.py": f'{head}"""Models of the types of the table."""\n'}
    for package, definitions in by_package(catalogue.messages()).items():
        text = module_of(package, definitions, catalogue, "schemas.models.")
        files[f"schemas/models/{module_name(package)}.py"] = head + text
    return files


def module_of(
    package: str, definitions: Iterable[Definition], catalogue: Catalogue, beside: str
) -> str:
    """Return the module of a package. *beside* comes before the names of the others it imports."""
    own = list(definitions)
    names = class_names(own)
    known = {definition.name for definition in own}
    imports = _imports({name: names[name] for name in sorted(names.keys() - known)}, beside)
    docstring = f'"""Models of the types of {package}."""\n\n'
    return "\n\n".join([docstring + imports, *class_sources(own, catalogue, names)])


def class_sources(
    definitions: Iterable[Definition], catalogue: Catalogue, names: Mapping[str, str]
) -> list[str]:
    """Return the classes of some types of a catalogue. *names* are as for `class_source`."""
    purposes = catalogue.purposes()
    return [
        class_source(one, catalogue.hashes[one.name], names, purposes.get(one.name))
        for one in definitions
    ]


def class_names(definitions: Iterable[Definition]) -> dict[str, str]:
    """Return the names of the classes in a module: of *definitions* and their nested types.

    It is the short name, unless a type of another package has taken it.
    """
    own = list(definitions)
    names = {definition.name: class_name(definition.short_name) for definition in own}
    for name in sorted({nested for definition in own for nested in definition.nested()}):
        if name not in names:
            short = class_name(name.rsplit("/", 1)[1])
            names[name] = prefixed(name) if short in names.values() else short
    return names


def prefixed(name: str) -> str:
    """Return a class name with the package before it: ``StdMsgsString``."""
    package, _, short = name.split("/")
    return "".join(word.capitalize() for word in package.split("_")) + short


def class_source(
    definition: Definition, type_hash: str, names: Mapping[str, str], purpose: str | None = None
) -> str:
    """Return the class of one type. *names* are the classes it can see, by ``pkg/msg/Name``.

    The text needs ``ros`` (schemas.message) and the nested classes in its name space.
    """
    base = _BASES.get(definition.name, "ros.Message")
    lines = [
        f"class {names[definition.name]}({base}):",
        *_docstring(definition, purpose),
        "",
        f"    ros_type: ros.ClassVar[str] = {_literal(definition.name)}",
        *_wrapped("    ros_type_hash: ros.ClassVar[str] = ", _literal(type_hash)),
    ]
    if definition.fields:
        lines.append("")
    for field in definition.fields:
        lines += _field(field, names)
    # Constants come last: a class body sees the names above, so none can hide a type of a field.
    if definition.constants:
        lines.append("")
    for constant in definition.constants:
        lines += _constant(constant)
    return "\n".join(lines) + "\n"


def _imports(names: Mapping[str, str], beside: str) -> str:
    by_package: dict[str, list[str]] = {}
    for name, python_name in names.items():
        package, _, short_name = name.split("/")
        short = class_name(short_name)
        renamed = "" if python_name == short else f" as {python_name}"
        by_package.setdefault(package, []).append(f"{short}{renamed}")
    lines = ["from schemas import message as ros"]
    for package, classes in by_package.items():
        line = f"from {beside}{module_name(package)} import {', '.join(classes)}"
        if len(line) > _LINE_LENGTH:
            inner = "".join(f"    {name},\n" for name in classes)
            line = f"from {beside}{module_name(package)} import (\n{inner})"
        lines.append(line)
    return "\n".join(lines) + "\n"


def _docstring(definition: Definition, purpose: str | None) -> list[str]:
    parts = [f"{purpose}." if purpose else "", definition.comment]
    text = "\n\n".join(part for part in parts if part) or f"{definition.name}."
    escaped = _printable(text).replace("\\", "\\\\").replace('"""', '\\"\\"\\"')
    first, *rest = escaped.split("\n")
    if not rest and not first.endswith('"') and len(first) <= _LINE_LENGTH - 10:
        return [f'    """{first}"""']
    return [
        f'    """{first}',
        *(f"    {line}".rstrip() for line in rest),
        '    """',
    ]


def _field(field: Field, names: Mapping[str, str]) -> list[str]:
    annotation = _annotation(field.type, names)
    name = attribute(field.name)
    is_factory, default = _default(field, names)
    arguments = [f"{'default_factory' if is_factory else 'default'}={default}"]
    if name != field.name:
        arguments.append(f"alias={_literal(field.name)}")
    if field.type.length is not None:
        arguments += [f"min_length={field.type.length}", f"max_length={field.type.length}"]
    elif field.type.bound is not None:
        arguments.append(f"max_length={field.type.bound}")
    comment = _printable(field.comment)
    if len(arguments) == 1 and not is_factory and not comment:
        return [f"    {name}: {annotation} = {default}"]
    described = [*arguments, f"description={_literal(comment)}"] if comment else arguments
    line = f"    {name}: {annotation} = ros.Field({', '.join(described)})"
    if len(line) <= _LINE_LENGTH and "\n" not in comment:
        return [line]
    lines = [f"    {name}: {annotation} = ros.Field("]
    lines += [f"        {argument}," for argument in arguments]
    if comment:
        lines += _description(comment)
    return [*lines, "    )"]


def _description(comment: str) -> list[str]:
    pieces = comment.splitlines(keepends=True)
    if len(pieces) == 1:
        return [f"        description={_literal(comment)},"]
    return [
        "        description=(",
        *(f"            {_literal(piece)}" for piece in pieces),
        "        ),",
    ]


def _annotation(field_type: FieldType, names: Mapping[str, str]) -> str:
    if field_type.is_octets:
        return "ros.Octets"
    base = _TYPES.get(field_type.base) or names[field_type.base]
    if field_type.string_bound is not None:
        bound = f"{_STRING_BOUNDS[field_type.base]}({field_type.string_bound})"
        base = f"ros.Annotated[{base}, {bound}]"
    return f"ros.Array[{base}]" if field_type.is_array else base


def _default(field: Field, names: Mapping[str, str]) -> tuple[bool, str]:
    """Return the source of a default, and whether it is a factory."""
    field_type = field.type
    if not field_type.is_primitive:
        name = names[field_type.base]
        if not field_type.is_array:
            return True, name
        if field_type.length is None:
            return True, "list"
        return True, f"lambda: [{name}() for _ in range({field_type.length})]"
    zero = _ZEROS.get(field_type.base, 0)
    if not field_type.is_array:
        default = zero if field.default is None else field.default
        return False, _literal(default)
    values = (zero,) * (field_type.length or 0)
    if isinstance(field.default, tuple):
        values = field.default
    if field_type.is_octets:
        octets = bytes(int(value) for value in values)
        return False, f"bytes({len(octets)})" if octets and not any(octets) else repr(octets)
    if not values:
        return True, "list"
    if field.default is None:
        return True, f"ros.fresh([{_literal(zero)}] * {len(values)})"
    return True, f"ros.fresh([{', '.join(_literal(value) for value in values)}])"


def _constant(constant: Constant) -> list[str]:
    kind = type(constant.value).__name__
    name = constant_attribute(constant.name)
    value = _literal(constant.value)
    if value == "None":
        kind, value = "float", 'float("nan")'  # a constant can be NaN. A field holds None for it
    line = f"    {name}: ros.ClassVar[{kind}] = {value}"
    comment = _printable(constant.comment)
    if "\n" not in comment:
        beside = f"{line}  # {comment}" if comment else line
        if len(beside) <= _LINE_LENGTH:
            return [beside]
    return [*(f"    # {above}".rstrip() for above in comment.splitlines()), line]


def _wrapped(start: str, value: str) -> list[str]:
    if len(start) + len(value) <= _LINE_LENGTH:
        return [start + value]
    return [f"{start}(", f"        {value}", "    )"]


def _literal(value: Value) -> str:
    match value:
        case str():
            return json.dumps(value, ensure_ascii=False)
        case float() if math.isnan(value):
            return "None"
        case float() if math.isinf(value):
            return f'float("{value}")'
        case _:
            return repr(value)


def _printable(text: str) -> str:
    """Drop control characters, which would end a line or the whole source."""
    return "".join(c for c in text.replace("\t", "    ") if c.isprintable() or c == "\n")
