# SPDX-License-Identifier: Apache-2.0
"""The contract of the router for services: the fake and rclpy."""

import asyncio
import contextlib
from collections.abc import Callable
from typing import Any

import pytest

from gateway.sources.services import ServiceClient, ServiceRequest
from gateway.sources.source import RosError
from tests.client import TIMEOUT_S, eventually, eventually_equal
from tests.sources.conftest import Robot
from tests.sources.test_contract import BAD_NAMES, refusals

pytestmark = pytest.mark.parts("services")

RETRY_S = 2  # much longer than an answer takes
SET_BOOL = "std_srvs/srv/SetBool"
TRIGGER = "std_srvs/srv/Trigger"
BASIC = "test_msgs/srv/BasicTypes"
BAD_TYPES = [
    *("", "x", "std_srvs/SetBool", "std_srvs/srv/Nothing", "none_msgs/srv/SetBool"),
    *("std_srvs/msg/SetBool", "std_msgs/msg/Int32", "std_srvs/srv/SetBool\n", "os/srv/Path"),
    *("std_srvs/srv/SetBool_Request", "test_msgs/action/Fibonacci"),
]


def request(value: bool) -> bytes:
    """SetBool_Request."""
    return b"\0\1\0\0" + bytes([value])


def response(text: str) -> bytes:
    """SetBool_Response and Trigger_Response."""
    octets = text.encode() + b"\0"
    return b"\0\1\0\0\1\0\0\0" + len(octets).to_bytes(4, "little") + octets


def text_of(cdr: bytes) -> str:
    return cdr[12 : 12 + int.from_bytes(cdr[8:12], "little") - 1].decode()


def echo(request: ServiceRequest) -> None:
    request.answer(response(f"got {bool(request.cdr[4])}"))


async def soon(calling: Any) -> Any:
    async with asyncio.timeout(TIMEOUT_S):
        return await calling


async def answered(client: ServiceClient, cdr: bytes) -> bytes:
    """Ask until there is an answer: a client that still sees a server that has ended asks that."""
    async with asyncio.timeout(TIMEOUT_S):
        while True:
            with contextlib.suppress(RosError, TimeoutError):
                async with asyncio.timeout(RETRY_S):
                    return await client.call(cdr)


async def test_a_call_reaches_an_outside_server_and_its_answer_comes_back(robot: Robot) -> None:
    robot.world.add_service("/arm", SET_BOOL, echo)
    client = robot.ros.services.client("/arm", SET_BOOL)
    assert text_of(await soon(client.call(request(True)))) == "got True"
    assert text_of(await soon(client.call(request(False)))) == "got False"


async def test_an_outside_call_reaches_a_provided_service(robot: Robot) -> None:
    robot.ros.services.serve("/arm", SET_BOOL, echo)
    client = robot.world.add_client("/arm", SET_BOOL)
    assert text_of(await soon(client.call(request(True)))) == "got True"


async def test_the_gateway_may_call_what_it_provides(robot: Robot) -> None:
    robot.ros.services.serve("/arm", SET_BOOL, echo)
    client = robot.ros.services.client("/arm", SET_BOOL)
    assert text_of(await soon(client.call(request(True)))) == "got True"


async def test_a_call_waits_for_its_server(robot: Robot) -> None:
    client = robot.ros.services.client("/arm", SET_BOOL)
    calling = asyncio.ensure_future(client.call(request(True)))
    await asyncio.sleep(0)
    assert not calling.done()
    robot.world.add_service("/arm", SET_BOOL, echo)
    assert text_of(await soon(calling)) == "got True"


async def in_turn(client: Any, requests: list[ServiceRequest]) -> list[asyncio.Future[bytes]]:
    """Make five calls, each after the one before has come to the server."""
    calls = []
    for count in range(1, 6):
        calls.append(asyncio.ensure_future(client.call(request(True))))
        await eventually(lambda count=count: len(requests) == count)
    return calls


async def test_answers_may_come_in_another_order_than_requests(robot: Robot) -> None:
    requests: list[ServiceRequest] = []
    robot.ros.services.serve("/arm", SET_BOOL, requests.append)
    client = robot.world.add_client("/arm", SET_BOOL)
    calls = await in_turn(client, requests)
    for index in (3, 0, 4, 1, 2):
        requests[index].answer(response(str(index)))
    assert [text_of(await soon(call)) for call in calls] == ["0", "1", "2", "3", "4"]


async def test_answers_of_an_outside_server_may_come_in_another_order(robot: Robot) -> None:
    requests: list[ServiceRequest] = []
    robot.world.add_service("/arm", SET_BOOL, requests.append)
    client = robot.ros.services.client("/arm", SET_BOOL)
    calls = await in_turn(client, requests)
    for index in (3, 0, 4, 1, 2):
        requests[index].answer(response(str(index)))
    assert [text_of(await soon(call)) for call in calls] == ["0", "1", "2", "3", "4"]


async def test_a_hundred_calls_at_once_are_all_answered(robot: Robot) -> None:
    robot.world.add_service("/out", SET_BOOL, echo)
    robot.ros.services.serve("/own", SET_BOOL, echo)
    clients = [
        robot.ros.services.client("/out", SET_BOOL),
        robot.world.add_client("/own", SET_BOOL),
    ]
    for client in clients:
        calls = [client.call(request(index % 2 == 0)) for index in range(100)]
        answers = await soon(asyncio.gather(*calls))
        expected = [f"got {index % 2 == 0}" for index in range(100)]
        assert [text_of(answer) for answer in answers] == expected


async def test_a_server_that_vanishes_fails_the_call_it_had(robot: Robot) -> None:
    requests: list[ServiceRequest] = []
    server = robot.world.add_service("/arm", SET_BOOL, requests.append)
    client = robot.ros.services.client("/arm", SET_BOOL)
    calling = asyncio.ensure_future(client.call(request(True)))
    await eventually(lambda: len(requests) == 1)
    server.close()
    with pytest.raises(RosError, match="service /arm has gone") as caught:
        await soon(calling)
    assert caught.value.code == "not_found"


async def test_a_client_calls_a_server_that_has_come_back(robot: Robot) -> None:
    client = robot.ros.services.client("/arm", SET_BOOL)
    for _ in range(2):
        server = robot.world.add_service("/arm", SET_BOOL, echo)
        assert text_of(await answered(client, request(True))) == "got True"
        server.close()
        await eventually(lambda: robot.ros.service_types("/arm") == ())


async def test_closing_a_client_fails_its_calls(robot: Robot) -> None:
    requests: list[ServiceRequest] = []
    robot.world.add_service("/arm", SET_BOOL, requests.append)
    client = robot.ros.services.client("/arm", SET_BOOL)
    waiting = robot.ros.services.client("/leg", SET_BOOL)
    calls = [asyncio.ensure_future(each.call(request(True))) for each in (client, waiting)]
    await eventually(lambda: len(requests) == 1)
    client.close()
    waiting.close()
    for calling, name in zip(calls, ("/arm", "/leg"), strict=True):
        with pytest.raises(RosError, match=f"client of service {name} is closed") as caught:
            await soon(calling)
        assert caught.value.code == "not_found"
    with pytest.raises(RosError, match="client of service /arm is closed"):
        await soon(client.call(request(True)))


async def test_a_cancelled_call_is_forgotten(robot: Robot) -> None:
    requests: list[ServiceRequest] = []
    robot.world.add_service("/arm", SET_BOOL, requests.append)
    client = robot.ros.services.client("/arm", SET_BOOL)
    first = asyncio.ensure_future(client.call(request(True)))
    await eventually(lambda: len(requests) == 1)
    first.cancel()
    second = asyncio.ensure_future(client.call(request(True)))
    await eventually(lambda: len(requests) == 2)
    requests[0].answer(response("late"))
    requests[1].answer(response("in time"))
    assert text_of(await soon(second)) == "in time"
    assert first.cancelled()


async def test_a_request_is_answered_once(robot: Robot) -> None:
    def answer_twice(each: ServiceRequest) -> None:
        each.answer(response("first"))
        each.answer(response("second"))

    robot.ros.services.serve("/arm", SET_BOOL, answer_twice)
    client = robot.world.add_client("/arm", SET_BOOL)
    for _ in range(3):
        assert text_of(await soon(client.call(request(True)))) == "first"


async def test_an_answer_to_a_client_that_has_gone_goes_nowhere(robot: Robot) -> None:
    requests: list[ServiceRequest] = []
    robot.ros.services.serve("/arm", SET_BOOL, requests.append)
    client = robot.ros.services.client("/arm", SET_BOOL)
    calling = asyncio.ensure_future(client.call(request(True)))
    await eventually(lambda: len(requests) == 1)
    client.close()
    requests[0].answer(response("late"))
    with pytest.raises(RosError, match="client of service /arm is closed"):
        await soon(calling)


async def test_an_answer_after_the_service_is_closed_goes_nowhere(robot: Robot) -> None:
    requests: list[ServiceRequest] = []
    service = robot.ros.services.serve("/arm", SET_BOOL, requests.append)
    client = robot.world.add_client("/arm", SET_BOOL)
    calling = asyncio.ensure_future(client.call(request(True)))
    await eventually(lambda: len(requests) == 1)
    service.close()
    requests[0].answer(response("late"))
    calling.cancel()


async def test_no_request_comes_after_close(robot: Robot) -> None:
    requests: list[ServiceRequest] = []
    service = robot.ros.services.serve("/arm", SET_BOOL, requests.append)
    client = robot.world.add_client("/arm", SET_BOOL)
    calling = asyncio.ensure_future(client.call(request(True)))
    await eventually(lambda: len(requests) == 1)
    calling.cancel()
    service.close()
    robot.ros.services.serve("/arm", SET_BOOL, echo)
    assert text_of(await answered(client, request(False))) == "got False"
    assert len(requests) == 1


async def test_a_service_that_closes_answers_what_has_arrived(robot: Robot) -> None:
    client = robot.world.add_client("/arm", SET_BOOL)
    # Requests that arrive after the close get no answer, and DDS decides which these are.
    most = 0
    while most < 2:
        most = max(most, await answers_while_closing(robot, client))


async def answers_while_closing(robot: Robot, client: ServiceClient) -> int:
    """Close a service at the first of many requests. Return how many had arrived."""
    requests: list[ServiceRequest] = []

    def on_request(each: ServiceRequest) -> None:
        requests.append(each)
        each.answer(response("closing"))
        service.close()

    service = robot.ros.services.serve("/arm", SET_BOOL, on_request)
    await eventually(lambda: robot.ros.service_types("/arm") == (SET_BOOL,))
    calls = [asyncio.ensure_future(client.call(request(True))) for _ in range(50)]
    await eventually(lambda: bool(requests))
    await eventually(lambda: sum(call.done() for call in calls) == len(requests))
    answers = [call.result() for call in calls if call.done()]
    for call in calls:
        call.cancel()
    await asyncio.wait(calls)
    assert [text_of(answer) for answer in answers] == ["closing"] * len(requests)
    return len(requests)


async def test_closing_twice_is_harmless(robot: Robot) -> None:
    client = robot.ros.services.client("/arm", SET_BOOL)
    service = robot.ros.services.serve("/arm", SET_BOOL, echo)
    assert robot.ros.diagnosis.entity_count() == 2
    for each in (client, service):
        each.close()
        each.close()
    assert robot.ros.diagnosis.entity_count() == 0


def attempts(robot: Robot, name: str, type_name: str) -> list[Callable[[], object]]:
    return [
        lambda: robot.ros.services.client(name, type_name),
        lambda: robot.ros.services.serve(name, type_name, echo),
    ]


async def test_a_name_that_is_not_fully_qualified_is_bad(robot: Robot) -> None:
    found = {each: refusals(attempts(robot, each, SET_BOOL)) for each in BAD_NAMES}
    assert found == {key: {"bad_name"} for key in BAD_NAMES}
    assert robot.ros.diagnosis.entity_count() == 0


async def test_a_type_without_a_ros_package_is_bad(robot: Robot) -> None:
    found = {each: refusals(attempts(robot, "/arm", each)) for each in BAD_TYPES}
    assert found == {key: {"bad_type"} for key in BAD_TYPES}
    assert robot.ros.diagnosis.entity_count() == 0


async def test_a_service_is_provided_once(robot: Robot) -> None:
    service = robot.ros.services.serve("/arm", SET_BOOL, echo)
    with pytest.raises(RosError, match="service /arm is provided here already") as caught:
        robot.ros.services.serve("/arm", SET_BOOL, echo)
    assert caught.value.code == "limit_exceeded"
    service.close()
    robot.ros.services.serve("/arm", SET_BOOL, echo)


async def test_a_service_is_open_with_one_type_at_a_time(robot: Robot) -> None:
    client = robot.ros.services.client("/arm", SET_BOOL)
    for attempt in attempts(robot, "/arm", TRIGGER):
        with pytest.raises(RosError, match=f"service /arm is open here as {SET_BOOL}") as caught:
            attempt()
        assert caught.value.code == "type_conflict"
    client.close()
    robot.ros.services.client("/arm", TRIGGER)


async def test_a_server_of_another_type_is_not_called(robot: Robot) -> None:
    requests: list[ServiceRequest] = []
    robot.world.add_service("/arm", TRIGGER, requests.append)
    client = robot.ros.services.client("/arm", SET_BOOL)
    calling = asyncio.ensure_future(client.call(request(True)))
    await eventually(lambda: robot.ros.service_types("/arm") == (TRIGGER,))
    assert not calling.done()
    calling.cancel()
    assert requests == []


async def test_the_types_of_a_service_appear_and_vanish_with_it(robot: Robot) -> None:
    assert robot.ros.service_types("/arm") == ()
    outside = robot.world.add_service("/arm", SET_BOOL, echo)
    await eventually(lambda: robot.ros.service_types("/arm") == (SET_BOOL,))
    outside.close()
    await eventually(lambda: robot.ros.service_types("/arm") == ())
    own = robot.ros.services.serve("/arm", TRIGGER, echo)
    await eventually(lambda: robot.ros.service_types("/arm") == (TRIGGER,))
    own.close()
    await eventually(lambda: robot.ros.service_types("/arm") == ())


async def test_a_client_alone_gives_a_service_no_type(robot: Robot) -> None:
    robot.ros.services.client("/arm", SET_BOOL)
    robot.world.add_client("/arm", SET_BOOL)
    robot.ros.services.serve("/leg", SET_BOOL, echo)
    await eventually(lambda: robot.ros.service_types("/leg") == (SET_BOOL,))
    assert robot.ros.service_types("/arm") == ()
    assert all(each.name != "/arm" for each in robot.ros.graph().services)


async def test_the_graph_lists_services_with_who_provides_them(robot: Robot) -> None:
    robot.world.add_service("/arm", SET_BOOL, echo)
    robot.ros.services.serve("/leg", TRIGGER, echo)

    def found() -> dict[str, tuple[tuple[str, ...], tuple[str, ...]]]:
        provided = robot.ros.graph().services
        return {s.name: (s.types, s.nodes) for s in provided if s.name in {"/arm", "/leg"}}

    expected = {
        "/arm": ((SET_BOOL,), ("/outside",)),
        "/leg": ((TRIGGER,), ("/ros2_gateway_services",)),
    }
    await eventually_equal(found, expected)


async def test_a_watch_hears_of_services_that_come_and_go(robot: Robot) -> None:
    seen: list[bool] = []
    robot.ros.watch_graph(
        lambda: seen.append(any(s.name == "/arm" for s in robot.ros.graph().services))
    )
    server = robot.world.add_service("/arm", SET_BOOL, echo)
    await eventually(lambda: bool(seen) and seen[-1])
    server.close()
    await eventually(lambda: not seen[-1])
