# SPDX-License-Identifier: Apache-2.0
"""The JSON Schemas."""

import pytest

from schemas.build import Models
from schemas.definition_text import parse_definition
from schemas.generate.json_schemas import schema_of
from schemas.installed import InstalledDefinitions


def property_of(line):
    definition = parse_definition("some_msgs/msg/Thing", line)
    (schema,) = schema_of(definition, [], "RIHS01_0")["properties"].values()
    return schema


def references(schema):
    match schema:
        case {"$ref": str(reference)}:
            yield reference
    for value in schema.values() if isinstance(schema, dict) else schema:
        if isinstance(value, dict | list):
            yield from references(value)


FLOAT = {"type": ["number", "null", "string"], "pattern": "^(NaN|-?Infinity)$"}


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("bool x", {"type": "boolean"}),
        ("int16 x 5", {"type": "integer", "minimum": -32768, "maximum": 32767, "default": 5}),
        ("float64 x", FLOAT),
        ("float64 x nan", {**FLOAT, "default": None}),
        (
            "float64[2] x # two",
            {
                "description": "two",
                "type": "array",
                "items": FLOAT,
                "minItems": 2,
                "maxItems": 2,
            },
        ),
        ("string<=5 x", {"type": "string", "pattern": "^[^\\u0000]*$", "maxLength": 5}),
        ("a_msgs/A x", {"$ref": "#/$defs/a_msgs.msg.A"}),
        (
            "uint8[<=4] x",
            {
                "anyOf": [
                    {"type": "string", "contentEncoding": "base64", "maxLength": 8},
                    {
                        "type": "array",
                        "items": {"type": "integer", "minimum": 0, "maximum": 255},
                        "maxItems": 4,
                    },
                ]
            },
        ),
    ],
)
def test_a_field_is_described_as_the_wire_carries_it(line, expected):
    assert property_of(line) == expected


def test_every_schema_has_the_fields_of_its_model_and_no_loose_reference():
    models = Models.installed()
    for name in InstalledDefinitions().names():
        schema = models.json_schema(name)
        if name not in {"builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration"}:
            fields = {
                field.alias or attribute
                for attribute, field in models.get(name).model_fields.items()
            }
            assert schema["properties"].keys() - {"seq"} == fields, name
            assert schema["additionalProperties"] is False
        for reference in references(schema):
            assert reference.removeprefix("#/$defs/") in schema["$defs"]


def test_a_time_may_be_spelt_in_three_ways():
    forms = Models.installed().json_schema("builtin_interfaces/msg/Time")["anyOf"]

    assert [list(form.get("properties", form)) for form in forms] == [
        ["sec", "nanosec"],
        ["secs", "nsecs"],
        ["description", "const"],
    ]


@pytest.mark.parametrize("kind", ["srv", "action"])
def test_the_schema_of_a_service_or_an_action_holds_those_of_its_parts(kind):
    models = Models.installed()
    for name in InstalledDefinitions().names(kind=kind):
        schema = models.json_schema(name)
        parts = InstalledDefinitions().interface(name).parts
        assert schema["title"] == name
        assert list(schema["properties"]) == schema["required"] == list(parts)
        assert schema["x-ros-type-hash"].startswith("RIHS01_")
        for role, part in parts.items():
            inner = schema["properties"][role]
            alone = models.json_schema(part.name)
            assert alone.pop("$defs", {}).items() <= schema.get("$defs", {}).items()
            assert {"$schema": schema["$schema"], **inner} == alone
        for reference in references(schema):
            assert reference.removeprefix("#/$defs/") in schema["$defs"]


def test_constants_and_the_type_hash_are_told():
    schema = Models.installed().json_schema("sensor_msgs/msg/NavSatStatus")

    assert schema["x-ros-constants"]["STATUS_NO_FIX"] == -1
    assert schema["x-ros-type-hash"].startswith("RIHS01_")
