# SPDX-License-Identifier: Apache-2.0
"""Services that clients provide."""

import asyncio
from typing import Any

import pytest

from gateway.access.permissions import Identity, Policy
from gateway.config.access import AccessConfig, OperatorConfig
from gateway.sources.source import RosError
from tests.client import TIMEOUT_S, Frame, eventually
from tests.clock import StoppedClock
from tests.core.conftest import LIMITS, SET_BOOL, Bench, Socketless
from tests.sources.fake_services import FakeRequest

MAX_PENDING = 64


class Caller:
    """A ROS node that calls ``/arm``."""

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        self.client = bench.ros.add_client("/arm", SET_BOOL)

    def call(self, data: bool = True) -> "asyncio.Future[dict[str, Any]]":
        return asyncio.ensure_future(self._call(data))

    async def _call(self, data: bool) -> dict[str, Any]:
        async with asyncio.timeout(TIMEOUT_S):
            cdr = await self.client.call(self.bench.cdr(f"{SET_BOOL}_Request", data=data))
        return self.bench.types.get(f"{SET_BOOL}_Response").decode(cdr)


def provider(bench: Bench) -> Socketless:
    client = bench.sender(op="advertise_service", service="arm", type="std_srvs/SetBool")
    assert not client.statuses
    return client


Called = tuple[Socketless, Frame, "asyncio.Future[dict[str, Any]]"]


async def called(bench: Bench) -> Called:
    """Return a provider, the call that it got, and the response that a node waits for."""
    client = provider(bench)
    response = Caller(bench).call()
    (frame,) = await client.sees(1, "call_service")
    return client, frame, response


async def test_a_call_goes_to_the_client_and_its_answer_back(bench: Bench) -> None:
    client = provider(bench)
    response = Caller(bench).call(data=True)
    (frame,) = await client.sees(1, "call_service")
    assert frame["id"].startswith("service_request:/arm:")
    assert (frame["service"], frame["args"]) == ("arm", {"data": True})
    values = {"success": True, "message": "moved"}
    client.send(op="service_response", id=frame["id"], service="arm", values=values, result=True)
    assert await response == values
    assert bench.router.counts()["calls"] == 0


async def test_answers_find_their_calls_in_any_order(bench: Bench) -> None:
    client = provider(bench)
    caller = Caller(bench)
    responses = [caller.call() for _ in range(5)]
    calls = await client.sees(5, "call_service")
    for number, frame in reversed(list(enumerate(calls))):
        client.send(
            op="service_response",
            id=frame["id"],
            service="arm",
            values={"success": True, "message": str(number)},
            result=True,
        )
    assert [(await response)["message"] for response in responses] == list("01234")


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        ({"result": False}, "service failed"),
        ({"result": False, "values": {}}, "service failed"),  # as roslib and roslibpy send it
        ({"result": False, "values": "jammed"}, "jammed"),
    ],
)
async def test_a_failure_without_values_reaches_the_caller_as_one(
    bench: Bench, answer: dict[str, Any], message: str
) -> None:
    client, frame, response = await called(bench)
    client.send(op="service_response", id=frame["id"], service="arm", **answer)
    assert await response == {"success": False, "message": message}
    assert not client.of("status")


async def test_a_failure_with_values_passes_them_on_with_a_warning(bench: Bench) -> None:
    client, frame, response = await called(bench)
    values = {"success": True, "message": "x"}
    client.send(op="service_response", id=frame["id"], service="arm", values=values, result=False)
    assert await response == values
    assert "cannot fail" in client.of("status")[0]["msg"]


async def test_values_that_do_not_fit_are_refused_and_fail_the_call(bench: Bench) -> None:
    client, frame, response = await called(bench)
    client.send(op="service_response", id=frame["id"], service="arm", values={"success": 1})
    assert client.statuses == [("invalid_value", "values.success: expected true or false, got 1")]
    assert (await response)["success"] is False


async def test_a_client_that_never_answers_lets_the_call_fail_in_time(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench.router.limits = LIMITS.model_copy(update={"service_timeout_s": 7})
    clock = StoppedClock(monkeypatch)
    client = provider(bench)
    response = Caller(bench).call()
    await bench.settle()
    await clock.advance(6.99)
    assert not response.done()
    await clock.advance(0.02)
    assert await response == {"success": False, "message": "service's client did not answer"}
    assert len(client.of("status")) == 1
    call_id = client.of("call_service")[0]["id"]
    client.send(op="service_response", id=call_id, service="arm", values={"success": True})
    assert client.of("status")[-1]["code"] == "not_found"


async def test_a_client_that_leaves_lets_its_calls_fail(bench: Bench) -> None:
    client, _, response = await called(bench)
    bench.router.leave(client.session)
    assert await response == {"success": False, "message": "service's client has left"}
    assert bench.ros.entity_count() == 0


async def test_calls_of_a_service_that_has_ended_have_no_deadline_any_more(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    clock = StoppedClock(monkeypatch)
    client = provider(bench)
    response = Caller(bench).call()
    await bench.settle()
    client.send(op="unadvertise_service", service="arm")
    assert (await response)["message"] == "service was withdrawn"
    await clock.advance(2 * LIMITS.service_timeout_s)
    assert client.statuses == []
    assert caplog.messages == []


async def test_a_withdrawn_service_lets_its_calls_fail(bench: Bench) -> None:
    client, _, response = await called(bench)
    client.send(op="unadvertise_service", service="arm")
    assert (await response)["message"] == "service was withdrawn"
    client.send(op="unadvertise_service", service="arm")
    assert client.of("status")[0]["code"] == "not_found"


async def test_calls_that_have_arrived_when_a_service_is_withdrawn_fail(bench: Bench) -> None:
    client = provider(bench)
    responses = [Caller(bench).call() for _ in range(3)]
    await asyncio.sleep(0)  # they are sent
    client.send(op="unadvertise_service", service="arm")
    for response in responses:
        assert (await response)["message"] == "service was withdrawn"
    assert not client.of("call_service")


async def test_a_client_that_is_far_behind_gets_no_more_calls(bench: Bench) -> None:
    client = provider(bench)
    caller = Caller(bench)
    waiting = [caller.call() for _ in range(MAX_PENDING)]
    await client.sees(MAX_PENDING, "call_service")
    assert (await caller.call())["message"] == "service's client is busy"
    bench.router.leave(client.session)
    await asyncio.gather(*waiting)


async def test_the_newest_provider_wins_and_the_former_is_told(bench: Bench) -> None:
    former, newest = provider(bench), provider(bench)
    assert "another client now" in former.of("status")[0]["msg"]
    caller = Caller(bench)
    response = caller.call()
    (frame,) = await newest.sees(1, "call_service")
    former.send(op="service_response", id=frame["id"], service="arm", values={"success": True})
    assert former.of("status")[-1]["code"] == "not_found"
    newest.send(op="service_response", id=frame["id"], service="arm", values={"success": True})
    assert (await response)["success"] is True
    bench.router.leave(former.session)
    response = caller.call()
    await eventually(lambda: len(newest.of("call_service")) == 2)
    bench.router.leave(newest.session)
    await response


@pytest.mark.parametrize(
    ("operation", "code"),
    [
        ({"service": "/arm", "type": "std_srvs/SetBol"}, "bad_type"),
        ({"service": "/arm", "type": "std_msgs/msg/String"}, "bad_type"),
        ({"service": "/a b", "type": "std_srvs/SetBool"}, "bad_name"),
        ({"service": "/arm"}, "bad_request"),
    ],
)
async def test_a_service_that_cannot_be_provided_is_refused(
    bench: Bench, operation: dict[str, Any], code: str
) -> None:
    client = bench.sender(op="advertise_service", id=1, **operation)
    assert (client.of("status")[0]["code"], client.of("status")[0]["id"]) == (code, 1)


async def test_a_client_provides_so_many_services_and_no_more(bench: Bench) -> None:
    client = bench.client()
    for number in range(LIMITS.max_advertisements + 1):
        client.send(op="advertise_service", service=f"/arm{number}", type="std_srvs/SetBool")
    assert [code for code, _ in client.statuses] == ["limit_exceeded"]
    client.send(op="advertise_service", service="/arm0", type="std_srvs/SetBool")
    assert len(client.statuses) == 1
    assert bench.ros.entity_count() == LIMITS.max_advertisements


async def test_a_take_over_by_another_type_is_refused_and_the_service_stays(bench: Bench) -> None:
    former, other = provider(bench), bench.client()
    other.send(op="advertise_service", id=1, service="/arm", type="std_srvs/Trigger")
    assert other.statuses == [
        ("type_conflict", f"/arm is provided by another client, as {SET_BOOL}")
    ]
    assert not former.statuses
    response = Caller(bench).call()
    (frame,) = await former.sees(1, "call_service")
    former.send(op="service_response", id=frame["id"], service="arm", values={"success": True})
    assert (await response)["success"] is True


async def test_a_service_is_given_back_where_ros_refuses_the_new_one(bench: Bench) -> None:
    client = provider(bench)
    client.send(op="call_service", service="/arm", timeout=0.01)  # keeps the type for a while
    await client.sees(1, "service_response")
    client.send(op="advertise_service", id=1, service="/arm", type="std_srvs/Trigger")
    assert client.of("status")[-1]["code"] == "type_conflict"
    client.frames.clear()
    response = Caller(bench).call()
    (frame,) = await client.sees(1, "call_service")
    client.send(op="service_response", id=frame["id"], service="arm", values={"success": True})
    assert (await response)["success"] is True


async def test_a_call_that_was_answered_has_no_deadline_any_more(
    bench: Bench, caplog: pytest.LogCaptureFixture
) -> None:
    bench.router.limits = LIMITS.model_copy(update={"service_timeout_s": 0.05})
    client, frame, response = await called(bench)
    client.send(op="service_response", id=frame["id"], service="arm", values={"success": True})
    await response
    # the deadline of a later call passes after that of the first would have
    await Caller(bench).call()
    await client.sees(1, "status")
    assert [status["id"] for status in client.of("status")] != [frame["id"]]
    assert "KeyError" not in caplog.text


async def test_a_request_that_does_not_fit_its_type_fails(bench: Bench) -> None:
    client = provider(bench)
    async with asyncio.timeout(TIMEOUT_S):
        cdr = await Caller(bench).client.call(b"\0\1\0\0")
    response = bench.types.get(f"{SET_BOOL}_Response").decode(cdr)
    assert response["success"] is False
    assert "request cannot be read" in str(response["message"])
    assert not client.of("call_service")


async def test_a_caller_that_cannot_be_answered_any_more_harms_nobody(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise RosError("internal", "the caller has gone")

    client = provider(bench)
    calling = Caller(bench).call()
    await client.sees(1, "call_service")
    monkeypatch.setattr(FakeRequest, "answer", refuse)
    bench.router.leave(client.session)
    assert bench.ros.entity_count() == 0
    calling.cancel()


async def test_a_provider_is_asked_in_ascii_for_ros_sharp_reads_no_other(bench: Bench) -> None:
    client = bench.sender(op="advertise_service", service="/map", type="nav_msgs/LoadMap")
    calling = bench.ros.add_client("/map", "nav_msgs/srv/LoadMap")
    request = bench.cdr("nav_msgs/srv/LoadMap_Request", map_url="grüße")
    waiting = asyncio.ensure_future(calling.call(request))
    (frame,) = await client.sees(1, "call_service")
    assert frame["args"] == {"map_url": "grüße"}
    assert any(b'"gr\\u00fc' in wire for wire in client.wires)
    waiting.cancel()


async def test_services_of_the_gateway_cannot_be_provided(bench: Bench) -> None:
    client = bench.sender(op="advertise_service", service="/rosapi/topics", type="std_srvs/Empty")
    assert client.statuses == [
        (
            "bad_name",
            "service /rosapi/topics: the gateway answers it itself, provide another name",
        )
    ]
    assert bench.ros.service_servers == []


async def test_a_service_that_a_node_provides_gets_a_warning_and_is_provided(bench: Bench) -> None:
    bench.ros.add_service("/arm", SET_BOOL, lambda request: None, node="/robot")
    client = bench.sender(op="advertise_service", id=1, service="arm", type=SET_BOOL)
    (warning,) = client.frames
    assert (warning["level"], warning["code"], warning["id"]) == ("warning", "already_provided", 1)
    assert warning["msg"].startswith("service /arm is also provided by /robot, ")
    assert bench.router.counts()["services"] == 1


async def test_a_service_that_is_taken_over_or_provided_again_gets_no_such_warning(
    bench: Bench,
) -> None:
    former, client = provider(bench), provider(bench)
    client.send(op="unadvertise_service", service="arm")
    client.send(op="advertise_service", service="arm", type=SET_BOOL)
    client.send(op="advertise_service", service="arm", type=SET_BOOL)
    assert client.statuses == []
    assert [code for code, _ in former.statuses] == ["not_found"]


async def test_a_warning_names_few_nodes_and_none_that_is_hidden(bench: Bench) -> None:
    for number in range(9):
        bench.ros.add_service("/arm", SET_BOOL, lambda request: None, node=f"/robot{number}")
        bench.ros.add_service("/leg", SET_BOOL, lambda request: None, node="/secret")
    hiding = OperatorConfig(
        deny_subscribe=("/secret",), deny_publish=("/secret",), deny_call=("/secret",)
    )
    operator = Policy(AccessConfig(operator=hiding)).of("operator")
    client = bench.client(identity=Identity("tablet", operator))
    for service in ("arm", "leg"):
        client.send(op="advertise_service", service=service, type=SET_BOOL)
    arm, leg = (text for _, text in client.statuses)
    assert "also provided by /robot0 and /robot1 and /robot2 and /robot3, so" in arm
    assert "also provided by a ROS node, so" in leg
