# SPDX-License-Identifier: Apache-2.0
"""The parser of `.msg` texts."""

import pytest

from schemas.definition import Constant, DefinitionError, FieldType
from schemas.definition_text import parse_definition


def parse(text):
    return parse_definition("some_msgs/msg/Thing", text)


def only_field(line):
    (field,) = parse(line).fields
    return field


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("float64 x", FieldType("float64")),
        ("float64[] x", FieldType("float64", is_sequence=True)),
        ("float64[9] x", FieldType("float64", length=9)),
        ("float64[<=9] x", FieldType("float64", is_sequence=True, bound=9)),
        ("string<=5 x", FieldType("string", string_bound=5)),
        ("string<=5[<=2] x", FieldType("string", is_sequence=True, bound=2, string_bound=5)),
        ("Other x", FieldType("some_msgs/msg/Other")),
        ("std_msgs/Header x", FieldType("std_msgs/msg/Header")),
        ("std_msgs/msg/Header[3] x", FieldType("std_msgs/msg/Header", length=3)),
        ("time x", FieldType("builtin_interfaces/msg/Time")),
    ],
)
def test_a_field_type_is_read_in_every_notation(line, expected):
    assert only_field(line).type == expected


@pytest.mark.parametrize("text", ["float64[]", "string<=5[<=2]", "a_msgs/msg/B[3]", "wstring"])
def test_a_field_type_prints_as_it_was_written(text):
    assert str(only_field(f"{text} x").type) == text


@pytest.mark.parametrize(
    ("line", "default"),
    [
        ("bool x true", True),
        ("int32 x -5", -5),
        ("int32 x 0x10", 16),
        ("int32 x 010", 10),
        ("int32[] x [010, 0b11]", (10, 3)),
        ("float32 x 1e3", 1000.0),
        ("string x hello", "hello"),
        ('string x "a # b"', "a # b"),
        ("string x 'a=b'", "a=b"),
        ("int8[] x [1, -2]", (1, -2)),
        ("bool[2] x [true, false]", (True, False)),
        ("string[] x ['a', 'b, c']", ("a", "b, c")),
        ('string[] x ["a", b c,]', ("a", "b c")),
        (r"string[] x ['it\'s', '\n']", ("it's", r"\n")),
        ("string[] x []", ()),
        ("uint8 x", None),
    ],
)
def test_a_default_is_read_in_every_notation(line, default):
    assert only_field(line).default == default


@pytest.mark.parametrize(
    "line",
    [
        "float64\tx",
        "int32 x\t5",
        "int32\t X=1",
        "int32\tX\t=\t1\t",
        "uint8[<=3]\t\tx \t [1,\t2]",
        'string x\t"a\tb"',
        "string<=3\tx ab\t# beside",
        "int32 x 010",
        "int64 x -0x10",
        "uint8 X=0b101",
        "uint8 x 1_0",
        "float32 x\t1e-3",
        "bool[2] x [True,\t0]",
        "string[] x ['a', \"b, c\", d e]",
        r"string[] x ['it\'s', '\n',]",
        "std_msgs/Header\tx",
    ],
)
def test_a_line_is_read_as_rosidl_reads_it(line):
    rosidl = pytest.importorskip("rosidl_adapter.parser")
    theirs = rosidl.parse_message_string("some_msgs", "Thing", line)
    ours = parse(line)

    def read(field):
        default = list(field.default) if isinstance(field.default, tuple) else field.default
        return field.name, str(field.type).replace("/msg/", "/"), default

    assert [read(field) for field in ours.fields] == [
        (f.name, str(f.type), f.default_value) for f in theirs.fields
    ]
    assert [(c.name, c.type, c.value) for c in ours.constants] == [
        (c.name, c.type, c.value) for c in theirs.constants
    ]


@pytest.mark.parametrize("name", [f"{'a' * 5000}-", f"{'a' * 5000}__", "\u017f", "\u212a"])
def test_a_name_of_any_length_is_read_at_once_and_has_letters_of_ascii(name):
    for line in (f"int32 {name}", f"int32 {name}=1"):
        with pytest.raises(DefinitionError, match="is no field name"):
            parse(line)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("int8[0] x", "a length is at least 1"),
        ("int8[<=0] x", "a length is at least 1"),
        ("wstring<=0 x", "a length is at least 1"),
        ("int8[3] x [1, 2]", "the default has 2 values, expected 3"),
        ("int8[<=2] x [1, 2, 3]", "the default has 3 values, at most 2"),
        ("string<=2 x 'abc'", "text has 3 bytes of UTF-8, at most 2 fit"),
        ("string<=2[] x ['ab', 'abc']", "text has 3 bytes of UTF-8, at most 2 fit"),
    ],
)
def test_sizes_of_which_no_message_can_be_made_are_refused_as_by_rosidl(line: str, words: str):
    with pytest.raises(DefinitionError, match=words):
        parse(line)
    rosidl = pytest.importorskip("rosidl_adapter.parser")
    with pytest.raises((TypeError, ValueError, rosidl.InvalidValue)):
        rosidl.parse_message_string("some_msgs", "Thing", line)


def test_the_text_of_a_definition_keeps_its_tabs():
    assert parse("float64\tx\n").text == "float64\tx\n"


def test_a_constant_is_told_from_a_field_with_a_default():
    definition = parse("uint8 RED=1\nstring NAME = 'x' # beside\nstring<=3 field 'a=b'")

    assert definition.constants == (
        Constant("RED", "uint8", 1),
        Constant("NAME", "string", "x", "beside"),
    )
    assert [field.name for field in definition.fields] == ["field"]


@pytest.mark.parametrize(
    ("text", "comments"),
    [
        ("# About it.\n#\n# More.\n\n# The x.\nint8 x\n", ["About it.\n\nMore.", "The x."]),
        ("# The x.\nint8 x\n", ["", "The x."]),  # a first block that touches a field is its own
        (
            "int8 x  # first\n        # second\n  # third\n# The y.\nint8 y",
            ["", "first\nsecond\nthird", "The y."],
        ),
        ("int8 x\n  # The y.\nint8 y", ["", "", "The y."]),
        ("int8 x # last", ["", "last"]),
    ],
)
def test_comments_describe_the_message_or_the_field_that_they_touch(text, comments):
    definition = parse(text)
    assert [definition.comment, *(field.comment for field in definition.fields)] == comments


def test_nested_types_are_named_once_in_order():
    definition = parse("B b\nother_msgs/A a\nB again\nint8 n")

    assert definition.nested() == ("some_msgs/msg/B", "other_msgs/msg/A")


@pytest.mark.parametrize(
    "line",
    [
        "int8",
        "int8 1x",
        "int8 x-y",
        "int8<=3 x",
        "int8[ x",
        "uint8 x 256",
        "int8 x word",
        "bool x 2",
        "Other x 1",
        "int8[] x 1",
        "a/b/c/d x",
    ],
)
def test_a_line_that_declares_nothing_raises_definition_error_with_its_number(line):
    with pytest.raises(DefinitionError, match="some_msgs/msg/Thing, line 2: "):
        parse(f"int8 ok\n{line}")


@pytest.mark.parametrize("text", ["int32 a\nbool a\n", "int32 X=1\nint32 X=1\n"])
def test_two_members_of_one_name_are_refused(text):
    with pytest.raises(DefinitionError, match=r"a_msgs/msg/A, line 2: the second member [aX]; re"):
        parse_definition("a_msgs/msg/A", text)
