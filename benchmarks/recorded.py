# SPDX-License-Identifier: Apache-2.0
"""Recordings to play, written by the package mcap."""

from collections.abc import Iterable
from pathlib import Path
from typing import Final

from benchmarks.errors import BenchmarkError
from benchmarks.samples import SAMPLES, message_type

START_NS: Final = 1_700_000_000_000_000_000
LATCHED: Final = (
    "- {history: 1, depth: 1, reliability: 1, durability: 1, deadline: {sec: 0, nsec: 0},"
    " lifespan: {sec: 0, nsec: 0}, liveliness: 1, liveliness_lease_duration: {sec: 0, nsec: 0},"
    " avoid_ros_namespace_conventions: false}"
)


def write(file: Path, messages: Iterable[tuple[float, str]], sample: str, latched: str = "") -> int:
    """Write a sample to topics, each at some seconds, and return the number of messages.

    The stamp of each message is its time. The topic *latched* has it once, at the beginning.

    Raises:
        BenchmarkError: the packages that read and write recordings are not installed.
    """
    try:
        from mcap.writer import CompressionType, Writer
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        raise BenchmarkError(
            f"{error.name} is not installed: run .venv/bin/pip install '.[record]'"
        ) from error
    type_name = message_type(sample)
    text, _ = get_typestore(Stores.ROS2_JAZZY).generate_msgdef(type_name, ros_version=2)
    cdr = SAMPLES[sample].cdr()
    count = 0
    with file.open("wb") as stream:
        writer = Writer(stream, compression=CompressionType.NONE)
        writer.start(profile="ros2", library="benchmarks")
        schema = writer.register_schema(type_name, "ros2msg", text.encode())
        channels: dict[str, int] = {}
        for at_s, topic in [(0.0, latched)] * bool(latched) + list(messages):
            if topic not in channels:
                qos = {"offered_qos_profiles": LATCHED if topic == latched else ""}
                channels[topic] = writer.register_channel(topic, "cdr", schema, qos)
            at_ns = START_NS + round(at_s * 1e9)
            SAMPLES[sample].clockwork.write(cdr, at_ns)
            writer.add_message(channels[topic], at_ns, bytes(cdr), at_ns)
            count += 1
        writer.finish()
    return count
