# SPDX-License-Identifier: Apache-2.0
"""The installed definitions, compared with the descriptions that ROS installs beside them."""

import json

import pytest

from schemas.definition import DefinitionError
from schemas.installed import InstalledDefinitions, UnknownTypeError, installed_prefixes
from schemas.type_hash import _type_id


def descriptions():
    """Yield the REP-2011 description of every installed message."""
    for prefix in installed_prefixes():
        for path in sorted(prefix.glob("share/*/msg/*.json")):
            yield json.loads(path.read_bytes())["type_description_msg"]["type_description"]


def described_field(field):
    return {
        "name": field.name,
        "type": {
            "type_id": _type_id(field.type),
            "capacity": field.type.length or field.type.bound or 0,
            "string_capacity": field.type.string_bound or 0,
            "nested_type_name": "" if field.type.is_primitive else field.type.base,
        },
        "default_value": "" if field.default is None else str(field.default),
    }


def write_definition(prefix, name, text):
    package, _, short_name = name.split("/")
    path = prefix / "share" / package / "msg" / f"{short_name}.msg"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def test_every_installed_definition_reads_as_ros_describes_it():
    definitions = InstalledDefinitions()
    compared = 0
    for description in descriptions():
        definition = definitions.get(description["type_name"])
        expected = [
            field
            for field in description["fields"]
            if field["name"] != "structure_needs_at_least_one_member"
        ]
        assert [described_field(field) for field in definition.fields] == expected
        compared += 1
    assert compared > 120


def test_names_lists_the_types_of_the_packages_asked_for():
    names = InstalledDefinitions().names(["builtin_interfaces"])

    assert names == ["builtin_interfaces/msg/Duration", "builtin_interfaces/msg/Time"]


def test_closure_gives_nested_types_first_and_each_once():
    names = [
        definition.name
        for definition in InstalledDefinitions().closure(["geometry_msgs/msg/TwistStamped"])
    ]

    assert names == [
        "builtin_interfaces/msg/Time",
        "std_msgs/msg/Header",
        "geometry_msgs/msg/Vector3",
        "geometry_msgs/msg/Twist",
        "geometry_msgs/msg/TwistStamped",
    ]


def test_a_type_that_nests_itself_raises_definition_error(tmp_path):
    write_definition(tmp_path, "some_msgs/msg/A", "B b")
    write_definition(tmp_path, "some_msgs/msg/B", "A[] a")

    with pytest.raises(DefinitionError, match="some_msgs/msg/A nests itself"):
        InstalledDefinitions([tmp_path]).closure(["some_msgs/msg/A"])


def test_a_comment_in_another_encoding_is_no_obstacle(tmp_path):
    write_definition(tmp_path, "some_msgs/msg/A", "")
    path = tmp_path / "share/some_msgs/msg/A.msg"
    path.write_bytes("# Größe\nint8 x".encode("latin-1"))

    assert InstalledDefinitions([tmp_path]).get("some_msgs/msg/A").fields[0].name == "x"


def test_an_earlier_prefix_hides_a_later_one(tmp_path):
    write_definition(tmp_path / "overlay", "some_msgs/msg/Thing", "int8 ours")
    write_definition(tmp_path / "below", "some_msgs/msg/Thing", "int8 theirs")
    definitions = InstalledDefinitions([tmp_path / "overlay", tmp_path / "below"])

    assert definitions.get("some_msgs/msg/Thing").fields[0].name == "ours"


@pytest.mark.parametrize(
    "name", ["", "Thing", "some_msgs/Thing", "some_msgs/srv/Thing", "../msg/Thing", "a/msg/../B"]
)
def test_what_is_no_type_name_is_never_looked_up(tmp_path, name):
    with pytest.raises(UnknownTypeError, match="expected pkg/msg/Name"):
        InstalledDefinitions([tmp_path]).get(name)


def test_a_type_that_is_not_installed_raises_unknown_type_error(tmp_path):
    with pytest.raises(UnknownTypeError, match="no definition of some_msgs/msg/Thing"):
        InstalledDefinitions([tmp_path]).get("some_msgs/msg/Thing")


def test_overlays_come_before_the_python_environment(monkeypatch, tmp_path):
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path / 'a'}:{tmp_path / 'b'}")

    assert installed_prefixes()[:2] == (tmp_path / "a", tmp_path / "b")
