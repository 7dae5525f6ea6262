# SPDX-License-Identifier: Apache-2.0
"""Cameras, recorded as JPEG."""

import base64
from pathlib import Path

from rosbags.highlevel import AnyReader

from gateway.codec.picture import COMPRESSED_IMAGE
from gateway.recording import session
from gateway.recording.active_recording import JPEG_TOPIC
from tests.client import eventually
from tests.core.conftest import IMAGE, STRING, Bench
from tests.recording.conftest import Studio
from tests.recording.readers import by_all

CAMERA = "/camera/image"


def picture(bench: Bench, number: int) -> bytes:
    pixels = base64.b64encode(bytes((x * number) % 256 for x in range(64 * 48 * 3))).decode()
    size = {"width": 64, "height": 48, "step": 192, "encoding": "rgb8"}
    stamp = {"sec": number, "nanosec": 7}
    return bench.cdr(IMAGE, **size, data=pixels, header={"stamp": stamp, "frame_id": "camera"})


def jpegs(folder: Path) -> list[tuple[int, str, bytes]]:
    """Return stamp, format and file of each, as rosbags decodes them."""
    with AnyReader([folder]) as reader:
        wanted = [each for each in reader.connections if each.topic == CAMERA + JPEG_TOPIC]
        assert [each.msgtype for each in wanted] == [COMPRESSED_IMAGE]
        found = [reader.deserialize(raw, COMPRESSED_IMAGE) for _, _, raw in reader.messages(wanted)]
    return [(each.header.stamp.sec, each.format, each.data.tobytes()) for each in found]


async def test_the_jpeg_that_an_operator_sees_is_recorded(studio: Studio):
    bench = studio.bench
    camera = bench.ros.add_publisher(CAMERA, IMAGE)
    bench.ros.add_publisher("/chatter", STRING)
    operator = bench.sender(op="subscribe", topic=CAMERA)
    folder = await studio.start(images="jpeg")
    for number in (1, 2, 3):
        camera.publish(picture(bench, number))
        await operator.sees(number)
        wanted = number + 2  # with an event, and a text
        bench.say("/chatter", "x") if number == 1 else None
        await eventually(lambda: studio.recorder.status().messages >= wanted)  # noqa: B023
    await studio.stop()
    seen = [base64.b64decode(each["data"]) for each in operator.messages]
    assert [each[2] for each in jpegs(folder)] == seen
    assert [each[0] for each in jpegs(folder)] == [1, 2, 3]
    assert {each[1] for each in jpegs(folder)} == {"jpeg"}
    assert set(by_all(folder)) == {CAMERA + JPEG_TOPIC, "/chatter"}


async def test_the_jpegs_of_the_camera_itself_are_recorded_instead(studio: Studio):
    bench = studio.bench
    bench.ros.add_publisher(CAMERA, IMAGE)
    compressed = bench.ros.add_publisher(CAMERA + JPEG_TOPIC, COMPRESSED_IMAGE)
    folder = await studio.start(images="jpeg")
    data = bench.cdr(COMPRESSED_IMAGE, format="jpeg", data=[255, 216])
    compressed.publish(data)
    bench.ros.publish(CAMERA, picture(bench, 1))
    await studio.stop()
    assert by_all(folder) == {CAMERA + JPEG_TOPIC: [data]}


async def test_pictures_for_which_no_worker_is_free_are_counted(studio: Studio):
    assert session.MAX_WAITING_PICTURES == 4
    assert session.MAX_WAITING_PICTURE_BYTES == 64 * 1024**2
    bench = studio.bench
    camera = bench.ros.add_publisher(CAMERA, IMAGE)
    folder = await studio.start(images="jpeg")
    data = picture(bench, 1)
    for _ in range(20):
        camera.publish(data)
    await eventually(lambda: studio.recorder.status().lost > 0)
    await eventually(lambda: studio.recorder.status().messages >= 5)
    await studio.stop()
    status = studio.recorder.status()
    assert len(jpegs(folder)) + status.lost == 20
