# SPDX-License-Identifier: Apache-2.0
"""Write the C# messages of the Unity client: a file per package, a class per message type.

A class has its ROS name and ``Msg``, so that none collides with UnityEngine or System. The parts of
services and actions are ``SetBoolRequest``, ``FibonacciGoal`` and so on. Each reads and writes
itself as JSON, without reflection.
"""

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Final

from schemas.definition import Constant, Definition, Field, FieldType
from schemas.generate.catalogue import GENERATED, Catalogue, by_package
from schemas.generate.csharp_table import table_source
from schemas.generate.csharp_text import (
    TYPES,
    ClassNames,
    constant_name,
    escaped,
    field_name,
    head,
    literal,
    namespace,
    summary,
    text_literal,
)

CSHARP_FOLDER: Final = "unity_client/client/Runtime/Messages/Generated"

_READS: Final = {
    "bool": "Bool",
    "byte": "UInt8",
    "char": "UInt8",
    "float32": "Float32",
    "float64": "Float64",
    "int8": "Int8",
    "int16": "Int16",
    "int32": "Int32",
    "int64": "Int64",
    "uint8": "UInt8",
    "uint16": "UInt16",
    "uint32": "UInt32",
    "uint64": "UInt64",
    "string": "String",
    "wstring": "String",
}
# A robot of ROS 2 has no use for them. A project can generate them.
_OF_ROS_1: Final = ("actionlib_msgs", "stereo_msgs")
# The Inspector stores a publisher's message with the name of its assembly, which was another one.
_MOVED: Final = (
    "#if UNITY_2021_3_OR_NEWER",
    '[UnityEngine.Scripting.APIUpdating.MovedFrom(false, null, "Ros2Gateway.Core")]',
    "#endif",
)
_INHERITED: Final = ("/// <inheritdoc/>",)
_LINE: Final = 112  # columns of a line in a class, which is indented
_KINDS: Final = {"srv": "Service", "action": "Action"}

# The gateway stamps a header that has no stamp. A stamp of 0 stays 0.
_UNSTAMPED: Final = ("std_msgs/msg/Header", "stamp")
_HEADER_REMARK: Final = """\
A stamp that nobody has set is not written, so that the gateway stamps the message when it arrives.
A stamp of 0 that was read, or assigned (<c>header.stamp = new TimeMsg()</c>), stays 0."""
_UNSET: Final = (
    ["private BuiltinInterfaces.TimeMsg _unset; // what stamp is until it is read or assigned"],
    [
        "/// <summary>A header that the gateway will stamp.</summary>",
        "public HeaderMsg() => _unset = this.stamp;",
    ],
)


def write(catalogue: Catalogue) -> dict[str, str]:
    """Return the file of each package, and that of the list of message types."""
    purposes = catalogue.purposes()
    classes = packaged(catalogue)
    names = [one.name for one in classes if "/msg/" in one.name]
    files = {f"{CSHARP_FOLDER}/MessageTable.cs": table_source(catalogue, names)}
    top = f"// SPDX-License-Identifier: Apache-2.0\n{head(GENERATED)}"
    for package, own in by_package(classes).items():
        text = file_of([namespace_of(package, own, purposes, _MOVED)], top)
        files[f"{CSHARP_FOLDER}/{namespace(package)}.cs"] = text
    return files


def packaged(catalogue: Catalogue) -> list[Definition]:
    """Return the messages whose classes come with the Unity package."""
    return [one for one in catalogue.messages() if one.name.split("/")[0] not in _OF_ROS_1]


def file_of(namespaces: Iterable[str], top: str) -> str:
    """Return the text of a file with some name spaces, below the comments at its *top*."""
    body = "\n".join(namespaces)
    return f"{top}\nusing System;\nusing Ros2Gateway.Json;\n\n{body}"


def namespace_of(
    package: str,
    definitions: Iterable[Definition],
    purposes: Mapping[str, str],
    attributes: Sequence[str] = (),
) -> str:
    """Return the name space of a package with the classes of some of its types.

    *attributes* are lines before each class of a message.
    """
    names = ClassNames(package)
    classes = [
        _class(one, names, purposes.get(one.name), attributes if "/msg/" in one.name else ())
        for one in definitions
    ]
    body = "\n\n".join("\n".join(_indented(lines)) for lines in classes)
    return f"namespace Ros2Gateway.Messages.{namespace(package)}\n{{\n{body}\n}}\n"


def _indented(lines: Iterable[str]) -> list[str]:
    return [f"    {line}" if line else line for line in lines]


def _class(
    definition: Definition, names: ClassNames, purpose: str | None, attributes: Sequence[str]
) -> list[str]:
    own = names.own(definition.name)
    members = {field.name: field_name(field.name, own) for field in definition.fields}
    blocks = [
        *_type_names(definition),
        *(_constant(constant, own, members.values()) for constant in definition.constants),
        *(_field(field, members[field.name], names) for field in definition.fields),
        _member_names(definition),
        *(_UNSET if definition.name == _UNSTAMPED[0] else ()),
        _ros_type(),
        _read(definition, members, names),
        _write(definition, members),
    ]
    body = [line for block in blocks for line in ["", *block]]
    remark = _HEADER_REMARK if definition.name == _UNSTAMPED[0] else ""
    parts = [f"{purpose}." if purpose else "", definition.comment]
    text = "\n\n".join(part for part in parts if part) or f"{definition.name}."
    return [
        *summary(escaped(text) + (f"\n\n{remark}" if remark else "")),
        *attributes,
        "[Serializable]",
        f"public sealed class {own} : IMessage",
        "{",
        *_indented(body[1:]),
        "}",
    ]


def _type_names(definition: Definition) -> list[list[str]]:
    name = text_literal(definition.name)
    blocks = [[*summary("The name of this type."), f"public const string Type = {name};"]]
    kind = definition.name.split("/")[1]
    if kind in _KINDS:
        interface = definition.name.rpartition("_")[0]
        what = _KINDS[kind]
        blocks.append(
            [
                *summary(f"The {what.lower()} that this is a part of."),
                f"public const string {what} = {text_literal(interface)};",
            ]
        )
    return blocks


def _constant(constant: Constant, own: str, fields: Collection[str]) -> list[str]:
    kind = TYPES[constant.type]
    name = constant_name(constant.name, own, fields)
    comment = escaped(constant.comment) or f"<c>{constant.type}</c>"
    value = literal(constant.type, constant.value)
    return [*summary(comment), f"public const {kind} {name} = {value};"]


def _field(field: Field, member: str, names: ClassNames) -> list[str]:
    kind = field.type
    comment = escaped(field.comment)
    ros = f"<c>{escaped(str(kind))}</c>"
    if not comment:
        comment = ros
    elif kind.length is not None or kind.bound is not None or kind.string_bound is not None:
        comment += f" ({ros})"
    element = _element(kind, names)
    array = "[]" if kind.is_array else ""
    default = _default(field, element)
    return [*summary(comment), f"public {element}{array} {member}{default};"]


def _element(kind: FieldType, names: ClassNames) -> str:
    return TYPES[kind.base] if kind.is_primitive else names[kind.base]


def _default(field: Field, element: str) -> str:
    """Return the initializer, or nothing if it is C#'s own default."""
    kind = field.type
    if not kind.is_array:
        if not kind.is_primitive:
            return " = new()"
        if field.default is None or isinstance(field.default, tuple):
            return ' = ""' if element == "string" else ""
        return f" = {literal(kind.base, field.default)}"
    if isinstance(field.default, tuple) and field.default:
        values = ", ".join(literal(kind.base, value) for value in field.default)
        return f" = new {element}[] {{ {values} }}"
    if kind.length is None:
        return f" = Array.Empty<{element}>()"
    if not kind.is_primitive:
        return f" = NestedMessages.Make({kind.length}, () => new {element}())"
    if element == "string":
        empty = ", ".join(['""'] * kind.length)
        return f" = new string[] {{ {empty} }}"
    return f" = new {element}[{kind.length}]"


def _member_names(definition: Definition) -> list[str]:
    start = "private static readonly JsonMembers Members = new("
    names = [text_literal(field.name) for field in definition.fields]
    line = f"{start}{', '.join(names)});"
    if len(line) <= _LINE:
        return [line]
    return [start, *(f"    {name}," for name in names[:-1]), f"    {names[-1]});"]


def _ros_type() -> list[str]:
    return [*_INHERITED, "public string RosType => Type;"]


def _read(definition: Definition, members: Mapping[str, str], names: ClassNames) -> list[str]:
    cases: list[str] = []
    for index, field in enumerate(definition.fields):
        statement = _read_field(field.type, f"this.{members[field.name]}", names)
        mark = ["    _unset = null;"] if (definition.name, field.name) == _UNSTAMPED else []
        cases += [f"case {index}:", *mark, f"    {statement}", "    break;"]
    cases += ["default:", "    reader.Skip();", "    break;"]
    return [
        *_INHERITED,
        "public void Read(JsonReader reader)",
        "{",
        "    reader.BeginObject();",
        "    int member = JsonMembers.Unknown;",
        "    while (reader.NextMember(Members, ref member))",
        "    {",
        "        switch (member)",
        "        {",
        *(f"            {line}" for line in cases),
        "        }",
        "    }",
        "}",
    ]


def _read_field(kind: FieldType, member: str, names: ClassNames) -> str:
    length = "" if kind.length is None else f", {kind.length}"
    if kind.is_octets:
        return f"{member} = reader.ReadBytes({member}{length});"
    if kind.is_primitive and kind.is_array:
        return f"{member} = reader.Read{_READS[kind.base]}s({member}{length});"
    if kind.is_primitive:
        return f"{member} = reader.Read{_READS[kind.base]}();"
    element = names[kind.base]
    if kind.is_array:
        return f"{member} = NestedMessages.Read({member}, reader, () => new {element}(){length});"
    return f"({member} ??= new {element}()).Read(reader);"


def _write(definition: Definition, members: Mapping[str, str]) -> list[str]:
    lines: list[str] = []
    for field in definition.fields:
        statements = _write_field(field, f"this.{members[field.name]}")
        if (definition.name, field.name) == _UNSTAMPED:
            is_set = "this.stamp != _unset || this.stamp.sec != 0 || this.stamp.nanosec != 0"
            condition = f"this.stamp != null && ({is_set})"
            statements = [f"if ({condition})", "{", *_indented(statements), "}"]
        lines += statements
    return [
        *_INHERITED,
        "public void Write(JsonWriter writer)",
        "{",
        "    writer.BeginObject();",
        *_indented(lines),
        "    writer.EndObject();",
        "}",
    ]


def _write_field(field: Field, member: str) -> list[str]:
    kind = field.type
    name = text_literal(field.name)
    statements = [f"writer.Name({name});"]
    if kind.length is not None:
        check = f"NestedMessages.CheckLength({member}, {name}, {kind.length});"
        statements.insert(0, check)
    if kind.is_octets:
        call = f"writer.Base64({member})"
    elif kind.is_primitive:
        call = f"writer.Value{'s' if kind.is_array else ''}({member})"
    else:
        call = f"NestedMessages.Write(writer, {member})"
    return [*statements, f"{call};"]
