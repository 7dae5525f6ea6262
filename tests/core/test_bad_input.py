# SPDX-License-Identifier: Apache-2.0
"""Every operation is carried out or answered, and none raises an exception."""

import random
from typing import Any

import pytest

from gateway.fronts.rosbridge.operations import OPERATIONS
from tests.client import eventually
from tests.core.conftest import Bench

NAMES = ["/arm", "arm", "/fib", "/chatter", "/rosapi/topics", "rosapi/get_param", "/a b", "", "/"]
TYPES = ["std_srvs/SetBool", "test_msgs/Fibonacci", "std_msgs/String", "x", "a/b/c", 0, 7, -1]
VALUES: list[Any] = [
    *(None, True, 0, -1, 1.5, 10**18, "", "x", "\x00", "é", [], {}, [1, "x"], {"x": {"y": []}}),
    *(
        {"data": True},
        {"data": "x"},
        {"order": 3},
        {"sequence": [1]},
        {"success": True},
        ["a", "b"],
    ),
]
LIKELY = {
    **dict.fromkeys(["topic", "service", "action", "node", "target_frame", "source_frame"], NAMES),
    **dict.fromkeys(["type", "action_type"], TYPES),
    "id": [1, "a", "b", None],
    "num": [0, 1, 2],
    "total": [1, 2, 3],
    "data": ["{", '{"op":"ping"}', "}"],
    "fragment_size": [64, 1, 2**31 - 1, 200],
    "compression": ["none", "cbor", "cbor-raw", "png", "zip"],
    "timeout": [0.01, 0, -1, "5"],
    "rate": [1, 100, 0, 1e9],
}


ANSWERED_BY_THREADS = {"fetch_asset", "generate"}


def operations(chance: random.Random, op: str) -> dict[str, Any]:
    """Return an operation that is likely to be wrong somewhere."""
    operation: dict[str, Any] = {"op": op}
    for name in OPERATIONS[op].model_fields:
        if chance.random() < 0.8:
            likely = LIKELY.get(name, VALUES)
            operation[name] = chance.choice(likely if chance.random() < 0.9 else VALUES)
    return operation


@pytest.mark.parametrize("op", OPERATIONS)
async def test_every_operation_that_is_refused_is_answered_with_its_id(
    bench: Bench, op: str
) -> None:
    bench.ros.add_service("/arm", "std_srvs/srv/SetBool", lambda request: None)
    bench.ros.add_action_server(
        "/fib", "test_msgs/action/Fibonacci", lambda goal: None, lambda goal: None
    )
    chance = random.Random(op)
    client = bench.client()
    for number in range(300):
        if number % 60 == 59:
            bench.router.leave(client.session)
            client = bench.client()
        operation = operations(chance, op)
        refused, count = client.session.refused, len(client.frames)
        client.send(**operation)
        await bench.settle()
        if op in ANSWERED_BY_THREADS:
            await eventually(lambda: not bench.router.counts()["calls"])
        if client.session.refused > refused:
            answers = client.frames[count:]
            assert answers, operation
            if op != "fragment" and type(operation.get("id")) in {str, int}:
                assert operation["id"] in [answer.get("id") for answer in answers], operation
    bench.router.leave(client.session)
