# SPDX-License-Identifier: Apache-2.0
"""The socket of WebGL builds, under Node, against peers that behave well, badly and not at all."""

import asyncio
import base64
import contextlib
import hashlib
import json
import re
import shutil
from collections.abc import AsyncIterator, Awaitable, Callable

import pytest
from websockets.asyncio.server import ServerConnection, serve
from websockets.exceptions import ConnectionClosed

from tests.gateway_process import gateway_process
from tests.unity.webgl.page import CLOSED, OPEN, TIMEOUT_S, Page, page, until

pytestmark = pytest.mark.skipif(shutil.which("node") is None, reason="node is missing")

TEXT = '{"data":"Grüße, 世界 🤖","nul":"\\u0000"}'


@pytest.fixture
async def browser() -> AsyncIterator[Page]:
    async with page() as running:
        yield running


@contextlib.asynccontextmanager
async def peer(behaviour: Callable[[ServerConnection], Awaitable[None]]) -> AsyncIterator[str]:
    async with serve(behaviour, "127.0.0.1", 0, max_size=None, compression=None) as server:
        yield f"ws://127.0.0.1:{server.sockets[0].getsockname()[1]}"


async def echo(connection: ServerConnection) -> None:
    async for frame in connection:
        await connection.send(frame)


@pytest.mark.parametrize("kind", ["", "shared", "high"])
async def test_text_arrives_as_utf8_and_leaves_as_text(kind):
    async with page(kind) as browser, peer(echo) as url:
        socket = await browser.open(url)
        await socket.until(OPEN)
        assert await socket.frame_bytes() == -1
        for text in (TEXT, "", "[]"):
            assert await socket.send(text.encode()) == 1
            assert await socket.next_frame() == text.encode()
        assert await socket.receive() == (-1, b"")


async def test_frames_of_megabytes_arrive_whole_also_after_the_memory_grew(browser):
    frame = (TEXT * 150_000).encode()
    async with peer(echo) as url:
        socket = await browser.open(url)
        await socket.until(OPEN)
        await socket.send(frame)
        await browser.call("!grow")
        assert await socket.next_frame() == frame


async def test_frames_keep_their_order_and_stay_until_they_fit(browser):
    async def count(connection: ServerConnection) -> None:
        for number in range(3000):
            await connection.send(f"frame {number}")
        await connection.wait_closed()

    async with peer(count) as url:
        socket = await browser.open(url)
        for number in range(3000):
            if number == 7:
                assert await socket.receive(capacity=3) == (-1, b"")
            assert await socket.next_frame() == f"frame {number}".encode()


async def test_a_frame_in_bytes_is_taken_as_it_is(browser):
    async with peer(lambda connection: connection.send(TEXT.encode())) as url:
        assert await (await browser.open(url)).next_frame() == TEXT.encode()


async def test_of_a_message_beyond_the_limit_only_the_size_is_kept(browser):
    async def send(connection: ServerConnection) -> None:
        for size in (100, 101, 5):
            await connection.send("x" * size)
        await connection.wait_closed()

    async with peer(send) as url:
        socket = await browser.open(url, message_bytes=100)
        assert await socket.next_frame() == b"x" * 100
        await until(socket.frame_bytes, lambda size: size == 101)
        assert await socket.receive() == (0, b"")
        assert await socket.next_frame() == b"xxxxx"


@pytest.mark.parametrize(
    ("code", "reason"), [(1000, ""), (1001, "the gateway shuts down"), (4503, "zu langsam 🐌")]
)
async def test_the_peers_close_code_and_reason_come_after_its_last_frame(browser, code, reason):
    async def leave(connection: ServerConnection) -> None:
        await connection.send("last words")
        await connection.close(code, reason)

    async with peer(leave) as url:
        socket = await browser.open(url)
        assert await socket.closed() == (code, reason)
        assert await socket.next_frame() == b"last words"
        assert await socket.send(b"too late") == 0


async def test_a_close_without_a_code_has_code_0(browser):
    async def leave(connection: ServerConnection) -> None:
        async with connection.send_context():
            connection.protocol.send_close()
        await connection.wait_closed()

    async with peer(leave) as url:
        assert await (await browser.open(url)).closed() == (0, "")


async def test_a_connection_that_breaks_is_told_in_words(browser):
    opened = asyncio.Event()

    async def break_off(connection: ServerConnection) -> None:
        async with asyncio.timeout(TIMEOUT_S):
            await opened.wait()
        connection.transport.abort()

    async with peer(break_off) as url:
        socket = await browser.open(url)
        await socket.until(OPEN)
        opened.set()
        assert await socket.closed() == (0, "the connection was lost")


async def test_a_refused_connection_is_told_in_words(browser):
    async with peer(echo) as url:
        pass
    socket = await browser.open(url)
    assert await socket.closed() == (0, "cannot connect, the browser does not tell why")


async def test_an_invalid_address_is_refused_in_words(browser):
    socket = await browser.open("not an address")
    assert await socket.state() == CLOSED
    code, reason = await socket.closed()
    assert code == 0
    assert reason.startswith("cannot connect to not an address: ")
    assert await socket.buffered_bytes() == 0
    await browser.call("Free", socket.handle)


@pytest.mark.parametrize("frame", ["x" * 10_000, ""], ids=["long frames", "empty frames"])
async def test_a_page_that_does_not_read_is_closed_with_4000(browser, frame):
    ended = asyncio.get_running_loop().create_future()

    async def flood(connection: ServerConnection) -> None:
        with contextlib.suppress(ConnectionClosed):
            for _ in range(1000):
                await connection.send(frame)
        await connection.wait_closed()
        ended.set_result((connection.close_code, connection.close_reason))

    async with peer(flood) as url:
        socket = await browser.open(url, inbox_bytes=100_000)
        assert await socket.closed() == (4000, "page does not read")
        assert await socket.frame_bytes() == -1
        async with asyncio.timeout(TIMEOUT_S):
            assert await ended == (4000, "page does not read")


async def test_a_page_that_reads_is_never_closed_however_much_comes(browser):
    async with peer(echo) as url:
        socket = await browser.open(url, inbox_bytes=100_000)
        await socket.until(OPEN)
        for _ in range(50):
            await socket.send(b"x" * 10_000)
            assert await socket.next_frame() == b"x" * 10_000
        assert await socket.state() == OPEN


@pytest.mark.parametrize(
    ("code", "reason", "sent_code", "sent_reason"),
    [
        (1000, "bye", 1000, "bye"),
        (4001, "", 4001, ""),
        (1001, "going", 1000, "going"),  # pages may not say so
        (1000, "ü" * 100, 1000, "ü" * 61),
    ],
)
async def test_a_close_reaches_the_peer(browser, code, reason, sent_code, sent_reason):
    ended = asyncio.get_running_loop().create_future()

    async def listen(connection: ServerConnection) -> None:
        await connection.wait_closed()
        ended.set_result((connection.close_code, connection.close_reason))

    async with peer(listen) as url:
        socket = await browser.open(url)
        await socket.until(OPEN)
        await socket.close(code, reason)
        assert await socket.send(b"too late") == 0
        await socket.close(4999, "a second one changes nothing")
        assert await socket.closed() == (code, reason)
        async with asyncio.timeout(TIMEOUT_S):
            assert await ended == (sent_code, sent_reason)


async def test_a_close_ends_although_the_peer_never_answers(browser):
    async with deaf_peer() as url:
        socket = await browser.open(url)
        await socket.until(OPEN)
        await socket.close(1000, "bye")
        assert await socket.closed() == (1000, "bye")


async def test_a_close_while_connecting_ends_it(browser):
    async with silent_peer() as url:
        socket = await browser.open(url)
        await socket.close(1000, "changed my mind")
        assert await socket.closed() == (1000, "changed my mind")


async def test_messages_that_the_network_does_not_accept_are_counted(browser):
    async with deaf_peer() as url:
        socket = await browser.open(url)
        await socket.until(OPEN)
        frame = b"x" * 2**20
        async with asyncio.timeout(TIMEOUT_S):
            while await socket.buffered_bytes() < len(frame):
                assert await socket.send(frame) == 1


async def test_a_freed_socket_leaves_its_peer(browser):
    left = asyncio.Event()

    async def listen(connection: ServerConnection) -> None:
        await connection.wait_closed()
        left.set()

    async with peer(listen) as url:
        first, second = await browser.open(url), await browser.open(url)
        await first.until(OPEN)
        await second.until(OPEN)
        await browser.call("Free", first.handle)
        async with asyncio.timeout(TIMEOUT_S):
            await left.wait()
        assert await second.state() == OPEN


async def test_a_page_talks_to_the_gateway(browser):
    async with gateway_process("demo") as gateway:
        socket = await browser.open(gateway.url)
        await socket.until(OPEN)
        await socket.send(json.dumps({"op": "subscribe", "topic": "/odom"}).encode())
        frame: dict[str, object] = {}
        async with asyncio.timeout(TIMEOUT_S):
            while frame.get("op") != "publish":
                frame = json.loads(await socket.next_frame())
        assert frame["topic"] == "/odom"
        await gateway.stop()
        assert (await socket.closed())[0] == 1001


@contextlib.asynccontextmanager
async def deaf_peer() -> AsyncIterator[str]:
    """Shakes hands, and then neither reads nor writes."""

    async def shake_hands(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        request = (await reader.readuntil(b"\r\n\r\n")).decode()
        found = re.search(r"sec-websocket-key: (\S+)", request, re.IGNORECASE)
        assert found
        guid = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"  # RFC 6455, 1.3
        digest = hashlib.sha1(f"{found[1]}{guid}".encode(), usedforsecurity=False).digest()
        writer.write(
            b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            b"Sec-WebSocket-Accept: " + base64.b64encode(digest) + b"\r\n\r\n"
        )

    async with _raw_peer(shake_hands) as url:
        yield url


@contextlib.asynccontextmanager
async def silent_peer() -> AsyncIterator[str]:
    """Accepts, and then says nothing at all."""

    async def say_nothing(_reader: asyncio.StreamReader, _writer: asyncio.StreamWriter) -> None:
        pass

    async with _raw_peer(say_nothing) as url:
        yield url


@contextlib.asynccontextmanager
async def _raw_peer(
    behaviour: Callable[[asyncio.StreamReader, asyncio.StreamWriter], Awaitable[None]],
) -> AsyncIterator[str]:
    writers: list[asyncio.StreamWriter] = []

    async def accept(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        writers.append(writer)
        await behaviour(reader, writer)

    server = await asyncio.start_server(accept, "127.0.0.1", 0)
    try:
        yield f"ws://127.0.0.1:{server.sockets[0].getsockname()[1]}"
    finally:
        server.close()
        for writer in writers:
            writer.transport.abort()
