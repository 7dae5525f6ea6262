# SPDX-License-Identifier: Apache-2.0
"""The C# reader and writer of JSON against Python's: the same values, the same verdicts."""

import json
import math
import random
import re
import struct
from decimal import Decimal, localcontext

import numpy as np
import pybase64
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from tests.unity import mono, package
from tests.unity.probe import Probe, Refusal

pytestmark = pytest.mark.skipif(mono.missing() != "", reason=mono.missing())

MAX_DEPTH = 64
SAMPLES = 10_000
JSON = package.CLIENT / "Runtime/Json"

TEXTS = st.text(st.characters(exclude_categories=["Cs"]))
MOST_OFF = 0.1  # of doubles of any exponent. In -22 to 22 nearly none
# the reader is exact for floats of six decimals
MICRO = st.floats(-1e9, 1e9).map(lambda value: round(value, 6))
NUMBERS = st.integers(-(2**63), 2**64 - 1) | MICRO
VALUES = st.recursive(
    st.none() | st.booleans() | NUMBERS | TEXTS,
    lambda inner: st.lists(inner) | st.dictionaries(TEXTS, inner),
    max_leaves=30,
)
SEEDS = (
    b'{"op":"publish","topic":"/odom","msg":{"x":[1,-2.5e-3,true,false,null],"y":"a\\u00e9\\n"}}',
    b'[{"a":{}},[],"\\ud83e\\udd16",1e5,0.1,-0,{"a":1,"a":2}]',
    '{"grüße": "ハロー \U0001f916"}'.encode(),
)
TYPED = (
    *("bool", "int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64"),
    *("bools", "int8s", "int16s", "int32s", "int64s", "uint8s", "uint16s", "uint32s", "uint64s"),
    *("float32", "float64", "float32s", "float64s", "string", "strings", "octets", "skip", "tree"),
    *("read:nav_msgs/msg/Odometry", "read:sensor_msgs/msg/LaserScan", "read:std_msgs/msg/Header"),
)
RANGES = {f"{u}int{n}": n for u in ("", "u") for n in (8, 16, 32, 64)}


@pytest.fixture(scope="module")
def probe():
    probe = Probe(package.compiled("Ros2Gateway.Core", package.EDITOR))
    probe.ask("culture")  # numbers look the same in any culture
    yield probe
    probe.close()


def bits64(value):
    return struct.unpack("<q", struct.pack("<d", value))[0]


def digits(text):
    """Return the significant digits of a number."""
    return re.sub(r"e.*|[-.]", "", text).strip("0")


def random_doubles(count, seed):
    pick = random.Random(seed)
    for number in range(count):
        match number % 5:
            case 0:
                bits = pick.getrandbits(64)
            case 1:  # what sensors measure
                bits = bits64(pick.gauss(0, 1) * 10.0 ** pick.randint(-20, 20))
            case 2:  # the powers of two, whose lower neighbours are closer than the upper
                bits = (pick.getrandbits(11) << 52) + pick.choice([-1, 0, 1, 2])
            case 3:
                bits = bits64(round(pick.random() * 10 ** pick.randint(0, 16), pick.randint(0, 9)))
            case _:  # subnormal
                bits = pick.getrandbits(pick.randint(1, 52))
        value = struct.unpack("<d", (bits % 2**64).to_bytes(8, "little"))[0]
        if math.isfinite(value):
            yield value


def random_singles(count, seed):
    pick = random.Random(seed)
    for number in range(count):
        bits = pick.getrandbits(32)
        if number % 3 == 0:
            bits = (pick.getrandbits(9) << 23) + pick.choice([0, 1, 2])
        value = np.uint32(bits).view(np.float32)
        if np.isfinite(value):
            yield value


def random_decimals(count, seed):
    """Yield numbers as people and programs write them, some with more digits than any float."""
    pick = random.Random(seed)
    for _ in range(count):
        text = str(pick.randint(1, 9))
        for _ in range(pick.randint(0, 24) if pick.random() < 0.95 else pick.randint(24, 900)):
            text += pick.choice("0123456789")
        if pick.random() < 0.5:
            point = pick.randint(1, len(text))
            text = f"{text[:point]}.{text[point:] or '0'}"
        if pick.random() < 0.7:
            text += f"{pick.choice('eE')}{pick.choice(['', '+', '-'])}"
            text += str(pick.randint(0, pick.choice([10, 30, 60, 340])))
        yield pick.choice(["", "-"]) + text


def halfway(value, above):
    """Yield the number half way between two neighbours, and two as close to it as one likes."""
    with localcontext(prec=1200):
        middle = format((Decimal(value) + Decimal(above)) / 2, "e")
        mantissa, _, exponent = middle.partition("e")
        point = "" if "." in mantissa else "."
        last = int(mantissa[-1])
        yield middle
        yield f"{mantissa}{point}{'0' * 900}1e{exponent}"
        if last:
            yield f"{mantissa[:-1]}{last - 1}{point}{'9' * 30}e{exponent}"


def nearest_single(text):
    """Round as numpy does not, which rounds to a double first."""
    with localcontext(prec=1200):
        exact = Decimal(text)
        double = float(exact)
        single = np.float32(double)
        if not np.isfinite(single) or Decimal(float(single)) == exact:
            return single
        around = [np.nextafter(single, np.float32(s * np.inf)) for s in (-1, 1)]
        candidates = [single, *(one for one in around if np.isfinite(one))]

        def distance(one):
            return abs(Decimal(float(one)) - exact), int(one.view(np.uint32)) & 1

        return min(candidates, key=distance)


@given(VALUES, st.booleans(), st.sampled_from([None, 1, "\t"]))
def test_a_tree_is_what_python_reads(probe, value, ascii_only, indent):
    text = json.dumps(value, ensure_ascii=ascii_only, indent=indent)
    answer = json.loads(probe.ask("tree", text.encode()))
    assert answer == value
    assert json.dumps(answer, sort_keys=True) == json.dumps(value, sort_keys=True)  # 1 is not 1.0


def python_reads(data):
    """Return what Python's json reads, where it is as strict as RFC 8259 and we are, else None."""

    def refuse(_constant):
        raise ValueError("JSON has no such literal")

    try:
        value = json.loads(data.decode(), parse_constant=refuse)
        json.dumps(value, ensure_ascii=False).encode()  # no half of a surrogate pair
        json.dumps(value, allow_nan=False)  # no number beyond double precision
    except ValueError:  # UnicodeError is one
        return None
    return (value,)


@st.composite
def mutated(draw):
    data = bytearray(draw(st.sampled_from(SEEDS)))
    for _ in range(draw(st.integers(0, 4))):
        at = draw(st.integers(0, len(data)))
        piece = draw(
            st.binary(max_size=3)
            | st.sampled_from([*b'[]{},:"\\']).map(lambda one: bytes([one]))
            | st.sampled_from([b"\\u", b"\\ud800", b"1e", b"-", b".5", b"00", b"NaN", b"\xed\xa0"])
        )
        data[at : at + draw(st.integers(0, 3))] = piece
    return bytes(data)


@given(mutated() | st.binary())
@example(b"[1,]")
@example(b'{"a":1,}')
@example(b"01")
@example(b"-")
@example(b"1.")
@example(b".1")
@example(b"1e")
@example(b"+1")
@example(b"NaN")
@example(b"-Infinity")
@example(b"nul")
@example(b"1 1")
@example(b'"\x01"')
@example(b'"\xc3\xbc\x1f"')
@example(b'"\x7f"')
@example(b'"\\x"')
@example(b'"\\ud83e"')
@example(b'"\\udd16\\ud83e"')
@example(b'"\\ud83e\\u0041"')
@example(b'"\\ud83e\\uffff"')
@example(b'"\\u12"')
@example(b'"\xc0\xaf"')
@example(b'"\xe0\x80\xaf"')
@example(b'"\xf0\x80\x80\xaf"')
@example(b'"\xf0\x8f\xbf\xbf"')
@example(b'"\xf4\x90\x80\x80"')
@example(b'"\xed\xa0\x80"')
@example(b'"\xe2\x82"')
@example(b"\xef\xbb\xbf1")
@example(b"1e999")
@example(b'"')
@example(b'"\\')
@example(b"\xa01")
@example(b"")
def test_the_verdict_on_any_bytes_is_that_of_python(probe, data):
    answer = probe.ask("tree", data)
    expected = python_reads(data)
    if expected is None:
        assert isinstance(answer, Refusal)
    else:
        assert json.loads(answer) == expected[0]


@given(st.sampled_from(TYPED), mutated() | st.binary())
def test_no_bytes_get_anything_but_a_value_or_a_format_error_from_any_read(probe, typed, data):
    probe.ask(typed, data)  # which raises otherwise


@given(
    st.sampled_from(["bools", "int8s", "float32s", "uint8s", "strings", "octets", "skip"]), VALUES
)
def test_valid_json_of_another_kind_gets_no_other_error(probe, typed, value):
    probe.ask(typed, json.dumps(value).encode())


@pytest.mark.parametrize(
    ("opening", "closing"), [("[", "]"), ('{"a":', "}"), ('[{"a":', "}]")], ids=["[", "{", "[{"]
)
@pytest.mark.parametrize("operation", ["tree", "skip"])
def test_nesting_ends_at_64_levels(probe, operation, opening, closing):
    levels = MAX_DEPTH // (len(closing))
    fits = (opening * levels + "1" + closing * levels).encode()
    assert not isinstance(probe.ask(operation, fits), Refusal)
    refusal = probe.ask(operation, b"[" + fits + b"]")
    assert isinstance(refusal, Refusal)
    assert "nested deeper than 64 levels" in refusal.text
    assert isinstance(probe.ask(operation, opening.encode() * 100_000), Refusal)


@given(mutated())
def test_json_can_be_skipped(probe, data):
    if python_reads(data) is not None:
        assert probe.ask("skip", data) == b"null"


def test_doubles_are_written_for_every_bit_and_read_to_the_last_but_one(probe):
    values = list(random_doubles(SAMPLES, seed=1))
    written = probe.ask_all(("write64", struct.pack("<d", value)) for value in values)
    for value, text in zip(values, written, strict=True):
        assert bits64(float(text)) == bits64(value)
    read = probe.ask_all(("float64", text) for text in written)
    assert_nearly(read, map(bits64, values), MOST_OFF)


def test_a_decimal_number_reads_as_the_nearest_double_or_the_next(probe):
    texts = list(random_decimals(SAMPLES, seed=2))
    for value in random_doubles(SAMPLES // 40, seed=3):
        if math.isfinite(above := math.nextafter(value, math.inf)):
            texts += halfway(value, above)
    beyond = [text for text in texts if math.isinf(float(text))]
    for answer in probe.ask_all(("float64", text.encode()) for text in beyond):
        assert isinstance(answer, Refusal)
    inside = [text for text in texts if not math.isinf(float(text))]
    answers = probe.ask_all(("float64", text.encode()) for text in inside)
    assert_nearly(answers, (bits64(float(text)) for text in inside), most=1)


def test_a_number_of_18_digits_with_22_decimals_reads_as_the_nearest_double(probe):
    pick = random.Random(5)
    texts = []
    for _ in range(SAMPLES):
        value = pick.uniform(1, 10) * 10.0 ** pick.randint(-4, 14)
        texts += [format(Decimal(repr(value)), "f"), format(Decimal(f"{value:.17e}"), "f")]
    answers = probe.ask_all(("float64", text.encode()) for text in texts)
    assert [int(bits) for bits in answers] == [bits64(float(text)) for text in texts]


def test_floats_are_written_and_read_back_bit_for_bit(probe):
    values = list(random_singles(SAMPLES, seed=4))
    written = probe.ask_all(("write32", value.tobytes()) for value in values)
    for value, text in zip(values, written, strict=True):
        assert np.float32(text).tobytes() == value.tobytes()
    read = probe.ask_all(("float32", text) for text in written)
    assert [int(bits) for bits in read] == [bits64(float(value)) for value in values]


def assert_nearly(answers, expected, most):
    """Assert that at most a share of the numbers is off, and each only by its last bit."""
    pairs = list(zip(map(int, answers), expected, strict=True))
    assert all(abs(one - other) <= 1 for one, other in pairs)
    assert sum(one != other for one, other in pairs) <= most * len(pairs)


@pytest.mark.parametrize("text", ["3.4028236e38", "-3.5e38", "1e300"])
def test_a_number_beyond_single_precision_is_refused_as_a_float(probe, text):
    answer = probe.ask("float32", text.encode())
    assert answer == Refusal(f"expected a float32, got {text} (byte 1)")


@pytest.mark.parametrize("kind", RANGES)
def test_integers_are_exact_to_the_ends_of_their_range(probe, kind):
    size = RANGES[kind]
    low, high = (
        (0, 2**size - 1) if kind.startswith("u") else (-(2 ** (size - 1)), 2 ** (size - 1) - 1)
    )
    for value in (low, high, 0, 1):
        for text in (f"{value}", f"{value}.0", f"{value}.000e0", f"{value * 10}e-1"):
            assert int(probe.ask(kind, text.encode())) == value
    for text in (
        f"{low - 1}",
        f"{high + 1}",
        "0.5",
        "1e-1",
        f"{high}.5",
        "1e30",
        f"{high}0",
        "1e999",
    ):
        refusal = probe.ask(kind, text.encode())
        assert isinstance(refusal, Refusal)
        assert f"expected an integer from {low} to {high}, got {text}" in refusal.text


@given(st.binary(max_size=100))
def test_octets_travel_as_base64(probe, octets):
    text = json.dumps(pybase64.b64encode(octets).decode())
    assert probe.ask("octets", text.encode()) == text.encode()
    assert probe.ask("octets", text.replace("/", "\\/").encode()) == text.encode()
    assert probe.ask("octets", json.dumps(list(octets)).encode()) == text.encode()


@given(st.text(st.sampled_from("AQgw/+=-_ \n\\"), max_size=12))
@example("Zm8=")
@example("Zm9=")
@example("Zg==")
@example("Zh==")
def test_invalid_base64_is_refused(probe, text):
    try:
        octets = pybase64.b64decode(text, validate=True)
    except ValueError:
        octets = None
    answer = probe.ask("octets", json.dumps(text).encode())
    if octets is None or pybase64.b64encode(octets).decode() != text:
        # Python accepts extra bits, but each octet sequence has one form
        assert isinstance(answer, Refusal)
    else:
        assert json.loads(answer) == text
