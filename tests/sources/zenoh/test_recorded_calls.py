# SPDX-License-Identifier: Apache-2.0
"""Recorded services, parameters, actions, and ends of nodes, played to the source."""

import asyncio
import base64
import contextlib
import itertools
import json
from collections.abc import Iterator
from typing import Any

import pytest

from gateway.sources.actions import SUCCEEDED, GoalRequest
from gateway.sources.services import ServiceRequest
from gateway.sources.zenoh.attachment import read_attachment
from gateway.sources.zenoh.heard_publishers import SampleNumbers
from gateway.sources.zenoh.port import ZenohSource
from gateway.sources.zenoh.token_graph import TokenGraph
from gateway.sources.zenoh.tokens import EndpointToken, parse_token
from tests.client import eventually
from tests.sources.test_contract_services import soon
from tests.sources.zenoh.conftest import open_source_on
from tests.sources.zenoh.outside import Router, client
from tests.sources.zenoh.recordings import NAMES, of_robot, recording
from tests.sources.zenoh.replay_calls import TYPES, Call, Callee, Caller, calls, decoded
from tests.sources.zenoh.test_recordings import RECORDED

FIBONACCI = "test_msgs/action/Fibonacci"
END_OF_HEADER = 4


@contextlib.contextmanager
def played(kind: type[Any], name: str) -> Iterator[tuple[ZenohSource, Any]]:
    with contextlib.ExitStack() as stack:
        router = stack.enter_context(contextlib.closing(Router()))
        source = stack.enter_context(open_source_on(router.address, RECORDED))
        yield source, stack.enter_context(contextlib.closing(kind(router.address, name)))


@pytest.mark.parametrize("name", ["4a_service_server", "5_parameters_types"])
async def test_the_real_server_is_asked_as_it_was_and_its_answers_are_read(name: str) -> None:
    with played(Callee, name) as (source, callee):
        known = [each for each in calls(name, "us") if each.reply is not None]
        for call in known:
            await eventually(lambda call=call: source.service_types(call.key.name))
            client = source.services.client(call.key.name, call.key.type_name)
            request = TYPES.get(f"{call.key.type_name}_Request")
            cdr = request.encode(plain(call.read_request(call.request)), 0)
            answer = await soon(client.call(cdr))
            client.close()
            assert call.read(answer) == call.answer
            recorded, came, attachment = callee.asked[-1]
            assert recorded.read_request(came) == call.read_request(call.request)
            assert read_attachment(attachment).number == 1
        assert len(callee.asked) == len(known) > 3


async def test_the_answers_were_read_alike_when_they_were_recorded() -> None:
    known = [each for each in calls("5_parameters_types", "us") if each.reply is not None]
    said = decoded("5_parameters_types", "decoded reply of ")
    assert len(known) == len(said) == 13
    assert [
        with_octets(plain(each.answer), like) for each, like in zip(known, said, strict=True)
    ] == said


def plain(values: Any) -> Any:
    """Return values as JSON has them."""
    return json.loads(json.dumps(values, default=list))


def with_octets(values: Any, like: Any) -> Any:
    """Return values with arrays of octets where others have them, in place of Base64."""
    match values, like:
        case str(), list():
            return list(base64.b64decode(values))
        case dict(), dict():
            return {key: with_octets(each, like[key]) for key, each in values.items()}
        case list(), list():
            return [with_octets(each, one) for each, one in zip(values, like, strict=True)]
    return values


async def test_a_real_client_is_answered_as_it_asks() -> None:
    name = "4b_service_client"
    with played(Caller, name) as (source, caller):
        asked: list[Any] = []
        [first, *others] = calls(name, "real")
        answer = TYPES.get(f"{first.key.type_name}_Response").encode

        def on_request(request: ServiceRequest) -> None:
            asked.append(first.read_request(request.cdr)["data"])
            request.answer(answer({"success": True, "message": f"answer {len(asked)}"}, 0))

        source.services.serve(first.key.name, first.key.type_name, on_request)
        for number, call in enumerate((first, *others), 1):
            assert await soon(caller.ask(call)) == {"success": True, "message": f"answer {number}"}
        said = [json.loads(line["note"]) for line in of_robot(name, "event")]
        assert asked == [each["sent"] for each in said if "sent" in each]


async def test_a_server_that_is_not_complete_is_not_asked_although_its_token_is_there() -> None:
    name = "4c_service_client_incomplete"
    said = [json.loads(line["note"]) for line in of_robot(name, "event")]
    assert {"service_is_ready": True} in said
    [call] = [each for each in said if "call" in each]
    assert call["got"] is None
    [server] = [each["key"] for each in of_tokens(name, by="us") if each["kind"] == "token_put"]
    token = parse_token(server)
    assert isinstance(token, EndpointToken)
    service, type_name = token.key.name, token.key.type_name
    with contextlib.ExitStack() as stack:
        source, caller = stack.enter_context(played(Caller, name))
        asked: list[Any] = []
        session = stack.enter_context(contextlib.closing(client(caller.router)))
        kept = [session.liveliness().declare_token(server)]
        kept.append(session.declare_queryable(token.key.text, asked.append, complete=False))
        await eventually(lambda: source.service_types(service) == (type_name,))
        [shown] = [each for each in source.graph().services if each.name == service]
        assert shown.nodes == ("/recorder",)
        ours = source.services.client(service, type_name)
        wire = TYPES.service(type_name)
        waiting = asyncio.ensure_future(ours.call(wire.request.encode({"data": True}, 0)))
        await eventually(lambda: bool(ours.requester._waiting) and not ours.requester.is_ready)
        answer = wire.response.encode({"success": True, "message": "complete"}, 0)

        def on_query(query: Any) -> None:
            query.reply(token.key.text, answer, attachment=query.attachment)
            query.drop()

        kept.append(session.declare_queryable(token.key.text, on_query, complete=True))
        assert wire.response.decode(await soon(waiting))["message"] == "complete"
        assert asked == []


@pytest.mark.parametrize("name", ["4d", "4e", "4f"])
async def test_the_gateway_leaves_out_requests_that_end_a_real_server(name: str) -> None:
    [name] = {each for each in NAMES if each.startswith(name)}
    with played(Caller, name) as (source, caller):
        asked: list[bytes] = []

        def on_request(request: ServiceRequest) -> None:
            asked.append(request.cdr)
            request.answer(b"\0\1\0\0\1\0\0\0\1\0\0\0\0\0\0\0")

        sent = calls(name, "us")
        source.services.serve(sent[0].key.name, sent[0].key.type_name, on_request)
        answers = [await soon(caller.ask(call)) for call in sent]
        assert [each is not None for each in answers] == [is_whole(each) for each in sent]
        assert None in answers


def is_whole(call: Call) -> bool:
    return len(call.attachment) == 33 and len(call.request) > END_OF_HEADER


async def test_goals_of_the_real_action_end_as_they_did() -> None:
    with played(Callee, "6a_action_server") as (source, _):
        await eventually(lambda: source.action_types("/fib") == (FIBONACCI,))
        client = source.actions.action_client("/fib", FIBONACCI)
        heard: list[bytes] = []
        encode = TYPES.get(f"{FIBONACCI}_Goal").encode
        ends = {5: (4, [0, 1, 1, 2, 3, 5, 8]), 30: (5, [0, 1, 1, 2, 3, 5]), 2: (6, [0, 1, 1, 2])}
        for order, (status, sequence) in ends.items():
            heard.clear()
            goal = await soon(client.send_goal(encode({"order": order}, 0), heard.append))
            if order == 30:
                goal.cancel()
            result = await soon(goal.result())
            assert result.status == status
            found = TYPES.get(f"{FIBONACCI}_Result").decode(result.cdr)
            assert list(found["sequence"]) == sequence
            read = TYPES.get(f"{FIBONACCI}_Feedback").decode
            await eventually(lambda: len(heard) >= len(sequence) - 2)  # noqa: B023
            so_far = [list(read(each)["sequence"]) for each in heard]
            assert so_far == [sequence[: len(each)] for each in so_far]
        assert await soon(client.send_goal(encode({"order": -1}, 0), heard.append)) is None
        client.close()


async def test_a_real_client_gets_its_goals_done() -> None:
    name = "6b_action_client"
    with played(Caller, name) as (source, caller):
        goals: list[GoalRequest] = []
        canceled: list[GoalRequest] = []
        server = source.actions.serve_action("/ours", FIBONACCI, goals.append, canceled.append)
        sent, result, second, cancel = calls(name, "real")
        assert (await soon(caller.ask(sent)))["accepted"]
        heard: list[bytes] = []
        [feedback] = {
            line["key"]
            for line in recording(name)
            if "FeedbackMessage" in (line["key"] or "") and line["kind"] == "put"
        }
        caller.subscribe(feedback, heard.append)
        waiting = asyncio.ensure_future(caller.ask(result))
        encode = TYPES.get(f"{FIBONACCI}_Feedback").encode
        said = [json.loads(line["note"]) for line in of_robot(name, "event")]
        [end] = [each for each in said if "feedback" in each]

        def is_heard() -> bool:
            goals[0].feedback(encode({"sequence": end["feedback"][0]}, 0))
            return bool(heard)

        await eventually(is_heard)
        recorded = [
            bytes.fromhex(line["payload"]) for line in recording(name) if line["key"] == feedback
        ]
        message = TYPES.get(f"{FIBONACCI}_FeedbackMessage").decode
        assert plain(message(heard[0])) == plain(message(recorded[0]))
        goals[0].finish(
            SUCCEEDED, TYPES.get(f"{FIBONACCI}_Result").encode({"sequence": end["result"]}, 0)
        )
        assert plain(await soon(waiting)) == plain(result.answer)
        assert (await soon(caller.ask(second)))["accepted"]
        answer = await soon(caller.ask(cancel))
        assert answer["return_code"] == 0
        assert [plain(each["goal_id"]) for each in answer["goals_canceling"]] == [
            plain(each["goal_id"]) for each in cancel.answer["goals_canceling"]
        ]
        assert canceled == goals[1:]
        server.close()


def test_nodes_that_end_in_any_way_leave_nothing_behind() -> None:
    graph, seen = TokenGraph("ours"), []
    for line in of_tokens("8_life"):
        graph.apply({line["key"]: line["kind"] == "token_put"})
        nodes = {each for each in graph.nodes() if "ros2cli" not in each}
        if not seen or seen[-1] != nodes:
            seen.append(nodes)
    assert graph.unread == 0
    assert not any((graph._places, graph._nodes, graph._publishers))
    ups = [each for before, each in itertools.pairwise(seen) if each and not before]
    assert len(ups) >= 5
    assert any("/lifer" in each for each in ups)
    assert any("/abrupt" in each for each in ups)


def test_a_router_that_starts_again_brings_back_the_same_graph() -> None:
    graph, wholes = TokenGraph("ours"), []
    numbers, heard, gone = SampleNumbers(), set(), False
    for line in recording("9_router_restart"):
        if line["kind"] == "event" and line["note"] in {
            "router killed",
            "what a fresh session sees now",
        }:
            wholes.append(graph.whole())
        if line in of_tokens("9_router_restart"):
            graph.apply({line["key"]: line["kind"] == "token_put"})
            gone |= not graph.nodes()
        elif line["kind"] == "put" and line["by"] == "real" and "/chatter/" in line["key"]:
            attachment = read_attachment(bytes.fromhex(line["attachment"]))
            numbers.note(attachment.gid, attachment.number)
            heard.add(attachment.number)
    assert gone
    assert wholes[0] == wholes[1]
    assert wholes[0].nodes == ("/steady", "/steady_listener")
    first, last = min(heard), max(heard)
    assert numbers.lost == last - first + 1 - len(heard) > 0


def of_tokens(name: str, by: str = "real") -> list[dict[str, Any]]:
    return [
        line
        for line in recording(name)
        if line["kind"].startswith("token_") and line["by"] == by
        if "/@adv/" not in line["key"]
    ]
