# SPDX-License-Identifier: Apache-2.0
"""An MCAP file that is being written, and the repair of one whose writer was killed.

It has another name until it is complete. The package mcap is needed to import this.
"""

import fcntl
import logging
import os
import time
from collections.abc import Iterator
from io import BufferedWriter
from pathlib import Path
from typing import IO, Final, cast

from mcap.records import Channel, McapRecord, Message, Metadata, Schema
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType, Writer

from gateway.config.recording import RecordingConfig
from gateway.recording.disk import (
    MOST_AT_ONCE,
    MOST_AT_ONCE_BYTES,
    PAUSE_S,
    DiskFullError,
    why_full,
)
from gateway.recording.entries import ACTIVE, RecordedMessage, RecordedNote, RecordedTopic

CHUNK_BYTES: Final = 1024**2  # a reader holds one or two of them
# A broken length must not fill the memory. The largest message has 64 MiB.
MAX_RECORD_BYTES: Final = 256 * 1024**2
DAMAGED: Final = ".damaged"  # the end of the name of a file that a repair could not read to its end

logger = logging.getLogger(__name__)


class RecordingFile:
    """One file of a recording, locked until it is closed.

    Raises:
        OSError: the file cannot be written. This is true for all methods.
    """

    def __init__(self, path: Path, library: str) -> None:
        """Create ``PATH.active``, which `finish` renames."""
        self._path = path
        self._active = path.with_name(path.name + ACTIVE)
        new = path.with_name(path.name + ".new")
        self._file = new.open("xb")
        fcntl.flock(self._file, fcntl.LOCK_EX)
        new.rename(self._active)  # now that nobody repairs it
        self._writer = _writer(self._file, library)
        self._channels: dict[RecordedTopic, int] = {}
        self._schemas: dict[str, int] = {}
        self.messages = 0

    @property
    def size(self) -> int:
        """The bytes that are in the file, without those that wait for the end of a chunk."""
        return self._file.tell()

    def add(self, message: RecordedMessage) -> None:
        """Add a message, and its channel if it is the first one."""
        topic = message.topic
        channel = self._channels.get(topic)
        if channel is None:
            channel = self._channels[topic] = self._register(topic)
        times = {"log_time": message.received_ns, "publish_time": message.published_ns}
        data = cast("bytes", message.cdr)  # or a view, which it writes as well
        self._writer.add_message(channel, data=data, sequence=self.messages, **times)
        self.messages += 1

    def note(self, note: RecordedNote) -> None:
        """Add a metadata record."""
        self._writer.add_metadata(note.name, note.values)

    def sync(self) -> None:
        """Have everything on the disk: what came so far outlives this process and the power."""
        self._writer.flush()
        os.fsync(self._file.fileno())

    def finish(self) -> Path:
        """Complete the file, and return its path."""
        self._writer.finish()
        _complete(self._file, self._active, self._path)
        return self._path

    def abandon(self) -> None:
        """Close the file as it is. A repair finds what it has."""
        self._file.raw.close()  # the buffer cannot be written

    def _register(self, topic: RecordedTopic) -> int:
        schema = self._schemas.get(topic.type_name)
        if schema is None:
            schema = self._writer.register_schema(topic.type_name, "ros2msg", topic.schema.encode())
            self._schemas[topic.type_name] = schema
        metadata = {"offered_qos_profiles": topic.qos, "topic_type_hash": topic.type_hash}
        return self._writer.register_channel(topic.name, "cdr", schema, metadata)


def repair(active: Path, config: RecordingConfig, library: str) -> int | None:
    """Complete the file of a writer that was killed. Return the number of its messages.

    Return None if another process writes or repairs it, or has just completed it.
    It is written again up to the last whole chunk. If this is interrupted, the next repair begins
    again. A file that was not only cut keeps its content under another name.

    Raises:
        DiskFullError: a second file would take the space that is to stay free.
        OSError: the file belongs to another user, for example.
    """
    try:
        with active.open("r+b") as source:
            fcntl.flock(source, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if not active.exists():
                return None
            path = active.with_name(active.name.removesuffix(ACTIVE))
            new = path.with_name(path.name + ".repaired")
            new.unlink(missing_ok=True)  # of an interrupted repair
            size = active.stat().st_size
            if why := why_full(active.parent, config, size):
                raise DiskFullError(f"a copy takes {size / 1e6:.0f} MB, and {why}")
            count = _write_again(source, new, path, library)
            if source.tell() == size:
                active.unlink()
            else:
                damaged = active.rename(path.with_name(path.name + DAMAGED))
                text = "try `mcap recover` on it, or delete it"
                logger.warning("%s lacks a part of %s: %s", path, damaged, text)
            return count
    except (BlockingIOError, FileNotFoundError):
        return None


def records_of(file: IO[bytes]) -> Iterator[McapRecord]:
    """Yield the records of a file that may be incomplete, up to the last whole one."""
    reader = StreamReader(file, validate_crcs=True, record_size_limit=MAX_RECORD_BYTES)
    try:
        yield from reader.records
    except (OSError, MemoryError):
        raise
    except Exception:  # noqa: BLE001  # mcap, struct, and zstandard have their own for a cut
        return


def _write_again(source: IO[bytes], new: Path, path: Path, library: str) -> int:
    with new.open("wb") as file:
        try:
            writer = _writer(file, library)
            count = _copy(source, writer)
            writer.finish()
            _complete(file, new, path)
        except BaseException:
            new.unlink(missing_ok=True)
            raise
    return count


def _copy(source: IO[bytes], writer: Writer) -> int:
    """Copy all records, and let the event loop run in between. Return the number of messages."""
    count = 0
    channels: dict[int, int] = {}
    schemas: dict[int, int] = {}
    for record in records_of(source):
        match record:
            case Schema():
                schemas[record.id] = writer.register_schema(
                    record.name, record.encoding, record.data
                )
            case Channel():
                channels[record.id] = writer.register_channel(
                    record.topic,
                    record.message_encoding,
                    schemas[record.schema_id],
                    record.metadata,
                )
            case Message():
                writer.add_message(
                    channels[record.channel_id],
                    record.log_time,
                    record.data,
                    record.publish_time,
                    record.sequence,
                )
                count += 1
                if count % MOST_AT_ONCE == 0 or len(record.data) >= MOST_AT_ONCE_BYTES:
                    time.sleep(PAUSE_S)
            case Metadata():
                writer.add_metadata(record.name, record.metadata)
    return count


def _writer(file: BufferedWriter, library: str) -> Writer:
    writer = Writer(file, chunk_size=CHUNK_BYTES, compression=CompressionType.ZSTD)
    writer.start(profile="ros2", library=library)
    return writer


def _complete(file: BufferedWriter, now: Path, then: Path) -> None:
    """Have a file on the disk under its last name, and close it."""
    file.flush()
    os.fsync(file.fileno())
    now.rename(then)
    file.close()
    folder = os.open(then.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)
