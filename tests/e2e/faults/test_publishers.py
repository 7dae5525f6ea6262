# SPDX-License-Identifier: Apache-2.0
"""Publishers in separate processes that die, and return as they were or otherwise."""

import itertools
import signal
from collections.abc import AsyncIterator

import pytest
import pytest_asyncio

from tests.client import Client, Frame, client
from tests.e2e.faults.conftest import IS_EXACT, REPEAT
from tests.e2e.faults.scene import publisher
from tests.gateway_process import GatewayProcess, gateway_process

pytestmark = [pytest.mark.asyncio(loop_scope="module"), pytest.mark.timeout(3600)]

STRING, INT32 = "std_msgs/msg/String", "std_msgs/msg/Int32"
TEXT = b"\0\1\0\0\5\0\0\0text\0"
NUMBER = b"\0\1\0\0\7\0\0\0"
STALE_AFTER_MS = 500

# A killed one is forgotten by the graph after 20 s, each time
ENDS = (signal.SIGTERM, signal.SIGKILL) if IS_EXACT else (signal.SIGTERM,)

_numbers = itertools.count(1)


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def gateway() -> AsyncIterator[GatewayProcess]:
    async with gateway_process("serve") as gateway:
        yield gateway


@pytest.fixture
def topic() -> str:
    return f"/published_{next(_numbers)}"


async def status(of: Client, code: str) -> Frame:
    return await of.receive(lambda frame: frame.get("code") == code)


async def publishers(of: Client, topic: str) -> list[str]:
    """Return those that the ROS graph has."""
    await of.send(op="graph", id="who")
    graph = await of.receive(lambda frame: frame["op"] == "graph")
    return [
        name for each in graph["topics"] if each["name"] == topic for name in each["publishers"]
    ]


async def test_a_killed_publisher_is_told_of_by_its_silence_and_heard_when_it_returns(
    gateway: GatewayProcess, topic: str
):
    async with client(gateway.url) as asks, client(gateway.url) as does_not_ask:
        await asks.send(op="subscribe", topic=topic, type=STRING, stale_after_ms=STALE_AFTER_MS)
        await does_not_ask.send(op="subscribe", topic=topic, type=STRING)
        assert (await status(asks, "stale"))["level"] == "warning"  # it has yet to begin
        codes: set[str] = set()
        for _ in range(REPEAT):
            async with publisher(topic, STRING) as talker:
                await talker.repeat(TEXT)
                assert await asks.message(topic) == {"data": "text"}
                await status(asks, "fresh")
                assert await does_not_ask.message(topic) == {"data": "text"}
                await talker.end(signal.SIGKILL)
            await status(asks, "stale")
            assert await publishers(asks, topic) != []  # it still seems to be alive there
            frames = [*does_not_ask.seen, *await does_not_ask.sync()]
            codes |= {frame["code"] for frame in frames if frame["op"] != "publish"}
        assert codes <= {"publisher_gone"}  # of those that were killed 20 s ago


async def test_a_publisher_that_is_frozen_is_told_of_and_heard_when_it_goes_on(
    gateway: GatewayProcess, topic: str
):
    async with client(gateway.url) as asks, publisher(topic, STRING) as talker:
        await talker.repeat(TEXT)
        await asks.send(op="subscribe", topic=topic, type=STRING, stale_after_ms=STALE_AFTER_MS)
        await asks.message(topic)
        for _ in range(REPEAT):
            talker.process.send_signal(signal.SIGSTOP)
            await status(asks, "stale")
            talker.process.send_signal(signal.SIGCONT)
            await status(asks, "fresh")
            await asks.message(topic)


@pytest.mark.parametrize("end", ENDS, ids=lambda number: number.name)
async def test_a_client_that_names_no_type_follows_the_publisher_to_another_and_back(
    gateway: GatewayProcess, topic: str, end: signal.Signals
):
    async with client(gateway.url) as follows:
        await follows.send(op="subscribe", topic=topic)
        for type_name, cdr, expected in ((STRING, TEXT, "text"), (INT32, NUMBER, 7)) * 2:
            async with publisher(topic, type_name) as talker:
                await talker.repeat(cdr)
                while await follows.message(topic) != {"data": expected}:
                    pass
                await talker.end(end)


@pytest.mark.parametrize("end", ENDS, ids=lambda number: number.name)
async def test_a_client_that_names_its_type_is_told_of_another_and_hears_the_first_again(
    gateway: GatewayProcess, topic: str, end: signal.Signals
):
    async with client(gateway.url) as insists, client(gateway.url) as follows:
        await insists.send(op="subscribe", id=1, topic=topic, type=STRING)
        async with publisher(topic, STRING) as talker:
            await talker.repeat(TEXT)
            assert await insists.message(topic) == {"data": "text"}
            await follows.send(op="subscribe", id=2, topic=topic)
            assert await follows.message(topic) == {"data": "text"}
            await talker.end(end)
        async with publisher(topic, INT32) as talker:
            await talker.repeat(NUMBER)
            conflict = await status(insists, "type_conflict")
            assert (conflict["level"], conflict["id"]) == ("warning", 1)
            assert f"publishes {INT32}, the subscription is for {STRING}" in conflict["msg"]
            # a participant knows a topic by one type, and the other client holds on to it
            assert (await status(follows, "type_conflict"))["id"] == 2
            await talker.end(end)
        async with publisher(topic, STRING) as talker:
            await insists.sync()
            await talker.repeat(TEXT)
            for each in (insists, follows):
                assert await each.message(topic) == {"data": "text"}


async def test_an_offer_that_does_not_match_is_told_of_in_words_until_one_returns_that_does(
    gateway: GatewayProcess, topic: str
):
    async with client(gateway.url) as adapts, client(gateway.url) as insists:
        reliable = {"reliability": "reliable"}
        await insists.send(op="subscribe", id=1, topic=topic, type=STRING, qos=reliable)
        await adapts.send(op="subscribe", topic=topic, type=STRING)
        for _ in range(REPEAT):
            async with publisher(topic, STRING) as talker:
                await talker.repeat(TEXT)
                for each in (insists, adapts):
                    each.seen.clear()
                    assert await each.message(topic) == {"data": "text"}
                await talker.end(signal.SIGKILL)
            async with publisher(topic, STRING, "best_effort") as talker:
                await talker.repeat(TEXT)
                warning = await status(insists, "qos_incompatible")
                assert (warning["level"], warning["id"]) == ("warning", 1)
                assert "offers reliability best_effort" in warning["msg"]
                await adapts.sync()
                assert await adapts.message(topic) == {"data": "text"}
                await talker.end(signal.SIGTERM)
        statuses = [frame for frame in await adapts.sync() if frame["op"] != "publish"]
        assert {status["code"] for status in statuses} <= {"publisher_gone"}
