# SPDX-License-Identifier: Apache-2.0
from typing import Any

import pytest
from pydantic import BaseModel, ValidationError

from gateway.protocol.operations import OPERATIONS
from gateway.protocol.operations.gateway import Ping
from gateway.protocol.operations.parameters import SetParameters
from gateway.protocol.operations.services import CallService
from gateway.protocol.operations.topics import (
    ImageRequest,
    Publish,
    QosRequest,
    SecsNsecs,
    Subscribe,
)
from gateway.protocol.operations.transforms import StampRequest

NEEDED: dict[str, Any] = {
    **dict.fromkeys(["topic", "service", "action", "node", "data", "id", "type"], "x"),
    **dict.fromkeys(["target_frame", "source_frame"], "x"),
    "num": 0,
    "total": 1,
    "sec": 0,
    "level": "info",
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


@pytest.mark.parametrize(("model", "name"), OPTIONAL)
def test_what_may_be_left_out_may_be_null(model, name):
    values = least(model)
    assert model.model_validate(values | {name: None}) == model.model_validate(values)


@pytest.mark.parametrize(
    ("model", "name"), [(model, name) for model in MODELS for name in least(model) if name != "msg"]
)
def test_what_must_not_be_left_out_must_not_be_null(model, name):
    with pytest.raises(ValidationError) as caught:
        model.model_validate(least(model) | {name: None})
    assert [(error["type"], error["loc"]) for error in caught.value.errors()] == [
        ("missing", (name,))
    ]


def test_null_stays_a_value_where_any_value_may_stand():
    assert Publish.model_validate({"topic": "/t", "msg": None}).msg is None
    assert Ping.model_validate({"value": {"x": None}}).value == {"x": None}
    deletes = {"node": "/n", "values": {"speed": None}}
    assert SetParameters.model_validate(deletes).values == {"speed": None}


def test_null_within_an_object_of_an_operation_counts_as_absent_too():
    wish = {"topic": "/t", "qos": {"depth": 3, "deadline": None}, "image": {"format": None}}
    subscribe = Subscribe.model_validate(wish)
    assert subscribe.image == ImageRequest()
    assert subscribe.qos == QosRequest(depth=3)


@pytest.mark.parametrize("size", [0, None])
@pytest.mark.parametrize("wanted", [{"topic": "/t"}, {"service": "/s"}, {"action": "/a"}])
def test_a_fragment_size_of_nothing_means_no_fragments(size, wanted):
    op = {"topic": "subscribe", "service": "call_service", "action": "send_action_goal"}
    (kind,) = wanted
    operation = OPERATIONS[op[kind]].model_validate(wanted | {"fragment_size": size})
    assert getattr(operation, "fragment_size", ...) is None


@pytest.mark.parametrize("size", [-1, 1, 63, 0.0, False, "0"])
def test_a_fragment_size_that_is_too_small_or_no_integer_is_refused(size):
    with pytest.raises(ValidationError):
        CallService.model_validate({"service": "/s", "fragment_size": size})
