# SPDX-License-Identifier: Apache-2.0
"""Recordings for tests: the same messages in each format, written by other people's libraries."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.interfaces import (
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)
from rosbags.rosbag1 import Writer as Bag1Writer
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Bag2Writer
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore

STRING: Final = "std_msgs/msg/String"
ODOMETRY: Final = "nav_msgs/msg/Odometry"
START_NS: Final = 1_700_000_000_000_000_000
STEP_NS: Final = 20_000_000
COUNT: Final = 100  # of odometry, and of the numbers on /chatter
NAME: Final = "of the map"  # on the latched topic, once, at the beginning

_ROS2: Final = get_typestore(Stores.ROS2_JAZZY)
_ROS1: Final = get_typestore(Stores.ROS1_NOETIC)
_NEVER: Final = QosTime(0, 0)
_LATCHED: Final = Qos(
    QosHistory.KEEP_LAST,
    1,
    QosReliability.RELIABLE,
    QosDurability.TRANSIENT_LOCAL,
    _NEVER,
    _NEVER,
    QosLiveliness.AUTOMATIC,
    _NEVER,
    False,
)
Message = tuple[int, str, str, object]
"""Time, topic, type, and the message of rosbags."""


def string_cdr(text: str) -> bytes:
    """Return a std_msgs/msg/String."""
    return bytes(_ROS2.serialize_cdr(_ROS2.types[STRING](data=text), STRING))


def expected() -> list[tuple[int, str, bytes]]:
    """Return time, topic, and CDR of each message, in order."""
    return [(at, topic, _cdr(each, name)) for at, topic, name, each in _messages(_ROS2)]


def write_bag2(
    folder: Path, plugin: StoragePlugin, compression: CompressionMode = CompressionMode.NONE
) -> Path:
    """Write a rosbag2 folder."""
    bag = Bag2Writer(folder, version=9, storage_plugin=plugin)
    bag.set_compression(compression, CompressionFormat.ZSTD)
    with bag as writer:
        open_topics: dict[str, Any] = {}
        for at, topic, type_name, each in _messages(_ROS2):
            if topic not in open_topics:
                offered = [_LATCHED] if topic == "/map_name" else []
                open_topics[topic] = writer.add_connection(
                    topic, type_name, typestore=_ROS2, offered_qos_profiles=offered
                )
            writer.write(open_topics[topic], at, _cdr(each, type_name))
    return folder


def write_bag1(path: Path) -> Path:
    """Write a bag of ROS 1."""
    with Bag1Writer(path) as writer:
        open_topics: dict[str, Any] = {}
        for at, topic, type_name, each in _messages(_ROS1):
            if topic not in open_topics:
                latching = 1 if topic == "/map_name" else None
                open_topics[topic] = writer.add_connection(
                    topic, type_name, typestore=_ROS1, latching=latching
                )
            writer.write(open_topics[topic], at, _ROS1.serialize_ros1(each, type_name))
    return path


def write_mcap(
    path: Path,
    messages: Sequence[tuple[int, str, bytes]],
    *,
    chunk_bytes: int = 2048,
    definition: str = "string data\n",
    encoding: str = "ros2msg",
    qos: str = "",
    of_message: str = "cdr",
    use_chunking: bool = True,
) -> Path:
    """Write messages of one type to an MCAP file of small chunks."""
    with path.open("wb") as stream:
        writer = McapWriter(
            stream,
            chunk_size=chunk_bytes,
            compression=CompressionType.ZSTD,
            use_chunking=use_chunking,
        )
        writer.start(profile="ros2", library="tests")
        schema = writer.register_schema(STRING, encoding, definition.encode())
        channels: dict[str, int] = {}
        for at, topic, cdr in messages:
            if topic not in channels:
                metadata = {"offered_qos_profiles": qos}
                channels[topic] = writer.register_channel(topic, of_message, schema, metadata)
            writer.add_message(channels[topic], log_time=at, data=cdr, publish_time=at)
        writer.finish()
    return path


def _messages(store: Typestore) -> list[Message]:
    strings = store.types[STRING]
    found: list[Message] = [(START_NS, "/map_name", STRING, strings(data=NAME))]
    for number in range(COUNT):
        at = START_NS + 1 + number * STEP_NS
        found.append((at, "/chatter", STRING, strings(data=str(number))))
        found.append((at + 1, "/odom", ODOMETRY, _odometry(store, at, number)))
    return found


def _odometry(store: Typestore, at: int, number: int) -> object:
    types = store.types
    stamp = types["builtin_interfaces/msg/Time"](*divmod(at, 1_000_000_000))
    sequence = {"seq": number} if store is _ROS1 else {}
    header = types["std_msgs/msg/Header"](**sequence, stamp=stamp, frame_id="odom")
    point = types["geometry_msgs/msg/Point"](float(number), 2.0, 3.0)
    turn = types["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0)
    pose = types["geometry_msgs/msg/Pose"](point, turn)
    speed = types["geometry_msgs/msg/Vector3"](0.5, 0.0, 0.0)
    twist = types["geometry_msgs/msg/Twist"](speed, speed)
    covariance = np.arange(36, dtype=np.float64)
    return types[ODOMETRY](
        header,
        "base_link",
        types["geometry_msgs/msg/PoseWithCovariance"](pose, covariance),
        types["geometry_msgs/msg/TwistWithCovariance"](twist, covariance),
    )


def _cdr(message: object, type_name: str) -> bytes:
    return bytes(_ROS2.serialize_cdr(message, type_name))
