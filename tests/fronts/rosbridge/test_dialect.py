# SPDX-License-Identifier: Apache-2.0
import tracemalloc

import pytest

from gateway.core.errors import ProtocolError
from gateway.fronts.rosbridge.dialect import Dialect
from gateway.fronts.rosbridge.operations import OPERATIONS, rosbridge

OWN = [
    (op, key)
    for op, model in OPERATIONS.items()
    for key in model.model_fields
    if key not in rosbridge.KEYS.get(op, ())
]


def test_rosbridges_own_keys_say_nothing():
    for op, keys in rosbridge.KEYS.items():
        dialect = Dialect()
        assert dialect.note(op, dict.fromkeys(keys, "x")) == ""
        assert dialect.hears("error")
        assert not dialect.hears("warning")


@pytest.mark.parametrize(("op", "key"), OWN)
def test_each_own_key_and_operation_begins_warnings(op, key):
    dialect = Dialect()
    assert dialect.note(op, {"op": op, key: "x"}) == ""
    assert dialect.hears("warning")
    assert not dialect.hears("info")


@pytest.mark.parametrize("operation", [{"fields": None}, {"anything": {"else": 1}}, {"sub": "x"}])
def test_a_null_and_a_key_that_resembles_none_are_ignored(operation):
    dialect = Dialect()
    assert dialect.note("subscribe", {"op": "subscribe", **operation}) == ""
    assert not dialect.hears("warning")


@pytest.mark.parametrize(
    ("op", "key", "near"),
    [
        ("subscribe", "feilds", "fields"),
        ("subscribe", "throtle_rate", "throttle_rate"),
        ("subscribe", "trottle_rat", "throttle_rate"),
        ("subscribe", "queue_lenght", "queue_length"),
        ("subscribe", "Topics", "topic"),
        ("call_service", "arg", "args"),
        ("call_service", "sevrise", "service"),
        ("publish", "mgs", "msg"),
        ("publish", "tpye", "type"),
        ("send_action_goal", "fedback", "feedback"),
        ("lookup_transform", "sorce_frame", "source_frame"),
        ("ping", "valeu", "value"),
    ],
)
def test_a_misspelt_key_gets_the_one_that_was_meant_once(op, key, near):
    dialect = Dialect()
    text = f"{key}: unknown, and ignored; did you mean {near}?"
    assert dialect.note(op, {"op": op, key: "x"}) == text
    assert dialect.hears("warning")
    assert dialect.note(op, {"op": op, key: "x"}) == ""


def test_a_key_that_is_there_already_was_not_meant():
    assert Dialect().note("subscribe", {"topic": "/t", "topics": "/t"}) == ""


@pytest.mark.parametrize(
    "key", ["uid", "ids", "ip", "tag", "queue_size", "latch", "label", "compresn"]
)
def test_a_key_of_other_libraries_is_not_a_misspelling(key):
    assert Dialect().note("subscribe", {"op": "subscribe", key: "x"}) == ""


def test_a_bounded_number_of_keys_is_compared():
    dialect = Dialect()
    many = {f"{number}": 0 for number in range(63)}
    dialect.note("subscribe", many)
    assert dialect.note("subscribe", {"feilds": 0})
    assert dialect.note("subscribe", {"typ": 0}) == ""


def test_a_long_key_is_not_kept():
    dialect = Dialect()
    tracemalloc.start()
    try:
        for number in range(64):
            assert dialect.note("subscribe", {f"{number}" * 10_000: 0}) == ""
        assert tracemalloc.get_traced_memory()[0] < 10_000
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("op", ["call_service", "send_action_goal"])
@pytest.mark.parametrize("key", ["agrs", "request", "goal", "k" * 300])
@pytest.mark.parametrize("value", [{"data": True}, [True]])
def test_arguments_under_another_key_are_refused_each_time(op, key, value):
    """A call that acts by defaults would switch a motor off instead of on."""
    dialect = Dialect()
    for _ in range(2):
        with pytest.raises(ProtocolError, match="did you mean args") as refused:
            dialect.note(op, {"op": op, key: value})
        assert len(str(refused.value)) < 200


@pytest.mark.parametrize("op", ["call_service", "send_action_goal"])
def test_an_unknown_object_next_to_args_is_ignored(op):
    dialect = Dialect()
    assert dialect.note(op, {"op": op, "args": {}, "meta": {"a": 1}}) == ""
    assert dialect.note(op, {"op": op, "comment": "a text"}) == ""
    assert dialect.note("publish", {"op": "publish", "meta": {"a": 1}}) == ""
