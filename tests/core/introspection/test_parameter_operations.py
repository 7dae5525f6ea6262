# SPDX-License-Identifier: Apache-2.0
from collections.abc import Sequence
from typing import Any, cast

import pytest

from gateway.core.errors import ProtocolError
from gateway.core.introspection.parameter_operations import ParameterOperations
from gateway.core.requests import (
    DescribeParameters,
    GetParameters,
    ListParameters,
    SetParameters,
)
from gateway.core.rosapi import Parameters, SetResult


class Scripted:
    """Parameters that answer what they are told to, and keep what they were asked."""

    def __init__(self, answer: Any) -> None:
        self.answer = answer
        self.asked: tuple[Any, ...] = ()

    async def _answer(self, *asked: Any) -> Any:
        self.asked = asked
        if isinstance(self.answer, Exception):
            raise self.answer
        return self.answer

    list_names = get = set = describe = _answer


def build(answer: Any) -> tuple[ParameterOperations, Scripted]:
    scripted = Scripted(answer)
    return ParameterOperations(cast("Parameters", scripted)), scripted


async def test_names_are_listed() -> None:
    operations, scripted = build(["a.b"])
    request = ListParameters(node="robot", prefixes=("a",), timeout=3)
    assert await operations.list(request) == {"node": "robot", "names": ["a.b"]}
    assert scripted.asked == ("robot", ("a",), 3.0)


@pytest.mark.parametrize("names", [None, ("speed",)])
async def test_values_are_read(names: Sequence[str] | None) -> None:
    operations, scripted = build({"speed": 0.5})
    request = GetParameters(node="/robot", names=None if names is None else tuple(names))
    assert await operations.get(request) == {"node": "/robot", "values": {"speed": 0.5}}
    assert scripted.asked == ("/robot", names, 2.5)


async def test_the_outcome_of_each_value_is_reported() -> None:
    operations, _ = build({"a": SetResult(successful=True), "b": SetResult(False, "too fast")})
    request = SetParameters(node="/robot", values={"a": 1, "b": 2})
    assert await operations.set(request) == {
        "node": "/robot",
        "results": {
            "a": {"successful": True, "reason": ""},
            "b": {"successful": False, "reason": "too fast"},
        },
    }


async def test_parameters_are_described() -> None:
    operations, _ = build({"speed": {"type": "double"}})
    assert await operations.describe(DescribeParameters(node="/robot")) == {
        "node": "/robot",
        "parameters": {"speed": {"type": "double"}},
    }


@pytest.mark.parametrize("asked", [1e9, 0])
async def test_a_request_to_a_node_has_a_timeout(asked: float) -> None:
    operations, scripted = build({})
    await operations.get(GetParameters(node="/robot", timeout=asked))
    assert scripted.asked[-1] == 60


async def test_errors_of_a_node_reach_the_client() -> None:
    operations, _ = build(ProtocolError("timeout", "node /robot has not answered within 1 s"))
    with pytest.raises(ProtocolError, match="has not answered"):
        await operations.get(GetParameters(node="/robot"))
