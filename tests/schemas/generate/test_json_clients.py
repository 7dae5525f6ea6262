# SPDX-License-Identifier: Apache-2.0
"""JSON Schemas for clients are those of `ros2-gateway schema`."""

import json

import pytest

from gateway.codec.json import dumps
from gateway.codec.types import Types
from schemas.build import json_schema
from schemas.generate.json_clients import files, text
from schemas.installed import InstalledDefinitions
from tests.messages import RandomMessages, to_json
from tests.schemas.generate.client_code import (
    GENERATED,
    awkward_definitions,
    names_of_messages,
    request_of,
    request_of_everything,
)

NOW_NS = 1_700_000_000_123_456_789


def test_each_type_has_a_file_with_the_schema_of_the_other_command():
    definitions = InstalledDefinitions()
    made = files(request_of_everything(definitions))
    assert len(made) == len(definitions.all_names())
    for source in made.values():
        schema = json.loads(source)
        assert schema.pop("$comment") == GENERATED
        assert schema == json_schema(schema["title"], definitions)


def test_services_and_actions_have_separate_folders():
    names = ("std_msgs/msg/String", "std_srvs/srv/SetBool", "test_msgs/action/Fibonacci")
    assert list(files(request_of(*names))) == [
        "std_msgs/String.json",
        "std_srvs/srv/SetBool.json",
        "test_msgs/action/Fibonacci.json",
    ]


def test_the_text_of_one_type_is_its_schema():
    schema = json.loads(text(request_of("geometry_msgs/msg/Twist")))
    assert schema.pop("$comment") == GENERATED
    assert schema == json_schema("geometry_msgs/msg/Twist", InstalledDefinitions())


def test_the_text_of_several_has_them_side_by_side():
    names = ("geometry_msgs/msg/Twist", "std_srvs/srv/SetBool")
    schema = json.loads(text(request_of(*names)))
    assert sorted(schema["$defs"]) == [
        "geometry_msgs.msg.Twist",
        "geometry_msgs.msg.Vector3",
        "std_srvs.srv.SetBool",
    ]
    twist = schema["$defs"]["geometry_msgs.msg.Twist"]
    assert twist["properties"]["linear"]["$ref"] == "#/$defs/geometry_msgs.msg.Vector3"
    assert schema["$defs"]["std_srvs.srv.SetBool"]["required"] == ["request", "response"]


def test_each_message_that_the_gateway_sends_fits_its_schema(tmp_path):
    jsonschema = pytest.importorskip("jsonschema", reason="pip install jsonschema")
    definitions = awkward_definitions(tmp_path)
    types = Types(definitions)
    schemas = json.loads(text(request_of_everything(definitions)))
    assert schemas["$defs"]
    for name in names_of_messages(definitions):
        validator = validator_of(jsonschema, schemas, name)
        for seed in range(2):
            values = to_json(RandomMessages(definitions, seed, longest=2).message(name))
            cdr = types.get(name).encode(values, now_ns=NOW_NS)
            validator.validate(json.loads(dumps(types.get(name).decode(cdr))))
        assert not validator.is_valid({"nonsense": 1})


def validator_of(jsonschema, schemas, name):
    package, kind, rest = name.split("/")
    short, _, role = rest.partition("_")
    path = f"#/$defs/{package}.{kind}.{short}"
    reference = f"{path}/properties/{role.lower()}" if role else path
    schema = {"$schema": schemas["$schema"], "$defs": schemas["$defs"], "$ref": reference}
    return jsonschema.Draft202012Validator(schema)
