# SPDX-License-Identifier: Apache-2.0
"""Pictures that are smaller than asked for, where the link is too slow for these."""

import base64
from typing import Any

import numpy as np
import pytest

from gateway.codec.grid_picture import GRID
from gateway.codec.picture import COMPRESSED_IMAGE, IMAGE
from tests.client import Frame
from tests.core.conftest import ODOMETRY, Bench, Socketless

WIDTH, HEIGHT = 320, 240
PIXELS = np.random.default_rng(1).integers(0, 255, (HEIGHT, WIDTH, 3), dtype=np.uint8)
SLOW = 50e3


class Camera:
    """A camera, and what it shows to one client after the other."""

    def __init__(self, bench: Bench) -> None:
        self._bench = bench
        bench.ros.add_publisher("/camera", IMAGE)
        self._cdr = bench.cdr(
            IMAGE,
            height=HEIGHT,
            width=WIDTH,
            encoding="rgb8",
            step=3 * WIDTH,
            data=base64.b64encode(PIXELS.tobytes()).decode(),
        )

    def client(self, bytes_per_s: float | None, **options: Any) -> Socketless:
        """Let a client look, on a link of some rate."""
        client = self._bench.client()
        if bytes_per_s is not None:
            client.session.outbox.drains(bytes_per_s)
        client.send(op="subscribe", topic="/camera", **options)
        return client

    async def show(self, *clients: Socketless, times: int = 1) -> list[Frame]:
        """Show a picture some times. Return the last frame of each client."""
        for _ in range(times):
            before = [len(client.of("publish")) for client in clients]
            self._bench.ros.publish("/camera", self._cdr)
            for client, count in zip(clients, before, strict=True):
                await client.sees(count + 1)
            await self._bench.settle()
        return [client.of("publish")[-1] for client in clients]


@pytest.fixture
def camera(bench: Bench) -> Camera:
    return Camera(bench)


def width(frame: Frame) -> int:
    return int(frame["msg"]["width"])


async def test_on_a_slow_link_the_next_picture_is_smaller(camera: Camera):
    client = camera.client(SLOW, meta=True)
    (first,) = await camera.show(client)
    (later,) = await camera.show(client, times=2)
    assert (width(first), first["quality"]) == (WIDTH, 80)
    assert width(later) < WIDTH
    assert later["quality"] < 80
    assert len(later["msg"]["data"]) <= SLOW * 0.08


async def test_on_a_link_that_never_was_full_it_is_as_asked_for(camera: Camera):
    client = camera.client(None, meta=True)
    (frame,) = await camera.show(client, times=5)
    assert (width(frame), frame["quality"]) == (WIDTH, 80)


async def test_the_bounds_that_were_asked_for_are_made_smaller_in_turn(camera: Camera):
    client = camera.client(SLOW, image={"max_width": 160})
    (first,) = await camera.show(client)
    (later,) = await camera.show(client, times=2)
    assert (width(first), width(later)) == (160, 80)


@pytest.mark.parametrize(
    "image", [{"quality": 80}, {"adapt": False}, {"format": "png"}, {"format": "raw"}]
)
async def test_a_requested_quality_or_lossless_picture_does_not_adapt(camera: Camera, image: Any):
    client = camera.client(SLOW, image=image, meta=True)
    (frame,) = await camera.show(client, times=3)
    assert width(frame) == WIDTH
    assert "quality" not in frame
    del client


async def test_a_quality_is_a_bound_for_who_adapts(camera: Camera):
    client = camera.client(1e9, image={"quality": 30, "adapt": True}, meta=True)
    (frame,) = await camera.show(client, times=2)
    assert (width(frame), frame["quality"]) == (WIDTH, 30)
    client.session.outbox.drains(SLOW / 10)
    (frame,) = await camera.show(client, times=3)
    assert width(frame) < WIDTH
    assert frame["quality"] == 30


async def test_clients_on_links_of_a_like_rate_share_their_pictures(camera: Camera):
    slow, as_slow, fast = (camera.client(rate) for rate in (SLOW, SLOW * 1.01, None))
    await camera.show(slow, as_slow, fast, times=3)
    assert slow.wires[-1] is as_slow.wires[-1]
    assert len(fast.wires[-1]) > len(slow.wires[-1])


async def test_pictures_grow_with_the_link(camera: Camera, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("gateway.core.topics.picture_adaptation.LARGER_AFTER_NS", 0)
    client = camera.client(SLOW)
    await camera.show(client, times=3)
    client.session.outbox.drains(1e9)
    (frame,) = await camera.show(client, times=30)
    assert width(frame) == WIDTH


async def test_another_request_goes_on_with_pictures_that_fit(camera: Camera):
    client = camera.client(SLOW, id="one")
    (before,) = await camera.show(client, times=3)
    client.send(op="subscribe", id="two", topic="/camera", image={"max_fps": 1000})
    (after,) = await camera.show(client)
    assert width(after) == width(before) < WIDTH
    client.send(op="subscribe", id="two", topic="/camera", image={"quality": 80})
    (asked,) = await camera.show(client)
    assert width(asked) == WIDTH


async def test_a_client_that_has_left_is_not_fed_again(camera: Camera, bench: Bench):
    client = camera.client(SLOW)
    subscription = bench.router._subscriptions._subscriptions[client.session]["/camera"]
    await camera.show(client)
    client.send(op="unsubscribe", topic="/camera")
    bench.router._subscriptions._on_step(subscription)
    await bench.settle()
    assert bench.ros.entity_count() == 0
    assert subscription.source is None


async def test_a_request_for_pictures_without_effect_gets_a_warning(bench: Bench):
    for topic, type_name in (("/camera", IMAGE), ("/map", GRID), ("/odom", ODOMETRY)):
        bench.ros.add_publisher(topic, type_name)
    statuses = []
    for options, *before in (
        [{"topic": "/odom", "image": {"quality": 50}}],
        [{"topic": "/map", "image": {"format": "png"}, "fields": ["info"]}],
        [{"topic": "/camera", "image": {"quality": 50}}],
        [
            {"topic": "/camera", "image": {"format": "png"}},
            {"id": 1, "topic": "/camera", "compression": "cbor-raw"},  # both get it as raw
        ],
    ):
        client = bench.client(image_format="raw")
        for each in (*before, options):
            client.send(op="subscribe", **each)
        statuses += client.statuses
    assert statuses == [
        ("bad_request", f"image: {why}, sending plain messages")
        for why in (
            "nav_msgs/msg/Odometry cannot be sent as images",
            "with fields, images are not available",
            "the default format is raw, and image names no other",
            "cbor-raw cannot be sent as images",
        )
    ]


@pytest.mark.parametrize(
    ("topic", "image"),
    [
        ("/camera", {"quality": 50}),
        ("/camera", {"format": "raw", "quality": 50}),
        ("/map", {"format": "png"}),
        ("/odom", {"max_fps": 5}),
        ("/odom", None),
    ],
)
async def test_a_request_with_its_effect_gets_no_warning(bench: Bench, topic: str, image: Any):
    for name, type_name in (("/camera", IMAGE), ("/map", GRID), ("/odom", ODOMETRY)):
        bench.ros.add_publisher(name, type_name)
    client = bench.sender(op="subscribe", topic=topic, image=image)
    assert client.statuses == []


async def test_a_compressed_image_is_unchanged_unless_a_client_asks(bench: Bench):
    bench.ros.add_publisher("/jpeg", COMPRESSED_IMAGE)
    client = bench.client()
    client.session.outbox.drains(SLOW)
    client.send(op="subscribe", topic="/jpeg")
    data = base64.b64encode(bytes(20_000)).decode()
    for count in range(1, 4):
        bench.ros.publish("/jpeg", bench.cdr(COMPRESSED_IMAGE, format="jpeg", data=data))
        await client.sees(count)
    assert {message["data"] for message in client.messages} == {data}
