# SPDX-License-Identifier: Apache-2.0
"""Every number of every operation, as large and as small as JSON can write it."""

import asyncio
import json
import logging
import re
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
from hypothesis import strategies as st

from gateway.codec.types import Types
from gateway.config.limits import Limits
from gateway.core.router import Router
from gateway.fronts.rosbridge.front import RosbridgeFront
from gateway.fronts.rosbridge.operations import OPERATIONS
from schemas.installed import InstalledDefinitions
from schemas.table import Table
from tests.core.conftest import IMAGE, Socketless
from tests.sources.fake import FakeRos

TYPES = Types(InstalledDefinitions())
TABLE = Table.load()
BEYOND_FLOAT = "@1e999"  # written without its quotes
TOKENS = ["@NaN", "@Infinity", "@-Infinity"]  # likewise
EXTREMES = [
    *(
        0,
        -1,
        1,
        2,
        63,
        64,
        1024,
        1025,
        2**31 - 1,
        2**31,
        2**53,
        2**63 - 1,
        2**63,
        2**64,
        10**30,
    ),
    *(-(2**63), -(10**30), 0.0, -0.0, 0.5, 1e-9, 1e-308, 1e-320, 5e-324, -5e-324),
    *(
        999.999,
        1e9,
        1e9 + 1,
        3_600_000.0,
        3_600_001.0,
        1e18,
        1e19,
        1e308,
        -1e308,
        BEYOND_FLOAT,
        *TOKENS,
    ),
]
NUMBERS = st.sampled_from(EXTREMES)
# of the members that an operation must have, so that its numbers are looked at
PLAUSIBLE = {"topic": "/camera", "type": IMAGE, "values": {"a": 1}, "level": "info"}
TEXTS = st.sampled_from(
    ["/camera", "/t", IMAGE, "std_msgs/msg/String", "std_srvs/srv/Trigger", "a"]
)
ANYTHING = st.one_of(
    NUMBERS, TEXTS, st.lists(NUMBERS, max_size=3), st.dictionaries(TEXTS, NUMBERS, max_size=3)
)


def values(schema: dict[str, Any], definitions: dict[str, Any]) -> st.SearchStrategy[Any]:
    """Return values of the kinds that a JSON Schema asks for. Numbers keep to no bounds."""
    if "$ref" in schema:
        return values(definitions[schema["$ref"].rpartition("/")[2]], definitions)
    if "anyOf" in schema:
        return st.one_of([values(each, definitions) for each in schema["anyOf"]])
    if "enum" in schema:
        return st.sampled_from(schema["enum"])
    match schema.get("type"):
        case "integer" | "number":
            return NUMBERS
        case "string":
            return TEXTS
        case "boolean":
            return st.booleans()
        case "null":
            return st.none()
        case "array":
            items = schema.get("items") or {"type": "number"}
            size = schema.get("minItems", 0)
            return st.lists(values(items, definitions), min_size=size, max_size=max(size, 2))
        case "object" if "properties" in schema:
            members = {
                name: values(member, definitions) for name, member in schema["properties"].items()
            }
            required = {name: members.pop(name) for name in schema.get("required", ())}
            return st.fixed_dictionaries(required, optional=members)
    return ANYTHING


Way = tuple[str | int, ...]


def numbers(schema: dict[str, Any], definitions: dict[str, Any], way: Way = ()) -> Iterator[Way]:
    """Yield the way to each number of a JSON Schema."""
    if "$ref" in schema:
        yield from numbers(definitions[schema["$ref"].rpartition("/")[2]], definitions, way)
    for each in schema.get("anyOf", ()):
        yield from numbers(each, definitions, way)
    if schema.get("type") in {"integer", "number"}:
        yield way
    for name, member in schema.get("properties", {}).items():
        yield from numbers(member, definitions, (*way, name))
    for index, item in enumerate(schema.get("prefixItems", ())):
        yield from numbers(item, definitions, (*way, index))


def with_one_number(op: str, way: Way, number: object) -> dict[str, Any]:
    """Return an operation that is valid except for one number."""
    value = number
    for part in reversed(way[1:]):
        value = {part: value} if isinstance(part, str) else [number, number]
    required = OPERATIONS[op].model_json_schema().get("required", ())
    return {**{name: PLAUSIBLE.get(name, "a") for name in required}, str(way[0]): value}


def operations(op: str) -> st.SearchStrategy[dict[str, Any]]:
    schema = OPERATIONS[op].model_json_schema()
    return values(schema, schema.get("$defs", {}))


class Gateway:
    """A gateway with a camera, for each operation a client, and the errors of its loop."""

    def __init__(self, workers: ThreadPoolExecutor) -> None:
        self.errors: list[Any] = []
        ros = FakeRos()
        self.camera = ros.add_publisher("/camera", IMAGE)
        self.picture = TYPES.get(IMAGE).encode({}, now_ns=lambda: 0)
        self.router = Router(ros, TYPES, TABLE, limits=Limits(), workers=workers, version="test")
        self.front = RosbridgeFront(self.router)

    async def carry_out(self, text: str) -> list[Any]:
        """Send an operation twice. Return the errors of the loop."""
        client = Socketless(self.front, "")
        for _ in range(2):
            client.send_raw(text.encode())
            self.camera.publish(self.picture)
            for _ in range(3):
                await asyncio.sleep(0)
        self.router.leave(client.session)
        await asyncio.sleep(0)
        return self.errors


CarryOut = Callable[[dict[str, Any], str], bool]


@pytest.fixture
def is_carried_out(caplog: pytest.LogCaptureFixture) -> Iterator[CarryOut]:
    """Return a function that says whether an operation has caused no fault."""
    with asyncio.Runner() as runner, ThreadPoolExecutor(1) as workers:

        async def begin() -> Gateway:
            gateway = Gateway(workers)
            asyncio.get_running_loop().set_exception_handler(
                lambda _, context: gateway.errors.append(context)
            )
            return gateway

        async def end() -> None:
            gateway.router.close()
            await asyncio.sleep(0)

        def is_carried_out(members: dict[str, Any], op: str) -> bool:
            errors = runner.run(gateway.carry_out(written({**members, "op": op})))
            logged = [each for each in caplog.records if each.levelno >= logging.ERROR]
            return not errors and not logged

        gateway = runner.run(begin())
        yield is_carried_out
        runner.run(end())
        assert gateway.errors == []


def written(operation: dict[str, Any]) -> str:
    return re.sub(r'"@([^"]*)"', r"\1", json.dumps(operation))


@pytest.mark.parametrize("op", sorted(OPERATIONS))
def test_each_number_of_an_operation_may_be_anything(op: str, is_carried_out: CarryOut):
    schema = OPERATIONS[op].model_json_schema()
    for way in set(numbers(schema, schema.get("$defs", {}))):
        for number in EXTREMES:
            members = with_one_number(op, way, number)
            assert is_carried_out(members, op), members


@pytest.mark.parametrize("member", [{"image": {"max_fps": 1e-320}}, {"image": {"max_fps": 0.0009}}])
async def test_a_rate_of_less_than_one_in_a_quarter_of_an_hour_is_refused(bench, member):
    client = bench.client()
    client.send(op="subscribe", topic="/camera", type=IMAGE, **member)
    ((code, text),) = client.statuses
    assert code == "bad_request"
    assert text.startswith("image.max_fps: expected at least 0.001")


async def test_a_lookup_less_often_than_once_in_a_quarter_of_an_hour_is_refused(bench):
    client = bench.client()
    operation = {"op": "lookup_transform", "target_frame": "a", "source_frame": "b"}
    client.send(**operation, rate=1e-320)
    ((code, text),) = client.statuses
    assert code == "bad_request"
    assert text.startswith("rate: expected at least 0.001")
