# SPDX-License-Identifier: Apache-2.0
"""The readers of other projects: what each of them finds in a recording."""

import contextlib
from collections import defaultdict
from pathlib import Path
from typing import Any

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader

from gateway.sources.recording.recording import open_recording

Messages = dict[str, list[bytes]]  # by topic
EVENTS = "/ros2_gateway/events"


def files(folder: Path) -> list[Path]:
    return sorted(folder.glob("*.mcap"), key=lambda path: (len(path.name), path.name))


def by_rosbags(folder: Path) -> Messages:
    """Read the directory by its metadata.yaml, and decode everything."""
    found: Messages = defaultdict(list)
    with Reader(folder) as reader:
        for connection, _, raw in reader.messages():
            found[connection.topic].append(bytes(raw))
        assert reader.message_count == sum(map(len, found.values()))
    with AnyReader([folder]) as decoding:
        for connection, _, raw in decoding.messages():
            decoding.deserialize(raw, connection.msgtype)
    return dict(found)


def by_mcap(folder: Path) -> Messages:
    found: Messages = defaultdict(list)
    for path in files(folder):
        with path.open("rb") as file:
            for _, channel, message in make_reader(file, validate_crcs=True).iter_messages():
                found[channel.topic].append(message.data)
    return dict(found)


def decoded(folder: Path) -> dict[str, list[Any]]:
    """Return the messages as mcap-ros2-support decodes them."""
    found: dict[str, list[Any]] = defaultdict(list)
    for path in files(folder):
        with path.open("rb") as file:
            reader = make_reader(file, decoder_factories=[DecoderFactory()])
            for _, channel, _, message in reader.iter_decoded_messages():
                found[channel.topic].append(message)
    return dict(found)


def by_play(folder: Path) -> Messages:
    """Read it as `ros2-gateway play` does, also a file that is not complete."""
    found: Messages = defaultdict(list)
    with contextlib.closing(open_recording([folder], lambda _: None)) as recording:
        for each in recording.messages(recording.start_ns):
            found[each.track.topic].append(bytes(each.cdr))
    return dict(found)


def by_all(folder: Path) -> Messages:
    """Return the messages of the topics of the robot, which each reader finds."""
    found = by_rosbags(folder)
    assert by_mcap(folder) == found
    assert not found or by_play(folder) == found
    assert {topic: len(each) for topic, each in decoded(folder).items()} == {
        topic: len(each) for topic, each in found.items()
    }
    found.pop(EVENTS, None)
    return found


def notes(folder: Path) -> dict[str, dict[str, str]]:
    """Return the metadata records."""
    found = {}
    for path in files(folder):
        with path.open("rb") as file:
            found.update({each.name: each.metadata for each in make_reader(file).iter_metadata()})
    return found
