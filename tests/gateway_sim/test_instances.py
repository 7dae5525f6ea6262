# SPDX-License-Identifier: Apache-2.0
"""rclpy's message objects are built from plain values and written as one line."""

import array

import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import Twist
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import Image, LaserScan
from std_msgs.msg import Bool, ByteMultiArray, String
from test_msgs.msg import Arrays, BoundedSequences, UnboundedSequences, WStrings
from visualization_msgs.msg import Marker, MarkerArray

from gateway_sim.content import Inventor
from gateway_sim.instances import Builder, message_class, one_line
from schemas.installed import InstalledDefinitions
from schemas.table import Table
from tests import interfaces

DEFINITIONS = InstalledDefinitions()
INVENTOR = Inventor(DEFINITIONS)
BUILDER = Builder(DEFINITIONS)
TEST_TYPES = [f"test_msgs/msg/{c.__name__}" for c in (Arrays, BoundedSequences, UnboundedSequences)]


@pytest.mark.parametrize("name", [*(row.name for row in Table.load().rows), *TEST_TYPES])
@pytest.mark.parametrize("counter", [0, 300])
def test_every_made_up_message_survives_the_wire(name, counter):
    built = BUILDER.build(name, INVENTOR.values(name, counter, 10**18))
    once = deserialize_message(serialize_message(built), type(built))
    # float32 rounds the first time only
    assert deserialize_message(serialize_message(once), type(built)) == once
    for field, value in INVENTOR.values(name, counter, 10**18).items():
        if isinstance(value, bytes):
            received = getattr(once, field)
            assert b"".join(b if isinstance(b, bytes) else bytes([b]) for b in received) == value
        elif isinstance(value, str | int):
            assert getattr(once, field) in {value, bytes([value]) if value in range(256) else None}


@pytest.mark.skipif(not DEFINITIONS.names(["idl_msgs"]), reason=interfaces.HOW)
@pytest.mark.parametrize("counter", [0, 300])
def test_every_made_up_message_of_idl_survives_the_wire(counter):
    for name in DEFINITIONS.names(["idl_msgs"]):
        built = BUILDER.build(name, INVENTOR.values(name, counter, 10**18))
        once = deserialize_message(serialize_message(built), type(built))
        assert deserialize_message(serialize_message(once), type(built)) == once


class Letters:
    """A class as rosidl makes it of a char of IDL. Given no text, rclpy aborts the process."""

    def __init__(self, **members):
        self.members = members

    @classmethod
    def get_fields_and_field_types(cls):
        kinds = (
            "char",
            "char[2]",
            "sequence<char>",
            "sequence<char, 4>",
            "uint8",
            "char_msgs/Char",
        )
        return dict(zip("abcdef", kinds, strict=True))


def test_a_char_of_idl_is_text(tmp_path, monkeypatch):
    folder = tmp_path / "share" / "char_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Char.msg").write_text("char x")
    (folder / "Letters.msg").write_text("char a\nchar[2] b\nchar[] c\nchar[<=4] d\nuint8 e\nChar f")
    monkeypatch.setattr("gateway_sim.instances.message_class", lambda name: Letters)
    values = {"a": 200, "b": b"ab", "c": b"", "d": b"\xff", "e": 200, "f": {}}
    built = Builder(InstalledDefinitions([tmp_path])).build("char_msgs/msg/Letters", values)
    assert {**built.members, "f": None} == {
        "a": "H", "b": ["a", "b"], "c": [], "d": ["\x7f"], "e": 200, "f": None
    }  # fmt: skip


def test_a_missing_package_is_an_import_error():
    with pytest.raises(ImportError):
        message_class("no_such_msgs/msg/Thing")
    with pytest.raises(ImportError, match="std_msgs has no message Thing"):
        message_class("std_msgs/msg/Thing")


def test_a_line_shows_every_field():
    twist = Twist()
    twist.linear.x = 0.2
    twist.angular.z = -1.5
    assert one_line(twist) == ("{linear: {x: 0.2, y: 0, z: 0}, angular: {x: 0, y: 0, z: -1.5}}")
    assert one_line(Bool(data=True)) == "{data: true}"
    assert one_line(DiagnosticStatus(level=b"\x02")).startswith("{level: 2, ")
    assert one_line(ByteMultiArray(data=[b"\x01", b"\xff"])).endswith("data: [1, 255]}")


def test_a_long_array_is_cut_and_counted():
    image = Image(data=array.array("B", range(200)))
    assert one_line(image).endswith("data: [0, 1, 2, 3, 4, 5, 6, 7, ... 200 in all]}")
    assert "ranges: [1, inf, nan]" in one_line(LaserScan(ranges=[1.0, float("inf"), float("nan")]))


def test_a_long_string_is_cut():
    line = one_line(String(data="x" * 10_000))
    assert line == '{data: "' + "x" * 80 + '..."}'


def test_a_long_line_is_cut():
    line = one_line(MarkerArray(markers=[Marker(ns=str(number)) for number in range(8)]))
    assert len(line) == 2000 + len(" ...")
    assert line.endswith(" ...")


def test_control_characters_do_not_reach_the_terminal():
    line = one_line(String(data="a\x1b[2Jb\nc\x9b31m"))
    assert line.isprintable()
    assert "\\u001b" in line
    assert one_line(String(data="grüß")) == '{data: "grüß"}'
    assert one_line(WStrings(wstring_value="grüß")).startswith('{wstring_value: "grüß"')
