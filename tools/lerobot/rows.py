# SPDX-License-Identifier: Apache-2.0
"""The rows of an episode: at each tick, the newest value that had come by then."""

import math
import re
from collections.abc import Callable, Iterable, Iterator
from typing import Any, Final, Generic, NamedTuple, TypeVar

import cv2
from cv2.typing import MatLike

from gateway.codec.compressed_images import decompress
from gateway.codec.error_text import CodecError, hint
from gateway.codec.image_encodings import RawImage, as_colours, pixels_of
from gateway.codec.picture import COMPRESSED_IMAGE, IMAGE
from gateway.codec.types import MessageType, Types
from gateway.sources.recording.recording import Recording
from gateway.sources.recording.tracks import Recorded
from schemas.installed import InstalledDefinitions
from tools.lerobot.errors import ConversionError, LeftOutError
from tools.lerobot.mapping import Images, Mapping, Numbers

S_TO_NS: Final = 1_000_000_000

_INDEX: Final = re.compile(r"\[(\d+)\]$")

T = TypeVar("T")
Newest = dict[str, Recorded]  # by topic


class Row(NamedTuple):
    """One tick. Images are BGR, of 8 bits, by the keys of the dataset."""

    state: list[float]
    action: list[float]
    images: dict[str, MatLike]


class Rows:
    """Makes the rows of the episodes of one recording."""

    def __init__(self, recording: Recording, mapping: Mapping) -> None:
        """Find the topics and fields.

        Raises:
            ConversionError: the recording does not have one of them.
        """
        self._recording = recording
        self._mapping = mapping
        definitions = InstalledDefinitions([])
        definitions.tell(recording.definitions)
        self._types = Types(definitions)
        self._type_names = {track.topic: track.type_name for track in recording.tracks}
        self._state = [self._numbers(each) for each in mapping.state]
        self._action = [self._numbers(each) for each in mapping.action]
        self._images = {each.key: self._image(each) for each in mapping.image}

    def of(self, start_ns: int, end_ns: int) -> Iterator[Row]:
        """Yield the rows from the first tick on at which every source has a value.

        Raises:
            LeftOutError: later a value is missing, or a value cannot be used.
            ConversionError: the recording is damaged.
        """
        fps = self._mapping.fps
        sources: list[_Source[Any]] = [*self._state, *self._action, *self._images.values()]
        earliest_ns = start_ns - max(each.max_age_ns for each in sources)
        messages = self._messages(earliest_ns)
        count = (end_ns - start_ns) * fps // S_TO_NS + 1
        ticks = (start_ns + number * S_TO_NS // fps for number in range(count))
        has_begun = False
        for tick_ns, newest in _newest_at(messages, ticks):
            try:
                row = self._row(newest, tick_ns)
            except (CodecError, _MissingError) as error:
                if has_begun or isinstance(error, CodecError):
                    at_s = (tick_ns - start_ns) / S_TO_NS
                    raise LeftOutError(f"{at_s:.2f} s after its start, {error}") from error
                missing = error
            else:
                has_begun = True
                yield row
        if not has_begun:
            raise LeftOutError(f"until its end, {missing}")

    def _messages(self, start_ns: int) -> Iterator[Recorded]:
        topics = self._mapping.topics
        try:
            for each in self._recording.messages(start_ns):
                if each.track.topic in topics:
                    yield each
        except Exception as error:  # of the libraries, whose kinds are many
            raise ConversionError(
                f"the recording is damaged, {error}: repair it, for example with `mcap recover`"
            ) from error

    def _row(self, newest: Newest, tick_ns: int) -> Row:
        return Row(
            [value for source in self._state for value in source.value(newest, tick_ns)],
            [value for source in self._action for value in source.value(newest, tick_ns)],
            {key: source.value(newest, tick_ns) for key, source in self._images.items()},
        )

    def _numbers(self, table: Numbers) -> "_Source[list[float]]":
        message_type = self._type_of(table.topic)
        paths = {path: _INDEX.sub("", path) for path in table.fields.values()}
        try:
            decode = message_type.decoder(tuple(paths.values()))
        except CodecError as error:  # a FieldError, which lists the fields
            raise ConversionError(f"topic {table.topic}: {error}: correct the mapping") from error

        def read(cdr: bytes) -> list[float]:
            values = decode(cdr)
            return [_number(values, path) for path in table.fields.values()]

        default = None if table.default is None else [table.default] * len(table.fields)
        return _Source(table, self._mapping.max_age_s, read, default)

    def _image(self, table: Images) -> "_Source[MatLike]":
        message_type = self._type_of(table.topic)
        if message_type.name not in {IMAGE, COMPRESSED_IMAGE}:
            raise ConversionError(
                f"topic {table.topic} has type {message_type.name}: name one with {IMAGE} or"
                f" {COMPRESSED_IMAGE}"
            )
        decode = message_type.decoder(octets="raw")
        return _Source(table, self._mapping.max_age_s, lambda cdr: _pixels(decode(cdr)), None)

    def _type_of(self, topic: str) -> MessageType:
        if topic not in self._type_names:
            known = hint(topic, self._type_names)
            raise ConversionError(f"topic {topic} is not in the recording{known}")
        return self._types.get(self._type_names[topic])


class _MissingError(Exception):
    """Raised when a source has no value at a tick."""


class _Source(Generic[T]):
    """Turns the messages of one topic into the values of a table."""

    def __init__(
        self,
        table: Numbers | Images,
        max_age_s: float,
        read: Callable[[bytes], T],
        default: T | None,
    ) -> None:
        self._topic = table.topic
        self._max_age_s = table.max_age_s or max_age_s
        self.max_age_ns = round(self._max_age_s * S_TO_NS)
        self._read = read
        self._default = default
        self._last: tuple[Recorded, T] | None = None  # read once, for many ticks

    def value(self, newest: Newest, tick_ns: int) -> T:
        """Return the value at a tick.

        Raises:
            CodecError: the message cannot be used.
            _MissingError: no value is available.
        """
        message = newest.get(self._topic)
        if message is None or tick_ns - message.time_ns > self.max_age_ns:
            if self._default is not None:
                return self._default
            raise _MissingError(
                f"{self._topic} has no message of the last {self._max_age_s:g} s: raise its"
                " max_age_s, or set a default"
            )
        if self._last is None or self._last[0] is not message:
            try:
                self._last = message, self._read(message.cdr)
            except CodecError as error:
                raise CodecError(
                    f"the newest message of {self._topic} is broken: {error}"
                ) from error
        return self._last[1]


def _newest_at(messages: Iterator[Recorded], ticks: Iterable[int]) -> Iterator[tuple[int, Newest]]:
    """Yield the newest message of each topic at or before each tick."""
    newest: Newest = {}
    message = next(messages, None)
    for tick_ns in ticks:
        while message is not None and message.time_ns <= tick_ns:
            newest[message.track.topic] = message
            message = next(messages, None)
        yield tick_ns, newest


def _number(values: Any, path: str) -> float:
    for name in path.split("."):
        index = _INDEX.search(name)
        values = values[_INDEX.sub("", name)]
        if index is not None:
            try:
                values = values[int(index[1])]
            except (IndexError, TypeError, KeyError) as error:
                raise CodecError(f"{path} is not in it") from error
    try:
        number = float(values)
    except (TypeError, ValueError) as error:
        raise CodecError(f"{path} is not a number") from error
    if not math.isfinite(number):
        raise CodecError(f"{path} is {number}")
    return number


def _pixels(values: dict[str, Any]) -> MatLike:
    """Return BGR of 8 bits. H.264 needs even sides."""
    if "step" in values:
        image = RawImage(
            values["height"],
            values["width"],
            values["encoding"],
            bool(values["is_bigendian"]),
            values["step"],
            values["data"],
        )
    else:
        image = decompress(values["format"], values["data"])
    pixels, layout = pixels_of(image)
    if layout.metres is not None:
        raise CodecError("it shows depth, a dataset needs colours")
    pixels = as_colours(pixels, image, layout, has_8_bits=True)
    if pixels.ndim == 2 or pixels.shape[2] == 1:
        pixels = cv2.cvtColor(pixels, cv2.COLOR_GRAY2BGR)
    height, width = pixels.shape[:2]
    return pixels[: height - height % 2, : width - width % 2, :3]
