# SPDX-License-Identifier: Apache-2.0
import asyncio
import json
from typing import Any

import pytest

from gateway.codec.error_text import MAX_ECHO
from gateway.core.rosapi import Parameters, Rosapi
from gateway.sources.source import Ros
from schemas.installed import InstalledDefinitions
from tests.clock import StoppedClock
from tests.core.rosapi.robot import NAMES, NodeWithParameters
from tests.core.rosapi.scripted import ScriptedNodes


@pytest.fixture
async def rosapi(ros: Ros, parameters: Parameters) -> Rosapi:
    return Rosapi(ros, InstalledDefinitions(), parameters)


async def answer(rosapi: Rosapi, name: str, *args: str) -> Any:
    answered = rosapi.answer(f"/rosapi/{name}", list(args))
    assert not isinstance(answered, dict)
    return await answered()


@pytest.mark.parametrize("name", ["/robot:gains", "robot:gains"])
async def test_a_value_is_json_in_a_string(rosapi: Rosapi, name: str) -> None:
    assert await answer(rosapi, "get_param", name) == {
        "value": '[0.1,"NaN"]',
        "successful": True,
        "reason": "",
    }


@pytest.mark.parametrize(
    ("default", "value"),
    [
        ("", "null"),
        ("5", "5"),
        ('{"a":[1]}', '{"a":[1]}'),
        ("plain text", '"plain text"'),
        ("NaN", '"NaN"'),
    ],
)
async def test_the_default_stands_in_as_json(rosapi: Rosapi, default: str, value: str) -> None:
    answered = await answer(rosapi, "get_param", "/robot:sped", default)
    assert answered == {
        "value": value,
        "successful": False,
        "reason": "node /robot has not declared parameter sped; did you mean speed?",
    }


async def test_a_parameter_without_a_value_has_the_default(rosapi: Rosapi) -> None:
    answered = await answer(rosapi, "get_param", "/robot:later", "1.5")
    assert answered == {
        "value": "1.5",
        "successful": False,
        "reason": "the parameter has no value",
    }


@pytest.mark.parametrize("name", ["", "speed", "/robot", ":speed", "/robot:"])
async def test_a_name_without_node_or_parameter_is_explained(rosapi: Rosapi, name: str) -> None:
    for service in ("get_param", "set_param", "delete_param"):
        answered = await answer(rosapi, service, name, *(["1"] if service == "set_param" else []))
        assert not answered["successful"]
        assert answered["reason"] == f"name: expected node:parameter, got {name!r}"


async def test_a_value_is_set_from_json(rosapi: Rosapi, robot: NodeWithParameters) -> None:
    assert await answer(rosapi, "set_param", "/robot:speed", "1") == {
        "successful": True,
        "reason": "",
    }
    assert robot.value("speed") == 1.0


async def test_text_that_is_not_json_is_not_set(rosapi: Rosapi, robot: NodeWithParameters) -> None:
    answered = await answer(rosapi, "set_param", "/robot:camera.name", "rear")
    assert answered == {"successful": False, "reason": "value: expected JSON, got 'rear'"}
    assert robot.value("camera.name") == "front"


async def test_a_long_text_that_is_not_json_comes_back_shortened(rosapi: Rosapi) -> None:
    answered = await answer(rosapi, "set_param", "/robot:speed", "x" * 10_000)
    assert len(answered["reason"]) < 2 * MAX_ECHO


async def test_a_long_invalid_name_comes_back_shortened(rosapi: Rosapi) -> None:
    answered = await answer(rosapi, "delete_param", "x" * 10_000)
    assert answered["reason"] == f"name: expected node:parameter, got {'x' * 125 + '...'!r}"


async def test_a_refusal_of_the_node_comes_with_its_reason(rosapi: Rosapi) -> None:
    answered = await answer(rosapi, "set_param", "/robot:firmware", '"2.0"')
    assert not answered["successful"]
    assert "read-only" in answered["reason"]


async def test_a_node_that_is_unknown_is_explained(rosapi: Rosapi) -> None:
    for service, args in [("set_param", ["/robt:speed", "1"]), ("delete_param", ["/robt:speed"])]:
        answered = await answer(rosapi, service, *args)
        assert answered == {
            "successful": False,
            "reason": "node /robt does not exist; did you mean /robot?",
        }


async def test_a_parameter_is_deleted(rosapi: Rosapi, robot: NodeWithParameters) -> None:
    answered = await answer(rosapi, "delete_param", "/robot:anything")
    assert answered == {"successful": True, "reason": ""}
    assert not robot.node.has_parameter("anything")


@pytest.mark.parametrize(
    ("name", "exists"),
    [
        ("/robot:speed", True),
        ("/robot:sped", False),
        ("/robot:later", False),
        ("/nowhere:speed", False),
        ("speed", False),
    ],
)
async def test_a_parameter_with_a_value_exists(rosapi: Rosapi, name: str, exists: bool) -> None:
    assert await answer(rosapi, "has_param", name) == {"exists": exists}


async def test_names_of_all_nodes_come_with_their_node(rosapi: Rosapi) -> None:
    answered = await answer(rosapi, "get_param_names")
    assert {f"/robot:{name}" for name in NAMES} <= set(answered["names"])
    value = await answer(rosapi, "get_param", "/robot:camera.fps")
    assert json.loads(value["value"]) == 30


@pytest.mark.parametrize(
    ("timeout_s", "waited_s"), [(None, 2.5), (20.0, 20.0), (0.0, 60.0), (1e9, 60.0)]
)
@pytest.mark.parametrize(
    ("name", "args"),
    [
        ("get_param", ["/robot:speed", ""]),
        ("has_param", ["/robot:speed"]),
        ("set_param", ["/robot:speed", "1"]),
        ("delete_param", ["/robot:speed"]),
    ],
)
async def test_a_node_has_the_time_that_the_client_gives_it(
    nodes: ScriptedNodes, name: str, args: list[str], timeout_s: float | None, waited_s: float
) -> None:
    nodes.add("/robot", "speed")
    rosapi = Rosapi(nodes.ros, InstalledDefinitions(), nodes.parameters)
    answered = rosapi.answer(f"/rosapi/{name}", args, timeout_s)
    assert not isinstance(answered, dict)
    await answered()
    assert waited_s / 2 < nodes.calls.timeouts_s[0] <= waited_s


async def test_names_of_all_nodes_come_within_the_time_that_the_client_gives(
    nodes: ScriptedNodes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("gateway.core.rosapi.node_parameters.EACH_NODE_TIMEOUT_S", 3600.0)
    monkeypatch.setattr("gateway.core.rosapi.parameter_services.ALL_NODES_TIMEOUT_S", 3600.0)
    nodes.add("/robot", "speed")
    nodes.add_silent("/dead")
    rosapi = Rosapi(nodes.ros, InstalledDefinitions(), nodes.parameters)
    answered = rosapi.answer("/rosapi/get_param_names", None, 0.1)
    assert not isinstance(answered, dict)
    clock = StoppedClock(monkeypatch)
    names = asyncio.ensure_future(answered())
    await clock.advance(0)  # it asks
    await clock.advance(0.09)
    assert not names.done()
    await clock.advance(0.02)
    assert names.result() == {"names": ["/robot:speed"]}
