# SPDX-License-Identifier: Apache-2.0
"""Bags that rosbags reads: rosbag2 with SQLite, or in a compressed folder, and those of ROS 1."""

import logging
import os
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Final
from urllib.parse import quote_from_bytes

from rosbags.interfaces import Connection, ConnectionExtRosbag1, MessageDefinitionFormat
from rosbags.rosbag1 import Reader as Bag1Reader
from rosbags.rosbag2 import Reader as Bag2Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from gateway.sources.recording.definition_parts import Notation, parse_parts
from gateway.sources.recording.offered import common_qos
from gateway.sources.recording.tracks import DEFAULT_QOS, Recorded, Track, uncompressed
from schemas.definition import Definition, DefinitionError

SQLITE_MAGIC: Final = b"SQLite format 3\0"
BAG1_MAGIC: Final = b"#ROSBAG V"

_NOTATIONS: Final[Mapping[MessageDefinitionFormat, Notation]] = {
    MessageDefinitionFormat.MSG: "msg",
    MessageDefinitionFormat.IDL: "idl",
}
_HEADER: Final = "std_msgs/msg/Header"
_LATCHED: Final = replace(DEFAULT_QOS, durability="transient_local", depth=1)

logger = logging.getLogger(__name__)

ToCdr = Callable[[bytes, str], bytes | memoryview]


class _PathInUri(type(Path())):  # type: ignore[misc]  # of this system
    """A path whose odd characters survive in the URI that rosbags formats it into, for SQLite."""

    def __format__(self, _: str) -> str:
        return quote_from_bytes(os.fsencode(self))


class BagFile:
    """Implements `gateway.sources.recording.tracks.RecordedFile`."""

    is_unfinished = False

    def __init__(self, path: Path, *, is_ros1: bool) -> None:
        """Open it.

        Raises:
            Exception: whatever the library raises where the file is damaged.
        """
        self._reader = Bag1Reader(path) if is_ros1 else Bag2Reader(_PathInUri(path))
        self._reader.open()
        try:
            self.start_ns, self.end_ns = self._reader.start_time, self._reader.end_time
            self._connections = {_key(each): each for each in self._reader.connections}
            self.skipped: dict[str, str] = {}
            self.definitions: dict[str, Definition] = {}
            self._to_cdr: ToCdr | None = None
            if is_ros1:
                self._learn_ros1()
            else:
                self._learn_ros2()
            self._tracks = {
                key: _track(connection)
                for key, connection in self._connections.items()
                if connection.topic not in self.skipped
            }
        except BaseException:
            self._reader.close()
            raise

    @property
    def tracks(self) -> Collection[Track]:
        """All that can be played."""
        return self._tracks.values()

    def messages(
        self, tracks: Collection[Track], start_ns: int, stop_ns: int
    ) -> Iterator[Recorded]:
        """Yield messages, ordered by time."""
        wanted = [self._connections[key] for key, track in self._tracks.items() if track in tracks]
        if not wanted:
            return
        for connection, time_ns, raw in self._reader.messages(wanted, start_ns, stop_ns):
            cdr = self._cdr(connection, raw)
            if cdr is not None:
                yield Recorded(time_ns, self._tracks[_key(connection)], cdr)

    def close(self) -> None:
        """Close the file."""
        self._reader.close()

    def _cdr(self, connection: Connection, raw: bytes) -> bytes | None:
        if self._to_cdr is None:
            return uncompressed(raw)
        try:
            return bytes(self._to_cdr(raw, connection.msgtype))
        except Exception as error:  # noqa: BLE001  # of rosbags, whose kinds are many
            logger.warning("topic %s: a message cannot be converted, %s", connection.topic, error)
            return None

    def _learn_ros2(self) -> None:
        for each in self._connections.values():
            notation = _NOTATIONS.get(each.msgdef.format)
            if notation is None:  # older bags have no definitions: installed ones serve
                continue
            try:
                self.definitions.update(parse_parts(each.msgtype, each.msgdef.data, notation))
            except DefinitionError as error:
                self.skipped[each.topic] = f"its definition cannot be read: {error}"

    def _learn_ros1(self) -> None:
        """Learn types from the file, and convert them to those of ROS 2: its header has no seq."""
        store = get_typestore(Stores.EMPTY)
        header = {_HEADER: get_typestore(Stores.ROS2_HUMBLE).fielddefs[_HEADER]}
        store.register(header)
        learned = set()
        for each in self._connections.values():
            if (each.msgtype, each.msgdef) in learned:
                continue
            try:
                store.register({**get_types_from_msg(each.msgdef.data, each.msgtype), **header})
                self.definitions.update(_definitions_of(store, each.msgtype))
            except Exception as error:  # noqa: BLE001  # of rosbags, whose kinds are many
                self.skipped[each.topic] = f"its definition cannot be read: {error}"
            else:
                learned.add((each.msgtype, each.msgdef))
        self._to_cdr = store.ros1_to_cdr


def _definitions_of(store: Typestore, type_name: str) -> Mapping[str, Definition]:
    text, _ = store.generate_msgdef(type_name, ros_version=2)
    return parse_parts(type_name, text, "msg")


def _key(connection: Connection) -> tuple[int, int]:
    return id(connection.owner), connection.id


def _track(connection: Connection) -> Track:
    if isinstance(connection.ext, ConnectionExtRosbag1):
        qos = _LATCHED if connection.ext.latching else DEFAULT_QOS
    else:
        qos = common_qos(connection.ext.offered_qos_profiles)
    return Track(connection.topic, connection.msgtype, qos)
