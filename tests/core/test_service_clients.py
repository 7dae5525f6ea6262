# SPDX-License-Identifier: Apache-2.0
"""Calls of ROS services with values."""

import asyncio
from collections.abc import AsyncIterator
from typing import Any

import pytest

from gateway.codec.types import Types
from gateway.core.deadline import Deadline
from gateway.core.errors import ProtocolError
from gateway.core.service_clients import ServiceClients, encode_values
from gateway.sources.services import ServiceRequest
from gateway.sources.source import RosError
from schemas.installed import InstalledDefinitions
from tests.client import eventually
from tests.sources.fake import FakeRos

TYPES = Types(InstalledDefinitions())
SET_BOOL = TYPES.service("std_srvs/srv/SetBool")


@pytest.fixture
async def ros() -> FakeRos:
    return FakeRos()


@pytest.fixture
async def service_clients(ros: FakeRos) -> AsyncIterator[ServiceClients]:
    service_clients = ServiceClients(ros)
    yield service_clients
    service_clients.close()
    assert ros.entity_count() == 0


def answer(request: ServiceRequest) -> None:
    data = SET_BOOL.request.decode(request.cdr)["data"]
    response = SET_BOOL.response
    request.answer(response.encode({"success": data}, now_ns=0))


async def test_a_response_comes_decoded(ros: FakeRos, service_clients: ServiceClients) -> None:
    ros.add_service("/arm", SET_BOOL.name, answer)
    response = await service_clients.call("/arm", SET_BOOL, {"data": True}, Deadline.within(5))
    assert response == {"success": True, "message": ""}


async def test_calls_of_one_service_share_a_ros_client(
    ros: FakeRos, service_clients: ServiceClients
) -> None:
    ros.add_service("/arm", SET_BOOL.name, answer)
    deadline = Deadline.within(5)
    await asyncio.gather(
        *(service_clients.call("/arm", SET_BOOL, [True], deadline) for _ in range(5))
    )
    await service_clients.call("/arm", SET_BOOL, None, deadline)
    assert service_clients.clients == ros.entity_count() == 1


async def test_a_call_waits_for_its_server_as_long_as_it_may(
    ros: FakeRos, service_clients: ServiceClients
) -> None:
    calling = asyncio.ensure_future(service_clients.call("/arm", SET_BOOL, {}, Deadline.within(30)))
    await eventually(lambda: service_clients.clients == 1)
    ros.add_service("/arm", SET_BOOL.name, answer)
    assert (await calling)["success"] is False
    with pytest.raises(ProtocolError, match=r"has not answered within 0\.02 s") as refused:
        await service_clients.call("/nobody", SET_BOOL, {}, Deadline.within(0.02))
    assert refused.value.code == "timeout"


async def test_a_cancelled_call_leaves_nothing_under_way(
    ros: FakeRos, service_clients: ServiceClients
) -> None:
    requests: list[ServiceRequest] = []
    ros.add_service("/arm", SET_BOOL.name, requests.append)
    calling = asyncio.ensure_future(service_clients.call("/arm", SET_BOOL, {}, Deadline.within(30)))
    await eventually(lambda: bool(requests))
    calling.cancel()
    with pytest.raises(asyncio.CancelledError):
        await calling
    (client,) = ros.clients
    assert not client.calls
    answer(requests[0])  # too late, and harmless


async def test_closing_fails_pending_calls(ros: FakeRos, service_clients: ServiceClients) -> None:
    ros.add_service("/arm", SET_BOOL.name, lambda request: None)
    calling = asyncio.ensure_future(service_clients.call("/arm", SET_BOOL, {}, Deadline.within(30)))
    await eventually(lambda: service_clients.clients == 1)
    service_clients.close()
    with pytest.raises(RosError, match="closed"):
        await calling


@pytest.mark.parametrize(
    "values",
    [
        {"data": 1},
        "on",
        [True, True],
    ],
)
async def test_values_that_do_not_fit_are_refused_before_ros_hears_of_it(
    ros: FakeRos, service_clients: ServiceClients, values: Any
) -> None:
    with pytest.raises(ProtocolError) as refused:
        await service_clients.call("/arm", SET_BOOL, values, Deadline.within(5))
    assert refused.value.code == "invalid_value"
    assert ros.entity_count() == 0


async def test_a_response_that_cannot_be_read_is_a_fault_of_its_server(
    ros: FakeRos, service_clients: ServiceClients
) -> None:
    ros.add_service("/arm", SET_BOOL.name, lambda request: request.answer(b"\0\1\0\0\1"))
    with pytest.raises(ProtocolError, match="response of /arm: need"):
        await service_clients.call("/arm", SET_BOOL, {}, Deadline.within(5))


def test_values_come_by_name_in_order_or_not_at_all() -> None:
    request = SET_BOOL.request
    true, false = encode_values(request, {"data": True}, 0, "args"), b"\0\1\0\0\0"
    assert encode_values(request, [True], 0, "args") == true
    assert encode_values(request, [], 0, "args") == encode_values(request, None, 0, "x") == false
