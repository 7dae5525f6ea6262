# SPDX-License-Identifier: Apache-2.0
"""Services over rclpy: what the contract cannot see."""

import asyncio
import logging
import warnings
from collections.abc import AsyncIterator, Callable, Iterator
from types import SimpleNamespace
from typing import Any

import pytest
from rclpy.qos import DurabilityPolicy, QoSProfile

from gateway.sources import requester
from gateway.sources.rclpy import RosOptions
from gateway.sources.rclpy.interfaces import service_class
from gateway.sources.rclpy.port import RclpyRos
from gateway.sources.rclpy.rclpy_private.handles import RESPONSE_TIMED_OUT
from gateway.sources.rclpy.requester import RclpyRequester
from gateway.sources.rclpy.service_entities import RclpyClient
from gateway.sources.services import ServiceRequest
from gateway.sources.source import MAX_TAKES_PER_TURN, RosError
from tests.client import eventually
from tests.sources.outside import Outside
from tests.sources.test_contract_services import SET_BOOL, echo, request, response, soon, text_of

MAX_IN_FLIGHT = 10
MAX_STALLS = 3


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
    def answer_some(each: ServiceRequest) -> None:
        if each.cdr[4]:
            echo(each)

    outside.add_service("/arm", SET_BOOL, answer_some)
    client = ros.services.client("/arm", SET_BOOL)
    unanswered = [asyncio.ensure_future(client.call(request(False))) for _ in range(3)]
    assert text_of(await soon(client.call(request(True)))) == "got True"
    for calling in unanswered:
        calling.cancel()
    await eventually(lambda: calls_of(client) == 0)
    waiting = asyncio.ensure_future(ros.services.client("/leg", SET_BOOL).call(request(True)))
    await asyncio.sleep(0)
    waiting.cancel()
    await eventually(waiting.cancelled)


async def test_a_call_that_is_cancelled_while_it_waits_is_never_sent(ros, outside):
    requests: list[ServiceRequest] = []
    client = ros.services.client("/arm", SET_BOOL)
    first = asyncio.ensure_future(client.call(request(False)))
    second = asyncio.ensure_future(client.call(request(True)))
    await asyncio.sleep(0)
    first.cancel()
    outside.add_service("/arm", SET_BOOL, requests.append)
    await eventually(lambda: bool(requests))
    requests[0].answer(response("done"))
    assert text_of(await soon(second)) == "done"
    assert [each.cdr[4] for each in requests] == [1]


async def test_requests_beyond_what_a_server_keeps_wait_here(ros, outside, monkeypatch):
    monkeypatch.setattr(requester, "PACING_S", 1e6)
    requests: list[ServiceRequest] = []
    outside.add_service("/arm", SET_BOOL, requests.append)
    client = ros.services.client("/arm", SET_BOOL)
    calls = [asyncio.ensure_future(client.call(request(True))) for _ in range(MAX_IN_FLIGHT)]
    unsent = asyncio.ensure_future(client.call(request(False)))
    calls += [asyncio.ensure_future(client.call(request(True))) for _ in range(20)]
    await eventually(lambda: len(requests) == MAX_IN_FLIGHT)
    assert len(client._requester._under_way) == MAX_IN_FLIGHT
    for calling in [*calls[:MAX_IN_FLIGHT], unsent]:
        calling.cancel()  # given up, which makes room
    await eventually(lambda: len(requests) == 2 * MAX_IN_FLIGHT)
    for each in requests:
        each.answer(response("done"))
    await eventually(lambda: len(requests) == 30)
    for each in requests[2 * MAX_IN_FLIGHT :]:
        each.answer(response("done"))
    for calling in calls[MAX_IN_FLIGHT:]:
        assert text_of(await soon(calling)) == "done"
    assert all(each.cdr[4] for each in requests)


async def test_a_service_of_this_process_gets_its_requests_at_once(ros, monkeypatch):
    monkeypatch.setattr(requester, "PACING_S", 1e6)
    requests: list[ServiceRequest] = []
    ros.services.serve("/arm", SET_BOOL, requests.append)
    client = ros.services.client("/arm", SET_BOOL)
    calls = [asyncio.ensure_future(client.call(request(True))) for _ in range(2 * MAX_IN_FLIGHT)]
    await eventually(lambda: len(requests) == len(calls))
    for each in requests:
        each.answer(response("done"))
    assert [text_of(await soon(calling)) for calling in calls] == ["done"] * len(calls)


async def test_a_request_that_is_cancelled_in_the_turn_that_makes_room_is_never_sent(
    ros: RclpyRos, outside: Outside, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(requester, "PACING_S", 1e6)
    requests: list[ServiceRequest] = []
    outside.add_service("/arm", SET_BOOL, requests.append)
    client = ros.services.client("/arm", SET_BOOL)
    calls = [asyncio.ensure_future(client.call(request(True))) for _ in range(MAX_IN_FLIGHT)]
    await eventually(lambda: len(requests) == MAX_IN_FLIGHT)
    unsent = asyncio.ensure_future(client.call(request(False)))
    calls.append(asyncio.ensure_future(client.call(request(True))))
    await asyncio.sleep(0)
    calls[0].cancel()
    unsent.cancel()
    await eventually(lambda: len(requests) > MAX_IN_FLIGHT)
    assert all(each.cdr[4] for each in requests)
    for calling in calls:
        calling.cancel()


async def test_a_call_fails_with_its_server_though_another_has_come(ros, outside, successor):
    requests: list[ServiceRequest] = []
    server = outside.add_service("/arm", SET_BOOL, requests.append)
    client = ros.services.client("/arm", SET_BOOL)
    calling = asyncio.ensure_future(client.call(request(True)))
    await eventually(lambda: len(requests) == 1)
    successor.add_service("/arm", SET_BOOL, echo)
    await eventually(lambda: len(client._requester._find_servers()) == 2)
    assert not calling.done()
    server.close()
    with pytest.raises(RosError, match="service /arm has gone"):
        await soon(calling)
    # its answer to a client that it does not know yet would be lost
    await eventually(lambda: successor.node.count_clients("/arm") == 1)
    assert text_of(await soon(client.call(request(True)))) == "got True"


async def test_a_call_outlives_a_moment_in_which_its_service_is_unready(ros, outside, monkeypatch):
    requests: list[ServiceRequest] = []
    outside.add_service("/arm", SET_BOOL, requests.append)
    client = ros.services.client("/arm", SET_BOOL)
    calling = asyncio.ensure_future(client.call(request(True)))
    await eventually(lambda: len(requests) == 1)
    with monkeypatch.context() as patch:  # as rmw says while it has found half of another server
        patch.setattr(RclpyRequester, "is_ready", False)
        client.follow_graph()
    requests[0].answer(response("done"))
    assert text_of(await soon(calling)) == "done"


async def test_a_call_whose_server_nobody_could_tell_fails_when_its_service_is_unready(
    ros: RclpyRos, outside: Outside, monkeypatch: pytest.MonkeyPatch
) -> None:
    requests: list[ServiceRequest] = []
    server = outside.add_service("/arm", SET_BOOL, requests.append)
    client = ros.services.client("/arm", SET_BOOL)
    monkeypatch.setattr(RclpyRequester, "_find_servers", lambda self: frozenset())
    calling = asyncio.ensure_future(client.call(request(True)))
    await eventually(lambda: len(requests) == 1)
    client.follow_graph()
    assert not calling.done()
    server.close()
    with pytest.raises(RosError, match="service /arm has gone"):
        await soon(calling)


async def test_a_server_that_has_come_before_word_of_it_keeps_its_calls(ros, outside, monkeypatch):
    requests: list[ServiceRequest] = []
    server = outside.add_service("/arm", SET_BOOL, echo)
    client = ros.services.client("/arm", SET_BOOL)
    await soon(client.call(request(True)))
    with monkeypatch.context() as patch:
        patch.setattr(ros.services, "follow_graph", lambda: None)
        server.close()
        await eventually(lambda: not client._requester.is_ready)
        outside.add_service("/arm", SET_BOOL, requests.append)
        calling = asyncio.ensure_future(client.call(request(True)))
        await eventually(lambda: bool(requests))
    client.follow_graph()
    requests[0].answer(response("done"))
    assert text_of(await soon(calling)) == "done"


@pytest.mark.parametrize("cdr", [b"", b"\0\1\0\0", b"x"])
async def test_cdr_of_another_type_is_refused(ros: RclpyRos, cdr: bytes) -> None:
    requests: list[ServiceRequest] = []
    ros.services.serve("/arm", SET_BOOL, requests.append)
    client = ros.services.client("/arm", SET_BOOL)
    with pytest.raises(RosError, match="service /arm: failed to deserialize"):
        await client.call(cdr)
    calling = asyncio.ensure_future(client.call(request(True)))
    await eventually(lambda: bool(requests))
    with pytest.raises(RosError, match="service /arm: failed to deserialize"):
        requests[0].answer(cdr)
    requests[0].answer(response("better"))
    assert text_of(await soon(calling)) == "better"


async def test_an_exception_in_a_callback_does_not_delay_other_requests(ros: RclpyRos) -> None:
    raised: list[object] = []
    loop = asyncio.get_running_loop()
    loop.set_exception_handler(lambda _, context: raised.append(context["exception"]))

    def on_request(each: ServiceRequest) -> None:
        if not each.cdr[4]:
            raise LookupError
        echo(each)

    ros.services.serve("/arm", SET_BOOL, on_request)
    client = ros.services.client("/arm", SET_BOOL)
    calls = [asyncio.ensure_future(client.call(request(index == 4))) for index in range(5)]
    assert text_of(await soon(calls[4])) == "got True"
    assert [type(each) for each in raised] == [LookupError] * 4
    for calling in calls:
        calling.cancel()


async def test_a_service_may_be_closed_by_its_own_callback(ros: RclpyRos) -> None:
    requests: list[ServiceRequest] = []

    def on_request(each: ServiceRequest) -> None:
        requests.append(each)
        each.answer(response("last"))
        service.close()

    service = ros.services.serve("/arm", SET_BOOL, on_request)
    client = ros.services.client("/arm", SET_BOOL)
    calls = [asyncio.ensure_future(client.call(request(True))) for _ in range(3)]
    assert [text_of(await soon(calling)) for calling in calls] == ["last"] * 3
    assert len(requests) == 3


def with_unreadable(take: Callable[[type], Any], count: int) -> Callable[[type], Any]:
    """Take as *take* does, except for the first messages, which cannot be read.

    rclpy returns for them what it returns if there is no message.
    """
    unread = count

    def taking(message_class: type) -> Any:
        nonlocal unread
        taken = take(message_class)
        if taken == (None, None) or not unread:
            return taken
        unread -= 1
        return None, None

    return taking


async def test_requests_that_cannot_be_read_keep_no_other_waiting(ros: RclpyRos) -> None:
    service: Any = ros.services.serve("/arm", SET_BOOL, echo)
    replier = service._replier
    replier._take_request = with_unreadable(replier._take_request, 6)
    client = ros.services.client("/arm", SET_BOOL)
    calls = [asyncio.ensure_future(client.call(request(True))) for _ in range(9)]
    for calling in calls[6:]:
        assert text_of(await soon(calling)) == "got True"
    for calling in calls[:6]:
        calling.cancel()


async def test_responses_that_cannot_be_read_keep_no_other_waiting(ros: RclpyRos) -> None:
    requests: list[ServiceRequest] = []
    ros.services.serve("/arm", SET_BOOL, requests.append)
    client: Any = ros.services.client("/arm", SET_BOOL)
    requester = client._requester
    requester._take_response = with_unreadable(requester._take_response, 6)
    calls = [asyncio.ensure_future(client.call(request(True))) for _ in range(9)]
    await eventually(lambda: len(requests) == 9)
    for each in requests:
        each.answer(response("done"))
    for calling in calls[6:]:
        assert text_of(await soon(calling)) == "done"
    for calling in calls[:6]:
        calling.cancel()


async def test_32_responses_are_taken_in_a_turn_then_others_have_theirs(ros: RclpyRos) -> None:
    requester: Any = ros.services.client("/arm", SET_BOOL)._requester
    taken = 0

    def take(_: type) -> Any:
        nonlocal taken
        taken += 1
        return SimpleNamespace(request_id=SimpleNamespace(sequence_number=-1)), None

    requester._take_response = take
    requester._take()
    assert taken == MAX_TAKES_PER_TURN == 32


async def test_an_answer_that_is_there_when_its_server_goes_counts(ros: RclpyRos) -> None:
    requests: list[ServiceRequest] = []
    service = ros.services.serve("/arm", SET_BOOL, requests.append)
    client: Any = ros.services.client("/arm", SET_BOOL)
    calling = asyncio.ensure_future(client.call(request(True)))
    await eventually(lambda: bool(requests))
    asyncio.get_running_loop().remove_reader(client._requester._source._fd)  # it is slow
    requests[0].answer(response("done"))
    service.close()
    await eventually(lambda: not client._requester.is_ready)
    client.follow_graph()
    assert text_of(await soon(calling)) == "done"


async def test_a_server_is_found_though_nothing_tells_of_it(ros, outside, monkeypatch):
    monkeypatch.setattr(ros.services, "follow_graph", lambda: None)
    client = ros.services.client("/arm", SET_BOOL)
    loop = asyncio.get_running_loop()
    before = loop.time()
    calling = asyncio.ensure_future(client.call(request(True)))
    await asyncio.sleep(0)
    assert before + 0.02 <= client._requester._next_look.when() <= loop.time() + 0.02
    outside.add_service("/arm", SET_BOOL, echo)
    assert text_of(await soon(calling)) == "got True"


async def test_a_response_that_came_before_dds_had_matched_the_client_is_sent_again(ros, outside):
    requests: list[ServiceRequest] = []
    service = ros.services.serve("/arm", SET_BOOL, requests.append)
    replier: Any = service._replier
    send, sent = replier._send_response, []
    loop = asyncio.get_running_loop()
    delays_s: list[float] = []

    def send_in_vain_at_first(response: Any, request_id: Any) -> None:
        sent.append(response)
        if len(sent) == 1:
            warnings.warn(RESPONSE_TIMED_OUT, RuntimeWarning, stacklevel=1)
        else:
            send(response, request_id)

    def call_soon(delay_s: float, *call: Any) -> None:
        delays_s.append(delay_s)
        loop.call_soon(*call)

    replier._loop = SimpleNamespace(time=loop.time, call_later=call_soon)
    replier._send_response = send_in_vain_at_first
    calling = asyncio.ensure_future(outside.add_client("/arm", SET_BOOL).call(request(True)))
    await eventually(lambda: bool(requests))
    requests[0].answer(response("done"))
    assert text_of(await soon(calling)) == "done"
    assert len(sent) == 2
    assert delays_s == [1.0]


async def test_a_service_that_has_become_silent_sends_what_it_owes(ros, outside):
    requests: list[ServiceRequest] = []
    replier = ros.services.serve("/arm", SET_BOOL, requests.append)._replier
    send, in_vain = replier._send_response, [None] * MAX_STALLS

    def send_in_vain_at_first(response: Any, request_id: Any) -> None:
        if in_vain:
            in_vain.pop()
            warnings.warn(RESPONSE_TIMED_OUT, RuntimeWarning, stacklevel=1)
        else:
            send(response, request_id)

    replier._send_response = send_in_vain_at_first
    client = outside.add_client("/arm", SET_BOOL)
    calls = [asyncio.ensure_future(client.call(request(True))) for _ in range(MAX_STALLS)]
    await eventually(lambda: len(requests) == MAX_STALLS)
    for each in requests:
        each.answer(response("done"))
    assert replier._silent_until > asyncio.get_running_loop().time()
    assert [text_of(await soon(calling)) for calling in calls] == ["done"] * MAX_STALLS


async def test_a_client_that_no_response_can_reach_is_told_of(ros, outside, caplog):
    ros.services.serve("/arm", SET_BOOL, echo)
    found = service_class(SET_BOOL)
    profile = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    deaf = outside.node.create_client(found, "/arm", qos_profile=profile)
    await eventually(outside.add_client("/arm", SET_BOOL)._client.service_is_ready)
    with caplog.at_level(logging.WARNING, "gateway.sources.rclpy.replier"):
        deaf.handle.send_request(found.Request())
        await eventually(lambda: bool(caplog.messages))
    assert caplog.messages == ["service /arm: a client's QoS does not let it get responses"]


async def test_a_client_that_no_response_can_reach_stops_the_loop_only_so_often(
    ros: RclpyRos, outside: Outside, caplog: pytest.LogCaptureFixture
) -> None:
    requests: list[ServiceRequest] = []
    service = ros.services.serve("/arm", SET_BOOL, requests.append)
    found = service_class(SET_BOOL)
    profile = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    deaf = outside.node.create_client(found, "/arm", qos_profile=profile)
    client = outside.add_client("/arm", SET_BOOL)
    await eventually(client._client.service_is_ready)
    for _ in range(2 * MAX_STALLS):
        deaf.handle.send_request(found.Request())  # rclpy's own would see no server
    await eventually(lambda: len(requests) == 2 * MAX_STALLS)
    with caplog.at_level(logging.WARNING, "gateway.sources.rclpy.replier"):
        for each in requests:
            each.answer(response("unheard"))
    assert caplog.messages == [
        "service /arm: no responses for 10 s, as its clients do not get them: see their QoS"
    ]
    assert service._replier._silent_until - asyncio.get_running_loop().time() > 5
    service._replier._silent_until = 0.0  # later
    calling = asyncio.ensure_future(client.call(request(True)))
    await eventually(lambda: len(requests) > 2 * MAX_STALLS)
    requests[-1].answer(response("heard"))
    assert text_of(await soon(calling)) == "heard"


async def test_a_closed_entity_leaves_the_callback_group_of_its_node(ros: RclpyRos) -> None:
    group: Any = ros.services._endpoints.node.default_callback_group
    before = len(group.entities)
    for _ in range(3):
        ros.services.client("/arm", SET_BOOL).close()
        ros.services.serve("/arm", SET_BOOL, echo).close()
    assert len(group.entities) == before


async def test_a_silent_server_gets_one_more_request_after_a_second(ros, outside):
    requests: list[ServiceRequest] = []
    outside.add_service("/arm", SET_BOOL, requests.append, depth=100)
    client = ros.services.client("/arm", SET_BOOL)
    loop = asyncio.get_running_loop()
    before = loop.time()
    calling = asyncio.ensure_future(client.call(request(True)))
    await eventually(lambda: client._requester._pacing is not None)
    assert before + 1 <= client._requester._pacing.when() <= loop.time() + 1
    calling.cancel()


async def test_a_silent_server_gets_one_more_request_at_a_time(ros, outside, monkeypatch):
    monkeypatch.setattr(requester, "PACING_S", 0.3)
    requests: list[ServiceRequest] = []
    outside.add_service("/arm", SET_BOOL, requests.append, depth=100)
    client = ros.services.client("/arm", SET_BOOL)
    calls = [asyncio.ensure_future(client.call(request(True))) for _ in range(3 * MAX_IN_FLIGHT)]
    sent: set[int] = set()

    def is_one_more() -> bool:
        sent.add(len(client._requester._under_way))
        return max(sent) == MAX_IN_FLIGHT + 2

    await eventually(is_one_more)
    assert sent <= {0, MAX_IN_FLIGHT, MAX_IN_FLIGHT + 1, MAX_IN_FLIGHT + 2}
    for calling in calls:
        calling.cancel()
