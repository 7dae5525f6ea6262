# SPDX-License-Identifier: Apache-2.0
"""One line for each end of a connection, with its origin and its reason."""

import asyncio
import contextlib
import logging
import socket
from collections import Counter
from collections.abc import Callable, Coroutine
from typing import Any

import pytest
from websockets.exceptions import ConnectionClosed
from websockets.frames import Opcode

from gateway.core.router import Router
from gateway.transport.close_codes import GOING_AWAY, INTERNAL_ERROR, POLICY_VIOLATION
from gateway.transport.connection import Connection
from gateway.transport.end import EndCause
from tests.client import TIMEOUT_S, client, eventually
from tests.transport.conftest import Serve, Served
from tests.transport.needs import needs_websockets_17
from tests.transport.test_server import closing, handshake, masked, upgrade

LOGGER = "gateway.transport.end"

Ending = Callable[[Served], Coroutine[Any, Any, None]]


def counted(served: Served) -> dict[str, int]:
    """Return the counts of ends by their reason."""
    counts: Counter[str] = Counter()
    for (_, reason, _), count in served.server.summary().ends.items():
        counts[reason] += count
    return dict(counts)


def ends(caplog: pytest.LogCaptureFixture) -> list[logging.LogRecord]:
    return [record for record in caplog.records if record.name == LOGGER]


async def request(served: Served, data: bytes) -> None:
    """Send some bytes, wait for the end, and close."""
    reader, writer = await asyncio.open_connection("127.0.0.1", served.port)
    writer.write(data)
    async with asyncio.timeout(TIMEOUT_S):
        await reader.read()
    writer.close()


async def leaves_without_a_word(served: Served) -> None:
    _, writer = await asyncio.open_connection("127.0.0.1", served.port)
    writer.close()


async def leaves_in_its_request(served: Served) -> None:
    _, writer = await asyncio.open_connection("127.0.0.1", served.port)
    writer.write(b"GET / HTTP/1.1\r\n")
    writer.close()


async def asks_for_health(served: Served) -> None:
    await request(served, b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n")


async def asks_for_what_is_not_there(served: Served) -> None:
    await request(served, b"GET /nope HTTP/1.1\r\nHost: localhost\r\n\r\n")


async def posts(served: Served) -> None:
    await request(served, b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\n\r\nhi")


async def sends_a_long_path(served: Served) -> None:
    await request(served, b"GET /" + b"a" * 10_000 + b" HTTP/1.1\r\n\r\n")


async def is_a_foreign_page(served: Served) -> None:
    await request(served, upgrade("Host: localhost", "Origin: https://evil.example"))


async def has_no_key(served: Served) -> None:
    await request(served, upgrade("Host: localhost").replace(b"Sec-WebSocket-Key", b"X"))


async def closes(served: Served) -> None:
    async with client(served.url) as speaker:
        await speaker.sync()
        await speaker.socket.close(3001, "tired\nof it")


async def vanishes(served: Served) -> None:
    reader, writer = await handshake(served)
    writer.close()
    del reader


async def is_reset(served: Served) -> None:
    _, writer = await handshake(served)
    sock = writer.get_extra_info("socket")
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")
    writer.transport.abort()


async def sends_a_broken_frame(served: Served) -> None:
    reader, writer = await handshake(served)
    writer.write(b"\x83\x80\0\0\0\0")
    await reader.read()
    writer.close()


async def sends_no_utf_8(served: Served) -> None:
    reader, writer = await handshake(served)
    writer.write(masked(Opcode.TEXT, b"\xff"))
    await reader.read()
    writer.close()


async def sends_too_much(served: Served) -> None:
    async with client(served.url) as speaker:
        with contextlib.suppress(ConnectionClosed):
            await speaker.send(op="ping", value="x" * 2000)
        await closing(speaker)


async def floods(served: Served) -> None:
    reader, writer = await handshake(served)
    writer.write(masked(Opcode.PONG, b"") * 20)
    await reader.read()
    writer.close()


async def is_one_too_many(served: Served) -> None:
    async with client(served.url) as first:
        await first.sync()
        async with client(served.url) as second:
            await closing(second)
        await eventually(lambda: counted(served).get("over_capacity") == 1)
        await first.socket.close(1000)


@pytest.mark.parametrize(
    ("ending", "level", "by", "reason", "code", "text"),
    [
        (leaves_without_a_word, "INFO", "client", "handshake", None, "it has sent nothing"),
        (leaves_in_its_request, "INFO", "client", "handshake", None, "it has sent no whole requ"),
        (asks_for_health, "DEBUG", "gateway", "http", 200, "200 OK"),
        (asks_for_what_is_not_there, "INFO", "gateway", "handshake", 404, "404 nothing is at"),
        (posts, "INFO", "gateway", "handshake", 405, "405 not a supported"),
        pytest.param(
            *(sends_a_long_path, "INFO", "gateway", "handshake", None, "request is too large"),
            marks=needs_websockets_17,
        ),
        (is_a_foreign_page, "INFO", "gateway", "handshake", 403, "403 pages from https://evil"),
        (has_no_key, "INFO", "gateway", "handshake", 400, "400 Failed to open"),
        (closes, "INFO", "client", "closed", 3001, "3001 tired\nof it"),
        (vanishes, "INFO", "network", "lost", None, "no closing handshake"),
        (is_reset, "INFO", "network", "lost", None, "connection reset by peer"),
        (sends_a_broken_frame, "INFO", "gateway", "protocol_error", 1002, "1002 invalid opcode"),
        (sends_no_utf_8, "INFO", "gateway", "invalid_data", 1007, "1007 not UTF-8: byte 0xff"),
        (sends_too_much, "INFO", "gateway", "message_too_big", 1009, "1009 message too large"),
        (
            floods,
            "WARNING",
            "gateway",
            "abuse",
            1008,
            "1008 at most 1 frames per second",
        ),
    ],
)
async def test_an_end_is_one_line_with_its_origin_and_reason(
    serve: Serve, caplog, ending: Ending, level, by, reason, code, text
):
    caplog.set_level("DEBUG", LOGGER)
    limits = {"max_message_bytes": 1024, "close_timeout_s": 0.1}
    if ending is floods:
        limits |= {"frames_per_s": 1, "frame_burst": 10}
    async with serve(limits) as served:
        await ending(served)
        await eventually(lambda: bool(ends(caplog)))
    (record,) = ends(caplog)
    assert (record.levelname, record.by, record.reason, record.code) == (level, by, reason, code)
    message = record.getMessage()
    assert message.startswith(f"ended by the {by} after ")
    assert text in message
    assert record.client == "127.0.0.1#1"
    assert counted(served) == {reason: 1}


async def test_an_end_has_the_counts_of_its_client(serve: Serve, caplog):
    caplog.set_level("INFO", LOGGER)
    async with serve() as served:
        async with client(served.url) as speaker:
            for _ in range(3):
                await speaker.sync()
        await eventually(lambda: bool(ends(caplog)))
    (record,) = ends(caplog)
    assert (record.messages_in, record.frames_out) == (3, 3)
    assert record.bytes_in > 200
    assert 0 < record.lasted_s < TIMEOUT_S


async def test_a_long_text_of_a_peer_is_truncated(serve: Serve, caplog):
    caplog.set_level("INFO", LOGGER)
    async with serve() as served:
        key = b"Sec-WebSocket-Key: " + b"9" * 5000 + b"\r\nX: "
        await request(served, upgrade("Host: localhost").replace(b"Sec-WebSocket-Key: ", key))
        await eventually(lambda: bool(ends(caplog)))
    (record,) = ends(caplog)
    assert "999" in record.getMessage()
    assert len(record.getMessage()) < 200


async def test_connections_are_numbered_and_so_are_their_lines(serve: Serve, caplog):
    caplog.set_level("INFO", "gateway.transport")
    async with serve({"max_clients": 1}) as served:
        await is_one_too_many(served)
        await eventually(lambda: len(ends(caplog)) == 2)
    assert [(record.client, record.reason) for record in ends(caplog)] == [
        ("127.0.0.1#2", "over_capacity"),
        ("127.0.0.1#1", "closed"),
    ]
    connected = [each.client for each in caplog.records if each.message == "connected"]
    assert connected == ["127.0.0.1#1"]


async def test_a_late_request_is_named_in_the_log(serve: Serve, caplog):
    caplog.set_level("INFO", LOGGER)
    async with serve({"open_timeout_s": 0.1}) as served:
        await request(served, b"GET /")
    (record,) = ends(caplog)
    assert (record.by, record.reason) == ("gateway", "handshake")
    assert "no handshake within 0.1 s" in record.getMessage()


async def test_a_bug_in_keeping_the_times_of_a_client_ends_it_alone(serve, caplog, monkeypatch):
    ticks: list[str] = []
    tick = Connection.tick

    def fail_for_the_first(connection: Connection, now_s: float) -> None:
        ticks.append(connection.name)
        if connection.name == "127.0.0.1#1":
            raise ZeroDivisionError
        tick(connection, now_s)

    caplog.set_level("INFO", LOGGER)
    async with serve() as served, client(served.url) as first:
        await first.sync()
        async with client(served.url) as other:
            await other.sync()
            monkeypatch.setattr(Connection, "tick", fail_for_the_first)
            await closing(first)
            ticks.clear()
            await eventually(lambda: len(ticks) > 1)
            await other.sync()
    (bug,) = [each for each in caplog.records if each.exc_info]
    assert bug.client == "127.0.0.1#1"
    assert set(ticks) == {"127.0.0.1#2"}
    record = ends(caplog)[0]
    assert (record.client, record.by, record.reason) == (bug.client, "gateway", "internal_error")


async def test_the_shutdown_ends_clients_and_half_open_sockets(serve: Serve, caplog):
    caplog.set_level("INFO", LOGGER)
    async with serve() as served:
        reader, writer = await asyncio.open_connection("127.0.0.1", served.port)
        connection = client(served.url)
        speaker = await connection.__aenter__()
        await eventually(lambda: len(served.server.connections) == 2)
    await closing(speaker)
    await connection.__aexit__(None, None, None)
    assert await reader.read() == b""
    writer.close()
    texts = {(each.reason, each.code): each.getMessage() for each in ends(caplog)}
    assert set(texts) == {("going_away", GOING_AWAY), ("going_away", None)}
    assert all("the gateway is shutting down" in text for text in texts.values())


async def test_the_first_cause_counts(serve: Serve, caplog):
    caplog.set_level("INFO", LOGGER)
    async with serve() as served:
        _, writer = await handshake(served)
        (connection,) = served.server.connections
        connection.close(POLICY_VIOLATION, "enough")
        connection.close(INTERNAL_ERROR, "internal error")
        connection.abort(EndCause("gateway", "send_timeout", "it accepted nothing"))
        await eventually(lambda: bool(ends(caplog)))
        writer.close()
    (record,) = ends(caplog)
    assert record.getMessage().endswith(": 1008 enough")


async def test_the_end_is_written_and_counted_even_if_leaving_fails(serve, caplog, monkeypatch):
    caplog.set_level("INFO", LOGGER)
    leave = Router.leave

    def fail(router: Router, session: Any) -> None:
        leave(router, session)
        raise ZeroDivisionError

    monkeypatch.setattr(Router, "leave", fail)
    async with serve() as served:
        loop = asyncio.get_running_loop()
        loop.set_exception_handler(lambda *_: None)
        async with client(served.url) as speaker:
            await speaker.sync()
        await eventually(lambda: counted(served).get("closed") == 1)
        monkeypatch.undo()
    assert len(ends(caplog)) == 1
