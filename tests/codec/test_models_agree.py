# SPDX-License-Identifier: Apache-2.0
"""The encoder takes what the Pydantic models take, and nothing else."""

import copy
import json
import math
import random
from typing import Any

import pytest
from pydantic import ValidationError

from gateway.codec.json import loads
from gateway.codec.types import Types
from gateway.codec.validation import InvalidValueError
from schemas.build import Models
from schemas.installed import InstalledDefinitions
from tests.messages import RandomMessages, to_json

NOW_NS = 12_000_000_034
DEFINITIONS = InstalledDefinitions()

ODD: list[Any] = [
    None, True, False, 0, 1, -1, 255, 256, 2**31, 2**63 - 1, 2**64 - 1, 0.0, 1.5, 1e39, 10**9,
    "", "x", "now", "a\0b", "ü" * 12, "AAAA", "A", [], [0], [None], [1, True], ["a"], [[]],
    [{}], {}, 2.0, -1.0, 255.0, 256.0, 2.0**53, 2.0**54, 1e19, [1.0], [1.5], [1, 256.0],
    math.inf, -math.inf, math.nan, "Infinity", "-Infinity", "NaN", "inf", ["Infinity", None],
    {"x": 1}, {"sec": 1}, {"secs": 1, "nsecs": 2}, {"secs": 1, "sec": 1},
    {"nanosec": 10**9}, {"nanosec": 2**32},
    {"seq": 1}, {"stamp": "now"}, {"frame_id": "map"}, {"stamp": {}, "seq": 3},
]  # fmt: skip


@pytest.fixture(scope="module")
def types():
    return Types(DEFINITIONS)


@pytest.fixture(scope="module")
def models():
    return Models(DEFINITIONS)


def places(value, path=()):
    """Yield the paths of everything inside a value."""
    items = value.items() if isinstance(value, dict) else enumerate(value)
    for key, item in items:
        yield (*path, key)
        if isinstance(item, (dict, list)):
            yield from places(item, (*path, key))


def odd(rng):
    return copy.deepcopy(rng.choice(ODD))


def change(value, rng):
    """Make one thing in a value odd: replace it, drop it, or add an odd one next to it."""
    found = list(places(value))
    if not found:
        value[rng.choice(["x", "data"])] = odd(rng)
        return
    *path, key = rng.choice(found)
    container = value
    for step in path:
        container = container[step]
    match rng.randrange(6):
        case 0:
            del container[key]
        case 1 if isinstance(container, dict):
            container[rng.choice(["x", "data", "nonsense", "sec"])] = odd(rng)
        case 1:
            container.insert(key, odd(rng))
        case _:
            container[key] = odd(rng)


@pytest.mark.parametrize("name", DEFINITIONS.names())
def test_only_values_that_a_model_accepts_are_encoded(name, types, models):
    rng = random.Random(name)
    message_type, model = types.get(name), models.get(name)
    for seed in range(25):
        value = to_json(RandomMessages(DEFINITIONS, seed, longest=2).message(name))
        for _ in range(rng.randint(1, 3)):
            change(value, rng)
        value = loads(json.dumps(value))
        try:
            read = model.model_validate(value, context={"now_ns": NOW_NS})
        except ValidationError:
            with pytest.raises(InvalidValueError, match=r"^msg"):
                message_type.encode(value, NOW_NS)
        else:
            spelt = read.model_dump(by_alias=True)
            assert message_type.encode(value, NOW_NS) == message_type.encode(spelt, NOW_NS)
