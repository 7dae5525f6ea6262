# SPDX-License-Identifier: Apache-2.0
import asyncio
import contextlib
import json
import socket
import time
import urllib.request
from functools import partial

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.frames import Frame, Opcode

from gateway.core.topics.encoding import Encoding
from gateway.errors import BindError
from gateway.sources.source import Qos
from gateway.transport import inbound
from gateway.transport.connections import TICK_S
from gateway.transport.end import ConnectionEnd, EndCause
from gateway.transport.listening import ListenPort
from tests.client import TIMEOUT_S, Client, client, eventually
from tests.transport.conftest import Serve, Served
from tests.transport.needs import needs_websockets_17

STRING = "std_msgs/msg/String"
FULL = "over capacity: at most 2 clients (limits.max_clients)"
FULL_ADDRESS = "over capacity: 1 clients of one address (limits.max_clients_per_address)"
END = ConnectionEnd("10.0.0.1#1", EndCause("network", "lost", "no closing handshake"), 1.0, 0)


async def closing(speaker: Client) -> tuple[int, str]:
    """Wait for the server to close. Return the code and the reason."""
    async with asyncio.timeout(TIMEOUT_S):
        with contextlib.suppress(ConnectionClosed):
            async for frame in speaker.socket:
                speaker.seen.append(json.loads(frame))
    return speaker.socket.close_code or 0, speaker.socket.close_reason or ""


UPGRADE = (
    b"GET / HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
    b"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n"
)


async def handshake(served: Served) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
    """Open a WebSocket by hand, to send data that no library would send."""
    reader, writer = await asyncio.open_connection("127.0.0.1", served.port)
    writer.write(UPGRADE)
    assert b" 101 " in await reader.readuntil(b"\r\n\r\n")
    return reader, writer


def masked(opcode: Opcode, data: bytes, *, fin: bool = True) -> bytes:
    return Frame(opcode, data, fin=fin).serialize(mask=True)


async def test_the_times_of_clients_and_budgets_are_looked_at_four_times_a_second(serve: Serve):
    assert TICK_S == 0.25
    async with serve() as served:
        async with client(served.url) as speaker:
            await speaker.sync()
            assert served.server.connections.budgets._addresses
        await eventually(lambda: not served.server.connections.budgets._addresses)


async def test_binary_and_fragmented_frames_are_json_too(serve: Serve):
    async with serve() as served, client(served.url) as speaker:
        await speaker.socket.send(b'{"op":"ping","id":1}')
        await speaker.socket.send([b'{"op":', b'"ping","id', b'":2}'])
        await speaker.socket.send(['{"op":"ping",', '"id":3}'])
        assert [(await speaker.receive())["id"] for _ in range(3)] == [1, 2, 3]


@pytest.mark.parametrize("size", [2_000, 2_000_000])
async def test_a_message_too_large_gets_one_status_and_1009(serve: Serve, size, caplog):
    async with (
        serve({"max_message_bytes": 1024}) as served,
        client(served.url) as speaker,
        client(served.url) as other,
    ):
        with contextlib.suppress(ConnectionClosed):  # the server need not wait for the end of it
            await speaker.send(op="ping", value="x" * size)
        code, _ = await closing(speaker)
        assert code == 1009
        (status,) = speaker.seen
        assert status["code"] == "limit_exceeded"
        assert "at most 1024 bytes" in status["msg"]
        assert await other.sync() == []
    assert "Traceback" not in caplog.text


@pytest.mark.parametrize(
    "frame",
    [
        b'{"op":"\xff"}',
        b'{"op":"pin\xe4"',  # no JSON either
        b"\xa1\x62op\x64ping",  # a map of CBOR
        b'{"op":"publish","topic":"/t","msg":{"data":"' + b"\xc3\xa4" * 300_000 + b'\xff"}}',
        b'{"op":"ping","x":NaN,"y":"\xff"}',
    ],
    ids=["text", "no-json", "cbor", "large", "token"],
)
async def test_a_text_frame_that_is_not_utf_8_gets_a_status_and_1007(serve: Serve, frame: bytes):
    async with serve({"close_timeout_s": 0.1}) as served, client(served.url) as other:
        reader, writer = await handshake(served)
        writer.write(masked(Opcode.TEXT, frame))
        answer = await reader.read()
        assert b'"code":"bad_json"' in answer
        assert (1007).to_bytes(2, "big") + b"not UTF-8: byte 0x" in answer
        assert (b"Send CBOR in binary frames" in answer) == (frame[0] == 0xA1)
        assert await other.sync() == []
        writer.close()


async def test_a_binary_frame_that_is_not_utf_8_gets_a_status(serve: Serve):
    async with serve() as served, client(served.url) as speaker:
        await speaker.socket.send(b'{"op":"\xff"}')
        assert (await speaker.status())["code"] == "bad_json"
        assert await speaker.sync() == []


@pytest.mark.parametrize(
    "garbage",
    [
        pytest.param(b"\x83\x80\0\0\0\0", id="reserved opcode"),
        pytest.param(b"\x81\x05hello", id="unmasked"),
        pytest.param(b"\xf1\x80\0\0\0\0", id="reserved bits"),
        pytest.param(b"\x80\x80\0\0\0\0", id="continuation of nothing"),
    ],
)
async def test_a_broken_frame_ends_that_connection_alone(serve: Serve, garbage):
    async with serve({"close_timeout_s": 0.1}) as served, client(served.url) as other:
        reader, writer = await handshake(served)
        writer.write(garbage)
        assert (1002).to_bytes(2, "big") in await reader.read()
        assert await other.sync() == []
        writer.close()


async def test_shutdown_does_not_wait_for_a_client_that_does_not_answer(serve: Serve):
    async with serve({"close_timeout_s": 0.2}) as served:
        reader, writer = await handshake(served)
        await eventually(lambda: served.clients == 1)
    assert (1001).to_bytes(2, "big") in await reader.read()
    writer.close()


async def test_one_client_too_many_is_told_so(serve: Serve):
    async with serve({"max_clients": 2}) as served:
        async with client(served.url) as one, client(served.url) as two:
            async with client(served.url) as three:
                assert await closing(three) == (1013, FULL)
                assert three.seen[-1]["msg"] == FULL
            await one.sync()
            await two.sync()
        await eventually(lambda: served.clients == 0)
        async with client(served.url) as again:
            await again.sync()


async def test_one_address_cannot_take_all_places(serve: Serve):
    async with (
        serve({"max_clients_per_address": 1}) as served,
        client(served.url),
        client(served.url) as second,
    ):
        assert (await closing(second))[1] == FULL_ADDRESS


async def test_sockets_that_never_shake_hands_are_cut_off_and_bounded(serve: Serve):
    async with serve({"open_timeout_s": 0.1, "max_clients": 1}) as served:
        silent = [await asyncio.open_connection("127.0.0.1", served.port) for _ in range(30)]
        for reader, writer in silent:
            assert await reader.read() == b""
            writer.close()
        async with client(served.url) as speaker:
            await speaker.sync()


class Newcomer:
    """A connection that is not a client yet, or was refused."""

    session = None

    def __init__(self, address: str, *, is_leaving: bool = False) -> None:
        self.address = address
        self.is_leaving = is_leaving

    @property
    def is_half_open(self) -> bool:
        return not self.is_leaving

    def abort(self, cause: EndCause) -> None:
        assert cause.text == "no handshake, and 64 others wait"
        self.is_leaving = True

    def tick(self, now_s: float) -> None: ...


async def test_of_more_than_64_handshakes_the_oldest_of_the_greediest_address_is_cut_off(serve):
    async with serve() as served:
        modest = [Newcomer("10.0.0.1") for _ in range(20)]
        greedy = [Newcomer("10.0.0.2") for _ in range(44)]
        newcomers = [Newcomer(f"10.0.1.{number}") for number in range(10)]
        for each in (*modest, *greedy):
            served.server.connections.add(each)
        assert not any(each.is_leaving for each in (*modest, *greedy))
        for each in newcomers:
            served.server.connections.add(each)
        assert [each.is_leaving for each in greedy] == [True] * 10 + [False] * 34
        assert not any(each.is_leaving for each in (*modest, *newcomers))
        for each in (*modest, *greedy, *newcomers):
            served.server.left(each, None, END)


async def test_of_more_than_64_that_were_rejected_the_oldest_is_cut_off(serve: Serve):
    async with serve() as served:
        leaving = [Newcomer("10.0.0.1", is_leaving=True) for _ in range(65)]
        cut_off: list[Newcomer] = []
        for each in leaving:
            each.abort = partial(cut_off.append, each)
            served.server.connections.add(each)
        assert cut_off == leaving[:1]
        for each in leaving:
            served.server.left(each, None, END)


async def test_health_is_answered_while_half_open_and_refused_sockets_flood_in(serve: Serve):
    async with serve({"max_clients": 1}) as served, client(served.url):
        silent = [await asyncio.open_connection("127.0.0.1", served.port) for _ in range(100)]
        refused = []
        for _ in range(70):  # none of them answers the close
            refused.append(await asyncio.open_connection("127.0.0.1", served.port))
            refused[-1][1].write(upgrade("Host: localhost"))
        assert (await asyncio.to_thread(get, served, "/healthz"))[0] == 200
        for _, writer in (*silent, *refused):
            writer.close()


async def test_a_refused_connection_frees_its_place(serve: Serve):
    async with serve({"max_clients": 1}) as served, client(served.url):
        reader, writer = await handshake(served)
        await reader.readuntil((1013).to_bytes(2, "big") + b"over capacity")
        refused = next(each for each in served.server.connections if each.session is None)
        assert refused.is_leaving
        assert not refused.is_half_open
        writer.close()


def from_proxy(address: str) -> dict[str, str]:
    return {"X-Forwarded-For": f"203.0.113.9, {address}"}


async def test_behind_a_trusted_proxy_the_clients_own_addresses_count(serve: Serve):
    async with (
        serve({"max_clients_per_address": 1}, trusted_proxies=["127.0.0.0/8"]) as served,
        client(served.url, additional_headers=from_proxy("192.0.2.1")) as one,
        client(served.url, additional_headers=from_proxy("192.0.2.2")) as two,
        client(served.url, additional_headers=from_proxy("192.0.2.1")) as three,
    ):
        await one.sync()
        await two.sync()
        assert (await closing(three))[1] == FULL_ADDRESS


async def test_health_counts_the_time_of_operations_and_pauses(serve: Serve):
    async with (
        serve({"client_time_share": 0.01, "address_time_share": 0.01}) as served,
        client(served.url) as speaker,
    ):
        while not served.server.health()["reading_pauses"]:
            await speaker.sync()
        assert served.server.health()["operations_time_s"] >= 0.01
        assert await speaker.sync() == []


async def test_a_greedy_pair_does_not_keep_a_third_client_from_its_answers(serve: Serve):
    shares = {"client_time_share": 0.02, "address_time_share": 0.04}
    async with serve(shares) as served, client(served.url) as third:
        floods = [asyncio.create_task(flood(served)) for _ in range(2)]
        await eventually(lambda: served.server.health()["reading_pauses"] > 10)
        for _ in range(2):
            before = served.server.health()["messages_in"]
            assert await third.sync() == []
            # while it waits, each of the others has some slices of the address's time, not more
            assert served.server.health()["messages_in"] - before < 20_000
        for task in floods:
            task.cancel()
        await asyncio.gather(*floods, return_exceptions=True)


async def test_a_client_that_connects_while_its_address_has_spent_its_time_stays(
    serve: Serve, monkeypatch
):
    monkeypatch.setattr(inbound, "LEFTOVER_S", 0.0)  # of a client that has left
    async with serve() as served:
        budgets = served.server.connections.budgets
        budgets.join("127.0.0.1").time.spend(0.6, time.monotonic())
        reader, writer = await asyncio.open_connection("127.0.0.1", served.port)
        writer.write(UPGRADE[:20])
        spent_s = budgets.spent_s
        await eventually(lambda: budgets.spent_s > spent_s)
        writer.write(UPGRADE[20:])
        assert b" 101 " in await reader.readuntil(b"\r\n\r\n")
        await asyncio.sleep(3 * TICK_S)
        writer.write(masked(Opcode.TEXT, b'{"op":"ping"}'))
        assert await reader.readuntil(b'"pong"')
        writer.close()


async def flood(served: Served) -> None:
    """Send pings as fast as they are accepted, and read all answers."""
    reader, writer = await handshake(served)
    try:
        async with asyncio.TaskGroup() as group:
            group.create_task(drain(reader))
            while True:
                writer.write(masked(Opcode.TEXT, b'{"op":"ping"}') * 100)
                await writer.drain()
                await asyncio.sleep(0)
    finally:
        writer.transport.abort()


async def drain(reader: asyncio.StreamReader) -> None:
    while await reader.read(1 << 16):
        pass


async def test_a_client_that_answers_no_ping_stays_and_a_late_answer_is_measured(serve: Serve):
    def round_trip_s() -> float | None:
        (state,) = served.server.summary().clients
        return state.round_trip_s

    async with serve({"ping_interval_s": 0.05, "send_deadline_s": 0.05}) as served:
        reader, writer = await handshake(served)
        async with asyncio.timeout(TIMEOUT_S):
            for _ in range(5):
                assert await reader.readexactly(2) == bytes((0x80 | Opcode.PING, 0))
        assert round_trip_s() is None
        writer.write(masked(Opcode.PONG, b""))
        await eventually(lambda: round_trip_s() is not None)
        writer.close()


async def test_health_counts_what_a_throttle_replaced_also_of_clients_that_left(serve: Serve):
    async with serve() as served:
        async with client(served.url) as listener:
            publisher = served.ros.add_publisher("/t", STRING)
            await listener.send(op="subscribe", topic="/t", throttle_rate=3_600_000)
            await listener.sync()
            for _ in range(5):
                publisher.publish(served.cdr(STRING, data="x"))
            # the first passes, the second is held, each later one takes the place of another
            await eventually(lambda: served.server.health()["coalesced"] == 3)
        await eventually(lambda: served.clients == 0)
        assert served.server.health()["coalesced"] == 3


async def test_a_client_that_accepts_nothing_is_cut_off_and_does_not_disturb_others(serve: Serve):
    async with serve({"send_deadline_s": 0.5}) as served, client(served.url) as good:
        publisher = served.ros.add_publisher("/big", STRING, Qos(depth=100))
        reader, writer = await handshake(served)
        writer.write(masked(Opcode.TEXT, b'{"op":"subscribe","topic":"/big"}'))
        await good.send(op="subscribe", topic="/big")
        await eventually(lambda: served.ros.entity_count() == 1 and served.clients == 2)
        await good.sync()
        sample = served.cdr(STRING, data="x" * 200_000)
        count = 0
        async with asyncio.timeout(TIMEOUT_S):
            while served.clients == 2:  # never read from `reader`: its buffers fill
                publisher.publish(sample)
                count += 1
                assert len((await good.message("/big"))["data"]) == 200_000
        assert count > 5
        assert served.server.health()["dropped"] > 0
        writer.close()
        del reader


def get(served: Served, path: str, method: str = "GET") -> tuple[int, str, str]:
    request = urllib.request.Request(f"http://127.0.0.1:{served.port}{path}", method=method)
    try:
        with urllib.request.urlopen(request, timeout=TIMEOUT_S) as response:  # noqa: S310  # ours
            return response.status, response.headers["Content-Type"], response.read().decode()
    except urllib.error.HTTPError as error:
        with error:
            return error.code, error.headers["Content-Type"], error.read().decode()


async def test_health_is_json_on_the_same_port(serve: Serve):
    async with serve() as served, client(served.url) as speaker:
        await speaker.send(op="subscribe", topic="/a", type=STRING)
        await speaker.sync()
        status, content_type, body = await asyncio.to_thread(get, served, "/healthz")
        assert (status, content_type) == (200, "application/json; charset=utf-8")
        health = json.loads(body)
        assert (health["status"], health["clients"], health["subscriptions"]) == ("ok", 1, 1)


@needs_websockets_17
async def test_the_version_is_told_as_rosbridge_does(serve: Serve):
    async with serve(version="1.2.3") as served:
        status, content_type, body = await asyncio.to_thread(get, served, "/version")
        assert (status, content_type) == (200, "application/json; charset=utf-8")
        told = {"protocol": {"major": 2, "minor": 0, "patch": 0}, "server": "1.2.3"}
        assert json.loads(body) == told
        assert (await asyncio.to_thread(get, served, "/version", "HEAD"))[::2] == (200, "")


async def test_health_is_never_cached(serve: Serve):
    async with serve() as served:
        reader, writer = await asyncio.open_connection("127.0.0.1", served.port)
        writer.write(b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n")
        assert b"cache-control: no-store\r\n" in (await reader.read()).lower()
        writer.close()


@needs_websockets_17
async def test_a_browser_is_told_how_to_connect(serve: Serve):
    async with serve() as served:
        status, _, body = await asyncio.to_thread(get, served, "/")
        assert status == 200
        assert f"ws://127.0.0.1:{served.port}/" in body
        assert (await asyncio.to_thread(get, served, "/healthz", "HEAD"))[::2] == (200, "")
        assert (await asyncio.to_thread(get, served, "/nope"))[0] == 404


@pytest.mark.parametrize(
    ("origin", "allowed", "is_welcome"),
    [
        (None, (), True),
        ("http://127.0.0.1:PORT", (), True),
        ("http://127.0.0.1:8080", (), False),
        ("http://localhost:PORT", (), False),  # asked for by another name
        ("https://evil.example", (), False),
        ("null", (), False),
        ("null", ("null",), True),
        ("http://localhost:3000", ("http://localhost:3000",), True),
        ("https://ui.example", ("https://ui.example",), True),
        ("https://anything.example", ("*",), True),
    ],
)
async def test_only_own_pages_and_allowed_ones_connect(serve: Serve, origin, allowed, is_welcome):
    async with serve(allowed_origins=allowed) as served:
        origin = origin and origin.replace("PORT", str(served.port))
        if is_welcome:
            async with client(served.url, origin=origin) as speaker:
                await speaker.sync()
            return
        with pytest.raises(InvalidStatus) as caught:
            async with client(served.url, origin=origin):
                pass
        assert caught.value.response.status_code == 403
        assert b"may not connect" in caught.value.response.body


async def test_a_refused_page_is_logged_once_with_the_setting_that_allows_it(serve: Serve, caplog):
    async with serve(allowed_origins=("https://ui.example",)) as served:
        for origin in ["http://localhost:3000"] * 3 + ["null", "http://a b", "http://x'y"]:
            status = await status_of(served, upgrade("Host: localhost", f"Origin: {origin}"))
            assert status == 403
    lines = [record.getMessage() for record in caplog.records if "--set" in record.message]
    assert lines == [
        (
            "pages from http://localhost:3000 may not connect: to allow them, use"
            "  --set 'allowed_origins=https://ui.example,http://localhost:3000'"
        ),
        (
            "pages from origin null (a page on disk, or in a sandboxed frame of any web site) may"
            " not connect: serve the page from a web server on this machine, or use"
            "  --set 'allowed_origins=https://ui.example,null'"
        ),
    ]


async def test_origins_without_end_leave_a_bounded_number_of_lines(serve: Serve, caplog):
    async with serve() as served:
        for number in range(100):
            await status_of(served, upgrade("Host: localhost", f"Origin: http://s{number}"))
    assert caplog.text.count("may not connect: to allow them, use") == 64
    assert caplog.text.count("the log does not show further origins") == 1


def upgrade(*lines: str) -> bytes:
    """Return the bytes of a handshake with further header lines."""
    head = (
        "GET / HTTP/1.1",
        "Connection: Upgrade",
        "Upgrade: websocket",
        "Sec-WebSocket-Version: 13",
        "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==",
        *lines,
    )
    return ("\r\n".join(head) + "\r\n\r\n").encode()


async def status_of(served: Served, request: bytes) -> int:
    """Send a request. Return the status of the response, and see that it is the only one."""
    reader, writer = await asyncio.open_connection("127.0.0.1", served.port)
    writer.write(request)
    async with asyncio.timeout(TIMEOUT_S):
        response = await reader.read()
    writer.close()
    assert response.count(b"HTTP/1.1") == 1
    assert b"Traceback" not in response
    return int(response.split()[1])


async def test_the_address_says_in_which_format_images_come(serve: Serve):
    image = "sensor_msgs/msg/Image"
    async with serve() as served, client(f"{served.url}?images=raw") as speaker:
        publisher = served.ros.add_publisher("/camera", image)
        await speaker.send(op="subscribe", topic="/camera")
        await speaker.sync()
        publisher.publish(
            served.cdr(image, encoding="mono8", width=1, height=1, step=1, data="AA==")
        )
        assert (await speaker.message("/camera"))["encoding"] == "mono8"
        with pytest.raises(InvalidStatus) as refused:
            async with client(f"{served.url}?images=gif"):
                pass
    assert refused.value.response.status_code == 400
    assert b"images: got 'gif', expected jpeg" in refused.value.response.body


@pytest.mark.parametrize(
    ("host", "status"), [("evil.example", 421), ("evil.example:9090", 421), ("", 400)]
)
@pytest.mark.parametrize("origin", [(), ("Origin: http://evil.example:9090",)])
@pytest.mark.parametrize("path", ["/", "/healthz"])
async def test_a_foreign_name_that_points_here_is_not_served(serve, host, status, origin, path):
    request = upgrade(f"Host: {host}", *origin).replace(b"GET / ", f"GET {path} ".encode())
    async with serve() as served:
        assert await status_of(served, request) == status


async def test_a_foreign_name_is_logged_once_with_the_setting_that_allows_it(serve: Serve, caplog):
    async with serve() as served:
        for host in ["robot.lan:9090"] * 3 + ["evil'name", "evil\x01name"]:
            await status_of(served, upgrade(f"Host: {host}"))
    lines = [record.getMessage() for record in caplog.records if "to allow it" in record.message]
    setting = "--set 'allowed_hosts=robot.lan'"
    assert lines == [f"refused a request for host robot.lan: to allow it, use  {setting}"]


async def test_all_addresses_but_the_first_may_be_taken(serve: Serve, caplog):
    caplog.set_level("INFO")
    async with serve() as served:
        with socket.socket(socket.AF_INET) as other:
            other.bind(("127.0.0.2", 0))
            other.listen()
            port = other.getsockname()[1]
            hosts = ["127.0.0.3", "127.0.0.2", "192.0.2.1"]
            async with served.server.listening(hosts, ListenPort(port)) as (addresses,):
                assert addresses == [("127.0.0.3", port)]
            with pytest.raises(BindError, match=r"127\.0\.0\.2"):
                async with served.server.listening(["127.0.0.2", "127.0.0.3"], ListenPort(port)):
                    pass
    lines = [record.message for record in caplog.records if "not listening" in record.message]
    assert [line.partition(":")[0] for line in lines] == ["not listening on 127.0.0.2"]


@pytest.mark.parametrize("version", ["8", "12", "14", "13, 8", "x"])
async def test_other_versions_of_the_protocol_learn_which_one_is_spoken(serve: Serve, version):
    other = f"Sec-WebSocket-Version: {version}".encode()
    request = upgrade("Host: localhost").replace(b"Sec-WebSocket-Version: 13", other)
    async with serve() as served:
        reader, writer = await asyncio.open_connection("127.0.0.1", served.port)
        writer.write(request)
        response = await reader.read()
        assert response.split()[1] == b"426"
        assert b"\r\nUpgrade: websocket\r\n" in response
        assert b"\r\nSec-WebSocket-Version: 13\r\n" in response
        writer.close()


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE"])
@pytest.mark.parametrize("body", [b"", b"Content-Length: 2\r\n\r\nhi"])
async def test_other_methods_get_405(serve: Serve, method, body):
    async with serve() as served:
        reader, writer = await asyncio.open_connection("127.0.0.1", served.port)
        writer.write(f"{method} / HTTP/1.1\r\nHost: localhost\r\n".encode() + (body or b"\r\n"))
        response = await reader.read()
        assert response.split()[1] == b"405"
        assert b"\r\nAllow: GET" in response
        writer.close()


@pytest.mark.parametrize(
    ("request_bytes", "status"),
    [
        pytest.param(b"nonsense\r\n\r\n", 400, id="no request line"),
        pytest.param(b"\x16\x03\x01\x02\x00\x01\x00\r\n\r\n", 400, id="TLS"),
        pytest.param(b"GET / HTTP/2\r\n\r\n", 400, id="HTTP/2"),
        pytest.param(b"GET / HTTP/1.1\r\nno header\r\n\r\n", 400, id="no header"),
        pytest.param(b"GET /\xff HTTP/1.1\r\n\r\n", 400, id="not ASCII"),
        pytest.param(b"GET / HTTP/1.1\r\n\r\n", 400, id="no host"),
        pytest.param(upgrade("Host: localhost", "Host: evil"), 400, id="two hosts"),
        pytest.param(
            b"GET /" + b"a" * 10_000 + b" HTTP/1.1\r\n\r\n",
            414,
            id="long path",
            marks=needs_websockets_17,
        ),
        pytest.param(
            upgrade("Host: a", "X: " + "x" * 10_000),
            431,
            id="long header",
            marks=needs_websockets_17,
        ),
        pytest.param(
            upgrade("Host: a", *["X: y"] * 200), 431, id="many headers", marks=needs_websockets_17
        ),
        pytest.param(upgrade("Host: a", *["X: " + "x" * 8000] * 3), 431, id="much in headers"),
        pytest.param(
            upgrade("Host: localhost", *["Sec-WebSocket-Protocol: " + "a," * 3900] * 3),
            431,
            id="many subprotocols",
        ),
    ],
)
async def test_an_invalid_request_gets_its_status_and_leaves_no_trace(
    serve: Serve, request_bytes, status, caplog
):
    async with serve() as served, client(served.url) as other:
        assert await status_of(served, request_bytes) == status
        assert await other.sync() == []
        await eventually(lambda: len(served.server.connections) == 1)
    assert "Traceback" not in caplog.text


@pytest.mark.parametrize(
    ("target", "status"),
    [
        ("http://evil.example/healthz", 421),
        ("ws://evil.example/", 421),
        ("http://localhost/healthz?", 200),
        ("HTTP://localhost:9090", 200),
        ("ftp://localhost/healthz", 400),
        ("localhost:9090/healthz", 400),
        ("http:/healthz", 400),
        ("*", 400),
        ("//evil.example/healthz", 404),
        ("//healthz", 200),
    ],
)
@pytest.mark.parametrize("header", ["localhost", "evil.example"])
async def test_the_host_of_a_target_counts_instead_of_the_header(serve, target, status, header):
    async with serve() as served:
        request = f"GET {target} HTTP/1.1\r\nHost: {header}\r\n\r\n".encode()
        is_path = target[0] == "/" and header == "evil.example"
        assert await status_of(served, request) == (421 if is_path else status)


async def test_a_malformed_request_in_small_pieces_is_answered_once(serve: Serve):
    async with serve() as served:
        reader, writer = await asyncio.open_connection("127.0.0.1", served.port)
        for byte in b"nonsense\r\nand\r\nmore\r\n":
            writer.write(bytes([byte]))
            await asyncio.sleep(0)
        response = await reader.read()
        assert response.split()[1] == b"400"
        assert response.count(b"HTTP/1.1") == 1
        writer.close()


@pytest.mark.parametrize(
    "request_bytes",
    [
        pytest.param(b"GET http://[ HTTP/1.1\r\nHost: localhost\r\n\r\n", id="no path"),
        pytest.param(upgrade("Host: localhost", "Origin: http://["), id="no origin"),
        pytest.param(
            upgrade("Host: localhost", "Origin: http://b", "Origin: http://c"), id="two origins"
        ),
        pytest.param(upgrade("Host: localhost", "Upgrade: websocket"), id="two upgrades"),
    ],
)
async def test_a_request_that_contradicts_itself_gets_400(serve: Serve, request_bytes, caplog):
    async with serve() as served:
        reader, writer = await asyncio.open_connection("127.0.0.1", served.port)
        writer.write(request_bytes)
        assert (await reader.readline()).split()[1] == b"400"
        writer.close()
    assert "Traceback" not in caplog.text


@pytest.mark.parametrize(
    "behind",
    [
        pytest.param(masked(Opcode.PING, b"hi"), id="ping"),
        pytest.param(masked(Opcode.CLOSE, b""), id="close"),
        pytest.param(b"\x81\x05hello", id="unmasked"),
        pytest.param(upgrade("Host: localhost"), id="another request"),
    ],
)
@pytest.mark.parametrize("chunk", [1, 10_000])
async def test_input_behind_the_handshake_is_read_after_it(serve: Serve, behind, chunk, caplog):
    async with serve() as served, client(served.url) as other:
        reader, writer = await asyncio.open_connection("127.0.0.1", served.port)
        data = upgrade("Host: localhost") + behind
        for start in range(0, len(data), chunk):
            writer.write(data[start : start + chunk])
            await writer.drain()
        assert (await reader.readline()).split()[1] == b"101"
        await reader.readuntil(b"\r\n\r\n")
        assert await reader.readexactly(1)  # a pong, or the end with a reason
        assert await other.sync() == []
        writer.close()
    assert "Traceback" not in caplog.text


async def test_a_fault_in_the_core_closes_only_that_client_with_1011(serve, monkeypatch, caplog):
    async with serve() as served, client(served.url) as other:

        def fail(session, data):
            if b"boom" in data:
                raise ZeroDivisionError
            receive(session, data)

        front = served.server.fronts.of(None)
        receive = front.receive
        monkeypatch.setattr(front, "receive", fail)
        async with client(served.url) as speaker:
            await speaker.send(op="boom")
            assert await closing(speaker) == (1011, "internal error")
        assert await other.sync() == []
        assert "ZeroDivisionError" in caplog.text


async def test_a_fault_in_encoding_closes_only_its_subscribers_with_1011(
    serve: Serve, monkeypatch, caplog
):
    def fail(encoding, shared):
        raise ZeroDivisionError

    monkeypatch.setattr(Encoding, "encode", fail)
    async with serve() as served, client(served.url) as other, client(served.url) as listener:
        publisher = served.ros.add_publisher("/chatter", STRING)
        await listener.send(op="subscribe", topic="/chatter")
        await listener.sync()
        publisher.publish(served.cdr(STRING, data="x"))
        assert await closing(listener) == (1011, "internal error")
        assert await other.sync() == []
        assert "ZeroDivisionError" in caplog.text
