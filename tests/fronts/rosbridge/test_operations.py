# SPDX-License-Identifier: Apache-2.0
from dataclasses import fields
from typing import Any, get_args

import pytest
from pydantic import BaseModel, ValidationError

from gateway.fronts.rosbridge.operations import OPERATIONS, ClientOperation
from gateway.fronts.rosbridge.operations.base import Operation
from gateway.fronts.rosbridge.operations.gateway import Ping
from gateway.fronts.rosbridge.operations.parameters import SetParameters
from gateway.fronts.rosbridge.operations.services import CallService
from gateway.fronts.rosbridge.operations.topics import (
    ImageRequest,
    Publish,
    QosRequest,
    SecsNsecs,
    Subscribe,
)
from gateway.fronts.rosbridge.operations.transforms import StampRequest

NEEDED: dict[str, Any] = {
    **dict.fromkeys(["topic", "service", "action", "node", "data", "id", "type", "uri"], "x"),
    **dict.fromkeys(["target_frame", "source_frame"], "x"),
    "num": 0,
    "total": 1,
    "sec": 0,
    "level": "info",
    "language": "csharp",
    "types": ["x"],
    "msg": {},
    "values": {"x": 1},
}
MODELS: list[type[BaseModel]] = [
    *OPERATIONS.values(),
    *(QosRequest, ImageRequest, SecsNsecs, StampRequest),
]
OPTIONAL = [
    (model, name)
    for model in MODELS
    for name, field in model.model_fields.items()
    if not field.is_required()
]


def least(model: type[BaseModel]) -> dict[str, Any]:
    return {name: NEEDED[name] for name, field in model.model_fields.items() if field.is_required()}


def read(model: type[BaseModel], values: dict[str, Any]) -> BaseModel:
    return model.read(values) if issubclass(model, Operation) else model.model_validate(values)


@pytest.mark.parametrize(("model", "name"), OPTIONAL)
def test_optional_fields_may_be_null(model, name):
    values = least(model)
    assert read(model, values | {name: None}) == read(model, values)


@pytest.mark.parametrize(
    ("model", "name"), [(model, name) for model in MODELS for name in least(model) if name != "msg"]
)
def test_required_fields_must_not_be_null(model, name):
    with pytest.raises(ValidationError) as caught:
        read(model, least(model) | {name: None})
    assert [(error["type"], error["loc"]) for error in caught.value.errors()] == [
        ("missing", (name,))
    ]


def test_null_stays_a_value_where_any_value_may_stand():
    assert Publish.read({"topic": "/t", "msg": None}).msg is None
    assert Ping.read({"value": {"x": None}}).value == {"x": None}
    deletes = {"node": "/n", "values": {"speed": None}}
    assert SetParameters.read(deletes).values == {"speed": None}


def test_null_within_an_object_of_an_operation_counts_as_absent_too():
    options = {"topic": "/t", "qos": {"depth": 3, "deadline": None}, "image": {"format": None}}
    subscribe = Subscribe.read(options)
    assert subscribe.image == ImageRequest()
    assert subscribe.qos == QosRequest(depth=3)


@pytest.mark.parametrize("size", [0, None])
@pytest.mark.parametrize("wanted", [{"topic": "/t"}, {"service": "/s"}, {"action": "/a"}])
def test_a_fragment_size_of_nothing_means_no_fragments(size, wanted):
    op = {"topic": "subscribe", "service": "call_service", "action": "send_action_goal"}
    (kind,) = wanted
    operation = OPERATIONS[op[kind]].read(wanted | {"fragment_size": size})
    assert getattr(operation, "fragment_size", ...) is None


@pytest.mark.parametrize("size", [-1, 1, 63, 0.0, False, "0"])
def test_a_fragment_size_that_is_too_small_or_no_integer_is_refused(size):
    with pytest.raises(ValidationError):
        CallService.read({"service": "/s", "fragment_size": size})


@pytest.mark.parametrize(
    ("asked", "expected"),
    [
        ({"secs": 3, "nsecs": 4}, (3, 4)),
        ({"sec": 3, "nanosec": 4}, (3, 4)),
        ({"nsecs": 4}, (0, 4)),
        ({}, (0, 0)),
    ],
)
def test_a_lookup_takes_the_time_in_the_names_of_either_ros(asked, expected):
    time = StampRequest.model_validate(asked)
    assert (time.sec, time.nanosec) == expected


def test_a_lookup_takes_a_time_in_the_names_of_one_ros():
    with pytest.raises(ValidationError):
        StampRequest.model_validate({"sec": 3, "secs": 3})


LOOKUP = {"op": "lookup_transform", "target_frame": "map", "source_frame": "odom"}
SUBSCRIBE = {"op": "subscribe", "topic": "/t"}
QOS = SUBSCRIBE | {"qos": {}}
IMAGE = SUBSCRIBE | {"image": {}}
CLOUD = SUBSCRIBE | {"cloud": {}}
LIFESPAN = SUBSCRIBE | {"qos": {"lifespan": {}}}
TIME = LOOKUP | {"time": {"sec": 0}}


def with_value(operation: dict[str, Any], path: str, value: Any) -> dict[str, Any]:
    """Return an operation with one value of it, or of an object within it, changed."""
    name, _, below = path.partition(".")
    return operation | {name: with_value(operation[name], below, value) if below else value}


@pytest.mark.parametrize(
    ("operation", "path", "allowed", "refused"),
    [
        ({"op": "ping"}, "id", "x" * 256, "x" * 257),
        ({"op": "call_service", "service": "/s"}, "timeout", 1e9, 1.1e9),
        ({"op": "call_service", "service": "/s"}, "timeout", 0, -0.1),
        (SUBSCRIBE, "throttle_rate", 3_600_000, 3_600_001),
        (SUBSCRIBE, "throttle_rate", 0, -0.1),
        (SUBSCRIBE, "queue_length", 0, -1),
        (SUBSCRIBE, "fragment_size", 64, 63),
        (SUBSCRIBE, "fields", ["x"] * 64, ["x"] * 65),
        (QOS, "qos.depth", 1, 0),
        (QOS, "qos.deadline", 1e9, 1.1e9),
        (LIFESPAN, "qos.lifespan.secs", 10**9, 10**9 + 1),
        (LIFESPAN, "qos.lifespan.secs", 0, -1),
        (LIFESPAN, "qos.lifespan.nsecs", 10**9 - 1, 10**9),
        (LIFESPAN, "qos.lifespan.nsecs", 0, -1),
        (IMAGE, "image.quality", 100, 101),
        (IMAGE, "image.quality", 1, 0),
        (IMAGE, "image.max_width", 8192, 8193),
        (IMAGE, "image.max_width", 1, 0),
        (IMAGE, "image.max_height", 8192, 8193),
        (IMAGE, "image.max_height", 1, 0),
        (IMAGE, "image.max_fps", 1000, 1000.1),
        (IMAGE, "image.max_fps", 0.001, 0.0009),
        (IMAGE, "image.depth_range_m", [0, 0.1], [-0.1, 0.1]),
        (IMAGE, "image.depth_range_m", [1, 2], [2, 2]),
        (CLOUD, "cloud.max_points", 500_000, 500_001),
        (CLOUD, "cloud.max_points", 1, 0),
        (CLOUD, "cloud.voxel_m", 0.001, 0.0009),
        (CLOUD, "cloud.voxel_m", 1000, 1000.1),
        (CLOUD, "cloud.fields", ["x"] * 8, ["x"] * 9),
        ({"op": "advertise", "topic": "/t", "type": "x"}, "queue_size", 0, -1),
        (LOOKUP, "target_frame", "x" * 256, "x" * 257),
        (LOOKUP, "source_frame", "x" * 256, "x" * 257),
        (LOOKUP, "timeout", 60, 60.1),
        (LOOKUP, "timeout", 0, -0.1),
        (LOOKUP, "rate", 200, 200.1),
        (LOOKUP, "rate", 0.001, 0),
        (TIME, "time.sec", 2**31 - 1, 2**31),
        (TIME, "time.sec", 0, -1),
        (TIME, "time.nanosec", 10**9 - 1, 10**9),
        (TIME, "time.nanosec", 0, -1),
        ({"op": "list_parameters", "node": "/n"}, "prefixes", ["x"] * 1024, ["x"] * 1025),
        ({"op": "get_parameters", "node": "/n"}, "names", ["x"] * 1024, ["x"] * 1025),
        ({"op": "describe_parameters", "node": "/n"}, "names", ["x"] * 1024, ["x"] * 1025),
        (
            {"op": "set_parameters", "node": "/n"},
            "values",
            dict.fromkeys(map(str, range(1024))),
            dict.fromkeys(map(str, range(1025))),
        ),
        ({"op": "set_parameters", "node": "/n"}, "values", {"x": 1}, {}),
        ({"op": "fragment", "id": 1, "total": 1, "data": ""}, "num", 0, -1),
        ({"op": "fragment", "id": 1, "num": 0, "data": ""}, "total", 1, 0),
    ],
)  # fmt: skip
def test_the_last_value_within_a_bound_is_taken_and_the_first_beyond_it_refused(
    operation, path, allowed, refused
):
    model = OPERATIONS[operation["op"]]
    read(model, with_value(operation, path, allowed))
    with pytest.raises(ValidationError):
        read(model, with_value(operation, path, refused))


@pytest.mark.parametrize("model", get_args(ClientOperation), ids=lambda model: model.op)
def test_each_operation_becomes_a_request_of_its_kind_with_the_same_fields(model: Any) -> None:
    assert model.makes.kind == model.op
    if model.request is Operation.request:
        taken = {each.name for each in fields(model.makes)}
        assert taken <= model.model_fields.keys()
