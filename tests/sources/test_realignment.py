# SPDX-License-Identifier: Apache-2.0
"""CDR that is moved, against what rclpy and the codec write in the other place."""

from pathlib import Path

import pytest
from rclpy.serialization import deserialize_message, serialize_message

from gateway.codec.types import Types
from gateway.sources.realignment import Realignment
from gateway.sources.source import RosError
from schemas.definition_text import parse_definition
from schemas.installed import InstalledDefinitions
from tests.messages import RandomMessages, ros_class, to_json, to_ros

DEFINITIONS = InstalledDefinitions()
MESSAGES = DEFINITIONS.names()
ACTIONS = DEFINITIONS.names(kind="action")
HEADER = b"\0\1\0\0"
STATUS = b"\4"


def realignment(text: str) -> Realignment:
    return Realignment(parse_definition("my_msgs/msg/Any", text), DEFINITIONS)


@pytest.mark.parametrize("name", ACTIONS)
@pytest.mark.parametrize("seed", range(5))
def test_a_result_is_where_rclpy_has_it(name: str, seed: int):
    part = f"{name}_Result"
    definition = DEFINITIONS.get(part)
    values = RandomMessages(DEFINITIONS, seed).message(part)
    result = to_ros(definition, DEFINITIONS, values)
    response_class = ros_class(name).Impl.GetResultService.Response
    response = response_class(status=4, result=result)
    written = serialize_message(response)  # between values rclpy leaves what was in memory
    alone = serialize_message(result)
    realignment = Realignment(definition, DEFINITIONS)
    moved = realignment.move(alone[4:], 0, STATUS, is_little_endian=True)
    assert deserialize_message(HEADER + moved, response_class) == response
    back = realignment.move(written[4:], 1, b"", is_little_endian=True)
    assert deserialize_message(HEADER + back, type(result)) == result
    assert 0 <= len(written) - 4 - len(moved) < 4


@pytest.mark.parametrize("before", ["int8 a", "int32 a"])
def test_every_type_is_where_the_codec_has_it(before: str, tmp_path: Path):
    folder = tmp_path / "my_msgs" / "msg"
    folder.mkdir(parents=True)
    for name in MESSAGES:
        (folder / f"{flat(name)}.msg").write_text(f"{before}\n{name} b\n")
    definitions = InstalledDefinitions(None, [tmp_path])
    types = Types(definitions)
    first = len(types.get(f"my_msgs/msg/{flat('std_msgs/msg/Bool')}").encode({}, 0)) - 4 - 1
    for seed, name in enumerate(MESSAGES):
        values = to_json(RandomMessages(definitions, seed).message(name))
        alone = types.get(name).encode(values, 0)
        behind = types.get(f"my_msgs/msg/{flat(name)}").encode({"b": values}, 0)
        realignment = Realignment(definitions.get(name), definitions)
        moved = realignment.move(alone[4:], 0, bytes(first), is_little_endian=True)
        assert moved == behind[4:], name
        back = realignment.move(behind[4:], first, b"", is_little_endian=True)
        assert back == alone[4:], name


def flat(name: str) -> str:
    """Return a name without a slash or an underscore."""
    package, _, short_name = name.split("/")
    return package.title().replace("_", "") + short_name


def test_the_rest_is_copied_as_soon_as_the_distance_is_right():
    realignment_of = realignment("uint8 a\nfloat64 b\nstring[] texts")
    moved = realignment_of.move(
        bytes(8) + b"12345678" + b"whatever", 0, STATUS, is_little_endian=True
    )
    assert moved == STATUS + bytes(7) + b"12345678" + b"whatever"


def test_counts_have_the_byte_order_of_their_message():
    source = b"\0\0\0\2abcd"
    moved = realignment("uint16[] a").move(source, 0, STATUS, is_little_endian=False)
    assert moved == STATUS + bytes(3) + source
    with pytest.raises(RosError, match="need 67108864 bytes at offset 4, there are 4"):
        realignment("string a\nfloat64 b").move(
            source[:3] + b"\4" + source[4:], 0, STATUS, is_little_endian=True
        )


@pytest.mark.parametrize(
    ("text", "source"),
    [
        ("uint8[8] a\nfloat64 b", bytes(7)),
        ("string a\nfloat64 b", b"\xff\xff\xff\xff"),
        ("wstring a\nfloat64 b", b"\2\0\0\0" + bytes(7)),
        ("std_msgs/Bool[] a\nfloat64 b", b"\xff\xff\xff\xff\0"),
        ("string[4] a\nfloat64 b", b"\1\0\0"),
        ("float64 a", b""),
    ],
)
def test_a_message_that_ends_too_early_is_refused(text: str, source: bytes):
    with pytest.raises(RosError, match=r"my_msgs/msg/Any: need \d+ bytes at offset \d+") as caught:
        realignment(text).move(source, 0, STATUS, is_little_endian=True)
    assert caught.value.code == "internal"


def test_every_beginning_of_a_message_is_moved_or_refused():
    name = "sensor_msgs/msg/LaserScan"
    values = to_json(RandomMessages(DEFINITIONS, 1).message(name))
    cdr = Types(DEFINITIONS).get(name).encode(values, 0)[4:]
    layout = Realignment(DEFINITIONS.get(name), DEFINITIONS)
    for end in range(len(cdr)):
        try:
            moved = layout.move(cdr[:end], 0, STATUS, is_little_endian=True)
        except RosError:
            continue
        assert len(moved) <= end + 8


def test_types_that_nest_each_other_twice_are_moved(tmp_path: Path):
    folder = tmp_path / "my_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "A0.msg").write_text("uint8 x\n")
    for level in range(1, 9):
        (folder / f"A{level}.msg").write_text(f"A{level - 1}[] a\nA{level - 1}[] b\n")
    definitions = InstalledDefinitions(None, [tmp_path])
    layout = Realignment(definitions.get("my_msgs/msg/A8"), definitions)
    moved = layout.move(bytes(8), 0, STATUS, is_little_endian=True)
    assert moved == STATUS + bytes(11)
