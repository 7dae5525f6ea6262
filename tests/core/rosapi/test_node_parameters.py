# SPDX-License-Identifier: Apache-2.0
import asyncio
import base64
import json
import math
from typing import Any

import numpy as np
import pytest

from gateway.codec.json import dumps
from gateway.core.errors import ProtocolError
from gateway.core.rosapi import Parameters, SetResult, node_parameters
from gateway.core.rosapi.node_parameters import EACH_NODE_TIMEOUT_S
from gateway.core.rosapi.unresponsive_nodes import FRESH_S
from gateway.sources.services import ServiceRequest
from gateway.sources.source import Ros
from tests.client import TIMEOUT_S, eventually
from tests.clock import StoppedClock
from tests.core.rosapi.conftest import discovered
from tests.core.rosapi.robot import NAMES, NodeWithParameters
from tests.core.rosapi.scripted import ScriptedNodes
from tests.sources.fake_services import FakeClient

OK = SetResult(successful=True)

NODE_TIMEOUT_S = 2.5
NODES_AT_ONCE = 32


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
        "gains": [0.1, "NaN"],
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


async def test_names_that_are_unknown_come_back_truncated(parameters: Parameters) -> None:
    with pytest.raises(ProtocolError) as caught:
        await parameters.get("/robot", ["x" * 200])
    assert f"declared parameter {'x' * 125}..." in str(caught.value)
    with pytest.raises(ProtocolError) as caught:
        await parameters.get("/" + "x" * 200, ["speed"])
    assert str(caught.value) == f"node /{'x' * 124}... does not exist"


async def test_a_node_is_guessed_by_the_first_128_characters_of_its_name(
    nodes: ScriptedNodes,
) -> None:
    name = "/" + "x" * 127
    nodes.add(name, "speed")
    with pytest.raises(ProtocolError, match=f"did you mean {name}[?]$"):
        await Parameters(nodes.ros, nodes.types, nodes.calls).get(name + "y" * 1000, ["speed"])


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
        ("gains", ["Infinity", "-Infinity"], [math.inf, -math.inf]),
        ("gains", [], []),
        ("later", "Infinity", math.inf),
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
        ("speed", "fast", 'a number, "NaN", "Infinity" or "-Infinity", got a string'),
        ("speed", True, "got true"),
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
async def test_a_value_that_does_not_fit_is_refused_with_a_reason_and_harms_no_other(
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
    found: dict[str, list[str]] = {}
    async with asyncio.timeout(TIMEOUT_S):
        while "/robot" not in found:
            found = await parameters.names_by_node(timeout_s=0.5)
            assert "/silent" not in found
    assert set(found["/robot"]) >= set(NAMES)


async def test_a_node_that_loses_answers_is_told_of(nodes: ScriptedNodes) -> None:
    for service in ("list_parameters", "describe_parameters", "set_parameters"):
        nodes.offer("/broken", service, lambda _: {})
    with pytest.raises(ProtocolError, match="node /broken answered 0 results for 2 parameters"):
        await nodes.parameters.set("/broken", {"a": 1, "b": 2})


async def test_many_undeclared_parameters_take_no_more_questions_than_one(
    nodes: ScriptedNodes,
) -> None:
    nodes.add("/robot", "speed", "height")
    wrong = [f"wrong{number}" for number in range(256)]
    with pytest.raises(ProtocolError, match="parameter wrong0 ") as caught:
        await nodes.parameters.get("/robot", ["speed", *wrong, "height"])
    assert caught.value.code == "not_found"
    assert len(nodes.calls.asked) == 3


async def test_many_undeclared_parameters_do_not_keep_others_from_being_set(
    nodes: ScriptedNodes,
) -> None:
    nodes.add("/robot", "speed", "height")
    values = {"speed": 1, **{f"wrong{number}": 1 for number in range(256)}, "height": 2}
    results = await nodes.parameters.set("/robot", values)
    assert [name for name, result in results.items() if result.successful] == ["speed", "height"]
    assert len(nodes.calls.asked) == 4


async def test_a_name_that_no_string_in_ros_can_have_harms_no_other(nodes: ScriptedNodes) -> None:
    nodes.add("/robot", "speed")
    parameters = nodes.parameters
    results = await parameters.set("/robot", {"sp\0eed": 1, "speed": 1})
    assert results == {
        "sp\0eed": SetResult(successful=False, reason="expected a name without U+0000"),
        "speed": OK,
    }
    for ask in (parameters.get, parameters.describe):
        with pytest.raises(ProtocolError) as caught:
            await ask("/robot", ["sp\0eed", "speed"])
        assert caught.value.code == "not_found"


async def test_the_deadline_is_for_all_questions_together(nodes: ScriptedNodes) -> None:
    nodes.add("/late", "speed")
    await nodes.parameters.get("/late")
    first, second = nodes.calls.timeouts_s
    assert second < first <= NODE_TIMEOUT_S


async def test_a_node_whose_answer_is_lost_is_asked_again(
    nodes: ScriptedNodes, monkeypatch: pytest.MonkeyPatch
) -> None:
    answers = iter([None, {"result": {"names": ["speed"]}}])
    nodes.offer("/robot", "list_parameters", lambda _: next(answers))
    clock = StoppedClock(monkeypatch)
    reading = asyncio.ensure_future(nodes.parameters.list_names("/robot"))
    await clock.advance(0)  # it asks
    await clock.advance(1.1)
    assert nodes.calls.asked == ["/robot/list_parameters"]
    await clock.advance(0.2)
    assert await reading == ["speed"]
    assert nodes.calls.asked == ["/robot/list_parameters"] * 2


async def test_the_answer_to_the_first_question_counts_when_it_comes_late(
    nodes: ScriptedNodes, monkeypatch: pytest.MonkeyPatch
) -> None:
    requests: list[ServiceRequest] = []
    type_ = nodes.types.service("rcl_interfaces/srv/ListParameters")
    nodes.ros.add_service("/robot/list_parameters", type_.name, requests.append, node="/robot")
    clock = StoppedClock(monkeypatch)
    reading = asyncio.ensure_future(nodes.parameters.list_names("/robot"))
    await clock.advance(0)  # it asks
    await clock.advance(1.3)
    assert len(requests) == 2
    requests[0].answer(type_.response.encode({"result": {"names": ["speed"]}}, 0))
    assert await reading == ["speed"]


async def test_a_request_that_sets_a_parameter_is_not_sent_again(
    nodes: ScriptedNodes, monkeypatch: pytest.MonkeyPatch
) -> None:
    nodes.add("/robot", "speed")
    nodes.ros.service_servers = [
        service for service in nodes.ros.service_servers if service.name != "/robot/set_parameters"
    ]
    nodes.offer("/robot", "set_parameters", lambda _: None)
    clock = StoppedClock(monkeypatch)
    setting = asyncio.ensure_future(nodes.parameters.set("/robot", {"speed": 1.0}))
    await clock.advance(0)  # it asks
    await clock.advance(2.4)
    assert not setting.done()
    await clock.advance(0.2)
    with pytest.raises(ProtocolError, match=r"has not answered within 2\.5 s"):
        await setting
    assert nodes.calls.asked == ["/robot/describe_parameters", "/robot/set_parameters"]


async def test_hidden_nodes_are_not_asked_for_their_names(nodes: ScriptedNodes) -> None:
    for node in ("/robot", "/_ros2cli_1", "/_hidden/robot"):
        nodes.add(node, "speed")
    assert await nodes.parameters.names_by_node() == {"/robot": ["speed"]}
    assert nodes.calls.asked == ["/robot/list_parameters"]


async def test_more_dead_nodes_than_are_asked_at_once_do_not_hide_a_living_one(
    nodes: ScriptedNodes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("gateway.core.rosapi.node_parameters.EACH_NODE_TIMEOUT_S", 1.0)
    for number in range(NODES_AT_ONCE + 1):
        nodes.add_silent(f"/dead{number}")
    nodes.add("/living", "speed")
    found = await nodes.parameters.names_by_node(timeout_s=TIMEOUT_S)
    assert found == {"/living": ["speed"]}
    assert nodes.calls.most_at_once == NODES_AT_ONCE


async def test_looking_at_all_nodes_ends_however_many_are_dead(
    nodes: ScriptedNodes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("gateway.core.rosapi.node_parameters.EACH_NODE_TIMEOUT_S", 3600.0)
    for number in range(2 * NODES_AT_ONCE + 1):
        nodes.add_silent(f"/dead{number:02}")
    nodes.add("/alive", "speed")
    clock = StoppedClock(monkeypatch)
    looking = asyncio.ensure_future(nodes.parameters.names_by_node(timeout_s=0.1))
    await clock.advance(0)
    assert not looking.done()
    await clock.advance(0.11)
    assert looking.done()
    assert await looking == {"/alive": ["speed"]}


async def test_all_nodes_together_have_two_seconds(
    nodes: ScriptedNodes, monkeypatch: pytest.MonkeyPatch
) -> None:
    for number in range(4 * NODES_AT_ONCE):
        nodes.add_silent(f"/dead{number}")
    clock = StoppedClock(monkeypatch)
    parameters = Parameters(nodes.ros, nodes.types, nodes.calls)
    looking = asyncio.ensure_future(parameters.names_by_node())
    for _ in range(NODES_AT_ONCE):
        await clock.advance(0)
    assert len(nodes.calls.asked) == NODES_AT_ONCE
    await clock.advance(0.99)
    assert len(nodes.calls.asked) == NODES_AT_ONCE
    for _ in range(NODES_AT_ONCE):
        await clock.advance(0.02 / NODES_AT_ONCE)
    assert len(nodes.calls.asked) == 2 * NODES_AT_ONCE
    await clock.advance(0.98)
    assert not looking.done()
    await clock.advance(0.02)
    assert looking.done()
    assert await looking == {}


async def test_nodes_that_were_silent_before_are_asked_last(
    nodes: ScriptedNodes, monkeypatch: pytest.MonkeyPatch
) -> None:
    nodes.add_silent("/dead")
    nodes.add("/living", "speed")
    clock = StoppedClock(monkeypatch)
    for _ in range(2):
        looking = asyncio.ensure_future(nodes.parameters.names_by_node())
        await clock.advance(0)
        await clock.advance(EACH_NODE_TIMEOUT_S)
        assert await looking == {"/living": ["speed"]}
        await clock.advance(2 * FRESH_S)
    dead, living = "/dead/list_parameters", "/living/list_parameters"
    assert nodes.calls.asked == [dead, living, living, dead]


async def test_looking_at_all_nodes_opens_one_client_in_a_turn_of_the_loop(
    nodes: ScriptedNodes, monkeypatch: pytest.MonkeyPatch
) -> None:
    turn = 0
    opened_in: list[int] = []
    open_client = nodes.ros.client

    async def count() -> None:
        nonlocal turn
        while True:
            turn += 1
            await asyncio.sleep(0)

    def noted(service: str, type_name: str) -> FakeClient:
        opened_in.append(turn)
        return open_client(service, type_name)

    monkeypatch.setattr(nodes.ros, "client", noted)
    for number in range(NODES_AT_ONCE):
        nodes.add(f"/robot{number}", "speed")
    counting = asyncio.create_task(count())
    await nodes.parameters.names_by_node()
    counting.cancel()
    assert len(opened_in) == len(set(opened_in)) == NODES_AT_ONCE


async def test_a_row_of_questions_to_a_dead_node_waits_for_it_once(nodes: ScriptedNodes) -> None:
    nodes.add_silent("/dead")
    parameters = nodes.parameters
    for _ in range(8):
        with pytest.raises(ProtocolError, match=r"/dead has not answered within 0\.1 s") as caught:
            await parameters.get("/dead", ["speed"], timeout_s=0.1)
        assert caught.value.code == "timeout"
    assert len(nodes.calls.asked) == 1
    with pytest.raises(ProtocolError, match=r"within 0\.2 s"):
        await parameters.get("/dead", ["speed"], timeout_s=0.2)
    assert len(nodes.calls.asked) == 2


async def test_a_node_that_answers_again_is_no_longer_taken_for_dead(nodes: ScriptedNodes) -> None:
    nodes.add_silent("/robot")
    parameters = nodes.parameters
    with pytest.raises(ProtocolError, match="has not answered"):
        await parameters.list_names("/robot", timeout_s=0.2)
    for service in list(nodes.ros.service_servers):
        service.close()
    nodes.add("/robot", "speed")
    assert await parameters.list_names("/robot", timeout_s=5.0) == ["speed"]
    assert await parameters.list_names("/robot", timeout_s=0.2) == ["speed"]


async def test_a_node_that_answers_some_questions_is_not_taken_for_dead(
    nodes: ScriptedNodes,
) -> None:
    nodes.add("/robot", "speed")
    nodes.ros.service_servers = [
        service for service in nodes.ros.service_servers if service.name != "/robot/get_parameters"
    ]
    nodes.offer("/robot", "get_parameters", lambda _: None)
    parameters = nodes.parameters
    with pytest.raises(ProtocolError, match="has not answered"):
        await parameters.get("/robot", timeout_s=0.2)
    assert await parameters.list_names("/robot", timeout_s=0.2) == ["speed"]


async def test_a_read_request_is_sent_again_after_1200_ms_and_then_twice_as_long(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clock = StoppedClock(monkeypatch)
    asked: list[None] = []

    async def ask() -> dict[str, Any]:
        asked.append(None)
        return await asyncio.Future()

    asking = asyncio.ensure_future(node_parameters._asked_again(ask))
    for seconds, count in ((0, 1), (1.19, 1), (0.02, 2), (2.38, 2), (0.03, 3)):
        await clock.advance(seconds)
        await clock.advance(0)
        assert len(asked) == count
    asking.cancel()
    await asyncio.gather(asking, return_exceptions=True)
