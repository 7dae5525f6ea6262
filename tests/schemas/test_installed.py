# SPDX-License-Identifier: Apache-2.0
"""The installed definitions, compared with the descriptions that ROS installs next to them."""

import difflib
import errno
import json
from pathlib import Path
from unittest.mock import Mock

import pytest

from schemas.definition import DefinitionError
from schemas.installed import InstalledDefinitions, UnknownTypeError, installed_prefixes
from schemas.type_hash import _type_id
from tests.messages import ros_class


def descriptions():
    """Yield the REP-2011 description of every installed message."""
    for prefix in installed_prefixes():
        for path in sorted(prefix.glob("share/*/msg/*.json")):
            yield json.loads(path.read_bytes())["type_description_msg"]["type_description"]


def descriptions_of_parts():
    """Yield those of the parts of every installed service and action."""
    for kind in ("srv", "action"):
        definitions = InstalledDefinitions()
        for name in definitions.names(kind=kind):
            package, _, short_name = name.split("/")
            (path,) = (
                path
                for prefix in installed_prefixes()
                if (path := prefix / "share" / package / kind / f"{short_name}.json").is_file()
            )
            described = json.loads(path.read_bytes())["type_description_msg"]
            by_name = {one["type_name"]: one for one in described["referenced_type_descriptions"]}
            for part in definitions.interface(name).parts.values():
                yield by_name[part.name]


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
    package, kind, short_name = name.split("/")
    path = prefix / "share" / package / kind / f"{short_name}.{kind}"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def write_idl(prefix, name, body):
    package, kind, short_name = name.split("/")
    write_definition(prefix, name, "")
    path = prefix / "share" / package / kind / f"{short_name}.{kind}"
    path.unlink()
    text = f"module {package} {{ module {kind} {{ {body} }}; }};"
    path.with_suffix(".idl").write_text(text, encoding="utf-8")


@pytest.mark.parametrize(
    ("described", "at_least"), [(descriptions, 120), (descriptions_of_parts, 60)]
)
def test_every_installed_definition_reads_as_ros_describes_it(described, at_least):
    definitions = InstalledDefinitions()
    compared = 0
    for description in described():
        definition = definitions.get(description["type_name"])
        expected = [
            field
            for field in description["fields"]
            if field["name"] != "structure_needs_at_least_one_member"
        ]
        assert [described_field(field) for field in definition.fields] == expected
        compared += 1
    assert compared > at_least


def test_names_lists_the_types_of_the_packages_asked_for():
    names = InstalledDefinitions().names(["builtin_interfaces"])

    assert names == ["builtin_interfaces/msg/Duration", "builtin_interfaces/msg/Time"]


def test_names_lists_services_and_actions_too():
    definitions = InstalledDefinitions()

    assert definitions.names(["std_srvs"], kind="srv") == [
        "std_srvs/srv/Empty",
        "std_srvs/srv/SetBool",
        "std_srvs/srv/Trigger",
    ]
    assert definitions.names(["test_msgs"], kind="action") == [
        "test_msgs/action/Fibonacci",
        "test_msgs/action/NestedMessage",
    ]
    assert definitions.all_names() == (
        definitions.names() + definitions.names(kind="srv") + definitions.names(kind="action")
    )


def idl_type(field_type):
    """Write a type as rclpy's classes do."""
    base = {"float64": "double", "float32": "float", "bool": "boolean", "byte": "octet"}.get(
        field_type.base, field_type.base
    )
    base = base.replace("/msg/", "/")
    if field_type.string_bound is not None:
        base = f"{base}<{field_type.string_bound}>"
    if field_type.length is not None:
        return f"{base}[{field_type.length}]"
    if not field_type.is_sequence:
        return base
    return (
        f"sequence<{base}>" if field_type.bound is None else f"sequence<{base}, {field_type.bound}>"
    )


@pytest.mark.parametrize(
    "name", [name for kind in ("srv", "action") for name in InstalledDefinitions().names(kind=kind)]
)
def test_every_part_of_a_service_or_an_action_has_the_fields_of_rclpys_class(name):
    definitions = InstalledDefinitions()
    for role, part in definitions.interface(name).parts.items():
        assert part.name == f"{name}_{role.capitalize()}"
        assert definitions.get(part.name) == part
        expected = ros_class(part.name).get_fields_and_field_types()
        fields = {field.name: idl_type(field.type) for field in part.fields}
        assert list(fields.items()) == list(expected.items()), part.name


def test_a_part_and_its_whole_are_read_once(tmp_path):
    write_definition(tmp_path, "some_msgs/srv/Thing", "int8 a\n---\nint8 b")
    definitions = InstalledDefinitions([tmp_path])
    service = definitions.interface("some_msgs/srv/Thing")

    assert definitions.get("some_msgs/srv/Thing_Response") is service.parts["response"]
    assert definitions.get_any("some_msgs/srv/Thing") is service
    assert definitions.get_any("some_msgs/srv/Thing_Request") is service.parts["request"]
    assert service.type_hash is None


@pytest.mark.parametrize(
    "name",
    ["", "SetBool", "std_srvs/SetBool", "std_srvs/msg/SetBool", "std_srvs/srv/SetBool_Request"],
)
def test_an_invalid_service_or_action_name_is_never_looked_up(name):
    definitions = InstalledDefinitions()
    with pytest.raises(UnknownTypeError, match="expected pkg/srv/Name or pkg/action/Name"):
        definitions.interface(name)


@pytest.mark.parametrize("name", ["some_msgs/srv/Thing", "some_msgs/action/Thing"])
def test_a_service_that_is_not_installed_is_named_without_its_part(tmp_path, name):
    definitions = InstalledDefinitions([tmp_path])
    part = f"{name}_{'Request' if '/srv/' in name else 'Goal'}"
    for look_up, asked in ((definitions.interface, name), (definitions.get, part)):
        with pytest.raises(UnknownTypeError) as caught:
            look_up(asked)
        assert str(caught.value) == f"no definition of {name} is installed"


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


def test_a_comment_in_another_encoding_is_read(tmp_path):
    write_definition(tmp_path, "some_msgs/msg/A", "")
    path = tmp_path / "share/some_msgs/msg/A.msg"
    path.write_bytes("# Größe\nint8 x".encode("latin-1"))

    assert InstalledDefinitions([tmp_path]).get("some_msgs/msg/A").fields[0].name == "x"


def test_a_type_may_be_defined_by_idl_alone(tmp_path):
    write_idl(tmp_path, "some_msgs/msg/Thing", "struct Thing { a_msgs::msg::Other x; };")
    write_definition(tmp_path, "a_msgs/msg/Other", "int8 y")
    write_idl(
        tmp_path, "some_msgs/srv/Do", "struct Do_Request {long a;}; struct Do_Response {long b;};"
    )
    definitions = InstalledDefinitions([tmp_path])

    closure = definitions.closure(["some_msgs/msg/Thing"])
    assert [definition.name for definition in closure] == [
        "a_msgs/msg/Other",
        "some_msgs/msg/Thing",
    ]
    assert definitions.get("some_msgs/srv/Do_Response").fields[0].name == "b"
    assert definitions.all_names() == [
        "a_msgs/msg/Other", "some_msgs/msg/Thing", "some_msgs/srv/Do"
    ]  # fmt: skip
    assert definitions.nearest("some_msgs/msg/Thin") == "some_msgs/msg/Thing"


def test_the_hash_next_to_idl_is_read(tmp_path):
    write_idl(tmp_path, "some_msgs/msg/Thing", "struct Thing { long x; };")
    known = {"type_hashes": [{"type_name": "some_msgs/msg/Thing", "hash_string": "RIHS01_a"}]}
    (tmp_path / "share/some_msgs/msg/Thing.json").write_text(json.dumps(known))

    assert InstalledDefinitions([tmp_path]).get("some_msgs/msg/Thing").type_hash == "RIHS01_a"


def test_a_msg_file_comes_before_the_idl_that_rosidl_wrote_from_it(tmp_path):
    write_idl(tmp_path, "some_msgs/msg/Thing", "struct Thing { long from_idl; };")
    write_definition(tmp_path, "some_msgs/msg/Thing", "int32 from_msg")
    definitions = InstalledDefinitions([tmp_path])

    assert definitions.get("some_msgs/msg/Thing").fields[0].name == "from_msg"
    assert definitions.names() == ["some_msgs/msg/Thing"]


def test_idl_in_an_earlier_prefix_hides_a_msg_file_in_a_later_one(tmp_path):
    write_idl(tmp_path / "overlay", "some_msgs/msg/Thing", "struct Thing { long ours; };")
    write_definition(tmp_path / "below", "some_msgs/msg/Thing", "int8 theirs")
    definitions = InstalledDefinitions([tmp_path / "overlay", tmp_path / "below"])

    assert definitions.get("some_msgs/msg/Thing").fields[0].name == "ours"


def test_idl_that_cannot_be_read_is_a_definition_error(tmp_path):
    write_idl(tmp_path, "some_msgs/msg/Thing", "struct Thing { wchar x; };")

    with pytest.raises(DefinitionError, match=r"some_msgs/msg/Thing\.idl, line 1, column 48: ros"):
        InstalledDefinitions([tmp_path]).get("some_msgs/msg/Thing")


@pytest.mark.parametrize(
    "name",
    [
        "",
        "Thing",
        "some_msgs/Thing",
        "../msg/Thing",
        "a/msg/../B",
        "some_msgs/srv/Thing",
        "some_msgs/srv/Thing_Goal",
        "some_msgs/action/Thing_Request",
        "some_msgs/msg/Thing_Request",
    ],
)
def test_an_invalid_type_name_is_never_looked_up(tmp_path, name):
    with pytest.raises(UnknownTypeError, match="expected pkg/msg/Name"):
        InstalledDefinitions([tmp_path]).get(name)


def test_a_type_that_is_not_installed_raises_unknown_type_error(tmp_path):
    with pytest.raises(UnknownTypeError, match="no definition of some_msgs/msg/Thing"):
        InstalledDefinitions([tmp_path]).get("some_msgs/msg/Thing")


def test_overlays_come_before_the_python_environment(monkeypatch, tmp_path):
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path / 'a'}:{tmp_path / 'b'}")

    assert installed_prefixes()[:2] == (tmp_path / "a", tmp_path / "b")


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"{",
        b"\xff\xfe",
        b"null",
        b"[]",
        b'{"x": 1}',
        b'{"type_hashes": 5}',
        b'{"type_hashes": [1]}',
        b'{"type_hashes": [{"type_name": "some_msgs/msg/A"}]}',
    ],
)
def test_a_foreign_file_next_to_a_definition_is_ignored(tmp_path, content):
    write_definition(tmp_path, "some_msgs/msg/A", "int8 x")
    (tmp_path / "share/some_msgs/msg/A.json").write_bytes(content)

    definition = InstalledDefinitions([tmp_path]).get("some_msgs/msg/A")

    assert definition.fields[0].name == "x"
    assert definition.type_hash is None


@pytest.mark.parametrize(
    "name", [f"{'a' * 5000}/msg/A", f"a_msgs/msg/{'A' * 5000}", f"a_msgs/srv/{'A' * 5000}_Request"]
)
def test_a_name_longer_than_that_of_any_file_raises_unknown_type_error(tmp_path, name):
    with pytest.raises(UnknownTypeError):
        InstalledDefinitions([tmp_path]).get(name)


def test_a_file_that_may_not_be_read_raises_unknown_type_error(tmp_path, monkeypatch):
    write_definition(tmp_path, "some_msgs/msg/A", "int8 x")
    refusal = PermissionError(errno.EACCES, "Permission denied")
    monkeypatch.setattr(Path, "read_text", Mock(side_effect=refusal))

    with pytest.raises(UnknownTypeError, match="some_msgs/msg/A can be read: Permission denied"):
        InstalledDefinitions([tmp_path]).get("some_msgs/msg/A")


def test_a_missing_type_is_named_also_if_another_type_nests_it(tmp_path):
    write_definition(tmp_path, "some_msgs/msg/A", "lost_msgs/Thing[] things")

    with pytest.raises(UnknownTypeError) as caught:
        InstalledDefinitions([tmp_path]).closure(["some_msgs/msg/A"])

    assert caught.value.name == "lost_msgs/msg/Thing"


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("nav_msgs/msg/Odometri", "nav_msgs/msg/Odometry"),
        ("nav_msg/msg/Odometry", "nav_msgs/msg/Odometry"),
        ("nav_msg/msg/Odometri", "nav_msgs/msg/Odometry"),
        ("geometry_msgs/msg/Odometry", "nav_msgs/msg/Odometry"),
        ("robot_interfaces/msg/Odometry", "nav_msgs/msg/Odometry"),
        ("std_srvs/srv/SetBoool", "std_srvs/srv/SetBool"),
        ("std_srvs/srv/SetBol_Request", "std_srvs/srv/SetBool"),
        ("test_msgs/action/Fibonaci", "test_msgs/action/Fibonacci"),
        ("geometry_msgs/msg/Twits", "geometry_msgs/msg/Twist"),
        ("geometry_mgs/msg/Twist", "geometry_msgs/msg/Twist"),
        ("std_msgs/msg/Strng", "std_msgs/msg/String"),
        ("nav_msgs/msg/Odom", "nav_msgs/msg/Odometry"),
        ("nav_msgs/msg/Od", None),
        ("sensor_msgs/msg/Pointcloud", "sensor_msgs/msg/PointCloud"),
        ("my_msgs/msg/BasicTypes", "test_msgs/msg/BasicTypes"),
        ("nav_msgs/msg/Xyzzy", None),
        ("xyzzy/msg/Xyzzy", None),
        ("Odometry", "nav_msgs/msg/Odometry"),
        ("", None),
        (f"nav_msgs/msg/{'A' * 200_000}", None),
    ],
)
def test_the_intended_type_is_guessed(name, meant):
    assert InstalledDefinitions().nearest(name) == meant


@pytest.mark.parametrize(
    ("text", "kind", "meant"),
    [
        ("Twist", "msg", "geometry_msgs/msg/Twist"),
        ("twist", "msg", "geometry_msgs/msg/Twist"),
        ("std_msgs/string", "msg", "std_msgs/msg/String"),
        ("std_msgs::msg::String", "msg", "std_msgs/msg/String"),
        ("std_msgs.msg.Strng", "msg", "std_msgs/msg/String"),
        ("sensor_msgs/laser_scan", "msg", "sensor_msgs/msg/LaserScan"),
        ("/geometry_msgs/Twist", "msg", "geometry_msgs/msg/Twist"),
        ("set_bool", "srv", "std_srvs/srv/SetBool"),
        ("SetBool", "msg", None),
        ("/odom", "msg", None),
        ("a/b/c/d", "msg", None),
        ("", "msg", None),
        ("/", "msg", None),
        ("::" * 100_000, "msg", None),
    ],
)
def test_the_type_that_a_text_means_is_guessed(text, kind, meant):
    assert InstalledDefinitions().meant(text, kind) == meant


def test_a_name_of_two_packages_is_not_guessed_to_be_that_of_the_tests(tmp_path):
    for package in ("example_interfaces", "test_msgs", "useful_msgs"):
        write_definition(tmp_path, f"{package}/msg/Thing", "")
    assert InstalledDefinitions([tmp_path]).meant("Thing") == "useful_msgs/msg/Thing"


def test_a_name_is_guessed_by_its_first_128_characters(tmp_path):
    name = f"some_msgs/msg/{'A' * 114}"
    write_definition(tmp_path, name, "")
    assert InstalledDefinitions([tmp_path]).nearest(name + "B" * 1000) == name


def test_guessing_reads_the_directories_once_and_compares_within_one_package(tmp_path, monkeypatch):
    for package in range(20):
        for number in range(20):
            write_definition(tmp_path, f"package{package}/msg/Thing{number}", "")
    globs = []
    compared = []
    glob, set_seq1 = Path.glob, difflib.SequenceMatcher.set_seq1
    monkeypatch.setattr(Path, "glob", lambda *args: [globs.append(args), glob(*args)][1])
    monkeypatch.setattr(
        difflib.SequenceMatcher,
        "set_seq1",
        lambda *args: [compared.append(args), set_seq1(*args)][1],
    )
    definitions = InstalledDefinitions([tmp_path])

    for _ in range(2):
        assert definitions.nearest("package7/msg/Thin9") == "package7/msg/Thing9"

    assert len(globs) == 1
    assert len(compared) < 2 * 3 * 20
