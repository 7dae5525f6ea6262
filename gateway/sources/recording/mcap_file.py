# SPDX-License-Identifier: Apache-2.0
"""MCAP files (https://mcap.dev/spec), also those whose writer was killed before the end."""

import os
import struct
from collections.abc import Callable, Collection, Iterator
from pathlib import Path
from typing import IO, Any, Final

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.reader import SeekingReader
from mcap.records import Channel, Chunk, ChunkIndex, Schema
from mcap.stream_reader import MAGIC_SIZE, breakup_chunk
from mcap.summary import Summary

from gateway.sources.recording.definition_parts import Notation, differs, parse_parts
from gateway.sources.recording.offered import offered_qos
from gateway.sources.recording.tracks import Recorded, Track, uncompressed
from schemas.definition import Definition, DefinitionError

MAGIC: Final = b"\x89MCAP0\r\n"

PROGRESS_BYTES: Final = 64 * 1024 * 1024  # take about half a second

_NOTATIONS: Final[dict[str, Notation]] = {"ros2msg": "msg", "ros2idl": "idl", "omgidl": "idl"}
_RECORD_HEADER: Final = struct.Struct("<BQ")  # opcode and length


class McapFile:
    """Implements `gateway.sources.recording.tracks.RecordedFile`."""

    def __init__(self, path: Path, show: Callable[[str], object]) -> None:
        """Open it. *show* gets the progress.

        Raises:
            Exception: whatever the library raises where the file is damaged.
        """
        self._stream: Final = path.open("rb")
        try:
            self._reader = _Reader(self._stream, show, validate_crcs=True)
            summary = self._reader.get_summary()
            chunks = summary.chunk_indexes
            self.start_ns = min((each.message_start_time for each in chunks), default=0)
            self.end_ns = max((each.message_end_time + 1 for each in chunks), default=0)
            self.is_unfinished = self._reader.is_unfinished
            self.skipped: dict[str, str] = {}
            self.definitions: dict[str, Definition] = {}
            self._tracks: dict[int, Track] = {}
            for channel in summary.channels.values():
                self._add(channel, summary.schemas.get(channel.schema_id))
        except BaseException:
            self._stream.close()
            raise

    @property
    def tracks(self) -> Collection[Track]:
        """All that can be played."""
        return self._tracks.values()

    def messages(
        self, tracks: Collection[Track], start_ns: int, stop_ns: int
    ) -> Iterator[Recorded]:
        """Yield messages, ordered by time."""
        topics = {track.topic for track in tracks}
        if not topics or start_ns >= stop_ns:
            return
        wanted = {number: track for number, track in self._tracks.items() if track in tracks}
        for _, channel, message in self._reader.iter_messages(
            topics, starting_at=max(start_ns, 0), ending_before=stop_ns
        ):
            track = wanted.get(channel.id)
            if track is not None:
                yield Recorded(message.log_time, track, uncompressed(message.data))

    def close(self) -> None:
        """Close the file."""
        self._stream.close()

    def _add(self, channel: Channel, schema: Schema | None) -> None:
        if channel.message_encoding != "cdr" or schema is None:
            self.skipped[channel.topic] = (
                f"it has {channel.message_encoding or 'no'} encoding, not cdr"
            )
            return
        notation = _NOTATIONS.get(schema.encoding)
        if notation is not None:
            try:
                found = parse_parts(schema.name, schema.data.decode(errors="replace"), notation)
            except DefinitionError as error:
                self.skipped[channel.topic] = f"its definition cannot be read: {error}"
                return
            other = [name for name, each in found.items() if differs(self.definitions, name, each)]
            if other:
                self.skipped[channel.topic] = f"the file defines {other[0]} in two ways"
                return
            self.definitions.update(found)
        qos = offered_qos(channel.metadata.get("offered_qos_profiles", ""))
        self._tracks[channel.id] = Track(channel.topic, schema.name, qos)


class _Reader(SeekingReader):
    """Reads also a file without a summary: it makes one of the chunks that are complete."""

    def __init__(
        self, stream: IO[bytes], show: Callable[[str], object], *, validate_crcs: bool
    ) -> None:
        super().__init__(stream, validate_crcs=validate_crcs)
        self.is_unfinished = not _has_footer(stream)
        own = None if self.is_unfinished else super().get_summary()
        if own is None or not (own.chunk_indexes and own.channels):
            own = _summarize(stream, show)
        self._own = own

    def get_summary(self) -> Summary:
        """Return the index of the file."""
        return self._own


def _has_footer(stream: IO[bytes]) -> bool:
    size = stream.seek(0, os.SEEK_END)
    stream.seek(max(size - MAGIC_SIZE, MAGIC_SIZE))
    return stream.read() == MAGIC


def _summarize(stream: IO[bytes], show: Callable[[str], object]) -> Summary:
    """Find the chunks of a file. A last one that is not complete, or damaged, is left out.

    Raises:
        McapError: messages are elsewhere.
    """
    summary = Summary()
    size = stream.seek(0, os.SEEK_END)
    start, shown = MAGIC_SIZE, 0
    while start + _RECORD_HEADER.size <= size:
        stream.seek(start)
        opcode, length = _RECORD_HEADER.unpack(stream.read(_RECORD_HEADER.size))
        end = start + _RECORD_HEADER.size + length
        if end > size:
            break
        if opcode == Opcode.MESSAGE:
            raise McapError("its messages are not in chunks")
        if opcode == Opcode.CHUNK:
            try:
                chunk = Chunk.read(ReadDataStream(stream))
                records = breakup_chunk(chunk, validate_crc=True)
            except Exception:  # noqa: BLE001  # the library and its decompressors raise many kinds
                break
            channels = _note(records, summary)
            index = _index(chunk, start, end - start, channels)
            if channels:
                summary.chunk_indexes.append(index)
        start = end
        if start - shown > PROGRESS_BYTES:
            shown = start
            show(f"{stream.name} has no index, {start // 10**6} of {size // 10**6} MB are read")
    return summary


def _note(records: Any, summary: Summary) -> set[int]:
    """Note schemas and channels. Return the channels that have messages."""
    used = set()
    for record in records:
        if isinstance(record, Schema):
            summary.schemas[record.id] = record
        elif isinstance(record, Channel):
            summary.channels[record.id] = record
        else:
            used.add(record.channel_id)
    return used


def _index(chunk: Chunk, start: int, length: int, channels: set[int]) -> ChunkIndex:
    return ChunkIndex(
        chunk_length=length,
        chunk_start_offset=start,
        compression=chunk.compression,
        compressed_size=len(chunk.data),
        message_end_time=chunk.message_end_time,
        message_index_length=0,
        message_index_offsets=dict.fromkeys(channels, 0),
        message_start_time=chunk.message_start_time,
        uncompressed_size=chunk.uncompressed_size,
    )
