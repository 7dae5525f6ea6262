# SPDX-License-Identifier: Apache-2.0

import asyncio
import json
import logging
import socket
from collections.abc import AsyncIterator, Iterator
from dataclasses import replace
from types import SimpleNamespace

import pytest

from gateway.transport import lan_discovery
from gateway.transport.lan_discovery import (
    DATAGRAMS_PER_TURN,
    QUESTION_BYTES,
    FoundGateway,
    LanDiscovery,
    answer,
    answering_questions,
    found,
    is_question,
    question,
)
from tests.client import TIMEOUT_S, eventually

GATEWAY = FoundGateway("4f1d", "robot7", 9090, "/", False, None, True, "0.1.0")


@pytest.fixture
async def discovery() -> AsyncIterator[LanDiscovery]:
    discovery = LanDiscovery(answer(GATEWAY), port=0)
    yield discovery
    discovery.close()


@pytest.fixture
def asking() -> Iterator[socket.socket]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asking:
        asking.setblocking(False)
        yield asking


async def heard(asking: socket.socket) -> bytes:
    async with asyncio.timeout(TIMEOUT_S):
        return await asyncio.get_running_loop().sock_recv(asking, 2048)


def waiting(asking: socket.socket) -> int:
    """Count the answers that have come."""
    for count in range(1000):
        try:
            asking.recv(2048)
        except BlockingIOError:
            return count
    raise AssertionError("they do not end")


async def test_a_question_is_answered_again_and_again(discovery, asking):
    for _ in range(3):
        asking.sendto(question(), ("127.0.0.1", discovery.port))
        assert await heard(asking) == answer(GATEWAY)


async def test_other_datagrams_are_not_answered(discovery, asking):
    for datagram in (b"", b"{}", question()[:-1], answer(GATEWAY), b"x" * 1400):
        asking.sendto(datagram, ("127.0.0.1", discovery.port))
    asking.sendto(question(), ("127.0.0.1", discovery.port))
    assert await heard(asking) == answer(GATEWAY)
    assert waiting(asking) == 0


async def test_a_flood_costs_the_loop_a_bounded_part_of_its_time(discovery, asking, monkeypatch):
    monkeypatch.setattr("gateway.transport.lan_discovery.PAUSE_S", 3600.0)
    for _ in range(DATAGRAMS_PER_TURN + 4):
        asking.sendto(question(), ("127.0.0.1", discovery.port))
    await eventually(lambda: discovery._resuming is not None)
    answered = waiting(asking)
    assert answered == DATAGRAMS_PER_TURN
    asking.sendto(question(), ("127.0.0.1", discovery.port))
    for _ in range(10):
        await asyncio.sleep(0)
    assert waiting(asking) == 0  # it does not even look
    discovery._resume()
    for _ in range(5):
        await heard(asking)


async def test_one_that_closes_between_its_turns_does_not_listen_again(monkeypatch):
    discovery = LanDiscovery(answer(GATEWAY), port=0)
    resumed: list[bool] = []
    monkeypatch.setattr("gateway.transport.lan_discovery.PAUSE_S", 0.0)
    monkeypatch.setattr(discovery, "_resume", lambda: resumed.append(True))
    discovery._read()
    discovery.close()
    for _ in range(10):
        await asyncio.sleep(0)
    assert resumed == []


async def test_gateways_of_one_machine_share_the_port(asking: socket.socket) -> None:
    first = LanDiscovery(answer(GATEWAY), port=0)
    second = LanDiscovery(b"{}", port=first.port)
    asking.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
    asking.sendto(question(), ("127.255.255.255", first.port))
    assert {await heard(asking), await heard(asking)} == {answer(GATEWAY), b"{}"}
    first.close()
    second.close()


async def test_a_client_that_leaves_before_the_answer_does_not_disturb_others(discovery, asking):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as gone:
        gone.sendto(question(), ("127.0.0.1", discovery.port))
    asking.sendto(question(), ("127.0.0.1", discovery.port))
    assert await heard(asking) == answer(GATEWAY)


async def test_a_port_in_use_is_reported_and_does_not_prevent_a_start(monkeypatch, caplog):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("", 0))
        port = other.getsockname()[1]
        monkeypatch.setattr(lan_discovery, "PORT", port)
        monkeypatch.setattr(LanDiscovery.__init__, "__defaults__", (port,))
        with caplog.at_level(logging.WARNING), answering_questions(GATEWAY):
            pass
    assert caplog.messages == [
        f"clients cannot find this gateway by themselves: UDP port {port}, address already in use"
    ]


async def test_after_a_turn_it_listens_again_in_100_ms_and_little_waits(discovery):
    delays_s: list[float] = []
    discovery._loop = SimpleNamespace(  # type: ignore[assignment]
        remove_reader=lambda _: None,
        call_later=lambda delay_s, _: delays_s.append(delay_s) or SimpleNamespace(cancel=int),
    )
    discovery._read()
    assert delays_s == [0.1]
    kept = discovery._socket.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)
    assert kept == 2 * 32 * 1024  # the kernel takes twice as much, for what it notes itself
    discovery._loop = asyncio.get_running_loop()


@pytest.mark.parametrize(
    "gateway", [GATEWAY, replace(GATEWAY, is_encrypted=True, path="/ros", tls_port=9091)]
)
def test_an_answer_can_be_read(gateway: FoundGateway) -> None:
    assert found(answer(gateway)) == gateway


def test_the_address_is_that_of_the_websocket() -> None:
    assert GATEWAY.url("10.0.0.7") == "ws://10.0.0.7:9090/"
    assert replace(GATEWAY, is_encrypted=True, path="/ros").url("r") == "wss://r:9090/ros"


def test_no_answer_is_longer_than_a_question() -> None:
    longest = FoundGateway(
        id="f" * 16,
        name="\u00e9" * 500,
        port=65535,
        path="/" + "p" * 199,
        is_encrypted=False,
        tls_port=65535,
        needs_token=False,
        version="10.10.10.dev10",
    )
    assert len(answer(longest)) <= QUESTION_BYTES == len(question())
    told = found(answer(longest))
    assert told.name == "?" * 63
    assert not is_question(question()[: QUESTION_BYTES - 1])


@pytest.mark.parametrize(
    "change",
    [
        {"op": "find_gateways"},
        {"port": "9090"},
        {"port": 0},
        {"port": 65536},
        {"name": "\x1b[2J"},
        {"path": None},
        {"tls": 1},
        {"tls_port": "9091"},
        {"tls_port": -5},
        {"port": True},
        {"path": "@evil.example:9090/"},
        {"name": "n" * 1100},
    ],
)
def test_other_datagrams_are_ignored(change: dict[str, object]) -> None:
    assert found(json.dumps(json.loads(answer(GATEWAY)) | change).encode()) is None


@pytest.mark.parametrize("datagram", [b"", b"{", b"[]", b"\xff" * 600, b"1" * 600])
def test_garbage_is_neither(datagram: bytes) -> None:
    assert not is_question(datagram)
    assert found(datagram) is None
