# SPDX-License-Identifier: Apache-2.0
"""The functions by which samples of a topic become messages, and where each of them runs."""

import time
from collections.abc import Callable, Iterator
from typing import Final

from gateway.codec import cbor
from gateway.codec.cdr import Cdr
from gateway.codec.chunks import Chunk
from gateway.codec.error_text import CodecError
from gateway.codec.json_slices import json_slices
from gateway.codec.nonfinite import writer
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
    framing = key.framing
    if key.fields == ():
        return Encoding(key, _nothing_of_it(key), on_error)
    compact = key.image or key.cloud
    if compact is not None:
        shared = topic.pictures.open(message_type, compact)
        to_picture = shared.encoder(framing.picture)
        encode = _packed(key, to_picture) if framing.is_packed else to_picture
        return WorkerEncoding(key, encode, on_error, topic, resources.workers, shared.close)
    if framing.is_packed:
        encode = _to_packed_json(message_type, key)
        return WorkerEncoding(key, encode, on_error, topic, resources.workers)
    match framing.content:
        case "json":
            encode = to_json(message_type, key)
            in_slices = to_json_slices(message_type, key)
        case "cbor":
            encode = message_type.transcoder(key.fields)
            in_slices = _to_cbor_slices(message_type, key)
        case "cdr":
            encode, in_slices = _to_cdr(key, topic.now_ns)
    large = LargeSamples(in_slices, on_error, topic, resources)
    has_elements = message_type.holds_elements and framing.content != "cdr"
    most_at_once = LARGE_ELEMENTS_BYTES if has_elements else LARGE_SAMPLE_BYTES
    return Encoding(key, encode, on_error, large, most_at_once)


def _nothing_of_it(key: EncodingKey) -> Encode:
    """Decode nothing: a client that asks for no fields wants to know that samples come."""
    message = b"{}" if key.framing.content == "json" else cbor.head(cbor.MAP, 0)
    if key.framing.is_packed:
        message = key.framing.pack(key.requested_name, (message,))
    return lambda _: message


def to_json_slices(message_type: MessageType, key: EncodingKey) -> EncodeInSlices:
    """Return what makes JSON of a large sample."""
    write = writer(key.nonfinite)

    def encode(cdr: Cdr) -> Iterator[Chunk]:
        # compiled when the first large sample has come
        value = yield from message_type.sliced_decoder(key.fields)(cdr, write)
        yield from json_slices(value, write)

    return encode


def _to_cbor_slices(message_type: MessageType, key: EncodingKey) -> EncodeInSlices:
    def encode(cdr: Cdr) -> Iterator[Chunk]:
        yield from (yield from message_type.sliced_transcoder(key.fields)(cdr))

    return encode


def _to_cdr(key: EncodingKey, now_ns: Callable[[], int]) -> tuple[Encode, EncodeInSlices]:
    head = key.framing.before_cdr
    return (
        lambda cdr: b"".join((head(now_ns(), len(cdr)), cdr)),
        lambda cdr: iter((head(now_ns(), len(cdr)), cdr)),
    )


def _packed(key: EncodingKey, encode: Encode) -> Encode:
    return lambda cdr: key.framing.pack(key.requested_name, (encode(cdr),))


def _to_packed_json(message_type: MessageType, key: EncodingKey) -> Encode:
    """Return the function for a worker."""
    encode = _packed(key, to_json(message_type, key))
    if not message_type.may_be_large:
        return encode
    decode = message_type.sliced_decoder(key.fields)  # now: it is not compiled in a worker
    write = writer(key.nonfinite)

    def message(cdr: Cdr) -> Iterator[bytes]:
        value = yield from decode(cdr, write)
        yield from map(bytes, json_slices(value, write))

    def encode_any(cdr: Cdr) -> bytes:
        if len(cdr) <= LARGE_SAMPLE_BYTES:
            return encode(cdr)
        return key.framing.pack(key.requested_name, message(cdr), _let_others_run)

    return encode_any


def _let_others_run() -> None:
    """Give the GIL to the event loop, which else waits for 5 ms (`sys.getswitchinterval`)."""
    time.sleep(PAUSE_S)
