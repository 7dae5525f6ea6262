# SPDX-License-Identifier: Apache-2.0
"""The source next to zenoh-ros2-sdk, a third implementation of rmw_zenoh's wire.

It gives its publishers ids that are not those of their tokens, and numbers samples from 0.
"""

import asyncio
import contextlib
import sys
from typing import Any

import pytest

from gateway.sources.source import Qos
from gateway.sources.zenoh.port import ZenohSource
from tests.client import eventually
from tests.sources.test_contract import Received
from tests.sources.test_contract_services import SET_BOOL, echo, request, soon, text_of
from tests.sources.zenoh.conftest import open_source_on
from tests.sources.zenoh.outside import DOMAIN, PEERS, WHY_MISSING, Router, hash_of
from tests.sources.zenoh.world import service_hash

sys.path.append(str(PEERS))
sdk = pytest.importorskip("zenoh_ros2_sdk", reason=WHY_MISSING)

STRING = "std_msgs/msg/String"
TEXT = {"msg_definition": "string data", "type_hash": hash_of(STRING)}
BOOL = {
    "request_definition": "bool data",
    "response_definition": "bool success\nstring message",
    "type_hash": service_hash(SET_BOOL),
}


@pytest.fixture
async def peers(monkeypatch: pytest.MonkeyPatch) -> Any:
    # a process has one session of it, which would find other routers as well
    monkeypatch.setenv("ZENOH_CONFIG_OVERRIDE", 'mode="client";scouting/multicast/enabled=false')
    with contextlib.ExitStack() as stack:
        router = stack.enter_context(contextlib.closing(Router()))
        source = stack.enter_context(open_source_on(router.address))
        port = int(router.address.rpartition(":")[2])
        where = {"router_ip": "127.0.0.1", "router_port": port, "domain_id": DOMAIN}
        yield source, where
        session = sdk.ZenohSession.get_instance()
        session.session.close()
        sdk.ZenohSession._instance = None


async def test_a_message_reaches_the_other_either_way(peers: tuple[ZenohSource, Any]) -> None:
    source, where = peers
    received, heard = Received(), []
    source.subscribe("/chatter", STRING, Qos(), received.on_samples, received.on_event)
    publisher = await asyncio.to_thread(
        lambda: sdk.ROS2Publisher("/chatter", STRING, **TEXT, **where)
    )
    await eventually(lambda: source.topic_types("/chatter") == (STRING,))

    def arrives() -> bool:
        publisher.publish(data="hello")
        return bool(received.cdrs)

    await eventually(arrives)
    assert b"hello" in received.cdrs[0]
    assert received.reasons == []
    subscriber = await asyncio.to_thread(
        lambda: sdk.ROS2Subscriber(
            "/talk", STRING, lambda each: heard.append(each.data), **TEXT, **where
        )
    )
    own = source.publishing.advertise("/talk", STRING, Qos(), lambda _: None)
    await eventually(lambda: own.new_matches() > 0)

    def is_heard() -> bool:
        own.publish(received.cdrs[0])
        return bool(heard)

    await eventually(is_heard)
    assert heard[0] == "hello"
    publisher.close()
    subscriber.close()


async def test_each_calls_the_service_of_the_other(peers: tuple[ZenohSource, Any]) -> None:
    source, where = peers
    source.services.serve("/ours", SET_BOOL, echo)
    calling = await asyncio.to_thread(
        lambda: sdk.ROS2ServiceClient("/ours", SET_BOOL, **BOOL, **where)
    )
    answer = await soon(asyncio.to_thread(lambda: calling.call(data=True)))
    assert answer.message == "got True"

    def answered(asked: Any) -> Any:
        return server.response_msg_class(success=True, message="yes" if asked.data else "no")

    server = await asyncio.to_thread(
        lambda: sdk.ROS2ServiceServer("/theirs", SET_BOOL, answered, **BOOL, **where)
    )
    client = source.services.client("/theirs", SET_BOOL)
    assert text_of(await soon(client.call(request(True)))) == "yes"
    assert text_of(await soon(client.call(request(False)))) == "no"
    calling.close()
    server.close()
