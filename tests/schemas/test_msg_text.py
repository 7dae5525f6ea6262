# SPDX-License-Identifier: Apache-2.0
"""A definition as the text of a .msg file."""

from schemas.definition import Constant, Definition, Field, FieldType
from schemas.definition_text import parse_definition
from schemas.msg_text import msg_text

NAME = "some_msgs/msg/Thing"


def read(text):
    definition = parse_definition(NAME, text)
    return definition.comment, definition.constants, definition.fields


def test_comments_stay_where_they_belong():
    for comment in ("", "one", "one\n\ntwo\n\n  three"):
        for above in ("", "first\nsecond"):
            definition = Definition(
                NAME,
                (Field("x", FieldType("uint8"), None, above), Field("y", FieldType("string"))),
                (Constant("A", "uint8", 1, above), Constant("B", "bool", True)),
                comment,
            )
            found = read(msg_text(definition))
            assert found == (comment, definition.constants, definition.fields)


def test_values_are_written_as_msg_files_have_them():
    fields = (
        Field("a", FieldType("bool"), False),
        Field("b", FieldType("float64", length=2), (1e300, -0.5)),
        Field("c", FieldType("string", string_bound=9), 'a "b" # c'),
        Field("d", FieldType("string", is_sequence=True), ('"', "a, b", "")),
        Field("e", FieldType("geometry_msgs/msg/Point", is_sequence=True, bound=3)),
    )
    text = msg_text(Definition(NAME, fields))
    assert text.splitlines()[0] == "bool a false"
    assert read(text) == ("", (), fields)


def test_no_character_of_a_text_ends_its_line():
    text = msg_text(
        Definition(
            NAME,
            (Field("x", FieldType("string"), "a\n\x85\\b", "one\r\ntwo\u2028three"),),
            comment="\x0cfour",
        )
    )
    assert text.count("\n") == len(text.splitlines())
    assert [line for line in text.splitlines() if line and not line.startswith("#")] == [
        r'string x "a\x0a\x85\\b"'
    ]


def test_an_empty_message_is_an_empty_text():
    assert msg_text(Definition(NAME, ())) == ""
