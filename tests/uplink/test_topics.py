# SPDX-License-Identifier: Apache-2.0
"""Topics of a robot that relays see through its uplink."""

import base64
import random
from typing import Any

import cv2
import numpy as np
import pytest

from gateway.codec.cloud import CLOUD
from gateway.codec.picture import COMPRESSED_IMAGE
from gateway.core.topics.subscription_options import DEFAULT_QUEUE_BYTES
from gateway.sources.source import Qos
from gateway.uplink.pace import UplinkPace
from gateway.uplink.uplink import Uplink
from tests.client import eventually
from tests.codec.test_cloud import cdr as cloud_of
from tests.core.conftest import IMAGE, ODOMETRY, STRING
from tests.uplink.conftest import Fleet, watched

JPEGS = "/camera/image_raw/compressed"


def slow_down(uplink: Uplink, bytes_per_s: float) -> None:
    """Say how slow the link is. Its pace says the truth again with each mark."""
    assert uplink.link is not None
    uplink.link.session.outbox.drains(bytes_per_s)


async def test_a_topic_flows_while_it_is_watched_and_comes_as_it_is(fleet: Fleet):
    bench = fleet.bench
    publisher = bench.ros.add_publisher("/odom", ODOMETRY)
    uplink = await fleet.offered()
    relay = fleet.relay()
    await eventually(lambda: relay.topic_types("/odom") == (ODOMETRY,))
    assert uplink.link is not None
    topics = uplink.link.topics
    assert not topics.flowing
    first, subscription = watched(relay, "/odom", ODOMETRY)
    second, other = watched(fleet.relay("other"), "/odom", ODOMETRY)
    await eventually(lambda: topics.flowing == {"/odom"})
    cdrs = [bench.cdr(ODOMETRY, child_frame_id=f"{number}") for number in range(3)]
    for cdr in cdrs:
        publisher.publish(cdr)
    await eventually(lambda: first.cdrs == cdrs and second.cdrs == cdrs)
    subscription.close()
    other.close()
    await eventually(lambda: not topics.flowing)
    assert not bench.ros.subscriptions


async def test_a_topic_that_keeps_messages_gives_them_to_late_viewers(fleet: Fleet):
    bench = fleet.bench
    publishers = [
        bench.ros.add_publisher("/map", STRING, Qos("reliable", "transient_local", depth=1))
        for _ in range(2)
    ]
    cdrs = {bench.cdr(STRING, data=f"{number}") for number in range(2)}
    for publisher, cdr in zip(publishers, sorted(cdrs), strict=True):
        publisher.publish(cdr)
    await fleet.offered()
    relay = fleet.relay()
    await eventually(
        lambda: [each.is_latched for each in relay.graph().topics if each.name == "/map"] == [True]
    )
    first, _ = watched(relay, "/map", STRING)
    await eventually(lambda: set(first.cdrs) == cdrs)
    late, _ = watched(fleet.relay("late"), "/map", STRING)
    await eventually(lambda: set(late.cdrs) == cdrs)
    assert len(first.cdrs) == len(late.cdrs) == 2


async def test_a_camera_is_offered_as_jpeg_that_fits_the_uplink(fleet: Fleet):
    bench = fleet.bench
    camera = bench.ros.add_publisher("/camera/image_raw", IMAGE)
    uplink = await fleet.offered()
    relay = fleet.relay()
    await eventually(lambda: relay.topic_types(JPEGS) == (COMPRESSED_IMAGE,))
    assert relay.topic_types("/camera/image_raw") == ()
    received, _ = watched(relay, JPEGS, COMPRESSED_IMAGE)
    await eventually(lambda: bench.ros.subscriptions)
    pixels = random.Random(7).randbytes(640 * 480 * 3)
    raw = bench.types.get(IMAGE).encode(
        {
            "header": {"frame_id": "lens"},
            "width": 640,
            "height": 480,
            "step": 1920,
            "encoding": "rgb8",
            "data": base64.b64encode(pixels).decode(),
        },
        0,
    )
    decode = bench.types.get(COMPRESSED_IMAGE).decoder(octets="raw")

    def shown() -> list[tuple[str, str, int]]:
        pictures: list[Any] = [decode(cdr) for cdr in received.cdrs]
        return [
            (each["header"]["frame_id"], each["format"], len(each["data"])) for each in pictures
        ]

    camera.publish(raw)
    await eventually(lambda: len(received.cdrs) == 1)

    def is_smaller() -> bool:
        slow_down(uplink, 100_000)
        camera.publish(raw)
        return min(shown())[2] < shown()[0][2] / 4

    await eventually(is_smaller)
    assert {each[:2] for each in shown()} == {("lens", "jpeg")}


async def test_jpegs_of_a_camera_are_offered_as_they_are_if_they_fit(fleet: Fleet):
    bench = fleet.bench
    bench.ros.add_publisher("/camera/image_raw", IMAGE)
    own = bench.ros.add_publisher(JPEGS, COMPRESSED_IMAGE)
    uplink = await fleet.offered()
    relay = fleet.relay()
    await eventually(lambda: relay.topic_types(JPEGS) == (COMPRESSED_IMAGE,))
    received, _ = watched(relay, JPEGS, COMPRESSED_IMAGE)
    await eventually(lambda: bench.ros.subscriptions)
    pixels = np.random.default_rng(7).integers(0, 255, (480, 640, 3), np.uint8)
    data = base64.b64encode(cv2.imencode(".jpg", pixels)[1].tobytes()).decode()
    cdr = bench.types.get(COMPRESSED_IMAGE).encode({"format": "jpeg", "data": data}, 0)
    own.publish(cdr)
    await eventually(lambda: received.cdrs == [cdr])

    def is_smaller() -> bool:
        slow_down(uplink, len(cdr))  # a second for each of them: too slow
        own.publish(cdr)
        return len(received.cdrs[-1]) < len(cdr) / 4

    await eventually(is_smaller)


async def test_clouds_come_no_faster_than_the_setting_says(fleet: Fleet):
    bench = fleet.bench
    clouds = bench.ros.add_publisher("/points", CLOUD)
    uplink = await fleet.offered(max_cloud_hz=1)
    relay = fleet.relay()
    await eventually(lambda: relay.topic_types("/points") == (CLOUD,))
    received, _ = watched(relay, "/points", CLOUD)
    await eventually(lambda: bench.ros.subscriptions)
    for number in range(5):
        clouds.publish(bench.cdr(CLOUD, width=number))
    assert uplink.link is not None
    link = uplink.link
    newest = [bench.cdr(CLOUD, width=number) for number in (0, 4)]
    await eventually(lambda: received.cdrs == newest)
    assert link.topics.flowing == {"/points"}


async def test_a_message_that_is_dropped_leaves_a_gap_for_relays_to_count(
    fleet: Fleet, monkeypatch: pytest.MonkeyPatch
):
    bench = fleet.bench
    publisher = bench.ros.add_publisher("/chatter", STRING)
    uplink = await fleet.offered()
    relay = fleet.relay()
    await eventually(lambda: relay.topic_types("/chatter") == (STRING,))
    received, subscription = watched(relay, "/chatter", STRING)
    await eventually(lambda: bench.ros.subscriptions)
    publisher.publish(bench.cdr(STRING, data="0"))
    await eventually(lambda: len(received.cdrs) == 1)
    assert uplink.link is not None
    monkeypatch.setattr(UplinkPace, "room_bytes", 0)  # the link is full
    for _ in range(7):
        publisher.publish(bench.cdr(STRING, data="x" * (DEFAULT_QUEUE_BYTES // 5 - 100)))
    await bench.settle()
    monkeypatch.undo()
    uplink.link._drain()
    # 2 of them at least: a busy machine makes the link a slow one, which keeps only fresh ones
    await eventually(lambda: len(received.cdrs) + subscription.lost == 1 + 7)
    assert subscription.lost >= 2


async def test_clouds_are_thinned_as_the_settings_say_and_stay_clouds(fleet: Fleet):
    bench = fleet.bench
    clouds = bench.ros.add_publisher("/points", CLOUD)
    await fleet.offered(max_cloud_points=10)
    relay = fleet.relay()
    await eventually(lambda: relay.topic_types("/points") == (CLOUD,))
    received, _ = watched(relay, "/points", CLOUD)
    await eventually(lambda: bench.ros.subscriptions)
    clouds.publish(cloud_of({each: np.arange(40, dtype="f4") for each in ("x", "y", "z", "ring")}))
    await eventually(lambda: received.cdrs)
    thinned = cloud_of({each: np.arange(0, 40, 4, dtype="f4") for each in ("x", "y", "z", "ring")})
    assert received.cdrs == [thinned]
