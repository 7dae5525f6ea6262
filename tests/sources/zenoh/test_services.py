# SPDX-License-Identifier: Apache-2.0
"""Requests and servers that are not as they should be, over Zenoh."""

import asyncio
import time
from typing import Any

import pytest
import zenoh

from gateway.sources.services import ServiceRequest
from gateway.sources.source import Qos, RosError
from gateway.sources.zenoh import queries
from gateway.sources.zenoh.requester import LISTED_S, MAX_ERROR_BYTES, ZenohRequester
from tests.client import eventually
from tests.sources.test_contract_services import SET_BOOL, echo, request, response, soon, text_of
from tests.sources.zenoh.conftest import open_robot
from tests.sources.zenoh.world import ATTACHMENT

MALFORMED = b"\0\1\0\0"  # a server of rclpy ends by it


async def test_a_request_that_is_not_of_its_type_is_not_sent() -> None:
    with open_robot() as (source, world):
        requests: list[ServiceRequest] = []
        world.add_service("/arm", SET_BOOL, requests.append)
        client = source.services.client("/arm", SET_BOOL)
        await eventually(lambda: source.service_types("/arm") == (SET_BOOL,))
        with pytest.raises(RosError, match="service /arm: need 5 bytes") as caught:
            await soon(client.call(MALFORMED))
        assert caught.value.code == "internal"
        calling = asyncio.ensure_future(client.call(request(True)))
        await eventually(lambda: bool(requests))
        assert [each.cdr for each in requests] == [request(True)]
        calling.cancel()


async def test_a_server_with_another_definition_is_not_called() -> None:
    with open_robot() as (source, world):
        world.add_service("/arm", SET_BOOL, echo, f"RIHS01_{'0' * 64}")
        client = source.services.client("/arm", SET_BOOL)
        with pytest.raises(RosError, match="its server has another definition") as caught:
            await soon(client.call(request(True)))
        assert caught.value.code == "type_conflict"


@pytest.mark.parametrize(
    ("payload", "attachment"),
    [
        (MALFORMED, ATTACHMENT.pack(1, 1, 16, bytes(16))),
        (request(True), b""),
        (request(True), bytes(9)),
        (None, None),
    ],
)
async def test_a_request_that_cannot_be_read_is_left_out(payload: Any, attachment: Any) -> None:
    with open_robot() as (source, world):
        requests: list[ServiceRequest] = []
        source.services.serve("/arm", SET_BOOL, lambda each: (requests.append(each), echo(each)))
        client = world.add_client("/arm", SET_BOOL)
        assert text_of(await soon(client.call(request(True)))) == "got True"
        client._querier.get(lambda _: None, payload=payload, attachment=attachment)
        assert text_of(await soon(client.call(request(False)))) == "got False"
        assert len(requests) == 2


async def test_an_error_of_a_server_is_told_as_it_is() -> None:
    assert MAX_ERROR_BYTES == 200
    with open_robot() as (source, world):

        def fail(asked: Any) -> None:
            asked._query.reply_err("no power" + "!" * 500)
            asked._query.drop()

        world.add_service("/arm", SET_BOOL, fail)
        client = source.services.client("/arm", SET_BOOL)
        with pytest.raises(RosError, match="service /arm: the server answers with an error") as got:
            await soon(client.call(request(True)))
        assert got.value.code == "internal"
        assert f"'no power{'!' * 192}': look at its log" in str(got.value)


async def test_a_server_that_is_listed_and_does_not_answer_has_not_gone() -> None:
    assert LISTED_S == 1.0
    with open_robot() as (source, world):
        world.add_service("/arm", SET_BOOL, lambda asked: asked._query.drop())
        client = source.services.client("/arm", SET_BOOL)
        with pytest.raises(RosError, match="/arm: no answer comes, although its server is listed"):
            await soon(client.call(request(True)))


async def test_the_log_goes_to_rosout() -> None:
    with open_robot() as (source, world):
        heard: list[Any] = []
        source.diagnosis.log("warning", "low battery")
        latched = Qos(durability="transient_local")
        world.add_subscription("/rosout", "rcl_interfaces/msg/Log", heard.extend, latched)
        await eventually(lambda: any(b"low battery" in each.cdr for each in heard))


async def test_a_flood_of_requests_takes_one_turn_at_a_time() -> None:
    with open_robot() as (source, world):
        requests: list[ServiceRequest] = []
        server = source.services.serve("/arm", SET_BOOL, requests.append)
        client = world.add_client("/arm", SET_BOOL)
        await eventually(lambda: bool(client._querier.matching_status.matching))
        attachment = ATTACHMENT.pack(1, 1, 16, bytes(16))
        for _ in range(100):
            client._querier.get(lambda _: None, payload=request(True), attachment=attachment)
        while len(server._replier._queries._waiting) < 100:  # the loop does not turn
            time.sleep(0.01)  # noqa: ASYNC251
        assert len(source.publishing._mailbox._calls) == 1
        await eventually(lambda: len(requests) == 100)
        large = request(True) + bytes(queries.MAX_WAITING_BYTES // 2)
        displaced: list[None] = []
        for _ in range(3):
            handler = zenoh.handlers.Callback(lambda _: None, lambda: displaced.append(None))
            client._querier.get(handler, payload=large, attachment=attachment)
        while len(displaced) < 2:
            time.sleep(0.01)  # noqa: ASYNC251
        assert server._replier._queries._bytes <= queries.MAX_WAITING_BYTES == 16 * 1024**2


async def test_of_many_answers_to_one_request_the_first_counts(monkeypatch) -> None:
    settled: list[bytes] = []
    settle = ZenohRequester._settle

    def count(self: ZenohRequester, number: int, cdr: bytes) -> None:
        settled.append(cdr)
        settle(self, number, cdr)

    monkeypatch.setattr(ZenohRequester, "_settle", count)
    with open_robot() as (source, world):

        def flood(asked: Any) -> None:
            for _ in range(50):
                asked._query.reply(asked._service.key, response("first"), attachment=b"")
            asked._query.drop()

        world.add_service("/arm", SET_BOOL, flood)
        client = source.services.client("/arm", SET_BOOL)
        assert text_of(await soon(client.call(request(True)))) == "first"
        await eventually(lambda: not client.requester._queries)
        assert len(settled) == 1
