# SPDX-License-Identifier: Apache-2.0
"""The encoding that a key asks for: from the CDR of a sample to its message."""

import time
from collections.abc import Callable, Iterator
from typing import Final

from gateway.codec import cbor
from gateway.codec.cdr import Cdr
from gateway.codec.chunks import Chunk
from gateway.codec.errors import CodecError
from gateway.codec.grid_picture import GRID, cbor_grid_renderer
from gateway.codec.json_slices import json_slices
from gateway.codec.nonfinite import writer
from gateway.codec.picture import cbor_picture_renderer
from gateway.codec.png import large_text_as_png, text_as_png
from gateway.codec.types import MessageType
from gateway.core.topics.encoding import Encode, Encoding, WorkerEncoding, to_json
from gateway.core.topics.large_samples import (
    LARGE_ELEMENTS_BYTES,
    LARGE_SAMPLE_BYTES,
    EncodedTopic,
    EncodeInSlices,
    EncodingResources,
    LargeSamples,
)
from gateway.core.topics.subscription import EncodingKey

# Between slices of a worker. A sleep of 0 gives the GIL back, and takes it before others wake up.
PAUSE_S: Final = 0.0001


def make_encoding(
    message_type: MessageType,
    key: EncodingKey,
    topic: EncodedTopic,
    on_error: Callable[[CodecError], None],
    resources: EncodingResources,
) -> Encoding:
    """Return the encoding that a key asks for. *on_error* hears of samples that have no message."""
    if key.fields == ():
        return Encoding(key, nothing_of_it(key), on_error)
    match key.compression:
        case "none":
            encode = to_json(message_type, key)
            in_slices = to_json_slices(message_type, key)
        case "png":
            encode = to_png(message_type, key)
        case "cbor":
            encode = to_cbor(message_type, key)
            in_slices = to_cbor_slices(message_type, key)
        case "cbor-raw":
            encode = to_raw_cbor(topic.now_ns)
            in_slices = to_raw_cbor_slices(topic.now_ns)
    if key.image is None and key.compression != "png":
        large = LargeSamples(in_slices, on_error, topic, resources)
        has_elements = message_type.holds_elements and key.compression != "cbor-raw"
        most_at_once = LARGE_ELEMENTS_BYTES if has_elements else LARGE_SAMPLE_BYTES
        return Encoding(key, encode, on_error, large, most_at_once)
    return WorkerEncoding(
        key,
        encode,
        on_error,
        topic=topic.name,
        on_ready=topic.on_ready,
        workers=resources.workers,
    )


def nothing_of_it(key: EncodingKey) -> Encode:
    """Decode nothing: a client that asks for no fields wants to know that samples come."""
    match key.compression:
        case "none":
            message = b"{}"
        case "png":
            message = text_as_png(b"".join(key.framing.text(key.requested_name, (b"{}",))))
        case "cbor" | "cbor-raw":  # with the latter, fields are refused before
            message = cbor.head(cbor.MAP, 0)
    return lambda _: message


def to_json_slices(message_type: MessageType, key: EncodingKey) -> EncodeInSlices:
    """Return what makes JSON of a large sample."""
    write = writer(key.nonfinite)

    def encode(cdr: Cdr) -> Iterator[Chunk]:
        # compiled when the first large sample has come
        value = yield from message_type.sliced_decoder(key.fields)(cdr, write)
        yield from json_slices(value, write)

    return encode


def to_cbor(message_type: MessageType, key: EncodingKey) -> Encode:
    """Return what makes CBOR of a sample, as `to_json` makes JSON."""
    if key.image is not None and message_type.name == GRID:
        return cbor_grid_renderer(message_type)
    if key.image is not None:
        return cbor_picture_renderer(message_type, key.image)
    return message_type.transcoder(key.fields)


def to_cbor_slices(message_type: MessageType, key: EncodingKey) -> EncodeInSlices:
    """Return what makes CBOR of a large sample."""

    def encode(cdr: Cdr) -> Iterator[Chunk]:
        yield from (yield from message_type.sliced_transcoder(key.fields)(cdr))

    return encode


def to_raw_cbor(now_ns: Callable[[], int]) -> Encode:
    """Return what wraps the CDR of a sample in CBOR."""
    return lambda cdr: b"".join((_up_to_bytes(now_ns(), len(cdr)), cdr))


def to_raw_cbor_slices(now_ns: Callable[[], int]) -> EncodeInSlices:
    """Return what wraps the CDR of a large sample, without copying it."""
    return lambda cdr: iter((_up_to_bytes(now_ns(), len(cdr)), cdr))


def _up_to_bytes(now_ns: int, size: int) -> bytes:
    """Return the message of `cbor-raw` up to its last member, the CDR."""
    secs, nsecs = divmod(now_ns, 1_000_000_000)
    members = {"secs": secs, "nsecs": nsecs}
    items = [cbor.text(name) + cbor.dumps(value) for name, value in members.items()]
    # the map has one member more, and its items just follow each other
    head = cbor.head(cbor.MAP, len(members) + 1)
    return b"".join((head, *items, cbor.text("bytes"), cbor.head(cbor.OCTETS, size)))


def to_png(message_type: MessageType, key: EncodingKey) -> Encode:
    """Return the function for a worker."""
    json_of = to_json(message_type, key)
    text, topic = key.framing.text, key.requested_name

    def encode(cdr: Cdr) -> bytes:
        return text_as_png(b"".join(text(topic, (json_of(cdr),))))

    if key.image is not None or not message_type.may_be_large:
        return encode
    decode = message_type.sliced_decoder(key.fields)  # now: it is not compiled in a worker
    write = writer(key.nonfinite)

    def message(cdr: Cdr) -> Iterator[bytes]:
        value = yield from decode(cdr, write)
        yield from map(bytes, json_slices(value, write))

    def encode_any(cdr: Cdr) -> bytes:
        if len(cdr) <= LARGE_SAMPLE_BYTES:
            return encode(cdr)
        return large_text_as_png(text(topic, message(cdr)), _let_others_run)

    return encode_any


def _let_others_run() -> None:
    """Give the GIL to the event loop, which else waits for 5 ms (`sys.getswitchinterval`)."""
    time.sleep(PAUSE_S)
