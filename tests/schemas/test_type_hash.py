# SPDX-License-Identifier: Apache-2.0
"""The REP-2011 hash."""

import dataclasses
import json

import pytest

from schemas.definition_text import parse_definition
from schemas.described import described_definitions
from schemas.idl import parse_idl_message
from schemas.installed import InstalledDefinitions
from schemas.type_hash import computed_type_hash, type_hash


def test_the_computed_hash_is_the_installed_one_for_every_type():
    definitions = InstalledDefinitions()
    for name in definitions.names():
        definition = definitions.get(name)
        assert computed_type_hash(definition, definitions) == definition.type_hash, name


def test_the_computed_hash_is_the_installed_one_for_every_part_of_a_service_or_an_action():
    definitions = InstalledDefinitions()
    for name in definitions.names(kind="srv") + definitions.names(kind="action"):
        for part in definitions.interface(name).parts.values():
            assert computed_type_hash(part, definitions) == part.type_hash, part.name


def test_a_type_without_installed_hash_gets_the_computed_one():
    definitions = InstalledDefinitions()
    definition = definitions.get("geometry_msgs/msg/Twist")

    assert type_hash(dataclasses.replace(definition, type_hash=None), definitions) == (
        definition.type_hash
    )


def test_defaults_and_comments_do_not_change_the_hash():
    plain = parse_definition("some_msgs/msg/Thing", "int8 x")
    adorned = parse_definition("some_msgs/msg/Thing", "# words\nint8 ONE=1\nint8 x 5 # more")
    other = parse_definition("some_msgs/msg/Thing", "int8 y")
    definitions = InstalledDefinitions([])

    assert computed_type_hash(plain, definitions) == computed_type_hash(adorned, definitions)
    assert computed_type_hash(plain, definitions) != computed_type_hash(other, definitions)


# All that a field can be in IDL, as type_description_interfaces/msg/FieldType lists it, except
# what rosidl makes no code for.
SINGLE = (
    "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float", "double",
    "char", "boolean", "octet", "string", "wstring", "string<5>", "wstring<5>", "a_msgs::msg::B",
)  # fmt: skip
EVERY_FIELD = """
module a_msgs { module msg {
TYPEDEFS
struct A { MEMBERS };
}; };
"""
NESTED = "module a_msgs { module msg { struct B { boolean on; }; }; };"


def every_field() -> str:
    typedefs = [f"typedef {kind} Fixed{number}[3];" for number, kind in enumerate(SINGLE)]
    forms = ("{kind}", "Fixed{number}", "sequence<{kind}, 4>", "sequence<{kind}>")
    members = [
        f"{form.format(kind=kind, number=number)} m{place}_{number};"
        for place, form in enumerate(forms)
        for number, kind in enumerate(SINGLE)
        # of which rosidl also takes the bound of the text for that of the sequence
        if (form, kind) != ("sequence<{kind}>", "wstring<5>")
    ]
    text = EVERY_FIELD.replace("TYPEDEFS", "\n".join(typedefs))
    return text.replace("MEMBERS", "\n".join(members))


@pytest.fixture(scope="module")
def hashed_by_rosidl(tmp_path_factory):
    """Return rosidl's hash and description of a message with every type of field."""
    rosidl = pytest.importorskip("rosidl_generator_type_description")
    folder = tmp_path_factory.mktemp("a_msgs")
    (folder / "msg").mkdir()
    (folder / "msg" / "A.idl").write_text(every_field())
    (folder / "msg" / "B.idl").write_text(NESTED)
    arguments = folder / "arguments.json"
    idl_tuples = [f"{folder}:msg/A.idl", f"{folder}:msg/B.idl"]
    asked = {"package_name": "a_msgs", "output_dir": str(folder), "idl_tuples": idl_tuples}
    arguments.write_text(json.dumps(asked))
    rosidl.generate_type_hash(str(arguments))
    return json.loads((folder / "msg" / "A.json").read_text())


def test_every_type_of_field_has_rosidls_hash_and_is_learned_from_its_description(hashed_by_rosidl):
    read = parse_idl_message("a_msgs/msg/A", every_field())
    nested = parse_idl_message("a_msgs/msg/B", NESTED)
    definitions = InstalledDefinitions([]).with_told({read.name: read, nested.name: nested})
    hashes = {each["type_name"]: each["hash_string"] for each in hashed_by_rosidl["type_hashes"]}
    assert computed_type_hash(read, definitions) == hashes[read.name]

    description = hashed_by_rosidl["type_description_msg"]
    told = described_definitions({"type_description": description, "type_sources": []})
    assert [(field.name, field.type) for field in told[read.name].fields] == [
        (field.name, field.type) for field in read.fields
    ]
