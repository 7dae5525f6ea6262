# SPDX-License-Identifier: Apache-2.0
"""TLS, on real sockets."""

import asyncio
import contextlib
import socket
import ssl
import sys
from collections.abc import Coroutine
from pathlib import Path
from typing import Any

import pytest
from websockets.frames import Opcode

from gateway.access_files import tls_context
from gateway.cli.certificate import make_certificate
from gateway.config.access import TlsConfig
from gateway.errors import BindError
from gateway.log_rate import BURST, LogRate
from gateway.transport.connection import Connection
from gateway.transport.connections import TICK_S
from gateway.transport.listening import ListenPort
from gateway.transport.scrapes import Scrapes
from tests.client import TIMEOUT_S, client, eventually
from tests.transport.conftest import Serve, Served
from tests.transport.test_server import closing, masked, upgrade

pytest.importorskip("cryptography")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("tls")
    make_certificate(folder, [])
    return folder


@pytest.fixture
def tls(folder: Path) -> ssl.SSLContext:
    context = tls_context(TlsConfig(cert=str(folder / "cert.pem"), key=str(folder / "key.pem")))
    assert context is not None
    return context


@pytest.fixture
def trusting(folder: Path) -> ssl.SSLContext:
    return ssl.create_default_context(cafile=folder / "cert.pem")


def url(served: Served) -> str:
    return f"wss://localhost:{served.port}/"


async def test_large_messages_pass_both_ways(serve: Serve, tls, trusting):
    async with serve(tls=tls) as served, client(url(served), ssl=trusting) as speaker:
        for size in (1, 200_000, 1):
            await speaker.send(op="ping", value="x" * size)
            assert (await speaker.receive())["value"] == "x" * size


async def test_input_with_the_end_of_the_handshake_is_read(serve: Serve, tls, trusting):
    """All in one packet: the last message of TLS, the request, and frames."""
    incoming, outgoing = ssl.MemoryBIO(), ssl.MemoryBIO()
    peer = trusting.wrap_bio(incoming, outgoing, server_hostname="localhost")
    request = upgrade("Host: localhost") + masked(Opcode.TEXT, b'{"op":"ping","id":"early"}')
    async with serve(tls=tls) as served, asyncio.timeout(TIMEOUT_S):
        reader, writer = await asyncio.open_connection("127.0.0.1", served.port)
        while True:
            try:
                peer.do_handshake()
                break
            except ssl.SSLWantReadError:
                writer.write(outgoing.read())
                incoming.write(await reader.read(65536))
        peer.write(request)
        writer.write(outgoing.read())
        seen = b""
        while b"early" not in seen:
            with contextlib.suppress(ssl.SSLWantReadError):
                seen += peer.read(65536)
                continue
            incoming.write(await reader.read(65536))
        writer.close()


@pytest.mark.skipif(
    sys.version_info < (3, 11), reason="asyncio of 3.10 has no ssl_shutdown_timeout"
)
async def test_tls_has_the_time_of_a_handshake_to_begin_and_that_of_a_page_to_end(
    serve: Serve, tls, monkeypatch
):
    loop = asyncio.get_running_loop()
    create_server = loop.create_server
    given: dict[str, object] = {}

    def note(*arguments: Any, **options: Any) -> Coroutine[Any, Any, asyncio.Server]:
        given.update(options)
        return create_server(*arguments, **options)

    monkeypatch.setattr(loop, "create_server", note)
    times = {"open_timeout_s": 7, "send_deadline_s": 11, "close_timeout_s": 2}
    async with serve(times, tls=tls):
        assert (given["ssl_handshake_timeout"], given["ssl_shutdown_timeout"]) == (7, 20)


async def test_a_socket_that_never_begins_is_cut_off_after_a_while(serve: Serve, tls):
    async with serve({"open_timeout_s": 0.2}, tls=tls) as served:
        reader, writer = await asyncio.open_connection("127.0.0.1", served.port)
        async with asyncio.timeout(TIMEOUT_S):
            with contextlib.suppress(ConnectionError):
                assert await reader.read() == b""
        writer.close()


@pytest.mark.parametrize(
    "data",
    [b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n", b"\x16\x03\x01\x00\x05hello", b"\0" * 9000],
)
async def test_data_other_than_tls_ends_only_that_socket(serve: Serve, tls, trusting, data, caplog):
    async with serve(tls=tls) as served, client(url(served), ssl=trusting) as other:
        reader, writer = await asyncio.open_connection("127.0.0.1", served.port)
        writer.write(data)
        async with asyncio.timeout(TIMEOUT_S):
            with contextlib.suppress(ConnectionError):
                await reader.read()
        writer.close()
        await other.sync()
        await eventually(lambda: len(served.server.connections) == 1)
    assert "Traceback" not in caplog.text
    assert not [record for record in caplog.records if record.levelname == "ERROR"]


async def test_a_peer_that_vanishes_leaves_nothing_behind(serve: Serve, tls, trusting, caplog):
    async with serve(tls=tls) as served:
        for moment in range(3):
            sock = socket.create_connection(("127.0.0.1", served.port))  # ours
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")
            if moment:
                sock.sendall(b"\x16\x03\x01"[:moment])
            sock.close()
        async with client(url(served), ssl=trusting) as speaker:
            await speaker.sync()
            speaker.socket.transport.abort()
        await eventually(lambda: not served.server.connections)
    assert "Traceback" not in caplog.text


@pytest.mark.parametrize("is_client", [True, False])
async def test_a_finished_client_does_not_wait(serve: Serve, tls, trusting, is_client, monkeypatch):
    monkeypatch.setattr(Connection, "tick", lambda *_: None)  # which ends by force
    async with serve(tls=tls) as served, asyncio.timeout(TIMEOUT_S):
        if is_client:
            async with client(url(served), ssl=trusting, close_timeout=None) as speaker:
                await speaker.sync()
        else:
            reader, writer = await asyncio.open_connection("localhost", served.port, ssl=trusting)
            writer.write(b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n")
            assert (await reader.read()).startswith(b"HTTP/1.1 200 ")
            writer.close()
        await eventually(lambda: not served.server.connections)


async def test_a_late_reader_gets_a_large_page_completely(serve: Serve, tls, trusting, monkeypatch):
    page = b"# a comment\n" * 700_000

    async def write(*_: object) -> bytes:
        return page

    monkeypatch.setattr(Scrapes, "_write", write)
    async with serve(tls=tls) as served, asyncio.timeout(TIMEOUT_S):
        reader, writer = await asyncio.open_connection("localhost", served.port, ssl=trusting)
        writer.write(b"GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n")
        await eventually(lambda: any(each.awaits_page for each in served.server.connections))
        await asyncio.sleep(3 * TICK_S)
        assert (await reader.read()).endswith(b"\r\n\r\n" + page)
        writer.close()
        await eventually(lambda: not served.server.connections)


async def test_a_failed_handshake_is_one_line_of_the_log_with_its_reason(
    serve: Serve, tls, trusting, caplog
):
    caplog.set_level("INFO", "gateway.transport.tls_handshakes")
    async with serve(tls=tls) as served, asyncio.timeout(TIMEOUT_S):
        reader, writer = await asyncio.open_connection("127.0.0.1", served.port)
        writer.write(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")
        with contextlib.suppress(ConnectionError):
            await reader.read()
        writer.close()
        with pytest.raises(ssl.SSLCertVerificationError):
            await asyncio.to_thread(distrust, served.port)
        await eventually(lambda: len(lines(caplog)) == 2)
        async with client(url(served), ssl=trusting) as speaker:
            await speaker.sync()
        assert lines(caplog) == [
            "a TLS handshake failed: the client speaks without TLS, it needs wss:// or https://",
            "a TLS handshake failed: the client does not trust the certificate",
        ]


async def test_a_flood_of_failed_handshakes_leaves_a_bounded_number_of_lines(serve, tls, caplog):
    caplog.set_level("INFO", "gateway.transport.tls_handshakes")
    async with serve(tls=tls) as served, asyncio.timeout(TIMEOUT_S):
        for _ in range(2 * BURST):
            reader, writer = await asyncio.open_connection("127.0.0.1", served.port)
            writer.write(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")
            with contextlib.suppress(ConnectionError):
                await reader.read()
            writer.close()
    assert len(lines(caplog)) == 2 * BURST
    rate = LogRate()
    assert sum(map(rate.filter, caplog.records)) == BURST


def distrust(port: int) -> None:
    """Connect as browsers do, which say why they leave. Asyncio does not."""
    with socket.create_connection(("127.0.0.1", port)) as sock:
        ssl.create_default_context().wrap_socket(sock, server_hostname="localhost")


def lines(caplog) -> list[str]:
    return [each.message for each in caplog.records if "handshake" in each.message]


async def test_a_second_port_with_tls_shares_clients_and_their_limits(serve: Serve, tls, trusting):
    async with (
        serve({"max_clients": 2}) as served,
        served.server.listening(["127.0.0.1"], ListenPort(0), ListenPort(0, tls)) as (
            plain,
            encrypted,
        ),
    ):
        (_, port), (_, tls_port) = plain[0], encrypted[0]
        secure = f"wss://localhost:{tls_port}/"
        async with client(f"ws://127.0.0.1:{port}/") as one, client(secure, ssl=trusting) as other:
            await other.send(op="subscribe", topic="/talk", type="std_msgs/String")
            await one.send(op="advertise", topic="/talk", type="std_msgs/String")
            await eventually(lambda: served.ros.publishers)
            assert served.server.health()["clients"] == 2
            async with client(secure, ssl=trusting) as third:
                assert await closing(third) == (
                    1013,
                    "over capacity: at most 2 clients (limits.max_clients)",
                )


async def test_the_text_for_people_names_the_scheme_of_its_port(serve: Serve, tls, trusting):
    async with (
        serve() as served,
        served.server.listening(["127.0.0.1"], ListenPort(0), ListenPort(0, tls)) as (
            plain,
            encrypted,
        ),
    ):
        for (_, port), context, scheme in (
            (plain[0], None, b"ws"),
            (encrypted[0], trusting, b"wss"),
        ):
            reader, writer = await asyncio.open_connection("localhost", port, ssl=context)
            writer.write(f"GET / HTTP/1.1\r\nHost: localhost:{port}\r\n\r\n".encode())
            assert b" %s://localhost:%d/" % (scheme, port) in await reader.read()
            writer.close()


async def test_when_one_port_is_taken_the_other_is_closed_again(serve: Serve, tls):
    async with serve() as served:
        with socket.socket() as free, socket.socket() as other:
            for each in (free, other):
                each.bind(("127.0.0.1", 0))
            other.listen()
            (_, port), (_, taken) = free.getsockname(), other.getsockname()
            free.close()
            with pytest.raises(BindError, match=f"127.0.0.1:{taken}, "):
                async with served.server.listening(
                    ["127.0.0.1"], ListenPort(port), ListenPort(taken, tls)
                ):
                    pass
        with pytest.raises(ConnectionRefusedError):
            await asyncio.open_connection("127.0.0.1", port)
