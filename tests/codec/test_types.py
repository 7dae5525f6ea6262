# SPDX-License-Identifier: Apache-2.0
import struct

import pytest
from rclpy.serialization import deserialize_message, serialize_message

from gateway.codec.cdr.misfits import TooManyFieldsError
from gateway.codec.error_text import FieldError
from gateway.codec.json import dumps, loads
from gateway.codec.types import Types
from gateway.codec.validation import InvalidValueError
from schemas.build import Models
from schemas.definition import DefinitionError
from schemas.installed import InstalledDefinitions, UnknownTypeError
from tests.messages import (
    RandomMessages,
    from_ros,
    normalized,
    ros_class,
    to_json,
    to_ros,
)
from tests.schemas.test_installed import write_definition

DEFINITIONS = InstalledDefinitions()
INTERFACES = DEFINITIONS.names(kind="srv") + DEFINITIONS.names(kind="action")
PARTS = [part.name for name in INTERFACES for part in DEFINITIONS.interface(name).parts.values()]
ODOMETRY = "nav_msgs/msg/Odometry"
SET_BOOL = "std_srvs/srv/SetBool"
FIBONACCI = "test_msgs/action/Fibonacci"


@pytest.mark.parametrize(
    ("type_name", "may_be_large"),
    [
        ("std_msgs/msg/String", False),
        ("geometry_msgs/msg/Twist", False),
        (ODOMETRY, False),  # 36 numbers, twice
        ("geometry_msgs/msg/TransformStamped", False),
        ("tf2_msgs/msg/TFMessage", False),  # each of which has names
        ("diagnostic_msgs/msg/DiagnosticArray", False),
        ("sensor_msgs/msg/Image", True),
        ("sensor_msgs/msg/LaserScan", True),
        ("nav_msgs/msg/OccupancyGrid", True),
        ("geometry_msgs/msg/PoseArray", True),  # of messages that are numbers alone
        ("visualization_msgs/msg/MarkerArray", True),  # deep inside
    ],
)
def test_a_message_with_an_array_of_numbers_without_a_bound_may_be_large(type_name, may_be_large):
    assert Types(DEFINITIONS).get(type_name).may_be_large is may_be_large


@pytest.mark.parametrize(
    ("field", "may_be_large"),
    [
        ("float64[4095]", False),
        ("float64[4096]", True),
        ("float64[<=4095]", False),
        ("float64[<=4096]", True),
        ("string[]", False),
    ],
)
def test_an_array_is_large_from_4096_elements_on(tmp_path, field, may_be_large):
    write_definition(tmp_path, "made_msgs/msg/Made", f"{field} data\n")
    types = Types(InstalledDefinitions([tmp_path]))
    assert types.get("made_msgs/msg/Made").may_be_large is may_be_large


@pytest.fixture(scope="module")
def types():
    return Types(DEFINITIONS)


@pytest.mark.parametrize("name", DEFINITIONS.names() + PARTS)
def test_json_values_come_back_from_cdr(name, types):
    message_type = types.get(name)
    for seed in range(2):
        values = to_json(RandomMessages(DEFINITIONS, seed, longest=2).message(name))
        cdr = message_type.encode(loads(dumps(values)), now_ns=0)
        assert normalized(message_type.decode(cdr)) == values


@pytest.mark.parametrize("name", DEFINITIONS.names() + PARTS)
def test_an_empty_value_encodes_to_the_defaults_of_rclpy(name, types):
    message_type = types.get(name)
    ours = message_type.decode(message_type.encode({}, now_ns=0))
    theirs = message_type.decode(serialize_message(ros_class(name)()))
    assert normalized(ours) == normalized(theirs)


@pytest.mark.parametrize("name", PARTS)
def test_the_parts_of_services_and_actions_are_on_the_wire_what_rclpy_says(name, types):
    part = types.get(name)
    for seed in range(3):
        values = RandomMessages(DEFINITIONS, seed).message(name)
        theirs = serialize_message(to_ros(part.definition, DEFINITIONS, values))
        assert normalized(part.decode(theirs)) == to_json(values)
        read = deserialize_message(part.encode(to_json(values), 0), ros_class(name))
        assert from_ros(part.definition, DEFINITIONS, read) == values


def test_a_service_is_its_request_and_its_response(types):
    service = types.service(SET_BOOL)
    assert service.name == SET_BOOL
    assert service.request is types.get(f"{SET_BOOL}_Request")
    assert service.response is types.get(f"{SET_BOOL}_Response")
    assert service.definition.text.splitlines()[1] == "---"
    assert types.service(SET_BOOL) is service


def test_an_action_is_its_goal_its_result_and_its_feedback(types):
    action = types.action(FIBONACCI)
    assert action.name == FIBONACCI
    assert action.goal is types.get(f"{FIBONACCI}_Goal")
    assert action.result is types.get(f"{FIBONACCI}_Result")
    assert action.feedback is types.get(f"{FIBONACCI}_Feedback")
    assert types.action(FIBONACCI) is action


def test_the_schema_of_a_service_or_an_action_is_that_of_the_generator(types):
    models = Models(DEFINITIONS)
    for name in INTERFACES:
        found = types.service(name) if "/srv/" in name else types.action(name)
        assert found.json_schema() == models.json_schema(name)


@pytest.mark.parametrize(
    "name", ["SetBool", "std_srvs/SetBool", ODOMETRY, FIBONACCI, f"{SET_BOOL}_Request"]
)
def test_an_invalid_service_type_name_raises_unknown_type_error(types, name):
    types.action(FIBONACCI)  # knowing it must make no difference
    with pytest.raises(UnknownTypeError) as caught:
        types.service(name)
    assert str(caught.value) == f"{name!r} is not a valid service type name: expected pkg/srv/Name"


@pytest.mark.parametrize("name", ["Fibonacci", SET_BOOL, f"{FIBONACCI}_Goal"])
def test_an_invalid_action_type_name_raises_unknown_type_error(types, name):
    types.service(SET_BOOL)
    with pytest.raises(UnknownTypeError) as caught:
        types.action(name)
    assert (
        str(caught.value) == f"{name!r} is not a valid action type name: expected pkg/action/Name"
    )


def test_a_service_or_an_action_that_is_not_installed_raises_unknown_type_error(types):
    with pytest.raises(UnknownTypeError, match="no definition of std_srvs/srv/SetBol is installed"):
        types.service("std_srvs/srv/SetBol")
    with pytest.raises(UnknownTypeError, match="no definition of a_msgs/action/B is installed"):
        types.action("a_msgs/action/B")


@pytest.mark.parametrize("values", [[], [1], [1, "two"]])
def test_values_without_names_are_those_of_the_first_fields(types, values):
    pair = types.get("diagnostic_msgs/msg/KeyValue")
    assert pair.named(values) == dict(zip(["key", "value"], values, strict=False))


@pytest.mark.parametrize(
    ("name", "expected", "having"),
    [
        (f"{SET_BOOL}_Request", "at most 1 element", "the std_srvs/srv/SetBool request has data"),
        ("geometry_msgs/msg/Point", "at most 3 elements", "geometry_msgs/msg/Point has x, y, z"),
        ("std_srvs/srv/Empty_Response", "no elements", "the std_srvs/srv/Empty response is empty"),
    ],
)
def test_more_values_than_fields_raise_invalid_value_error(types, name, expected, having):
    with pytest.raises(InvalidValueError) as caught:
        types.get(name).named([1, 2, 3, 4])
    assert str(caught.value) == f"args: expected {expected}, got 4: {having}"
    assert caught.value.path == "args"


@pytest.mark.parametrize(
    ("value", "reason"),
    [
        ({"data": "on"}, "args.data: expected true or false, got a string"),
        ({"dat": 1}, "args.dat: unknown field of the SERVICE request; did you mean data?"),
        ({"x": 1}, "args.x: unknown field of the SERVICE request, which has data"),
        (3, "args: expected an object, got 3"),
    ],
)
def test_an_error_in_a_request_names_the_service(types, value, reason):
    with pytest.raises(InvalidValueError) as caught:
        types.service(SET_BOOL).request.encode(value, now_ns=0, root="args")
    assert str(caught.value) == reason.replace("SERVICE", SET_BOOL)


def test_a_type_is_made_once(types):
    assert types.get(ODOMETRY) is types.get(ODOMETRY)
    assert types.get(ODOMETRY).name == ODOMETRY
    assert types.get(ODOMETRY).definition is DEFINITIONS.get(ODOMETRY)


@pytest.mark.parametrize("name", ["nav_msgs/msg/Odometri", "nav_msgs/Odometry", "../msg/X", ""])
def test_an_unknown_type_raises_unknown_type_error(name, types):
    with pytest.raises(UnknownTypeError):
        types.get(name)


def test_now_is_the_time_given(types):
    header = types.get("std_msgs/msg/Header")
    cdr = header.encode({"stamp": "now"}, now_ns=3_000_000_007)
    assert header.decode(cdr)["stamp"] == {"sec": 3, "nanosec": 7}


@pytest.mark.parametrize("name", ["Time", "Duration"])
@pytest.mark.parametrize("nanosec", [0, 10**9 - 1, 10**9, 2**32 - 1])
def test_a_time_is_the_same_on_both_sides_whatever_its_nanoseconds(types, name, nanosec):
    clock = types.get(f"builtin_interfaces/msg/{name}")
    value = {"sec": -1, "nanosec": nanosec}
    cdr = clock.encode(value, now_ns=0)
    assert cdr == b"\0\1\0\0" + struct.pack("<iI", -1, nanosec)
    assert clock.decode(cdr) == value
    assert clock.encode({"secs": -1, "nsecs": nanosec}, now_ns=0) == cdr


def test_null_reaches_ros_as_nan(types):
    point = types.get("geometry_msgs/msg/Point")
    decoded = point.decode(point.encode({"x": None, "y": 1}, now_ns=0))
    assert dumps(decoded) == b'{"x":null,"y":1.0,"z":0.0}'


def test_a_value_that_costs_too_much_is_refused_with_a_reason(types):
    markers = {"markers": [{"id": 1}] * 20_000}
    with pytest.raises(TooManyFieldsError, match=r"^args: over 60000 values .* fewer elements"):
        types.get("visualization_msgs/msg/MarkerArray").encode(markers, now_ns=0, root="args")


def test_a_value_that_does_not_fit_raises_invalid_value_error_with_its_path(types):
    with pytest.raises(InvalidValueError, match=r"^args\.x: expected a number") as caught:
        types.get("geometry_msgs/msg/Point").encode({"x": "1"}, now_ns=0, root="args")
    assert caught.value.path == "args.x"


def test_the_same_fields_share_a_decoder(types):
    odometry = types.get(ODOMETRY)
    decoder = odometry.decoder(("pose", "header.stamp"))
    assert odometry.decoder(("header.stamp", "pose", "pose")) is decoder
    assert odometry.decoder(("header.stamp", "pose"), "raw") is not decoder
    assert odometry.decoder() is odometry.decode
    assert odometry.decoder(()) is odometry.decode


def test_a_client_that_makes_up_selections_does_not_fill_the_memory():
    odometry = Types(DEFINITIONS).get(ODOMETRY)
    names = ("x", "y", "z", "w")
    axes = [f"pose.pose.orientation.{name}" for name in names]
    axes += [f"twist.twist.linear.{name}" for name in names[:3]]
    kept = (axes[0],)
    first = odometry.decoder(kept)
    for number in range(1, 100):
        odometry.decoder(tuple(axis for bit, axis in enumerate(axes) if number >> bit & 1))
        assert odometry.decoder(kept) is first  # in use, so it stays
    assert odometry._compiled.cache_info().currsize == 32


def test_unknown_fields_raise_field_error(types):
    with pytest.raises(FieldError, match=r"^unknown field poze: nav_msgs/msg/Odometry has "):
        types.get(ODOMETRY).decoder(("poze",))


@pytest.mark.parametrize(
    ("fields", "reason"),
    [
        (("poze",), "unknown field poze: "),
        (("pose", "pose.pose.w"), "unknown field pose.pose.w: "),
        (("header.stamp.sec.x",), "unknown field header.stamp.sec.x: "),
    ],
)
def test_checking_unknown_fields_raises_field_error(types, fields, reason):
    with pytest.raises(FieldError) as caught:
        types.get(ODOMETRY).check_fields(fields)
    assert str(caught.value).startswith(reason)


def test_checking_fields_compiles_nothing():
    odometry = Types(DEFINITIONS).get(ODOMETRY)
    for fields in (None, (), ("pose", "header.stamp")):
        odometry.check_fields(fields)
    assert odometry._compiled.cache_info().currsize == 0


def test_a_type_that_nests_what_is_not_installed_raises_unknown_type_error(tmp_path):
    write_definition(tmp_path, "some_msgs/msg/A", "lost_msgs/Thing thing")
    write_definition(tmp_path, "some_msgs/srv/B", "A a\n---\n")
    types = Types(InstalledDefinitions([tmp_path]))
    for ask, name in ((types.get, "some_msgs/msg/A"), (types.service, "some_msgs/srv/B")):
        with pytest.raises(UnknownTypeError, match="no definition of lost_msgs/msg/Thing"):
            ask(name)


def test_a_type_that_nests_itself_raises_definition_error(tmp_path):
    write_definition(tmp_path, "some_msgs/msg/A", "A[] a")
    with pytest.raises(DefinitionError, match="some_msgs/msg/A nests itself"):
        Types(InstalledDefinitions([tmp_path])).get("some_msgs/msg/A")


@pytest.mark.parametrize(
    ("name", "holds"),
    [
        ("nav_msgs/msg/Odometry", False),
        ("sensor_msgs/msg/LaserScan", False),
        ("sensor_msgs/msg/CompressedImage", False),
        ("std_msgs/msg/String", False),
        ("sensor_msgs/msg/JointState", True),
        ("nav_msgs/msg/Path", True),
        ("std_msgs/msg/Float64MultiArray", True),
    ],
)
def test_arrays_of_messages_and_of_texts_are_elements(name, holds):
    assert Types(InstalledDefinitions()).get(name).holds_elements == holds
