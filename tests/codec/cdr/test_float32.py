# SPDX-License-Identifier: Apache-2.0
"""A float32 has one spelling in JSON, wherever it stands: the shortest that is this float32."""

import json
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gateway.codec.cdr import compile_decoder, compile_encoder
from gateway.codec.json import dumps
from schemas.installed import InstalledDefinitions
from tests.codec.cdr.reference import Writer

MESSAGES = {
    "Single": "float32 data",
    "Between": "uint8 a\nfloat32 b\nfloat64 c\nfloat32 d\nfloat32[2] e\nfloat32 f\nbool g",
    "Point": "float32 x\nfloat32 y\nfloat32 z",
    "Mixed": "float32 x\nint8 flag\nfloat32 y",
    "Named": "string name\nfloat32 value\nfloat32[3] values",
    "Floats": (
        "string name\nfloat32 first\nBetween between\nfloat32[] any\nfloat32[<=200] bounded\n"
        "float32[3] three\nfloat32[30] thirty\nPoint[] points\nMixed[] mixed\nNamed[] named\n"
        "Point[2] corners\nfloat32 last"
    ),
}
FLOATS = st.floats(width=32, allow_nan=False, allow_infinity=False)


@pytest.fixture(scope="module")
def definitions(tmp_path_factory):
    root = tmp_path_factory.mktemp("floats")
    share = root / "share/odd_msgs/msg"
    share.mkdir(parents=True)
    for name, text in MESSAGES.items():
        (share / f"{name}.msg").write_text(text + "\n")
    return InstalledDefinitions([root])


def point(one):
    return {"x": one(), "y": one(), "z": one()}


def between(one):
    pair = [one(), one()]
    return {"a": 7, "b": one(), "c": 0.1, "d": one(), "e": pair, "f": one(), "g": True}


def named(one):
    return {"name": "n", "value": one(), "values": [one() for _ in range(3)]}


def message(floats, length):
    """Return the plain form of a Floats that holds these again and again."""
    every = iter(floats * 2000)

    def one():
        return next(every)

    def some(count):
        return [one() for _ in range(count)]

    return {
        "name": "x" * (length % 8),
        "first": one(),
        "between": between(one),
        "any": some(length),
        "bounded": some(length),
        "three": some(3),
        "thirty": some(30),
        "points": [point(one) for _ in range(length % 7)],
        "mixed": [{"x": one(), "flag": -1, "y": one()} for _ in range(length % 7)],
        "named": [named(one) for _ in range(length % 7)],
        "corners": [point(one), point(one)],
        "last": one(),
    }


def spelled(value):
    """Return the digits that numpy writes for a float32, as orjson writes them."""
    single = np.float32(value)
    (text,) = json.loads(dumps(np.array([single])), parse_float=lambda text: [text])[0]
    assert Decimal(text) == Decimal(np.format_float_scientific(single, unique=True))
    return text


def spelling(value, key=""):
    """Return a message with its float32 as texts."""
    if isinstance(value, dict):
        return {name: spelling(item, name) for name, item in value.items()}
    if isinstance(value, list):
        return [spelling(item) for item in value]
    if isinstance(value, float):
        return "0.1" if key == "c" else spelled(value)
    return value


def assert_spelled(definitions, decode, order, values):
    definition = definitions.get("odd_msgs/msg/Floats")
    text = dumps(decode(Writer(definitions, order).message(definition, values)))
    assert json.loads(text, parse_float=str) == spelling(values)


@pytest.fixture(scope="module")
def decode(definitions):
    return compile_decoder(definitions.get("odd_msgs/msg/Floats"), definitions)


@pytest.mark.parametrize("order", ["<", ">"])
@given(floats=st.lists(FLOATS, min_size=1, max_size=5), length=st.integers(0, 30))
def test_every_float32_is_spelled_as_numpy_spells_it(definitions, decode, order, floats, length):
    assert_spelled(definitions, decode, order, message(floats, length))


@pytest.mark.parametrize("order", ["<", ">"])
def test_arrays_of_any_length_are_spelled_as_a_single_one(definitions, decode, order):
    rng = np.random.default_rng(0)
    for length in range(201):
        singles = rng.integers(0, 2**32, 20, np.uint32).view(np.float32)
        floats = [float(single) for single in singles if np.isfinite(single)]
        assert_spelled(definitions, decode, order, message(floats, length))


@given(st.lists(FLOATS, min_size=1, max_size=5))
def test_a_spelled_float32_is_read_as_the_same_float32(definitions, floats):
    definition = definitions.get("odd_msgs/msg/Floats")
    cdr = Writer(definitions).message(definition, message(floats, 9))
    sent = json.loads(dumps(compile_decoder(definition, definitions)(cdr)))
    assert compile_encoder(definition, definitions)(sent, 0) == cdr


@pytest.mark.parametrize(
    "fields", ["first", "between.d", "points.y", "mixed.y", "mixed.flag", "named.value", "last"]
)
def test_a_selected_float32_is_spelled_the_same(definitions, fields):
    definition = definitions.get("odd_msgs/msg/Floats")
    cdr = Writer(definitions).message(definition, message([float(np.float32(0.1))], 5))
    selected = json.loads(dumps(compile_decoder(definition, definitions, [fields])(cdr)))
    whole = json.loads(dumps(compile_decoder(definition, definitions)(cdr)))
    for name in fields.split("."):
        if isinstance(whole, list):
            whole = [each[name] for each in whole]
            selected = [each[name] for each in selected]
        else:
            whole, selected = whole[name], selected[name]
    assert selected == whole
    assert "flag" in fields or 0.1 in (whole if isinstance(whole, list) else [whole])
