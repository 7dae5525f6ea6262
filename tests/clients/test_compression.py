# SPDX-License-Identifier: Apache-2.0
"""Encodings other than plain JSON: CBOR, PNG, and fragments, which only roslib accepts."""

import json

import pytest
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import CompressedImage, LaserScan
from std_msgs.msg import Header, Int64MultiArray, String

from tests.client import eventually
from tests.clients.driver import ROSLIB_1, ROSLIB_2, Connection
from tests.clients.robot import Robot

STRING = "std_msgs/String"

pytestmark = pytest.mark.asyncio(loop_scope="package")

in_javascript = pytest.mark.parametrize("library", [ROSLIB_1, ROSLIB_2], ids=str, indirect=True)
joins_fragments = pytest.mark.parametrize("library", [ROSLIB_2], ids=str, indirect=True)


@in_javascript
async def test_cbor_brings_numbers_as_typed_arrays(client: Connection, robot: Robot):
    topic = client.own("scan")
    robot.publish(topic, LaserScan(header=Header(frame_id="läser"), ranges=[0.5, 1.5, 2.5]))
    await client.subscribe(topic, "sensor_msgs/LaserScan", compression="cbor")
    message = await client.next("message", topic)
    assert message["ranges"] == {"array": "Float32Array", "values": [0.5, 1.5, 2.5]}
    assert message["header"]["frame_id"] == "läser"


@in_javascript
async def test_cbor_brings_bytes_as_bytes(client: Connection, robot: Robot):
    topic = client.own("image")
    robot.publish(topic, CompressedImage(format="jpeg", data=bytes(range(256))))
    await client.subscribe(topic, "sensor_msgs/CompressedImage", compression="cbor")
    message = await client.next("message", topic)
    assert message["data"] == {"array": "Uint8Array", "values": list(range(256))}


@in_javascript
async def test_cbor_brings_64_bit_numbers(client: Connection, robot: Robot):
    topic = client.own("numbers")
    robot.publish(topic, Int64MultiArray(data=[-1, 2**40]))
    await client.subscribe(topic, "std_msgs/Int64MultiArray", compression="cbor")
    data = (await client.next("message", topic))["data"]
    if client.library == ROSLIB_1:  # which makes plain numbers of them, and warns
        assert data == [-1, 2**40]
        client.driver.take("warning")
    else:
        assert data == {"array": "BigInt64Array", "values": ["-1", str(2**40)]}


@in_javascript
async def test_cbor_raw_brings_what_ros_has_sent(client: Connection, robot: Robot):
    topic = client.own("scan")
    scan = LaserScan(header=Header(frame_id="laser"), ranges=[0.5, 1.5])
    robot.publish(topic, scan)
    await client.subscribe(topic, "sensor_msgs/LaserScan", compression="cbor-raw")
    message = await client.next("message", topic)
    assert set(message) == {"secs", "nsecs", "bytes"}
    assert deserialize_message(bytes(message["bytes"]["values"]), LaserScan) == scan


@in_javascript
async def test_png_brings_the_message(client: Connection, robot: Robot):
    topic = client.own("out")
    robot.publish(topic, String(data="grüße" * 1000))
    await client.subscribe(topic, STRING, compression="png")
    assert await client.next("message", topic) == {"data": "grüße" * 1000}


@joins_fragments
async def test_fragments_bring_the_message(client: Connection, robot: Robot):
    topic = client.own("out")
    robot.publish(topic, String(data="grüße" * 1000))
    await client.do("listen", topic=topic)
    subscribe = {"op": "subscribe", "topic": topic, "type": STRING, "fragment_size": 100}
    await client.do("send", operation=subscribe)
    assert await client.next("message", topic) == {"data": "grüße" * 1000}


@in_javascript
async def test_an_operation_in_fragments_is_carried_out(client: Connection, robot: Robot):
    topic = client.own("in")
    heard = robot.hear(String, topic)
    await client.is_awaited(topic)
    text = json.dumps({"op": "publish", "topic": topic, "type": STRING, "msg": {"data": "x" * 100}})
    pieces = [text[at : at + 20] for at in range(0, len(text), 20)]
    for num, piece in enumerate(pieces):
        fragment = {"op": "fragment", "id": "f", "num": num, "total": len(pieces), "data": piece}
        await client.do("send", operation=fragment)
    await eventually(lambda: heard == [String(data="x" * 100)])
