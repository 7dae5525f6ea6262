# SPDX-License-Identifier: Apache-2.0
"""The source next to pyzeros, another implementation of rmw_zenoh's wire: topics and services."""

import asyncio
import contextlib
import os
import sys
from typing import Any

import pytest

from gateway.sources.source import Qos
from gateway.sources.zenoh.port import ZenohSource
from tests.client import eventually
from tests.sources.test_contract import Received
from tests.sources.test_contract_services import SET_BOOL, echo, request, soon, text_of
from tests.sources.zenoh.conftest import open_source_on
from tests.sources.zenoh.outside import DOMAIN, PEERS, WHY_MISSING, Router, client

os.environ.setdefault("CYDR_CACHE_DIR", ".cache/cydr")  # of what it compiles
sys.path.append(str(PEERS))
pyzeros = pytest.importorskip("pyzeros", reason=WHY_MISSING)
from ros2_pyterfaces.cydr.std_msgs.msg import String  # noqa: E402  # comes with pyzeros
from ros2_pyterfaces.cydr.std_srvs.srv import SetBool  # noqa: E402

STRING = "std_msgs/msg/String"
pytestmark = pytest.mark.long  # it compiles what reads and writes its messages


@pytest.fixture
async def peers() -> Any:
    # compiled now: in a test, that would hold up the loop for a minute
    for message in (String(data=b"x"), SetBool.Request(data=True), SetBool.Response(message=b"x")):
        type(message).deserialize(bytes(message.serialize()))
    with contextlib.ExitStack() as stack:
        router = stack.enter_context(contextlib.closing(Router()))
        session = stack.enter_context(contextlib.closing(client(router.address)))
        node = pyzeros.Node("peer", session, domain_id=DOMAIN)
        source = stack.enter_context(open_source_on(router.address))
        yield source, node


def test_both_say_the_same_hashes(peers: tuple[ZenohSource, Any]) -> None:
    source, _ = peers
    assert source.hash_of(STRING) == String.hash_rihs01()


async def test_a_message_reaches_the_other_either_way(peers: tuple[ZenohSource, Any]) -> None:
    source, node = peers
    received, loop = Received(), asyncio.get_running_loop()
    source.subscribe("/chatter", STRING, Qos(), received.on_samples, received.on_event)
    publisher = node.create_publisher(String, "chatter")  # it takes relative names
    await eventually(lambda: source.graph().nodes and source.topic_types("/chatter") == (STRING,))
    message = String(data=b"hello")

    def arrives() -> bool:
        publisher.publish(message)
        return bool(received.cdrs)

    await eventually(arrives)
    assert received.cdrs[0] == bytes(message.serialize())
    heard: list[bytes] = []
    pyzeros.sub.RawSub(
        String,
        "talk",
        lambda sample: loop.call_soon_threadsafe(heard.append, sample.payload.to_bytes()),
        session=node,
        scope=None,
    )
    own = source.publishing.advertise("/talk", STRING, Qos(), lambda _: None)
    await eventually(lambda: own.new_matches() > 0)
    assert len(source.publishing.readers("/talk")) == 1

    def is_heard() -> bool:
        own.publish(received.cdrs[0])
        return bool(heard)

    await eventually(is_heard)
    assert heard[0] == received.cdrs[0]


async def test_each_calls_the_service_of_the_other(peers: tuple[ZenohSource, Any]) -> None:
    source, node = peers
    source.services.serve("/ours", SET_BOOL, echo)
    calling = pyzeros.Client(SetBool, "/ours", session=node, scope=None)
    await soon(calling.wait_for_service())
    answer = await soon(calling.call_async(SetBool.Request(data=True)))
    assert bytes(answer.message) == b"got True"
    server = pyzeros.Server(SetBool, "/theirs", session=node, scope=None)

    async def answer_all() -> None:
        async for each in server.listen_reliable():
            each.response.success = True
            each.response.message = b"yes" if each.request.data else b"no"
            each.send()

    answering = asyncio.create_task(answer_all())
    own = source.services.client("/theirs", SET_BOOL)
    assert text_of(await soon(own.call(request(True)))) == "yes"
    assert text_of(await soon(own.call(request(False)))) == "no"
    answering.cancel()
