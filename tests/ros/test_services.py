# SPDX-License-Identifier: Apache-2.0
"""Services over rclpy: what the contract cannot see."""

import asyncio
from collections.abc import AsyncIterator, Iterator

import pytest

from gateway.ports import Request, RosError
from gateway.ros import RosOptions
from gateway.ros.endpoints import MAX_UNANSWERED
from gateway.ros.port import RclpyRos
from gateway.ros.services import RclpyClient
from tests.client import eventually
from tests.ros.outside import Outside
from tests.ros.test_contract_services import SET_BOOL, echo, request, response, soon, text_of


@pytest.fixture
async def ros() -> AsyncIterator[RclpyRos]:
    ros = RclpyRos(RosOptions())
    yield ros
    ros.close()


@pytest.fixture
def successor() -> Iterator[Outside]:
    outside = Outside("successor")
    yield outside
    outside.close()


def calls_of(client: RclpyClient) -> int:
    return len(client._requester._waiting) + len(client._requester._under_way)


async def test_calls_leave_nothing_behind(ros: RclpyRos, outside: Outside) -> None:
    def answer_some(each: Request) -> None:
        if each.cdr[4]:
            echo(each)

    outside.add_service("/arm", SET_BOOL, answer_some)
    client = ros.client("/arm", SET_BOOL)
    unanswered = [asyncio.ensure_future(client.call(request(False))) for _ in range(3)]
    assert text_of(await soon(client.call(request(True)))) == "got True"
    for calling in unanswered:
        calling.cancel()
    await eventually(lambda: calls_of(client) == 0)
    waiting = asyncio.ensure_future(ros.client("/leg", SET_BOOL).call(request(True)))
    await asyncio.sleep(0)
    waiting.cancel()
    await eventually(waiting.cancelled)


async def test_a_call_that_is_cancelled_while_it_waits_is_never_sent(
    ros: RclpyRos, outside: Outside
) -> None:
    requests: list[Request] = []
    client = ros.client("/arm", SET_BOOL)
    first = asyncio.ensure_future(client.call(request(False)))
    second = asyncio.ensure_future(client.call(request(True)))
    await asyncio.sleep(0)
    first.cancel()
    outside.add_service("/arm", SET_BOOL, requests.append)
    await eventually(lambda: bool(requests))
    requests[0].answer(response("done"))
    assert text_of(await soon(second)) == "done"
    assert [each.cdr[4] for each in requests] == [1]


async def test_requests_beyond_what_a_server_keeps_wait_here(
    ros: RclpyRos, outside: Outside
) -> None:
    requests: list[Request] = []
    outside.add_service("/arm", SET_BOOL, requests.append)
    client = ros.client("/arm", SET_BOOL)
    calls = [asyncio.ensure_future(client.call(request(True))) for _ in range(MAX_UNANSWERED)]
    unsent = asyncio.ensure_future(client.call(request(False)))
    calls += [asyncio.ensure_future(client.call(request(True))) for _ in range(20)]
    await eventually(lambda: len(requests) == MAX_UNANSWERED)
    assert len(client._requester._under_way) == MAX_UNANSWERED
    for calling in [*calls[:MAX_UNANSWERED], unsent]:
        calling.cancel()  # given up, which makes room
    await eventually(lambda: len(requests) == 2 * MAX_UNANSWERED)
    for each in requests:
        each.answer(response("done"))
    await eventually(lambda: len(requests) == 30)
    for each in requests[2 * MAX_UNANSWERED :]:
        each.answer(response("done"))
    for calling in calls[MAX_UNANSWERED:]:
        assert text_of(await soon(calling)) == "done"
    assert all(each.cdr[4] for each in requests)


async def test_a_call_fails_with_its_server_though_another_has_come(
    ros: RclpyRos, outside: Outside, successor: Outside
) -> None:
    requests: list[Request] = []
    server = outside.add_service("/arm", SET_BOOL, requests.append)
    client = ros.client("/arm", SET_BOOL)
    calling = asyncio.ensure_future(client.call(request(True)))
    await eventually(lambda: len(requests) == 1)
    successor.add_service("/arm", SET_BOOL, echo)
    await eventually(lambda: len(client._requester._find_servers()) == 2)
    assert not calling.done()
    server.close()
    with pytest.raises(RosError, match="service /arm has gone"):
        await soon(calling)
    assert text_of(await soon(client.call(request(True)))) == "got True"


@pytest.mark.parametrize("cdr", [b"", b"\0\1\0\0", b"x"])
async def test_what_is_no_cdr_of_the_type_is_refused(ros: RclpyRos, cdr: bytes) -> None:
    requests: list[Request] = []
    ros.serve("/arm", SET_BOOL, requests.append)
    client = ros.client("/arm", SET_BOOL)
    with pytest.raises(RosError, match="service /arm: failed to deserialize"):
        await client.call(cdr)
    calling = asyncio.ensure_future(client.call(request(True)))
    await eventually(lambda: bool(requests))
    with pytest.raises(RosError, match="service /arm: failed to deserialize"):
        requests[0].answer(cdr)
    requests[0].answer(response("better"))
    assert text_of(await soon(calling)) == "better"


async def test_what_a_callback_raises_keeps_no_other_request_waiting(ros: RclpyRos) -> None:
    raised: list[object] = []
    loop = asyncio.get_running_loop()
    loop.set_exception_handler(lambda _, context: raised.append(context["exception"]))

    def on_request(each: Request) -> None:
        if not each.cdr[4]:
            raise LookupError
        echo(each)

    ros.serve("/arm", SET_BOOL, on_request)
    client = ros.client("/arm", SET_BOOL)
    calls = [asyncio.ensure_future(client.call(request(index == 4))) for index in range(5)]
    assert text_of(await soon(calls[4])) == "got True"
    assert [type(each) for each in raised] == [LookupError] * 4
    for calling in calls:
        calling.cancel()


async def test_a_service_may_be_closed_by_its_own_callback(ros: RclpyRos) -> None:
    requests: list[Request] = []

    def on_request(each: Request) -> None:
        requests.append(each)
        each.answer(response("last"))
        service.close()

    service = ros.serve("/arm", SET_BOOL, on_request)
    client = ros.client("/arm", SET_BOOL)
    calls = [asyncio.ensure_future(client.call(request(True))) for _ in range(3)]
    assert text_of(await soon(calls[0])) == "last"
    for calling in calls[1:]:
        with pytest.raises(RosError, match="service /arm has gone"):
            await soon(calling)
    assert len(requests) == 1
