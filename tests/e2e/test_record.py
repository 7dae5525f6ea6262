# SPDX-License-Identifier: Apache-2.0
"""``ros2-gateway record``, of real nodes."""

import asyncio
import contextlib
import json
import random
import signal
import subprocess
import sys
from collections import Counter, defaultdict
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest
from mcap.records import Channel, Message
from rosbags.rosbag2 import Reader

from gateway.recording.folder import repair_all
from gateway.recording.mcap_file import records_of
from gateway.sources.rclpy.distro import distro
from gateway.sources.source import Qos
from tests.client import client, eventually
from tests.core.conftest import IMAGE, STRING
from tests.gateway_process import gateway_process
from tests.namespaces import needs_namespaces
from tests.recording.process import RecordProcess, record_process
from tests.recording.readers import EVENTS, by_all, decoded, files
from tests.recording.test_mcap_file import CONFIG
from tests.sources.outside import Outside

KILLS = 3  # `python -m tests.recording.kills` does more
SIM = (sys.executable, "-m", "gateway", "sim", "--until-stdin-closes")
# It runs a command on a small disk in $1, and copies what is there at the end to $2.
_ON_A_SMALL_DISK = """mount -t tmpfs -o size=64m,mode=755 tmpfs "$1" || exit
disk=$1 copy=$2; shift 2; "$@"; code=$?; cp -r "$disk" "$copy"; exit $code"""


@pytest.fixture
def outside() -> Iterator[Outside]:
    with contextlib.closing(Outside()) as outside:
        yield outside


def string(number: int) -> bytes:
    text = b"%07d\0" % number  # whole words: DDS pads others
    return b"\0\1\0\0" + len(text).to_bytes(4, "little") + text


def image(noise: bytes) -> bytes:
    from array import array

    from rclpy.serialization import serialize_message
    from sensor_msgs.msg import Image  # type: ignore[attr-defined]

    return bytes(serialize_message(Image(data=array("B", noise))))


def on_disk(recording: RecordProcess) -> Counter[str]:
    """Return the number of messages of each topic that outlive a kill now."""
    names: dict[int, str] = {}
    counts: Counter[str] = Counter()
    with recording.active.open("rb") as file:
        for record in records_of(file):
            match record:
                case Channel():
                    names[record.id] = record.topic
                case Message():
                    counts[names[record.channel_id]] += 1
    return counts


@pytest.mark.brief
async def test_a_robot_is_recorded_byte_for_byte(outside: Outside, tmp_path: Path):
    heard: dict[str, list[bytes]] = defaultdict(list)
    with subprocess.Popen(SIM, stdin=subprocess.PIPE) as robot:  # noqa: ASYNC220  # it is awaited
        types = {"/odom": "nav_msgs/msg/Odometry", "/scan": "sensor_msgs/msg/LaserScan"}
        types |= {"/imu": "sensor_msgs/msg/Imu", "/camera/image_raw": IMAGE}
        came_once = {"/map", "/tf_static", "/robot_description"}

        def hear(topic: str, samples) -> None:
            heard[topic] += [bytes(each.cdr) for each in samples]

        for topic, type_name in types.items():
            outside.add_subscription(topic, type_name, partial(hear, topic), Qos(depth=1000))
        await eventually(lambda: len(heard) == len(types))
        async with record_process(tmp_path, "-t", "/**") as recording:
            await eventually(
                lambda: (
                    (found := on_disk(recording)).keys() >= came_once | set(types)
                    and found["/odom"] > 50
                )
            )
            code, text = await recording.end()
        last = {topic: len(each) for topic, each in heard.items()}
        await eventually(lambda: all(len(heard[topic]) > last[topic] + 2 for topic in types))
        robot.stdin.close()
    recorded = by_all(recording.folder)
    assert code == 0
    assert f": {recording.folder}" in text
    assert came_once <= set(recorded)
    for topic in types:
        first = heard[topic].index(recorded[topic][0])
        assert recorded[topic] == heard[topic][first : first + len(recorded[topic])], topic


async def test_the_offers_and_the_distribution_are_described(outside: Outside, tmp_path: Path):
    from rclpy.duration import Duration
    from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile
    from std_msgs.msg import String

    qos = QoSProfile(
        depth=7,
        durability=DurabilityPolicy.TRANSIENT_LOCAL,
        deadline=Duration(seconds=30),
        lifespan=Duration(seconds=60, nanoseconds=5),
        liveliness=LivelinessPolicy.MANUAL_BY_TOPIC,
        liveliness_lease_duration=Duration(seconds=40),
    )
    publisher = outside.node.create_publisher(String, "/said", qos)
    publisher.publish(String(data="x"))
    async with record_process(tmp_path, "-t", "/said") as recording:
        await eventually(lambda: on_disk(recording)["/said"] > 0)
        await recording.end()
    with Reader(recording.folder) as reader:
        (offered,) = next(
            each.ext.offered_qos_profiles for each in reader.connections if each.topic == "/said"
        )
        assert reader.ros_distro == distro()
    assert (offered.reliability.name, offered.durability.name) == ("RELIABLE", "TRANSIENT_LOCAL")
    assert offered.liveliness.name == "MANUAL_BY_TOPIC"
    periods = offered.deadline, offered.lifespan, offered.liveliness_lease_duration
    assert [(each.sec, each.nsec) for each in periods] == [(30, 0), (60, 5), (40, 0)]


async def test_a_killed_recording_has_all_that_was_on_the_disk(outside: Outside, tmp_path: Path):
    publisher = outside.add_publisher("/count", STRING, Qos("reliable", depth=1000))
    for kill in range(KILLS):
        async with record_process(tmp_path, "-t", "/count") as recording:
            await eventually(lambda: publisher.subscribers > 0)
            sent = 0
            goal = random.randrange(1, 300)
            while (safe := on_disk(recording)["/count"]) < goal:
                publisher.publish(string(sent))
                sent += 1
                await asyncio.sleep(random.random() / 100)
            await recording.end(signal.SIGKILL)
        await eventually(lambda: publisher.subscribers == 0)
        repair_all(tmp_path, CONFIG, "test")
        found = by_all(recording.folder)["/count"]
        assert found == [string(number) for number in range(len(found))]
        assert len(found) >= safe, kill
        assert not recording.is_active


async def test_the_next_start_repairs(outside: Outside, tmp_path: Path):
    outside.add_publisher("/count", STRING)
    async with record_process(tmp_path) as killed:
        await killed.end(signal.SIGKILL)
    async with record_process(tmp_path) as recording:
        await eventually(lambda: bool(files(killed.folder)) and not killed.is_active)
        _, text = await recording.end()
    assert f"repaired {killed.folder}" in text


async def test_a_gateway_records_for_a_client(outside: Outside, tmp_path: Path):
    publisher = outside.add_publisher("/count", STRING, Qos("reliable", depth=1000))
    setting = ("--set", f"recording.directory={tmp_path}")
    async with gateway_process("serve", *setting) as gateway, client(gateway.url) as operator:
        await operator.send(op="record", id="on", action="start", topics=["/count"])
        started = await operator.receive(lambda frame: frame.get("id") == "on")
        await eventually(lambda: publisher.subscribers > 0)
        sent = [string(number) for number in range(200)]
        for cdr in sent:
            publisher.publish(cdr)
        await operator.send(op="record", id="watch", watch=True)
        await operator.receive(lambda frame: frame.get("messages", 0) >= len(sent))
        await gateway.stop()
    assert by_all(tmp_path / started["recording"])["/count"] == sent


async def test_messages_of_clients_are_recorded_with_the_clock_of_the_driver(tmp_path: Path):
    setting = ("--set", f"recording.directory={tmp_path / 'asked'}")
    hands = {"topic": "/hand/left", "type": "geometry_msgs/msg/PoseStamped"}
    async with (
        record_process(tmp_path, "-t", "/hand/**") as recording,
        gateway_process("serve", *setting) as gateway,
        client(gateway.url) as headset,
    ):
        await headset.send(op="ping", clock_offset_ms=12.5)
        await headset.send(op="advertise", topic="/cmd_vel", type="geometry_msgs/msg/Twist")
        await headset.send(op="record", action="start", topics=["/hand/**"])
        started = await headset.receive(lambda frame: frame["op"] == "record")
        await headset.send(op="acquire_control", topic="/cmd_vel")
        sent = 0
        recorded = 0
        while recorded < 9 or on_disk(recording)["/hand/left"] < 3:
            position = {"x": sent, "y": 0, "z": 0}
            await headset.send(op="publish", msg={"pose": {"position": position}}, **hands)
            await headset.send(op="record", id="status")
            status = await headset.receive(lambda frame: frame.get("id") == "status")
            recorded, sent = status["messages"], sent + 1
        await headset.send(op="record", id="end", action="stop")
        await headset.receive(lambda frame: frame.get("id") == "end")
        await recording.end()
    asked = tmp_path / "asked" / started["recording"]
    for folder in (asked, recording.folder):
        places = [each.pose.position.x for each in decoded(folder)["/hand/left"]]
        assert places == [*range(int(places[0]), int(places[-1]) + 1)]
    events = [json.loads(each.data) for each in decoded(asked)[EVENTS]]
    taken = next(each for each in events if each["event"] == "control_taken")
    assert taken["clock_offset_ms"] == 12.5


@needs_namespaces
@pytest.mark.parametrize(
    ("settings", "texts"),
    [
        ((), ("MB left, and 3 MB are to stay free", "lower recording.min_free_share")),
        (("--set", "recording.min_free_bytes=0"), ("cannot write", "no space left on device")),
    ],
    ids=["before it is full", "full"],
)
async def test_a_recording_on_a_full_disk_ends_with_all_that_it_has(
    outside: Outside, tmp_path: Path, settings: tuple[str, ...], texts: tuple[str, ...]
):
    disk, copy = tmp_path / "disk", tmp_path / "copy"
    disk.mkdir()
    publisher = outside.add_publisher("/image", IMAGE, Qos("reliable", depth=10))
    small = ("unshare", "--mount", "sh", "-c", _ON_A_SMALL_DISK, "sh", str(disk), str(copy))
    async with record_process(disk, "-t", "/image", *settings, before=small) as recording:
        await eventually(lambda: publisher.subscribers > 0)
        noise = random.Random(1)
        sent = []
        while recording.process.returncode is None:
            sent.append(image(noise.randbytes(500_000)))
            publisher.publish(sent[-1])
            await asyncio.sleep(0.01)
        code, text = await recording.ended()
    assert code == 1
    assert all(each in text for each in texts)
    repair_all(copy, CONFIG, "test")  # elsewhere, with more room
    found = by_all(copy / recording.folder.name)["/image"]
    assert len(found) > 100
    assert found == [each for each in sent if each in set(found)]
