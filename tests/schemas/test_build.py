# SPDX-License-Identifier: Apache-2.0
"""Models of any type: checked in, or built at run time."""

import itertools
import json
import subprocess
import sys
from pathlib import Path

import pytest

import schemas
from schemas.build import Models, json_schema
from schemas.definition import DefinitionError
from schemas.installed import InstalledDefinitions, UnknownTypeError, installed_prefixes
from schemas.models import geometry_msgs, nav_msgs, std_msgs, std_srvs
from schemas.naming import attribute
from tests.messages import RandomMessages, ros_class, to_json


@pytest.fixture(scope="module")
def models():
    return Models.installed()


@pytest.fixture
def made_up(tmp_path):
    """Return a function that installs definitions and gives the models of all."""

    def install(**texts):
        folder = tmp_path / "share" / "made_up_msgs" / "msg"
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in texts.items():
            (folder / f"{name}.msg").write_text(text, encoding="utf-8")
        return Models(InstalledDefinitions([tmp_path, *installed_prefixes()]))

    return install


def plain(value, field_type):
    """Return what rclpy holds in a field in the way that models hold it."""
    if field_type.is_octets:
        return b"".join(one if isinstance(one, bytes) else bytes([one]) for one in value)
    if field_type.is_array:
        return [one.item() if hasattr(one, "item") else one for one in value]
    return value[0] if isinstance(value, bytes) else value


def assert_same(held, ros, definition, definitions):
    for field in definition.fields:
        ours, theirs = getattr(held, attribute(field.name)), getattr(ros, field.name)
        if field.type.is_primitive:
            assert ours == plain(theirs, field.type), (definition.name, field.name)
        else:
            nested = definitions.get(field.type.base)
            ours, theirs = ([ours], [theirs]) if not field.type.is_array else (ours, theirs)
            for one, other in zip(ours, theirs, strict=True):
                assert_same(one, other, nested, definitions)


def names_of_parts(definitions):
    interfaces = definitions.names(kind="srv") + definitions.names(kind="action")
    return [part.name for name in interfaces for part in definitions.interface(name).parts.values()]


def test_an_empty_object_is_the_message_that_rclpy_makes_for_every_installed_type(models):
    definitions = InstalledDefinitions()
    for name in definitions.names() + names_of_parts(definitions):
        held = models.get(name).model_validate({})
        assert_same(held, ros_class(name)(), definitions.get(name), definitions)


def test_a_service_of_the_table_has_checked_in_models_of_its_parts(models):
    assert models.get("std_srvs/srv/SetBool_Request") is std_srvs.SetBool_Request
    assert models.get("nav_msgs/srv/GetPlan_Response") is nav_msgs.GetPlan_Response
    assert isinstance(models.get("nav_msgs/srv/GetPlan_Response")().plan, nav_msgs.Path)


def test_the_parts_of_a_service_outside_the_table_are_built(models):
    model = models.get("test_msgs/action/NestedMessage_Goal")

    assert model.__name__ == "NestedMessage_Goal"
    assert model.ros_type == "test_msgs/action/NestedMessage_Goal"
    assert isinstance(model().nested_field, models.get("test_msgs/msg/BasicTypes"))


def test_a_service_that_differs_from_the_checked_in_one_wins(tmp_path):
    folder = tmp_path / "share" / "std_srvs" / "srv"
    folder.mkdir(parents=True)
    (folder / "SetBool.srv").write_text(
        "bool data\nbool force\n---\nbool success\nstring message\n"
    )
    models = Models(InstalledDefinitions([tmp_path]))

    assert models.get("std_srvs/srv/SetBool_Request").model_validate({"force": True}).force
    # no hash is installed here, so that of the same structure is computed and found equal
    assert models.get("std_srvs/srv/SetBool_Response") is std_srvs.SetBool_Response


def test_a_type_of_the_table_has_its_checked_in_model(models):
    assert models.get("geometry_msgs/msg/Twist") is geometry_msgs.Twist


def test_a_type_is_built_once(models):
    assert models.get("test_msgs/msg/Nested") is models.get("test_msgs/msg/Nested")


def test_a_type_outside_the_table_is_built_with_all_it_nests(models):
    model = models.get("test_msgs/msg/MultiNested")
    held = model.model_validate({"unbounded_sequence_of_arrays": [{"int8_values": [1, 2, 3]}]})

    assert held.unbounded_sequence_of_arrays[0].int8_values == [1, 2, 3]
    assert held.unbounded_sequence_of_arrays[0].uint8_values_default == b"\x00\x01\xff"
    assert model.ros_type == "test_msgs/msg/MultiNested"
    assert model.ros_type_hash == InstalledDefinitions().get(model.ros_type).type_hash


def test_a_made_up_type_is_documented_from_its_definition(made_up):
    model = made_up(
        Thing='# A "thing" with a \\ and """ in its words.\n\nint8 A=1 # one\nint8 x 3 # how many\n'
    ).get("made_up_msgs/msg/Thing")

    assert model.__doc__.strip() == 'A "thing" with a \\ and """ in its words.'
    assert model.model_fields["x"].description == "how many"
    assert model.A == 1
    assert model().x == 3


def test_a_made_up_type_may_nest_types_of_the_table_and_its_own(made_up):
    models = made_up(
        Outer="Inner[] inner\nstd_msgs/Header header\nInner[2] two", Inner="geometry_msgs/Point p"
    )
    held = models.get("made_up_msgs/msg/Outer").model_validate({"inner": [{"p": {"x": 1}}]})

    assert isinstance(held.header, std_msgs.Header)
    assert isinstance(held.inner[0].p, geometry_msgs.Point)
    assert held.inner[0].p.x == 1.0
    assert len(held.two) == 2


def test_types_of_one_short_name_and_two_packages_are_kept_apart(made_up):
    models = made_up(Point="geometry_msgs/Point there\nint8 mine")
    held = models.get("made_up_msgs/msg/Point").model_validate({"there": {"x": 1}, "mine": 2})

    assert (held.there.x, held.mine) == (1.0, 2)


def test_no_word_of_a_definition_becomes_code(made_up):
    hostile = '""" + exit() + """\\"""\\\\'
    models = made_up(
        Thing=f"# {hostile}\n\nstring S='{hostile}' # {hostile}\nstring s '{hostile}' # {hostile}\n"
        f"# {hostile}\0\x1f\nint8 last\n"
    )
    model = models.get("made_up_msgs/msg/Thing")

    assert hostile == model.S
    assert model().s == hostile
    assert hostile in model.__doc__
    assert hostile in model.model_fields["s"].description
    assert hostile in model.model_fields["last"].description


def test_constants_and_fields_of_one_name_do_not_hide_each_other(made_up):
    model = made_up(
        Thing="int8 None=1\nint8 copy=2\nfloat64 NAN=nan\nfloat64 INF=-inf\nint8 x"
    ).get("made_up_msgs/msg/Thing")

    assert (model.None_, model.copy_, model.INF) == (1, 2, float("-inf"))
    assert model.NAN != model.NAN  # only NaN differs from itself


def test_a_default_of_nan_is_held_as_null(made_up):
    model = made_up(Thing="float64 x nan\nfloat64[] y [1.0, nan]").get("made_up_msgs/msg/Thing")

    assert (model().x, model().y) == (None, [1.0, None])


def test_a_definition_that_differs_from_the_checked_in_one_wins(tmp_path):
    folder = tmp_path / "share" / "geometry_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Vector3.msg").write_text("float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n")
    (folder / "Twist.msg").write_text("Vector3 linear\nVector3 angular\n")
    (folder / "Point.msg").write_text("float64 x\nfloat64 y\nfloat64 z\n")
    models = Models(InstalledDefinitions([tmp_path]))
    twist = models.get("geometry_msgs/msg/Twist")

    assert twist.model_validate({"linear": {"w": 1}}).linear.w == 1.0
    # no hash is installed here, so that of the same structure is computed and found equal
    assert models.get("geometry_msgs/msg/Point") is geometry_msgs.Point


def test_a_definition_that_differs_in_defaults_and_constants_alone_does_not_win(tmp_path):
    folder = tmp_path / "share" / "geometry_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Point.msg").write_text("int8 AXES=3\nfloat64 x 1.0\nfloat64 y\nfloat64 z\n")
    point = Models(InstalledDefinitions([tmp_path])).get("geometry_msgs/msg/Point")

    assert point is geometry_msgs.Point


def test_a_type_that_is_not_installed_raises_unknown_type_error(models):
    with pytest.raises(UnknownTypeError, match="no_such_msgs/msg/Thing"):
        models.get("no_such_msgs/msg/Thing")


def test_a_nested_type_that_is_not_installed_is_named(made_up):
    with pytest.raises(UnknownTypeError, match="no_such_msgs/msg/Part"):
        made_up(Thing="no_such_msgs/Part part").get("made_up_msgs/msg/Thing")


def test_a_definition_that_cannot_be_parsed_raises_definition_error(made_up):
    with pytest.raises(DefinitionError, match="made_up_msgs/msg/Thing, line 1"):
        made_up(Thing="???").get("made_up_msgs/msg/Thing")


def test_the_schema_of_a_checked_in_type_is_the_checked_in_one():
    path = Path(schemas.__file__).parent / "json" / "nav_msgs" / "Odometry.json"
    checked_in = json.loads(path.read_bytes())
    del checked_in["$comment"]

    assert json_schema("nav_msgs/msg/Odometry", InstalledDefinitions()) == checked_in


def test_the_schema_of_a_checked_in_service_is_the_checked_in_one():
    path = Path(schemas.__file__).parent / "json" / "nav_msgs" / "srv" / "GetPlan.json"
    checked_in = json.loads(path.read_bytes())
    del checked_in["$comment"]

    assert json_schema("nav_msgs/srv/GetPlan", InstalledDefinitions()) == checked_in


def test_a_type_outside_the_table_has_a_schema_too(models):
    schema = models.json_schema("test_msgs/msg/Nested")

    assert schema["title"] == "test_msgs/msg/Nested"
    assert list(schema["$defs"]) == ["test_msgs.msg.BasicTypes"]


def test_one_model_imports_only_the_packages_it_needs():
    code = (
        "import sys; from schemas.build import Models;"
        "Models.installed().get('geometry_msgs/msg/Twist');"
        "print(*sorted(name for name in sys.modules if name.startswith('schemas.models.')))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True, timeout=180
    )

    assert done.stdout.split() == [
        "schemas.models.builtin_interfaces",
        "schemas.models.geometry_msgs",
        "schemas.models.std_msgs",
    ]


@pytest.mark.parametrize("kind", ["msg", "srv", "action"])
def test_a_message_of_every_type_is_written_as_a_client_sends_it(kind):
    definitions = InstalledDefinitions()
    models = Models(definitions)
    names = definitions.names(kind=kind)
    if kind != "msg":
        interfaces = map(definitions.interface, names)
        names = [part.name for each in interfaces for part in each.parts.values()]
    for name, seed in itertools.product(names, range(3)):
        sent = to_json(RandomMessages(definitions, seed).message(name))
        message = models.get(name).model_validate(sent)
        text = message.model_dump_json()
        assert json.loads(text) == message.model_dump(mode="json") == sent, name
        assert models.get(name).model_validate_json(text) == message


@pytest.mark.parametrize("value", ["NaN", "Infinity", "-Infinity", None])
def test_nan_and_infinities_are_written_as_a_client_sends_them(value):
    sent = {"ranges": [value, 1.5], "angle_min": value}
    scan = Models.installed().get("sensor_msgs/msg/LaserScan").model_validate(sent)
    assert json.loads(scan.model_dump_json(exclude_unset=True)) == sent
