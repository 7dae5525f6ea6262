# SPDX-License-Identifier: Apache-2.0
"""The C# reader of CBOR: what it reads is what the reader of JSON reads, and what cbor2 wrote."""

import json
import struct

import cbor2
import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from gateway.codec.json import dumps
from gateway.codec.types import Types
from schemas.generate.catalogue import Catalogue
from schemas.generate.csharp_messages import packaged
from schemas.installed import InstalledDefinitions
from schemas.table import Table
from tests.messages import RandomMessages, to_json
from tests.unity import mono, package
from tests.unity.probe import Probe, Refusal

pytestmark = pytest.mark.skipif(mono.missing() != "", reason=mono.missing())

DEFINITIONS = InstalledDefinitions()
TABLE = Catalogue.of(Table.load(), DEFINITIONS)
TYPES = Types(DEFINITIONS)
NOW_NS = 1_700_000_000_123_456_789
TAGS = {
    "u1": 64,
    "u2": 69,
    "u4": 70,
    "u8": 71,
    "i1": 72,
    "i2": 77,
    "i4": 78,
    "i8": 79,
    "f4": 85,
    "f8": 86,
}
READS = {
    "u1": "uint8s",
    "u2": "uint16s",
    "u4": "uint32s",
    "u8": "uint64s",
    "i1": "int8s",
    "i2": "int16s",
    "i4": "int32s",
    "i8": "int64s",
    "f4": "float32s",
    "f8": "float64s",
}
VALUES = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**63), 2**64 - 1)
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(st.characters(exclude_categories=["Cs"])),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(max_size=5), inner),
    max_leaves=30,
)
TYPED = (
    *("bool", "int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64"),
    *("bools", "int8s", "int16s", "int32s", "int64s", "uint8s", "uint16s", "uint32s", "uint64s"),
    *("float32", "float64", "float32s", "float64s", "string", "strings", "octets", "skip", "tree"),
    *("read:nav_msgs/msg/Odometry", "read:sensor_msgs/msg/LaserScan", "read:std_msgs/msg/Header"),
    *("read:sensor_msgs/msg/PointCloud2", "read:visualization_msgs/msg/MarkerArray"),
)


@pytest.fixture(scope="module")
def probe():
    probe = Probe(package.compiled("Ros2Gateway.Core", package.EDITOR))
    yield probe
    probe.close()


def array(numbers):
    return cbor2.CBORTag(TAGS[numbers.dtype.str[1:]], numbers.tobytes())


def both(name, seed):
    """Return a message as JSON and as CBOR, as the gateway sends them."""
    message_type = TYPES.get(name)
    values = to_json(RandomMessages(DEFINITIONS, seed).message(name))
    cdr = message_type.encode(values, now_ns=NOW_NS)
    return dumps(message_type.decode(cdr)), bytes(message_type.transcoder()(cdr))


def pair(first, second):
    return struct.pack("<i", len(first)) + first + second


@pytest.mark.parametrize("name", [one.name for one in packaged(TABLE)])
def test_a_message_is_the_same_in_cbor_and_again_in_the_place_of_another(probe, name):
    (first, first_cbor), (second, second_cbor) = both(name, 1), both(name, 2)
    expected = probe.ask(f"read:{name}", second)
    assert not isinstance(expected, Refusal)
    assert probe.ask(f"cbor:read:{name}", second_cbor) == expected
    assert probe.ask(f"again:{name}", pair(first, second)) == expected
    assert probe.ask(f"cbor:again:{name}", pair(first_cbor, second_cbor)) == expected
    assert probe.ask("cbor:skip", second_cbor) == b"null"


@given(VALUES)
@example([0, 23, 24, 255, 256, 65535, 65536, 2**32 - 1, 2**32, 2**64 - 1, -1, -24, -25, -(2**63)])
@example({"": 1.5, "a" * 300: [1e300, 5e-324]})
def test_a_tree_is_what_cbor2_writes(probe, value):
    answer = json.loads(probe.ask("cbor:tree", cbor2.dumps(value)))
    assert answer == value
    assert json.dumps(answer, sort_keys=True) == json.dumps(value, sort_keys=True)  # 1 is not 1.0
    assert probe.ask("cbor:skip", cbor2.dumps(value)) == b"null"


@pytest.mark.parametrize("kind", TAGS)
def test_typed_arrays_are_read_as_their_type_and_as_a_tree(probe, kind):
    numbers = np.array([0, 1, 100, 50], dtype=f"<{kind}")
    if kind[0] != "f":
        limits = np.iinfo(kind)
        numbers = np.array([limits.min, limits.max, 5], dtype=f"<{kind}")
    for values in (numbers, numbers[:0]):
        data = cbor2.dumps(array(values))
        assert json.loads(probe.ask(f"cbor:{READS[kind]}", data)) == values.tolist()
        assert json.loads(probe.ask("cbor:tree", data)) == values.tolist()
        assert json.loads(probe.ask(f"cbor:{READS[kind]}", cbor2.dumps(values.tolist()))) == (
            values.tolist()
        )


def test_an_array_of_another_type_is_converted_where_its_numbers_fit(probe):
    data = cbor2.dumps(array(np.array([1, 2, 300], "<i2")))
    assert json.loads(probe.ask("cbor:float64s", data)) == [1, 2, 300]
    assert json.loads(probe.ask("cbor:uint16s", data)) == [1, 2, 300]
    assert probe.ask("cbor:uint8s", data) == Refusal(
        "[2]: expected an integer from 0 to 255, got 300 (byte 8)"
    )


def test_numbers_that_json_has_not(probe):
    data = cbor2.dumps([float("nan"), float("inf"), float("-inf"), None])
    assert json.loads(probe.ask("cbor:float64s", data)) == [None, "Infinity", "-Infinity", None]
    half = b"\x84\xf9\x3c\x00\xf9\x00\x01\xf9\x7c\x00\xf9\xc0\x00"
    assert json.loads(probe.ask("cbor:float64s", half)) == [1.0, 2**-24, "Infinity", -2.0]
    assert json.loads(probe.ask("cbor:float32s", b"\x81\xfa\x3f\xc0\x00\x00")) == [1.5]


def test_octets_are_bytes_or_in_a_tree_base64(probe):
    data = cbor2.dumps(b"abc")
    assert json.loads(probe.ask("cbor:octets", data)) == "YWJj"
    assert json.loads(probe.ask("cbor:tree", data)) == "YWJj"
    assert json.loads(probe.ask("cbor:octets", cbor2.dumps([1, 2]))) == "AQI="


@pytest.mark.parametrize(
    ("operation", "data", "words"),
    [
        ("tree", b"\x9f\x01\xff", "an item of indefinite length (byte 1)"),
        ("tree", b"\x5a\xff\xff\xff\xff", "need 4294967295 bytes, 0 are there (byte 1)"),
        ("float64s", b"\x9b" + b"\xff" * 8, "need 18446744073709551615 bytes, 0 are there"),
        ("float32s", b"\xd8\x55\x43abc", "3 bytes are not an array of numbers of 4 bytes"),
        ("tree", b"\xc1\x01", "tag 1, not a little-endian array of numbers"),
        ("string", b"\x62\xc3\x28", "a string is not UTF-8"),
        ("float32", cbor2.dumps(1e300), "expected a float32, got 1E+300"),
        ("uint8", cbor2.dumps(-1), "expected an integer from 0 to 255, got -1"),
        ("bool", cbor2.dumps(1), "expected true or false, got a number"),
        ("tree", b"\x81" * 70 + b"\x01", "nested deeper than 64 levels"),
        ("tree", b"\x01\x01", "expected the end, got a number"),
        (
            "read:geometry_msgs/msg/PoseStamped",
            cbor2.dumps({"pose": {"position": {"x": "a"}}}),
            "pose.position.x: expected a number, got a string (byte 20)",
        ),
        (
            "read:geometry_msgs/msg/PoseWithCovariance",
            cbor2.dumps({"covariance": array(np.zeros(2))}),
            "covariance: expected 36 elements, got 2",
        ),
    ],
)
def test_faults_are_said_with_their_place(probe, operation, data, words):
    answer = probe.ask(f"cbor:{operation}", data)
    assert isinstance(answer, Refusal)
    assert words in answer.text


SEEDS = [
    *(both(name, 3)[1] for name in ("nav_msgs/msg/Odometry", "sensor_msgs/msg/LaserScan")),
    *(both(name, 4)[1] for name in ("sensor_msgs/msg/PointCloud2", "std_msgs/msg/Header")),
    cbor2.dumps({"a": [1, -2, 1.5, True, None, "grüße", b"abc"], "b": {"c": []}}),
]


@st.composite
def mutated(draw):
    data = bytearray(draw(st.sampled_from(SEEDS)))
    for _ in range(draw(st.integers(0, 4))):
        at = draw(st.integers(0, len(data)))
        data[at : at + draw(st.integers(0, 3))] = draw(st.binary(max_size=3))
    return bytes(data)


@given(st.sampled_from(TYPED), mutated() | st.binary())
def test_no_bytes_get_anything_but_a_value_or_a_format_error_from_any_read(probe, typed, data):
    probe.ask(f"cbor:{typed}", data)  # which raises otherwise


@pytest.mark.parametrize("seed", SEEDS)
def test_every_truncation_is_refused(probe, seed):
    for operation in ("tree", "skip"):
        answers = probe.ask_all((f"cbor:{operation}", seed[:n]) for n in range(len(seed)))
        assert all(isinstance(answer, Refusal) for answer in answers)
