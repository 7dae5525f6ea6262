# SPDX-License-Identifier: Apache-2.0
"""The content of the gateway's WebSocket frames, read by other people's code."""

import json
from typing import Any

import cbor2
import numpy as np
from websockets.frames import Frame, Opcode
from websockets.streams import StreamReader

# RFC 8746, 2.1
DTYPES = {
    69: "<u2",
    70: "<u4",
    71: "<u8",
    72: "i1",
    77: "<i2",
    78: "<i4",
    79: "<i8",
    85: "<f4",
    86: "<f8",
}


def websocket_frames(wire: bytes) -> list[Frame]:
    """Read the frames that stand in a row."""
    reader = StreamReader()
    reader.feed_data(wire)
    reader.feed_eof()
    frames = []
    while True:
        parser = Frame.parse(reader.read_exact, mask=False)
        try:
            next(parser)
        except StopIteration as stop:
            frames.append(stop.value)
        except EOFError:
            return frames


def unpacked(wire: bytes) -> list[Any]:
    """Read the JSON and CBOR in the frames that stand in a row."""
    return [
        cbor2.loads(frame.data) if frame.opcode is Opcode.BINARY else json.loads(bytes(frame.data))
        for frame in websocket_frames(wire)
    ]


def untagged(value: Any) -> Any:
    """Turn typed arrays into lists."""
    match value:
        case cbor2.CBORTag():
            return np.frombuffer(value.value, DTYPES[value.tag]).tolist()
        case dict():
            return {key: untagged(item) for key, item in value.items()}
        case list():
            return [untagged(item) for item in value]
    return value
