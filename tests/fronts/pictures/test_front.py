# SPDX-License-Identifier: Apache-2.0
"""Pictures by plain HTTP, as an `<img>` asks for them."""

import asyncio
import base64
import contextlib
import html
import logging
import socket
from collections.abc import AsyncIterator, Iterator
from typing import Any

import cv2
import numpy as np
import pytest

from gateway.access.permissions import Policy
from gateway.access.tokens import Tokens
from gateway.codec import picture as picture_module
from gateway.config.access import ViewerConfig
from gateway.fronts.pictures import front as pictures_front
from gateway.fronts.pictures.requests import PictureRequestError, picture_request
from gateway.transport.connections import MAX_HANDSHAKES
from tests.client import TIMEOUT_S, client, eventually
from tests.sources.fake import FakePublisher
from tests.transport.conftest import Serve, Served
from tests.transport.needs import needs_websockets_17
from tests.transport.test_admission import OPERATOR, OPERATORS, VIEWERS, AccessServer, bearer
from tests.transport.test_server import status_of

IMAGE = "sensor_msgs/msg/Image"
COMPRESSED_IMAGE = "sensor_msgs/msg/CompressedImage"
CAMERA = "/camera/image_raw"
NEXT = b"\r\n--next-picture\r\n"


def grey(served: Served, shade: int = 128, width: int = 64, height: int = 48) -> bytes:
    """Return a picture of one shade of grey."""
    data = base64.b64encode(bytes([shade]) * width * height).decode()
    return served.cdr(IMAGE, encoding="mono8", width=width, height=height, step=width, data=data)


def noise(served: Served, shade: int, side: int = 512) -> bytes:
    """Return a picture that compresses badly, around a shade of grey."""
    pixels = np.random.default_rng(shade).integers(shade - 40, shade + 40, (side, side), np.uint8)
    data = base64.b64encode(pixels.tobytes()).decode()
    return served.cdr(IMAGE, encoding="mono8", width=side, height=side, step=side, data=data)


def decoded(jpeg: bytes) -> np.ndarray:
    assert jpeg.startswith(b"\xff\xd8")
    return cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_GRAYSCALE)


def viewers(served: Served) -> int:
    return len(served.pictures)


def camera(served: Served, topic: str = CAMERA) -> FakePublisher:
    return served.ros.add_publisher(topic, IMAGE)


class Viewer:
    """A request for images, and its answer."""

    def __init__(self, reader: asyncio.StreamReader) -> None:
        self._reader = reader
        self.head = b""

    async def begin(self) -> bytes:
        """Return the head of the response. Of a stream the first boundary is taken with it."""
        self.head = await self._until(b"\r\n\r\n")
        if b"multipart" in self.head:
            assert await self._until(NEXT.lstrip()) == NEXT.lstrip()
        return self.head

    async def rest(self) -> bytes:
        """Return all that comes until the end."""
        async with asyncio.timeout(TIMEOUT_S):
            return await self._reader.read()

    async def picture(self) -> np.ndarray:
        """Return the next picture of a stream."""
        if not self.head:
            await self.begin()
        head = await self._until(b"\r\n\r\n")
        assert head.startswith(b"Content-Type: image/jpeg\r\nContent-Length: ")
        async with asyncio.timeout(TIMEOUT_S):
            jpeg = await self._reader.readexactly(int(head.split()[-1]))
        assert await self._until(NEXT) == NEXT
        return decoded(jpeg)

    async def _until(self, end: bytes) -> bytes:
        async with asyncio.timeout(TIMEOUT_S):
            return await self._reader.readuntil(end)


@contextlib.asynccontextmanager
async def view(
    served: Served, path: str, method: str = "GET", **headers: str
) -> AsyncIterator[Viewer]:
    """Ask for pictures, with a small buffer of the kernel."""
    connection = socket.socket()
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 64 * 1024)
    connection.setblocking(False)
    await asyncio.get_running_loop().sock_connect(connection, ("127.0.0.1", served.port))
    reader, writer = await asyncio.open_connection(sock=connection, limit=16 * 1024)
    lines = [f"{method} {path} HTTP/1.1", "Host: localhost"]
    lines += [f"{name}: {value}" for name, value in headers.items()]
    writer.write(("\r\n".join(lines) + "\r\n\r\n").encode())
    try:
        yield Viewer(reader)
    finally:
        writer.close()


async def answer(served: Served, path: str, method: str = "GET", **headers: str) -> tuple[int, str]:
    """Return the status and the text of a response without an image."""
    async with view(served, path, method, **headers) as viewer:
        head = await viewer.begin()
        return int(head.split()[1]), (await viewer.rest()).decode()


@pytest.fixture(autouse=True)
def no_errors(caplog: pytest.LogCaptureFixture) -> Iterator[None]:
    """Fail if something of ours failed, though the viewer got what it wanted."""
    yield
    records = caplog.get_records("call")
    assert [each.getMessage() for each in records if each.levelno >= logging.ERROR] == []


@pytest.fixture
def encoded(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """Return the options of all pictures that are encoded from now on."""
    seen: list[Any] = []
    compress = picture_module.compress

    def count(image: Any, options: Any) -> Any:
        seen.append(options)
        return compress(image, options)

    monkeypatch.setattr(picture_module, "compress", count)
    return seen


async def test_a_snapshot_is_the_next_picture_in_the_width_that_is_asked_for(serve: Serve):
    async with serve() as served:
        publisher = camera(served)
        async with view(served, f"/snapshot?topic={CAMERA}&width=32&quality=90") as viewer:
            await eventually(lambda: viewers(served) == 1)
            publisher.publish(grey(served, shade=200))
            head = (await viewer.begin()).lower()
            jpeg = await viewer.rest()
        assert head.startswith(b"http/1.1 200 ok\r\n")
        for header in (
            b"content-type: image/jpeg",
            b"cache-control: no-store",
            b"x-content-type-options: nosniff",
            b"cross-origin-resource-policy: same-site",
            b"content-length: %d" % len(jpeg),
        ):
            assert header + b"\r\n" in head
        assert decoded(jpeg).shape == (24, 32)
        assert abs(decoded(jpeg).mean() - 200) < 3
        await eventually(lambda: viewers(served) == 0 and served.ros.entity_count() == 0)


async def test_a_stream_sends_picture_after_picture(serve: Serve):
    async with serve() as served:
        publisher = camera(served)
        async with view(served, f"/stream?topic={CAMERA}&width=16") as viewer:
            await eventually(lambda: viewers(served) == 1)
            for shade in (50, 100, 150):
                publisher.publish(grey(served, shade))
                shown = await viewer.picture()
                assert shown.shape == (12, 16)
                assert abs(shown.mean() - shade) < 3
            assert b"Content-Type: multipart/x-mixed-replace; boundary=next-picture" in viewer.head
        await eventually(lambda: viewers(served) == 0)


async def test_equal_viewers_and_subscribers_share_one_encoding(serve: Serve, encoded: list[Any]):
    def is_image(frame: dict[str, Any]) -> bool:
        return frame["op"] == "publish"

    path = f"/stream?topic={CAMERA}&width=16"
    async with (
        serve() as served,
        client(served.url) as subscriber,
        view(served, path) as none,
    ):
        assert (await none.begin()).startswith(b"HTTP/1.1 404")  # before there is a camera
        publisher = camera(served)
        await subscriber.send(op="subscribe", topic=CAMERA, image={"max_width": 16})
        # by another name, and so in other frames
        await subscriber.send(op="subscribe", topic=CAMERA[1:], image={"max_width": 16})
        await subscriber.sync()
        async with view(served, path) as one, view(served, path[:-2] + "16&t=1") as other:
            await eventually(lambda: viewers(served) == 2)
            for number in range(1, 4):
                publisher.publish(grey(served))
                await one.picture()
                await other.picture()
                frames = [await subscriber.receive(is_image) for _ in range(2)]
                assert {frame["topic"] for frame in frames} == {CAMERA, CAMERA[1:]}
                assert {frame["msg"]["width"] for frame in frames} == {16}
                assert len(encoded) == number
            assert served.server.health()["subscriptions"] == 1


async def test_without_viewers_nothing_is_encoded(serve: Serve, encoded: list[Any]):
    async with serve() as served:
        publisher = camera(served)
        async with view(served, f"/stream?topic={CAMERA}") as viewer:
            await eventually(lambda: viewers(served) == 1)
            publisher.publish(grey(served))
            await viewer.picture()
        await eventually(lambda: served.ros.entity_count() == 0)
        publisher.publish(grey(served))
        assert len(encoded) == 1
        assert served.clients == 0


async def test_a_slow_reader_gets_the_newest_and_nothing_queues(serve: Serve):
    async with serve({"send_deadline_s": 60}) as served:
        publisher = camera(served)
        async with view(served, f"/stream?topic={CAMERA}&quality=100") as viewer:
            await eventually(lambda: viewers(served) == 1)
            (connection,) = served.server.connections
            old = noise(served, 60)
            published = 0

            def fill() -> bool:
                nonlocal published
                publisher.publish(old)
                published += 1
                return connection.is_paused

            await eventually(fill)
            for _ in range(50):
                publisher.publish(old)
            publisher.publish(noise(served, 200))
            assert connection._viewer.outbox.size <= 2 * len(old)
            shown = 0
            while (await viewer.picture()).mean() < 150:
                shown += 1
            assert shown <= published


async def test_a_viewer_that_takes_nothing_is_cut_off(serve: Serve):
    async with serve({"send_deadline_s": 0.2}) as served:
        publisher = camera(served)
        async with view(served, f"/stream?topic={CAMERA}&quality=100"):
            await eventually(lambda: viewers(served) == 1)
            sample = noise(served, 60)

            def publish_until_it_is_gone() -> bool:
                publisher.publish(sample)
                return viewers(served) == 0

            await eventually(publish_until_it_is_gone)
        assert served.ros.entity_count() == 0
        summary = served.server.summary()
        assert summary.ends == {("gateway", "send_timeout", ""): 1}
        assert summary.handshakes_refused == {}


async def test_at_most_so_many_look_and_one_that_leaves_makes_room(serve: Serve):
    path = f"/stream?topic={CAMERA}"
    async with serve() as served, contextlib.AsyncExitStack() as others:
        camera(served)
        async with view(served, path):
            for _ in range(15):
                await others.enter_async_context(view(served, path))
            await eventually(lambda: viewers(served) == 16)
            status, text = await answer(served, f"/snapshot?topic={CAMERA}")  # which has an end
            assert (status, text.partition(".")[0]) == (503, "busy: 16 other viewers get images")
        await eventually(lambda: viewers(served) == 15)
        await others.enter_async_context(view(served, path))
        await eventually(lambda: viewers(served) == 16)


async def test_viewers_are_neither_half_open_nor_do_they_take_the_pages_of_metrics(serve: Serve):
    async with serve({"open_timeout_s": 60.0}) as served:
        publisher = camera(served)
        async with view(served, f"/stream?topic={CAMERA}") as viewer:
            await eventually(lambda: viewers(served) == 1)
            (connection,) = served.server.connections
            assert not connection.is_half_open
            assert not connection.awaits_page
            for _ in range(MAX_HANDSHAKES + 1):
                assert await status_of(served, b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n") == 200
            connection.tick(connection._opened_s + 64.0)  # later than any handshake may be
            publisher.publish(grey(served))
            await viewer.picture()


@pytest.mark.parametrize(
    ("path", "status", "text"),
    [
        (
            "/snapshot",
            400,
            "topic is missing: name a topic of images, /snapshot?topic=/camera/image_raw",
        ),
        ("/stream?topic=", 400, "topic is missing"),
        ("/stream?topic=/a//b", 400, ""),
        (f"/stream?topic={CAMERA}&quality=0", 400, "quality: got '0', expected a whole number"),
        (f"/stream?topic={CAMERA}&width=wide", 400, "width: got 'wide', expected a whole number"),
        (f"/stream?topic={CAMERA}&width=1_0_0", 400, "width: got '1_0_0', expected a whole"),
        (f"/stream?topic={CAMERA}&width=%20100", 400, "width: got ' 100', expected a whole"),
        (f"/stream?topic={CAMERA}&width=%D9%A1%D9%A0", 400, "expected a whole number from 0 to"),
        (f"/stream?topic={CAMERA}&width=1e2", 400, "width: got '1e2', expected a whole number"),
        (f"/stream?topic={CAMERA}&height=-1", 400, "expected a whole number from 0 to 8192"),
        (f"/stream?topic={CAMERA}&type=h264", 400, "type: got 'h264', but images are always JPEG"),
        (f"/stream_viewer?topic={CAMERA}&invert", 400, "with CSS instead: rotate: 180deg"),
        (f"/stream_viewer?topic={CAMERA}&qos_profil=x", 400, "qos_profil: unknown"),
        (f"/stream?topic={CAMERA}&topic=/odom", 400, "topic: given 2 times. Give it once"),
        (f"/stream?topic={CAMERA}&fps=nan", 400, "fps: got 'nan', expected a number from 0.001"),
        (f"/stream?topic={CAMERA}&qualty=3", 400, "qualty: unknown; did you mean quality?"),
        (f"/snapshot?topic={CAMERA}&fps=3", 400, "fps: unknown; known are topic, type"),
        (f"/stream?topic={CAMERA}" + "&t=1" * 16, 400, "too many parameters: send at most 16"),
        ("/stream?topic=/camera/image", 404, f"did you mean {CAMERA}?"),
        ("/snapshot?topic=/odom", 400, "topic /odom is nav_msgs/msg/Odometry, but images are"),
        (f"/stream?topic={CAMERA}&token=r2g_x", 400, "a token must not be in the address"),
    ],
)
async def test_refusals_say_what_to_do(serve: Serve, path, status, text):
    async with serve() as served:
        camera(served)
        served.ros.add_publisher("/odom", "nav_msgs/msg/Odometry")
        found = await answer(served, path)
        assert found[0] == status
        assert text in found[1]
        assert found[1].count("\n") == 1
        assert served.ros.entity_count() == 0
        assert viewers(served) == 0


async def test_a_snapshot_without_a_picture_says_so_and_a_stream_waits_on(serve, monkeypatch):
    monkeypatch.setattr(pictures_front, "WAIT_S", 0.1)
    async with serve() as served:
        publisher = camera(served)
        status, text = await answer(served, f"/snapshot?topic={CAMERA}")
        assert status == 504
        assert text == f"no image of {CAMERA} within 0.1 s: check that its camera is running\n"
        await eventually(lambda: not served.server.connections)
        assert served.server.summary().handshakes_refused == {"no_picture": 1}
        assert served.ros.entity_count() == 0
        async with view(served, f"/stream?topic={CAMERA}") as viewer:
            assert (await viewer.begin()).startswith(b"HTTP/1.1 200 OK\r\n")
            publisher.publish(grey(served))
            await viewer.picture()


@pytest.mark.parametrize("path", ["/snapshot", "/stream"])
async def test_a_picture_that_cannot_be_encoded_is_answered_in_words(serve: Serve, path):
    async with serve() as served:
        publisher = camera(served)
        async with view(served, f"{path}?topic={CAMERA}") as viewer:
            await eventually(lambda: viewers(served) == 1)
            publisher.publish(
                served.cdr(IMAGE, encoding="purple", width=1, height=1, step=1, data="AA==")
            )
            assert (await viewer.begin()).startswith(b"HTTP/1.1 503")
            assert b"purple" in await viewer.rest()
        await eventually(lambda: served.ros.entity_count() == 0)


async def test_a_bug_ends_one_viewer_alone(serve: Serve, monkeypatch: pytest.MonkeyPatch, caplog):
    async with serve() as served:
        publisher = camera(served)
        async with view(served, f"/stream?topic={CAMERA}") as viewer:
            await eventually(lambda: viewers(served) == 1)
            monkeypatch.setattr(pictures_front, "JPEG_START", None)
            publisher.publish(grey(served))
            assert await viewer.rest() == b""
        await eventually(lambda: viewers(served) == 0)
        assert "connection failed" in caplog.text
        caplog.clear()


@needs_websockets_17
async def test_head_tells_the_type_and_opens_nothing(serve: Serve):
    async with serve() as served:
        for path, content_type in (("/snapshot", "image/jpeg"), ("/stream", "multipart/x-mixed")):
            async with view(served, f"{path}?topic={CAMERA}", "HEAD") as viewer:
                head = await viewer._until(b"\r\n\r\n")
                assert head.startswith(b"HTTP/1.1 200")
                assert content_type.encode() in head
                assert await viewer.rest() == b""
        assert served.ros.entity_count() == 0


@needs_websockets_17
async def test_a_token_is_needed_where_clients_need_one_and_its_role_decides(serve: Serve):
    hidden = ViewerConfig(deny_subscribe=("/secret/**",))
    async with AccessServer(serve, viewer=hidden).open() as served:
        path = "/snapshot?topic=/secret/image"
        absent = await answer(served, path, **bearer(VIEWERS))
        camera(served, "/secret/image")
        status, text = await answer(served, path)
        assert (status, text) == (401, "send a token: Authorization: Bearer TOKEN\n")
        assert (await answer(served, path, "HEAD"))[0] == 401
        assert (await answer(served, path, **bearer("r2g_wrong")))[0] == 401
        assert await answer(served, path, **bearer(VIEWERS)) == absent
        assert absent == (404, "topic /secret/image is not known\n")
        async with view(served, path, **bearer(OPERATORS)):
            await eventually(lambda: viewers(served) == 1)
        await eventually(lambda: viewers(served) == 0)


async def test_a_stream_ends_with_the_token_that_it_was_asked_for_with(serve: Serve):
    access_server = AccessServer(serve)
    async with access_server.open() as served:
        publisher = camera(served)
        path = f"/stream?topic={CAMERA}"
        async with (
            view(served, path, **bearer(VIEWERS)) as revoked,
            view(served, path, **bearer(OPERATORS)) as other,
        ):
            await eventually(lambda: viewers(served) == 2)
            served.server.reload(Tokens((OPERATOR,)), Policy(access_server.config))
            assert await revoked.rest() == b""
            await eventually(lambda: viewers(served) == 1)
            publisher.publish(grey(served))
            await other.picture()


async def test_a_lost_viewer_is_noticed_while_no_image_arrives(serve: Serve):
    async with serve() as served:
        camera(served)
        async with view(served, f"/stream?topic={CAMERA}"):
            await eventually(lambda: viewers(served) == 1)
            (connection,) = served.server.connections
            sock = connection._transport.get_extra_info("socket")
            assert sock.getsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE) == 1


async def test_foreign_pages_and_hosts_get_nothing_and_allowed_ones_are_named(serve: Serve):
    async with serve(allowed_origins=("https://fleet.example",)) as served:
        publisher = camera(served)
        path = f"/snapshot?topic={CAMERA}"
        assert (await answer(served, path, Origin="https://evil.example"))[0] == 403
        foreign = f"GET {path} HTTP/1.1\r\nHost: evil.example\r\n\r\n".encode()
        assert await status_of(served, foreign) == 421
        async with view(served, path, Origin="https://fleet.example") as viewer:
            await eventually(lambda: viewers(served) == 1)
            publisher.publish(grey(served))
            head = await viewer.begin()
        assert b"Access-Control-Allow-Origin: https://fleet.example\r\n" in head


@needs_websockets_17
@pytest.mark.parametrize(
    ("referer", "policy"),
    [
        ("http://localhost:8000/page", b"cross-origin"),
        ("https://evil.example/localhost", b"same-site"),
        ("http://[", b"same-site"),
        ("", b"same-site"),
    ],
)
async def test_browsers_give_pictures_to_pages_of_this_host_on_any_port(serve, referer, policy):
    async with (
        serve() as served,
        view(served, f"/stream?topic={CAMERA}", "HEAD", Referer=referer) as viewer,
    ):
        head = await viewer.rest()
        assert b"Cross-Origin-Resource-Policy: " + policy + b"\r\n" in head


async def test_the_shutdown_ends_streams(serve: Serve):
    async with serve() as served:
        camera(served)
        reader, writer = await asyncio.open_connection("127.0.0.1", served.port)
        writer.write(f"GET /stream?topic={CAMERA} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
        await eventually(lambda: viewers(served) == 1)
    assert await reader.read() == b""
    writer.close()


def test_a_request_becomes_the_subscription_that_it_asks_for():
    asked = picture_request("/stream?topic=/a&quality=50&width=320&fps=2.5")
    assert (asked.topic, asked.queue_length) == ("/a", 1)
    assert (asked.image.format, asked.image.quality) == ("jpeg", 50)
    assert (asked.image.max_width, asked.image.max_fps) == (320, 2.5)
    with pytest.raises(PictureRequestError):
        picture_request("/snapshot?fps=1")


@pytest.mark.parametrize("path", ["/stream", "/snapshot", "/stream_viewer"])
def test_an_address_of_web_video_server_asks_for_the_same(path):
    asked = picture_request(
        f"{path}?topic=/a&type=ros_compressed&width=640&height=480&quality=90&bitrate=250000"
        "&qos_profile=sensor_data&qos_profile=&default_transport=compressed&gop=0&qmin=1&qmax=9"
    )
    sides = (asked.image.max_width, asked.image.max_height)
    assert (asked.topic, *sides, asked.image.quality) == ("/a", 640, 480, 90)
    unbounded = picture_request(f"{path}?topic=/a&width=0&height=0&type=mjpeg").image
    assert unbounded == picture_request(f"{path}?topic=/a").image


async def test_the_viewer_is_a_page_that_shows_the_stream_of_its_parameters(serve: Serve):
    async with serve() as served:
        publisher = camera(served)
        query = f"topic={CAMERA}&type=mjpeg&width=20&default_transport=raw"
        status, text = await answer(served, f"/stream_viewer?{query}&t=%22%3E<script>")
        assert status == 200
        source = html.unescape(text.partition('<img src="')[2].partition('"')[0])
        assert source == f"stream?{query}&t=%22%3E<script>"
        assert "<script" not in text
        async with view(served, f"/stream?{query}") as viewer:
            await eventually(lambda: viewers(served) == 1)
            publisher.publish(grey(served))
            assert (await viewer.picture()).shape[1] == 20


async def test_a_first_picture_is_waited_for_5_s(serve: Serve):
    async with serve() as served:
        camera(served)
        async with view(served, f"/snapshot?topic={CAMERA}"):
            await eventually(lambda: viewers(served) == 1)
            (asked,) = served.pictures._viewers.values()
            refused: list[tuple[int, str]] = []
            asked._refuse = lambda status, text: refused.append((status, text))
            for seconds in (4.9, 5.1):
                asked.tick(asked._opened_s + seconds)
            assert [status for status, _ in refused] == [504]
            assert "within 5 s" in refused[0][1]
        await eventually(lambda: viewers(served) == 0)
