# SPDX-License-Identifier: Apache-2.0
import base64
import json
from functools import partial

import numpy as np
import pytest

from gateway.calls import Calls
from gateway.codec.json import dumps
from gateway.codec.types import Types
from gateway.ports import Request, Ros
from gateway.protocol.errors import ProtocolError
from gateway.rosapi import Parameters, SetResult
from gateway.rosapi.parameters import NODES_AT_ONCE
from schemas.installed import InstalledDefinitions
from tests.client import eventually
from tests.ros.fake import FakeRos
from tests.rosapi.conftest import discovered
from tests.rosapi.robot import NAMES, NodeWithParameters

OK = SetResult(successful=True)


async def test_names_are_listed_sorted(parameters: Parameters) -> None:
    names = await parameters.list_names("/robot")
    assert names == sorted(names)
    assert set(names) >= set(NAMES)


async def test_names_below_a_prefix_are_listed(parameters: Parameters) -> None:
    assert await parameters.list_names("robot", ["camera"]) == ["camera.fps", "camera.name"]


async def test_values_of_every_kind_are_read(parameters: Parameters) -> None:
    values = json.loads(dumps(await parameters.get("/robot")))
    assert {name: values[name] for name in NAMES} == {
        "anything": 1,
        "calibration": base64.b64encode(b"\x00\xff").decode(),
        "camera.fps": 30,
        "camera.name": "front",
        "firmware": "1.2",
        "flags": [True, False],
        "gains": [0.1, None],
        "labels": ["a", "b"],
        "later": None,
        "speed": 0.5,
        "steps": [1, 2],
        "use_sim_time": False,
        "verbose": False,
    }


async def test_a_parameter_without_a_value_does_not_hide_the_others(
    parameters: Parameters,
) -> None:
    values = await parameters.get("/robot", ["speed", "later", "verbose"])
    assert values == {"speed": 0.5, "later": None, "verbose": False}


async def test_an_undeclared_parameter_is_not_found_but_guessed(parameters: Parameters) -> None:
    with pytest.raises(ProtocolError) as caught:
        await parameters.get("/robot", ["verbose", "sped"])
    assert caught.value.code == "not_found"
    assert str(caught.value) == ("node /robot has not declared parameter sped; did you mean speed?")


async def test_an_unknown_node_is_not_found_but_guessed(parameters: Parameters) -> None:
    with pytest.raises(ProtocolError, match="node /robbot does not exist; did you mean /robot") as (
        caught
    ):
        await parameters.get("/robbot", ["speed"])
    assert caught.value.code == "not_found"


async def test_a_silent_node_is_a_timeout(
    parameters: Parameters, ros: Ros, silent: NodeWithParameters
) -> None:
    await discovered(ros, silent)
    with pytest.raises(ProtocolError, match=r"node /silent has not answered within 0\.2 s") as (
        caught
    ):
        await parameters.get("/silent", timeout_s=0.2)
    assert caught.value.code == "timeout"


async def test_a_node_without_parameters_is_told_apart_from_a_silent_one(
    parameters: Parameters, ros: Ros
) -> None:
    bare = NodeWithParameters("bare", start_parameter_services=False)
    try:
        await eventually(lambda: "/bare" in ros.graph().nodes)
        with pytest.raises(ProtocolError, match="node /bare offers no parameters") as caught:
            await parameters.get("/bare", timeout_s=0.2)
    finally:
        bare.close()
    assert caught.value.code == "not_found"


@pytest.mark.parametrize(
    ("name", "value", "held"),
    [
        ("verbose", True, True),
        ("speed", 2, 2.0),
        ("camera.fps", 25.0, 25),
        ("camera.name", "rear", "rear"),
        ("gains", [1, 2.5], [1.0, 2.5]),
        ("gains", [], []),
        ("steps", [3], [3]),
        ("flags", [], []),
        ("labels", ["c"], ["c"]),
        ("calibration", "AQI=", [b"\x01", b"\x02"]),
        ("calibration", [3, 4], [b"\x03", b"\x04"]),
        ("later", 7, 7.0),
        ("anything", 5, 5),
        ("anything", "now a string", "now a string"),
        ("anything", [1, 2.5], [1.0, 2.5]),
    ],
)
async def test_a_value_takes_the_type_of_its_parameter(
    parameters: Parameters, robot: NodeWithParameters, name: str, value: object, held: object
) -> None:
    assert await parameters.set("/robot", {name: value}) == {name: OK}
    now = robot.value(name)
    assert list(now) == held if isinstance(held, list) else now == held
    assert type(now) is type(held) or isinstance(held, list)


async def test_null_in_an_array_of_doubles_is_nan(
    parameters: Parameters, robot: NodeWithParameters
) -> None:
    assert await parameters.set("/robot", {"gains": [None, 1]}) == {"gains": OK}
    np.testing.assert_array_equal(robot.value("gains"), [np.nan, 1.0])


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("verbose", 1, "expected true or false, got 1"),
        ("speed", "fast", "expected a finite number, got a string"),
        ("speed", True, "expected a finite number, got true"),
        ("camera.fps", 2.5, "expected an integer of 64 bits, got 2.5"),
        ("camera.name", 5, "expected a string without U+0000, got 5"),
        ("gains", 1.0, "expected an array, got 1.0"),
        ("steps", [1, "2"], "[1]: expected an integer of 64 bits, got a string"),
        ("anything", {"a": 1}, "got an object"),
        ("anything", [], "an empty array has no type"),
        ("speed", 3.0, "speed"),
        ("firmware", "2.0", "firmware"),
        ("nowhere", 1, "the node has not declared it: "),
    ],
)
async def test_what_does_not_fit_is_refused_with_a_reason_and_harms_no_other(
    parameters: Parameters, robot: NodeWithParameters, name: str, value: object, reason: str
) -> None:
    results = await parameters.set("/robot", {name: value, "labels": ["set"]})
    assert not results[name].successful
    assert reason in results[name].reason
    assert results["labels"] == OK
    assert list(robot.value("labels")) == ["set"]


async def test_null_undeclares_a_parameter_that_may_change_its_type(
    parameters: Parameters, robot: NodeWithParameters
) -> None:
    assert await parameters.set("/robot", {"anything": None}) == {"anything": OK}
    assert not robot.node.has_parameter("anything")


async def test_null_for_a_parameter_of_fixed_type_is_refused(parameters: Parameters) -> None:
    results = await parameters.set("/robot", {"speed": None, "nowhere": None})
    assert not results["speed"].successful
    assert results["speed"].reason
    assert not results["nowhere"].successful
    assert results["nowhere"].reason


async def test_an_undeclared_parameter_takes_the_type_of_its_value(
    parameters: Parameters, ros: Ros
) -> None:
    liberal = NodeWithParameters("liberal", allow_undeclared_parameters=True)
    try:
        await discovered(ros, liberal)
        values = {"a": 1, "b": 1.5, "c": "x", "d": True, "e": [1, 2.5], "f": [False]}
        results = await parameters.set("/liberal", dict(values))
        assert all(result.successful for result in results.values())
        assert json.loads(dumps(await parameters.get("/liberal", list(values)))) == values
    finally:
        liberal.close()


async def test_parameters_are_described(parameters: Parameters) -> None:
    described = await parameters.describe("/robot", ["speed", "camera.fps", "firmware"])
    assert described["speed"] == {
        "type": "double",
        "description": "metres a second",
        "additional_constraints": "",
        "read_only": False,
        "dynamic_typing": False,
        "range": {"from": 0.0, "to": 2.0, "step": 0.0},
    }
    assert described["camera.fps"]["range"] == {"from": 1, "to": 60, "step": 1}
    assert described["firmware"]["read_only"]
    assert "range" not in described["firmware"]


async def test_all_parameters_are_described_without_names(parameters: Parameters) -> None:
    assert set(await parameters.describe("/robot")) >= set(NAMES)


async def test_describing_an_undeclared_parameter_is_not_found(parameters: Parameters) -> None:
    with pytest.raises(ProtocolError, match="node /robot has not declared parameter fps"):
        await parameters.describe("/robot", ["fps", "speed"])


async def test_a_dead_node_is_left_out_of_the_names_of_all(
    parameters: Parameters, ros: Ros, silent: NodeWithParameters
) -> None:
    await discovered(ros, silent)
    found = await parameters.names_by_node()
    assert set(found["/robot"]) >= set(NAMES)
    assert "/silent" not in found


async def test_more_dead_nodes_than_are_asked_at_once_do_not_hide_a_living_one() -> None:
    fake = FakeRos()
    types = Types(InstalledDefinitions())
    service = types.service("rcl_interfaces/srv/ListParameters")
    names = {"result": {"names": ["speed"]}}
    response = service.response.encode(service.response.validate(names, 0))
    for number in range(NODES_AT_ONCE + 1):
        fake.add_service(f"/dead{number}/list_parameters", service.name, lambda request: None)
    fake.add_service(
        "/living/list_parameters", service.name, lambda request: request.answer(response)
    )
    calls = Calls(fake, types)
    assert await Parameters(fake, calls).names_by_node() == {"/living": ["speed"]}
    calls.close()
    assert not fake.entity_count()


async def test_a_node_that_loses_answers_is_told_of() -> None:
    fake = FakeRos()
    types = Types(InstalledDefinitions())
    for name in ("describe_parameters", "set_parameters"):
        type_name = "".join(part.capitalize() for part in name.split("_"))
        empty = types.service(f"rcl_interfaces/srv/{type_name}").response
        response = empty.encode(empty.validate({}, 0))
        fake.add_service(
            f"/broken/{name}",
            f"rcl_interfaces/srv/{type_name}",
            partial(_answer, response),
            node="/broken",
        )
    calls = Calls(fake, types)
    with pytest.raises(ProtocolError, match="node /broken answered 0 results for 2 parameters"):
        await Parameters(fake, calls).set("/broken", {"a": 1, "b": 2})
    calls.close()


def _answer(response: bytes, request: Request) -> None:
    request.answer(response)
