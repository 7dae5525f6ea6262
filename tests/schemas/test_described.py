# SPDX-License-Identifier: Apache-2.0
"""The types that nodes describe. tests/e2e/test_learned_types.py asks real ones."""

from typing import Any

import pytest

from schemas import described
from schemas.definition import DefinitionError
from schemas.described import described_definitions
from schemas.installed import InstalledDefinitions
from schemas.type_hash import type_description

INSTALLED = InstalledDefinitions()


def answer(name: str, *sources: dict[str, str]) -> dict[str, Any]:
    return {
        "type_description": type_description(INSTALLED.get(name), INSTALLED),
        "type_sources": list(sources),
    }


def source(name: str, text: str, encoding: str = "msg") -> dict[str, str]:
    return {"type_name": name, "encoding": encoding, "raw_file_contents": text}


def field(**type_members: Any) -> dict[str, Any]:
    members = {"type_id": 6, "capacity": 0, "string_capacity": 0, "nested_type_name": ""}
    return {"name": "x", "type": members | type_members}


def of_fields(*fields: dict[str, Any]) -> dict[str, Any]:
    description = {"type_name": "my_msgs/msg/Told", "fields": list(fields)}
    nothing: list[Any] = []
    return {
        "type_description": {
            "type_description": description,
            "referenced_type_descriptions": nothing,
        },
        "type_sources": nothing,
    }


def test_a_description_has_the_fields_of_every_installed_message():
    for name in INSTALLED.names():
        told = described_definitions(answer(name))
        assert told.keys() == {each.name for each in INSTALLED.closure([name])}
        for each in told.values():
            fields = INSTALLED.get(each.name).fields
            expected = [(field.name, str(field.type)) for field in fields]
            assert [(field.name, str(field.type)) for field in each.fields] == expected


def test_the_source_has_comments_and_constants_in_addition_to_the_fields():
    name = "sensor_msgs/msg/NavSatStatus"
    text = INSTALLED.get(name).text
    told = described_definitions(answer(name, source(name, text)))[name]
    assert told.text == text
    assert told.constants == INSTALLED.get(name).constants != ()


@pytest.mark.parametrize(
    ("text", "encoding"),
    [
        ("int64 data\n", "msg"),  # it has string data
        ("string data\nstring other", "msg"),
        ("string data\n", "implicit"),  # rosidl's word where there was no file
        ("", "msg"),
        (f"string data # {'x' * described.MAX_TEXT_CHARACTERS}", "msg"),
    ],
)
def test_a_source_that_says_something_else_is_not_used(text: str, encoding: str):
    name = "std_msgs/msg/String"
    told = described_definitions(answer(name, source(name, text, encoding)))[name]
    assert told.text == "string data\n"


@pytest.mark.parametrize(
    ("told", "words"),
    [
        (field(type_id=0), "my_msgs/msg/Told: a field has the type 0, which no ROS message has"),
        (field(type_id=12), "the type 12"),  # long double
        (field(type_id=255), "the type 255"),
        (field(type_id=48), "the type 48"),  # an array of nothing
        (field(type_id=1, nested_type_name="a b"), "a my_msgs/msg/a has no literal"),
        (field() | {"name": "x\nint32"}, "line 2: '' is no field name"),
        (field() | {"name": "__import__('os')"}, "is no field name"),
        (field(type_id=1, nested_type_name="a/b/c/d"), "is not a valid type name"),
    ],
)
def test_an_invalid_message_is_refused_with_a_reason(told: dict[str, Any], words: str):
    with pytest.raises(DefinitionError, match=words):
        described_definitions(of_fields(told))


def test_how_much_is_read_is_bounded(monkeypatch):
    monkeypatch.setattr(described, "MAX_TEXT_CHARACTERS", 20)
    with pytest.raises(DefinitionError, match="my_msgs/msg/Told: its text has over 20 characters"):
        described_definitions(of_fields(*(field() | {"name": f"x{n}"} for n in range(3))))
    monkeypatch.setattr(described, "MAX_DESCRIBED_TYPES", 1)
    with pytest.raises(DefinitionError, match="nests 2 types, at most 1 are read"):
        described_definitions(answer("std_msgs/msg/Header") | two_nested())


def two_nested() -> dict[str, Any]:
    one = {"type_name": "my_msgs/msg/Nested", "fields": []}
    told = of_fields()["type_description"] | {"referenced_type_descriptions": [one, one]}
    return {"type_description": told}
