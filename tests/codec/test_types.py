# SPDX-License-Identifier: Apache-2.0
import pytest

from gateway.codec.errors import FieldError
from gateway.codec.json import dumps, loads
from gateway.codec.types import MAX_DECODERS, Types
from gateway.codec.validation import InvalidValueError
from schemas.installed import InstalledDefinitions, UnknownTypeError
from tests.messages import RandomMessages, normalized, to_json

DEFINITIONS = InstalledDefinitions()
ODOMETRY = "nav_msgs/msg/Odometry"


@pytest.fixture(scope="module")
def types():
    return Types(DEFINITIONS)


@pytest.mark.parametrize("name", DEFINITIONS.names())
def test_what_json_says_comes_back_from_cdr(name, types):
    message_type = types.get(name)
    for seed in range(2):
        values = to_json(RandomMessages(DEFINITIONS, seed, longest=2).message(name))
        message = message_type.validate(loads(dumps(values)), now_ns=0)
        assert normalized(message_type.decode(message_type.encode(message))) == values


@pytest.mark.parametrize("name", DEFINITIONS.names())
def test_an_empty_value_encodes_to_the_defaults_of_rclpy(name, types):
    from rclpy.serialization import serialize_message

    from tests.messages import ros_class

    message_type = types.get(name)
    ours = message_type.decode(message_type.encode(message_type.validate({}, now_ns=0)))
    theirs = message_type.decode(serialize_message(ros_class(name)()))
    assert normalized(ours) == normalized(theirs)


def test_a_type_is_made_once(types):
    assert types.get(ODOMETRY) is types.get(ODOMETRY)
    assert types.get(ODOMETRY).name == ODOMETRY
    assert types.get(ODOMETRY).definition is DEFINITIONS.get(ODOMETRY)


@pytest.mark.parametrize("name", ["nav_msgs/msg/Odometri", "nav_msgs/Odometry", "../msg/X", ""])
def test_an_unknown_type_raises_unknown_type_error(name, types):
    with pytest.raises(UnknownTypeError):
        types.get(name)


def test_now_is_the_time_given(types):
    header = types.get("std_msgs/msg/Header").validate({"stamp": "now"}, now_ns=3_000_000_007)
    assert (header.stamp.sec, header.stamp.nanosec) == (3, 7)


def test_null_reaches_ros_as_nan(types):
    point = types.get("geometry_msgs/msg/Point")
    decoded = point.decode(point.encode(point.validate({"x": None, "y": 1}, now_ns=0)))
    assert dumps(decoded) == b'{"x":null,"y":1.0,"z":0.0}'


def test_what_does_not_fit_raises_invalid_value_error_with_its_path(types):
    with pytest.raises(InvalidValueError, match=r"^args\.x: expected a number") as caught:
        types.get("geometry_msgs/msg/Point").validate({"x": "1"}, now_ns=0, root="args")
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
    for number in range(1, 2 * MAX_DECODERS):
        odometry.decoder(tuple(axis for bit, axis in enumerate(axes) if number >> bit & 1))
        assert odometry.decoder(kept) is first  # in use, so it stays
    assert len(odometry._decoders) == MAX_DECODERS


def test_unknown_fields_raise_field_error(types):
    with pytest.raises(FieldError, match=r"^unknown field poze: nav_msgs/msg/Odometry has "):
        types.get(ODOMETRY).decoder(("poze",))
