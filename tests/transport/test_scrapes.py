# SPDX-License-Identifier: Apache-2.0
"""The metrics, asked for as Prometheus does."""

import asyncio
import socket
import urllib.error
import urllib.request
from collections.abc import Iterator
from typing import Any

import pytest
from blockbuster import blockbuster_ctx
from prometheus_client.parser import text_string_to_metric_families
from websockets.frames import Opcode

from gateway.access.permissions import UNLIMITED, Permissions
from gateway.config.access import RoleConfig, ViewerConfig
from gateway.sources.source import Qos
from gateway.transport import scrapes as scrapes_module
from gateway.transport.scrapes import Scrapes
from tests.client import TIMEOUT_S, client, eventually
from tests.metrics.states import state
from tests.transport.conftest import Serve, Served
from tests.transport.needs import needs_websockets_17
from tests.transport.test_admission import OPERATORS, VIEWERS, AccessServer, bearer
from tests.transport.test_server import handshake, masked, status_of

STRING = "std_msgs/msg/String"
COUNTS = ("sent_total", "coalesced_total", "dropped_total", "pending")


@pytest.fixture(autouse=True)
def no_blocking_calls() -> Iterator[None]:
    """Fail if the loop waits, also for a page: /proc is memory, and no disk."""
    with blockbuster_ctx("gateway") as calls:
        for call in calls.functions.values():
            call.can_block_in("schemas/installed.py", {"_read", "_installed_place"})
            call.can_block_in("prometheus_client/process_collector.py", {"collect"})
        yield


def fetch(served: Served, method: str = "GET", **headers: str) -> tuple[int, Any, str]:
    url = f"http://127.0.0.1:{served.port}/metrics"
    request = urllib.request.Request(url, method=method, headers=headers)
    try:
        with urllib.request.urlopen(request, timeout=TIMEOUT_S) as response:  # noqa: S310  # ours
            return response.status, response.headers, response.read().decode()
    except urllib.error.HTTPError as error:
        with error:
            return error.code, error.headers, error.read().decode()


METRICS = b"GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n"


async def ask(served: Served) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
    """Ask for a page, and read nothing yet."""
    connection = socket.socket()
    # otherwise the kernel may accept a whole page of 8 MB
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 64 * 1024)
    connection.setblocking(False)
    await asyncio.get_running_loop().sock_connect(connection, ("127.0.0.1", served.port))
    reader, writer = await asyncio.open_connection(sock=connection)
    writer.write(METRICS)
    return reader, writer


def awaited(served: Served) -> int:
    """Count the pages that are waited for, or not taken yet."""
    return sum(each.awaits_page for each in served.server.connections)


def hold_pages(monkeypatch: pytest.MonkeyPatch) -> asyncio.Event:
    """Let no page be written until the event is set."""
    may_write = asyncio.Event()

    async def write(_: Scrapes, permissions: Permissions) -> bytes:
        del permissions
        await may_write.wait()
        return b"page"

    monkeypatch.setattr(Scrapes, "_write", write)
    return may_write


class Scrape:
    """One page, by names and labels."""

    def __init__(self, text: str) -> None:
        self.text = text
        self._samples = [
            sample for family in text_string_to_metric_families(text) for sample in family.samples
        ]

    def values(self, name: str) -> dict[tuple[str, ...], float]:
        """Return the values of a metric by those of its labels, in the order of their names."""
        return {
            tuple(value for _, value in sorted(sample.labels.items())): sample.value
            for sample in self._samples
            if sample.name == f"ros2_gateway_{name}"
        }

    def check_sums(self) -> int:
        """Check that what was offered has become something, of each client and topic."""
        checked = 0
        for scope in ("client", "topic"):
            parts = [self.values(f"{scope}_messages_{count}") for count in COUNTS]
            for labels, offered in self.values(f"{scope}_messages_received_total").items():
                assert offered == sum(part[labels] for part in parts)
                checked += 1
        return checked


async def scrape(served: Served, **headers: str) -> Scrape:
    status, _, text = await asyncio.to_thread(fetch, served, **headers)
    assert status == 200
    return Scrape(text)


@needs_websockets_17
async def test_prometheus_gets_its_text_which_is_not_cached(serve: Serve):
    async with serve() as served:
        status, headers, text = await asyncio.to_thread(fetch, served)
        assert status == 200
        assert headers["Content-Type"] == "text/plain; version=0.0.4; charset=utf-8"
        assert headers["Cache-Control"] == "no-store"
        assert Scrape(text).values("clients") == {(): 0}
        assert (await asyncio.to_thread(fetch, served, "HEAD"))[::2] == (200, "")


async def test_a_slow_reader_and_a_throttle_are_seen_in_the_counts_which_add_up(serve: Serve):
    async with serve() as served, client(served.url) as good, client(served.url) as calm:
        publisher = served.ros.add_publisher("/big", STRING, Qos(depth=100))
        reader, writer = await handshake(served)  # never read from
        writer.write(masked(Opcode.TEXT, b'{"op":"subscribe","topic":"/big","queue_length":3}'))
        await good.send(op="subscribe", topic="/big")
        await good.sync()
        await calm.send(op="subscribe", topic="/big", throttle_rate=3_600_000)
        await calm.sync()
        page = await scrape(served)
        while len(page.values("client_messages_received_total")) < 3:
            page = await scrape(served)
        sample = served.cdr(STRING, data="x" * 200_000)
        for _ in range(100):
            publisher.publish(sample)
            await good.message("/big")
        page = await scrape(served)
        assert page.check_sums() == 3 + len(page.values("topic_messages_received_total"))
        received = page.values("topic_received_total")["/big",]
        assert received == 100
        assert page.values("topic_received_bytes_total")["/big",] == 100 * len(sample)
        offered = page.values("client_messages_received_total")
        assert set(offered.values()) == {100}
        by_address = sorted(page.values("client_messages_sent_total").values())
        assert (by_address[0], by_address[-1]) == (1, 100)  # the calm one, the good one
        assert sorted(page.values("client_messages_coalesced_total").values()) == [0, 0, 98]
        assert sum(page.values("client_messages_dropped_total").values()) > 50
        assert 1 < sum(page.values("client_messages_pending").values()) <= 1 + 3 + 1
        assert page.values("topic_messages_sent_bytes_total")["/big",] > 100 * 200_000
        assert sum(page.values("topic_latency_seconds_bucket").values()) > 0
        writer.close()
        del reader


async def test_the_series_of_a_client_end_with_it_and_its_topics_keep_the_counts(serve: Serve):
    async with serve() as served:
        publisher = served.ros.add_publisher("/t", STRING)
        for _ in range(3):
            async with client(served.url) as listener:
                await listener.send(op="subscribe", topic="/t")
                await listener.send(op="subscribe", topic="t", throttle_rate=3_600_000)
                await listener.send(op="publish", topic="/u", type=STRING, msg={"data": "x"})
                await listener.sync()
                for _ in range(3):
                    publisher.publish(served.cdr(STRING, data="x"))
                for _ in range(3):
                    await listener.message("/t")
                page = await scrape(served)
                (((_, topic), offered),) = page.values("client_messages_received_total").items()
                assert (topic, offered) == ("/t", 6)  # both names of it
                assert page.check_sums() >= 2
                assert list(page.values("client_published_total").values()) == [1]
            await eventually(lambda: served.clients == 0)
        page = await scrape(served)
        assert page.values("client_messages_received_total") == {}
        assert page.values("client_published_total") == {}
        assert page.values("client_operations_total") == {}
        assert page.values("topic_messages_received_total")["/t",] == 18
        assert page.values("topic_messages_sent_total")["/t",] == 12
        assert page.values("topic_messages_coalesced_total")["/t",] == 3
        assert (
            page.values("topic_messages_dropped_total")["/t",] == 3
        )  # messages that throttles still held
        assert page.values("topic_published_total")["/u",] == 3
        assert page.values("sessions_total")[()] == 3
        page.check_sums()


async def test_the_counts_of_a_client_and_topic_do_not_fall_when_one_of_two_names_ends(serve):
    async with serve() as served, client(served.url) as listener:
        publisher = served.ros.add_publisher("/t", STRING)

        async def hear() -> Scrape:
            publisher.publish(served.cdr(STRING, data="x"))
            await listener.sync()
            page = await scrape(served)
            page.check_sums()
            offered = page.values("client_messages_received_total")
            assert list(offered.values()) == [page.values("topic_messages_received_total")["/t",]]
            return page

        offered = []
        for operation, name in (
            ("subscribe", "/t"),
            ("subscribe", "t"),
            ("unsubscribe", "/t"),
            ("subscribe", "/t"),
            ("unsubscribe", "t"),
        ):
            await listener.send(op=operation, topic=name, id=name)
            await listener.sync()
            page = await hear()
            offered += page.values("client_messages_received_total").values()
        assert offered == [1, 3, 4, 6, 7]
        await listener.send(op="unsubscribe", topic="/t")
        await listener.sync()
        page = await scrape(served)
        assert page.values("client_messages_received_total") == {}
        assert page.values("topic_messages_received_total")["/t",] == 7


async def test_a_message_that_cannot_be_encoded_is_not_dropped_by_a_full_queue(serve: Serve):
    async with serve() as served, client(served.url) as listener:
        publisher = served.ros.add_publisher("/t", STRING)
        await listener.send(op="subscribe", topic="/t")
        await listener.sync()
        publisher.publish(b"\0\1\0\0")  # no string
        await listener.sync()
        page = await scrape(served)
        assert list(page.values("client_messages_dropped_total").values()) == [1]
        summary = served.server.summary()
        assert summary.totals.dropped_by_full_queue == 0
        assert [each.counts.dropped_by_full_queue for each in summary.clients] == [0]
        assert served.server.health()["dropped"] == 0


async def test_a_client_that_always_asks_for_new_names_leaves_no_series(serve: Serve):
    async with serve({"max_subscriptions": 16}) as served, client(served.url) as curious:
        before = (await scrape(served)).text.count("\n")
        for number in range(200):
            await curious.send(op="subscribe", topic=f"/made_up{number}")
            await curious.send(op="unsubscribe", topic=f"/made_up{number}")
        await curious.sync()
        page = await scrape(served)
        assert "/made_up" not in page.text
        assert page.text.count("\n") < before + 20


async def test_without_a_token_where_one_is_needed_nothing_is_told(serve: Serve):
    async with (
        AccessServer(serve).open() as served,
        client(served.url, additional_headers=bearer(OPERATORS)) as one,
    ):
        await one.send(op="subscribe", topic="/secret", type=STRING)
        await one.sync()
        status, headers, text = await asyncio.to_thread(fetch, served)
        assert (status, headers["WWW-Authenticate"]) == (401, "Bearer")
        assert "secret" not in text
        assert "ros2_gateway" not in text
        assert (await asyncio.to_thread(fetch, served, **bearer("r2g_wrong")))[0] == 401
        assert "/secret" in (await scrape(served, **bearer(VIEWERS))).text
        page = await scrape(served, **bearer(OPERATORS))
        assert page.values("handshakes_refused_total") == {("token",): 2}
        assert page.values("authentication_failures_total") == {("wrong",): 1}
        assert (await asyncio.to_thread(fetch, served, Authorization="Basic x"))[0] == 400


async def test_topics_hidden_from_a_role_are_not_in_its_metrics(serve: Serve):
    hidden = ViewerConfig(deny_subscribe=("/secret/**",))
    async with (
        AccessServer(serve, viewer=hidden).open() as served,
        client(served.url, additional_headers=bearer(OPERATORS)) as one,
    ):
        await one.send(op="subscribe", topic="/secret/plan", type=STRING)
        await one.send(op="subscribe", topic="/open", type=STRING)
        await one.send(op="publish", topic="/secret/out", type=STRING, msg={"data": "x"})
        await one.sync()
        seen, all_of_it = await asyncio.gather(
            scrape(served, **bearer(VIEWERS)), scrape(served, **bearer(OPERATORS))
        )
        assert "/open" in seen.text
        assert "secret" not in seen.text
        assert all_of_it.text.count("/secret/plan") > 10
        assert "/secret/out" in all_of_it.text


async def test_pages_of_others_and_foreign_hosts_get_no_metrics(serve: Serve):
    async with serve() as served:

        def get(*lines: str) -> bytes:
            return "\r\n".join(["GET /metrics HTTP/1.1", *lines, "", ""]).encode()

        assert (
            await status_of(served, get("Host: localhost", "Origin: https://evil.example")) == 403
        )
        assert await status_of(served, get("Host: evil.example")) == 421
        own = f"localhost:{served.port}"
        assert await status_of(served, get(f"Host: {own}", f"Origin: http://{own}")) == 200
        assert await status_of(served, get("Host: localhost", "Origin: null")) == 403
        with_token = get("Host: localhost").replace(b"/metrics", b"/metrics?token=x")
        assert await status_of(served, with_token) == 400
        page = await scrape(served)
        refused = {("origin",): 2, ("host",): 1, ("malformed",): 1}
        assert page.values("handshakes_refused_total") == refused


async def test_all_that_ask_while_a_page_is_written_get_it_and_a_fault_is_answered_500(
    serve: Serve, monkeypatch: pytest.MonkeyPatch
):
    written = 0

    def count() -> Any:
        nonlocal written
        written += 1
        return state()

    pages: list[bytes | None] = []
    scrapes = Scrapes(count)
    for _ in range(50):
        scrapes.ask(UNLIMITED, pages.append)
    other = UNLIMITED.__class__("wall", Permissions("viewer", RoleConfig()))
    scrapes.ask(other, pages.append)
    await eventually(lambda: len(pages) == 51)
    assert written == 2

    def fail(_: Any) -> Any:
        raise ZeroDivisionError

    async with serve() as served:
        monkeypatch.setattr(scrapes_module, "pieces", fail)
        assert (await asyncio.to_thread(fetch, served))[0] == 500
        monkeypatch.undo()
        assert (await asyncio.to_thread(fetch, served))[0] == 200


async def test_pages_take_a_quarter_of_the_time_and_no_more_than_a_slice_at_once(monkeypatch):
    now_s = 0.0
    worked_s = rested_s = 0.0
    slices: list[float] = []

    class Clock:
        @staticmethod
        def monotonic() -> float:
            return now_s

    def slow(_: Any) -> Iterator[str]:
        nonlocal now_s, worked_s
        for _ in range(101):
            now_s += 0.0015
            worked_s += 0.0015
            yield "x"

    async def sleep(time_s: float) -> None:
        nonlocal now_s, rested_s
        slices.append(worked_s - sum(slices))
        rested_s += time_s
        now_s += time_s

    monkeypatch.setattr(scrapes_module, "time", Clock)
    monkeypatch.setattr(scrapes_module, "pieces", slow)
    monkeypatch.setattr(scrapes_module.asyncio, "sleep", sleep)
    page = await Scrapes(state)._write(UNLIMITED.permissions)
    assert page == b"x" * 101
    assert rested_s == pytest.approx(3 * worked_s)
    assert max(slices) < 0.0045


async def test_replies_are_written_one_at_a_time_with_rests_between(monkeypatch):
    now_s = 0.0
    seen: list[str] = []

    class Clock:
        @staticmethod
        def monotonic() -> float:
            return now_s

    def reply(_: bytes | None) -> None:
        nonlocal now_s
        now_s += 0.003
        seen.append("reply")

    async def sleep(time_s: float) -> None:
        if time_s:
            seen.append(f"{time_s:.3f}")

    monkeypatch.setattr(scrapes_module, "time", Clock)
    monkeypatch.setattr(scrapes_module, "pieces", lambda _: ["x"])
    monkeypatch.setattr(scrapes_module.asyncio, "sleep", sleep)
    scrapes = Scrapes(state)
    for _ in range(3):
        scrapes.ask(UNLIMITED, reply)
    task = scrapes._task
    assert task is not None
    await task
    assert seen == ["reply", "0.009"] * 3


@needs_websockets_17
async def test_eight_wait_for_a_page_and_the_next_is_refused_until_one_is_done(serve, monkeypatch):
    async with serve() as served:
        may_write = hold_pages(monkeypatch)
        asked = [await ask(served) for _ in range(8)]
        await eventually(lambda: awaited(served) == 8)
        status, _, text = await asyncio.to_thread(fetch, served)
        assert (status, text) == (503, "busy: 8 others get metrics. Try again later\n")
        assert (await asyncio.to_thread(fetch, served, "HEAD"))[0] == 200  # writes none
        asked.pop()[1].close()
        await eventually(lambda: awaited(served) == 7)
        asked.append(await ask(served))
        await eventually(lambda: awaited(served) == 8)
        may_write.set()
        for reader, writer in asked:
            assert (await reader.read()).endswith(b"\r\n\r\npage")
            writer.close()
        monkeypatch.undo()
        page = await scrape(served)
        assert page.values("handshakes_refused_total") == {("busy",): 1, ("none",): 1}


async def test_a_page_that_is_not_taken_is_waited_for(serve, monkeypatch):
    monkeypatch.setattr(scrapes_module, "pieces", lambda _: ["x" * 8_000_000])
    async with serve() as served:
        asked = [await ask(served) for _ in range(8)]
        await eventually(lambda: awaited(served) == 8 and served.server._scrapes._task is None)
        assert (await asyncio.to_thread(fetch, served))[0] == 503
        for reader, writer in asked:
            assert (await reader.read()).endswith(b"x" * 8_000_000)
            writer.close()


async def test_input_behind_a_request_for_the_metrics_is_ignored(serve, monkeypatch):
    async with serve() as served:
        may_write = hold_pages(monkeypatch)
        reader, writer = await ask(served)
        await eventually(lambda: awaited(served) == 1)
        (connection,) = served.server.connections
        more = masked(Opcode.PING, b"x") * 100 + masked(Opcode.CLOSE, b"") + b"\xff\xff"
        writer.write(more)
        await eventually(lambda: connection._bytes_in == len(METRICS) + len(more))
        may_write.set()
        answer = await reader.read()
        assert answer.startswith(b"HTTP/1.1 200 OK\r\n")
        assert answer.endswith(b"\r\n\r\npage")
        writer.close()


async def test_a_page_that_takes_too_long_is_answered_so(serve, monkeypatch):
    async with serve({"open_timeout_s": 0.1}) as served:
        may_write = hold_pages(monkeypatch)
        status, _, text = await asyncio.to_thread(fetch, served)
        assert (status, text) == (503, "busy: no page within 0.1 s\n")
        may_write.set()
        await eventually(lambda: served.server._scrapes._task is None)
        monkeypatch.undo()
        assert served.server.summary().handshakes_refused == {"busy": 1}


async def test_a_page_that_the_shutdown_prevents_is_counted_so(serve, monkeypatch):
    async with serve() as served:
        hold_pages(monkeypatch)
        reader, writer = await ask(served)
        await eventually(lambda: awaited(served) == 1)
    assert await reader.read() == b""
    writer.close()
    assert served.server.summary().handshakes_refused == {"going_away": 1}


@needs_websockets_17
async def test_head_writes_no_page_and_needs_a_token_as_well(serve, monkeypatch):
    monkeypatch.setattr(scrapes_module, "pieces", None)
    async with AccessServer(serve).open() as served:
        assert (await asyncio.to_thread(fetch, served, "HEAD"))[0] == 401
        found = await asyncio.to_thread(fetch, served, "HEAD", **bearer(VIEWERS))
    status, headers, text = found
    assert (status, text, headers["Content-Length"]) == (200, "", None)
    assert headers["Content-Type"] == "text/plain; version=0.0.4; charset=utf-8"


async def test_a_scraper_that_leaves_early_does_not_disturb_others(serve: Serve):
    async with serve() as served:
        for _ in range(20):
            _, writer = await asyncio.open_connection("127.0.0.1", served.port)
            writer.write(b"GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\nand more\x00\xff")
            writer.close()
        assert (await scrape(served)).values("clients") == {(): 0}
