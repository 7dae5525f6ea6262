# SPDX-License-Identifier: Apache-2.0
"""Services that clients call."""

import asyncio
import json
from typing import Any

import pytest

from gateway.sources.services import ServiceRequest
from tests.client import eventually
from tests.clock import StoppedClock
from tests.core.conftest import LIMITS, SET_BOOL, Bench

MAX_WAITING_CALLS = 256


class Arm:
    """A ROS service ``/arm`` that answers when it is told to."""

    def __init__(self, bench: Bench, *, at_once: bool = True) -> None:
        self.bench = bench
        self.requests: list[ServiceRequest] = []
        self.service = bench.ros.add_service("/arm", SET_BOOL, self.requests.append)
        if at_once:
            self.service.on_request = self.answer

    def answer(self, request: ServiceRequest) -> None:
        values = self.bench.types.get(f"{SET_BOOL}_Request").decode(request.cdr)
        message = f"got {json.dumps(values['data'])}"
        request.answer(self.bench.cdr(f"{SET_BOOL}_Response", success=True, message=message))


async def test_a_response_comes_with_the_id_and_the_form_of_the_call(bench: Bench) -> None:
    Arm(bench)
    client = bench.sender(op="call_service", id="c1", service="arm", args={"data": True})
    (frame,) = await client.sees(1, "service_response")
    assert frame == {
        "op": "service_response",
        "id": "c1",
        "service": "arm",
        "values": {"success": True, "message": "got true"},
        "result": True,
    }


@pytest.mark.parametrize(
    ("arguments", "message"),
    [({"args": [True]}, "got true"), ({"args": []}, "got false"), ({}, "got false")],
)
async def test_arguments_may_come_in_order_or_not_at_all(
    bench: Bench, arguments: dict[str, Any], message: str
) -> None:
    Arm(bench)
    client = bench.sender(op="call_service", service="/arm", **arguments)
    (frame,) = await client.sees(1, "service_response")
    assert frame["values"]["message"] == message
    assert "id" not in frame


@pytest.mark.parametrize("form", ["std_srvs/SetBool", "std_srvs/srv/SetBool", "", None])
async def test_the_type_may_be_said(bench: Bench, form: str | None) -> None:
    Arm(bench)
    client = bench.sender(op="call_service", service="/arm", type=form)
    (frame,) = await client.sees(1, "service_response")
    assert frame["result"] is True
    assert client.statuses == []


@pytest.mark.parametrize(
    "form",
    ["std_srvs/Trigger", "std_srvs/srv/SetBol", "SetBool", "none_msgs/None", "std_msgs/msg/Bool"],
)
async def test_a_service_of_another_type_is_not_called(bench: Bench, form: str) -> None:
    arm = Arm(bench, at_once=False)
    client = bench.sender(op="call_service", id="c1", service="/arm", type=form, args=[True])
    (refused,) = await client.sees(1, "service_response")
    assert (refused["id"], refused["result"]) == ("c1", False)
    assert "type" in refused["values"]
    client.send(op="call_service", id="c2", service="/arm")
    await eventually(lambda: bool(arm.requests))
    assert len(arm.requests) == 1
    assert client.statuses == []


@pytest.mark.parametrize("form", ["rosapi/ActionServers", "rosapi_msgs/srv/GetActionServers"])
async def test_rosapi_takes_any_type(bench: Bench, form: str) -> None:
    client = bench.sender(op="call_service", service="/rosapi/action_servers", type=form)
    (answer,) = client.of("service_response")
    assert answer["values"] == {"action_servers": []}


@pytest.mark.parametrize(
    ("call", "words"),
    [
        ({"service": "/amr"}, "service /amr does not exist; did you mean /arm?"),
        ({"service": "/a b"}, "is not a valid service name"),
        ({"service": "/arm#c1"}, "is not a valid service name"),
        ({"service": "/arm", "args": {"data": "yes"}}, "args.data: expected true or false, got"),
        ({"service": "/arm", "args": {"dta": True}}, "args.dta: unknown field"),
        ({"service": "/arm", "args": [True, False]}, "args: expected at most 1 element, got 2"),
        (
            {"service": "/arm", "agrs": {"data": True}},
            "agrs: unknown, and call_service has no",
        ),
        ({"service": "/arm", "timeout": "5"}, "timeout: expected a number"),
        ({"service": "/strange"}, "none_msgs/srv/Strange"),
    ],
)
async def test_a_call_that_fails_is_answered_with_the_reason(
    bench: Bench, call: dict[str, Any], words: str
) -> None:
    Arm(bench)
    bench.ros.add_service("/strange", "none_msgs/srv/Strange", lambda request: None)
    client = bench.sender(op="call_service", id="c1", **call)
    (frame,) = await client.sees(1, "service_response")
    assert (frame["id"], frame["service"]) == ("c1", call["service"])
    assert frame["result"] is False
    assert words in frame["values"]


async def test_a_call_without_a_service_is_answered_as_every_call(bench: Bench) -> None:
    client = bench.sender(op="call_service", id="c1")
    (answer,) = client.of("service_response")
    assert (answer["id"], answer["service"], answer["result"]) == ("c1", "", False)
    assert answer["values"].startswith("service: missing")


async def test_a_call_that_nobody_answers_times_out(bench: Bench) -> None:
    Arm(bench, at_once=False)
    client = bench.sender(op="call_service", id="c1", service="/arm", timeout=0.05)
    (frame,) = await client.sees(1, "service_response")
    assert frame["result"] is False
    assert "has not answered within 0.05 s" in frame["values"]


async def test_a_call_whose_server_dies_is_answered(bench: Bench) -> None:
    arm = Arm(bench, at_once=False)
    client = bench.sender(op="call_service", id="c1", service="/arm")
    await eventually(lambda: bool(arm.requests))
    arm.service.close()
    (frame,) = await client.sees(1, "service_response")
    assert frame["result"] is False
    assert "/arm has gone" in frame["values"]


async def test_calls_do_not_wait_for_each_other(bench: Bench) -> None:
    arm = Arm(bench, at_once=False)
    client = bench.client()
    for number in range(LIMITS.max_pending_calls):
        client.send(op="call_service", id=number, service="/arm")
    await eventually(lambda: len(arm.requests) == LIMITS.max_pending_calls)
    for request in reversed(arm.requests):
        arm.answer(request)
    frames = await client.sees(LIMITS.max_pending_calls, "service_response")
    assert [frame["id"] for frame in frames] == list(reversed(range(LIMITS.max_pending_calls)))


async def test_more_calls_than_may_be_under_way_wait_for_their_turn(bench: Bench) -> None:
    arm = Arm(bench, at_once=False)
    client = bench.client()
    count = LIMITS.max_pending_calls + 3
    for number in range(count):
        client.send(op="call_service", id=number, service="/arm")
    await eventually(lambda: len(arm.requests) == LIMITS.max_pending_calls)
    await bench.settle()
    assert len(arm.requests) == LIMITS.max_pending_calls
    arm.service.on_request = arm.answer
    for request in arm.requests:
        arm.answer(request)
    frames = await client.sees(count, "service_response")
    assert sorted(frame["id"] for frame in frames) == list(range(count))
    assert all(frame["result"] for frame in frames)


async def test_a_client_cannot_let_calls_wait_without_end(bench: Bench) -> None:
    Arm(bench, at_once=False)
    client = bench.client()
    for number in range(LIMITS.max_pending_calls + MAX_WAITING_CALLS + 1):
        client.send(op="call_service", id=number, service="/arm")
    (frame,) = await client.sees(1, "service_response")
    assert frame["id"] == LIMITS.max_pending_calls + MAX_WAITING_CALLS
    assert "unfinished calls per client" in frame["values"]


async def test_a_client_that_leaves_takes_its_calls_along(bench: Bench) -> None:
    arm = Arm(bench, at_once=False)
    leaving, staying = bench.client(), bench.client()
    leaving.send(op="call_service", service="/arm")
    staying.send(op="call_service", service="/arm")
    await eventually(lambda: len(arm.requests) == 2)
    bench.router.leave(leaving.session)
    await eventually(lambda: bench.router.counts()["calls"] == 1)
    for request in arm.requests:
        arm.answer(request)
    await staying.sees(1, "service_response")
    assert not leaving.frames


async def test_the_ros_client_lingers_for_the_next_call_and_then_goes(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    Arm(bench)
    client = bench.sender(op="call_service", service="/arm")
    await client.sees(1, "service_response")
    (ros_client,) = [each for each in bench.ros.clients if bench.ros.is_own(each.node)]
    monkeypatch.setattr("gateway.sources.client_cache.IDLE_S", 0.01)
    client.send(op="call_service", service="/arm")
    await client.sees(2, "service_response")
    assert ros_client in bench.ros.clients or not bench.ros.entity_count()
    await eventually(lambda: bench.ros.entity_count() == 0)


async def test_operations_of_one_client_that_need_no_other_node_keep_their_order(
    bench: Bench,
) -> None:
    client = bench.sender(op="advertise", topic="/here", type="std_msgs/String")
    client.send(op="call_service", id="c1", service="/rosapi/topic_type", args={"topic": "/here"})
    client.send(op="unadvertise", topic="/here")
    client.send(op="ping")
    assert [frame["op"] for frame in client.frames] == ["service_response", "pong"]
    assert client.frames[0]["values"] == {"type": "std_msgs/msg/String"}


async def test_shutdown_leaves_no_task(bench: Bench) -> None:
    Arm(bench, at_once=False)
    before = asyncio.all_tasks()
    client = bench.sender(op="call_service", service="/arm")
    assert len(asyncio.all_tasks()) == len(before) + 1
    bench.router.leave(client.session)
    await eventually(lambda: asyncio.all_tasks() == before)


async def test_no_time_limit_is_a_long_one(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    clock = StoppedClock(monkeypatch)
    Arm(bench, at_once=False)
    client = bench.client()
    for number, timeout in enumerate([0, 1e9, 3599]):
        client.send(op="call_service", id=number, service="/arm", timeout=timeout)
    await bench.settle()
    await clock.advance(3599.9)
    assert [frame["id"] for frame in client.of("service_response")] == [2]
    await clock.advance(0.2)
    limits = {f["id"]: f["values"].split("within ")[1] for f in client.of("service_response")}
    assert limits == {0: "3600 s", 1: "3600 s", 2: "3599 s"}


async def test_the_time_limit_counts_while_a_call_waits_for_its_turn(bench: Bench) -> None:
    arm = Arm(bench, at_once=False)
    client = bench.client()
    for number in range(LIMITS.max_pending_calls):
        client.send(op="call_service", id=number, service="/arm", timeout=600)
    client.send(op="call_service", id="late", service="/arm", timeout=0.05)
    (frame,) = await client.sees(1, "service_response")
    assert frame["id"] == "late"
    assert f"{LIMITS.max_pending_calls} other calls" in frame["values"]
    client.send(op="get_parameters", id="p", node="/nobody", timeout=0.05)
    (status,) = await client.sees(1, "status")  # which does not wait for calls
    assert status["id"] == "p"
    arm.service.on_request = arm.answer
    for request in arm.requests:
        arm.answer(request)
    await client.sees(LIMITS.max_pending_calls + 1, "service_response")
    client.send(op="call_service", id="next", service="/arm")  # every slot is free again
    frames = await client.sees(LIMITS.max_pending_calls + 2, "service_response")
    assert (frames[-1]["id"], frames[-1]["result"]) == ("next", True)


async def test_a_long_response_comes_in_the_pieces_that_were_asked_for(bench: Bench) -> None:
    Arm(bench)
    client = bench.sender(op="call_service", id="c1", service="/arm", args=[True], fragment_size=64)
    pieces = await client.sees(2, "fragment")
    whole = json.loads("".join(piece["data"] for piece in pieces))
    assert (whole["op"], whole["id"], whole["result"]) == ("service_response", "c1", True)


async def test_a_fault_of_ours_is_answered_and_logged(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    Arm(bench)

    async def fail(*_: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr("gateway.core.service_clients.ServiceClients.call", fail)
    client = bench.sender(op="call_service", id="c1", service="/arm")
    (frame,) = await client.sees(1, "service_response")
    assert (frame["id"], frame["result"]) == ("c1", False)
    assert "fault of the gateway" in frame["values"]
    assert "ZeroDivisionError" in caplog.text
