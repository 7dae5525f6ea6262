# SPDX-License-Identifier: Apache-2.0
"""Images whose header says anything, as pictures, and texts in pictures, and CBOR."""

from typing import Any

import cbor2
import cv2
import numpy as np
import pybase64

from gateway.codec import cbor
from gateway.codec.error_text import CodecError
from gateway.codec.image import ImageOptions
from gateway.codec.image_encodings import ENCODINGS
from gateway.codec.json import loads
from gateway.codec.picture import picture_renderer
from gateway.codec.png import text_as_png
from tests.fuzz import types
from tests.fuzz.choices import Choices
from tests.fuzz.target import Target, check

IMAGE = "sensor_msgs/msg/Image"
SIDES = (1, 2, 3, 4, 5, 7, 8, 16, 31, 0, 8192, 8193, 2**31, 2**32 - 1)
BOUNDS = (None, 1, 2, 5, 8192)


def run(data: bytes) -> None:
    choices = Choices(data)
    match choices.byte() % 4:
        case 0 | 1:
            show(choices)
        case 2:
            carry_text(choices.rest())
        case 3:
            write_cbor(choices)


def show(choices: Choices) -> None:
    options = ImageOptions(
        format=choices.pick(("jpeg", "png")),
        quality=1 + choices.below(100),
        max_width=choices.pick(BOUNDS),
        max_height=choices.pick(BOUNDS),
        depth_range_m=choices.pick(((0.0, 10.0), (0.0, 0.1), (999.9, 1000.0))),
    )
    is_json = choices.pick((True, False))
    cdr = an_image(choices)
    try:
        picture = picture_renderer(types.types().get(IMAGE), options)(cdr)
    except CodecError as error:
        check(str(error), "refused without words")
        return
    message: Any
    if is_json:
        message = loads(picture.json())
        pixels = pybase64.b64decode(message["data"], validate=True)
    else:
        message = cbor2.loads(picture.cbor())
        pixels = message["data"]
    shown = cv2.imdecode(np.frombuffer(pixels, np.uint8), cv2.IMREAD_UNCHANGED)
    check(shown is not None, "is no picture")
    check(shown.shape[:2] == (message["height"], message["width"]), "has another size")
    check(message["width"] <= (options.max_width or 8192))
    check(message["height"] <= (options.max_height or 8192))


def an_image(choices: Choices) -> bytes:
    """Return an image, right except for what is decided otherwise, or any bytes."""
    if choices.happens(16):
        return b"\0\1\0\0" + choices.rest()
    encoding = choices.pick(ENCODINGS)
    if choices.happens(16):
        encoding = choices.text().replace("\0", "")
    width, height = choices.pick(SIDES), choices.pick(SIDES)
    item = {"1": 2, "3": 4}.get(encoding[-2:-1] if "16" in encoding or "32" in encoding else "", 1)
    step = choices.pick(SIDES) if choices.happens(32) else width * item * choices.pick((4, 3, 2, 1))
    size = step * height * choices.pick((1, 1, 3)) // choices.pick((1, 1, 2))
    size = choices.below(300) if choices.happens(16) or size > 20_000 else size
    is_big = choices.happens(32)
    pattern = choices.rest() or b"\0"
    pixels = (pattern * (size // len(pattern) + 1))[:size]
    image = types.types().get(IMAGE)
    values: dict[str, object] = {
        "height": height,
        "width": width,
        "encoding": encoding,
        "is_bigendian": int(is_big),
        "step": step % 2**32,
        "data": pixels,
    }
    return image.encode(values, 0)


def carry_text(text: bytes) -> None:
    """Read the text from the pixels, as rosbridge's clients do."""
    text = b"{" + bytes(octet & 127 for octet in text)  # a frame is never empty
    png = pybase64.b64decode(text_as_png(text), validate=True)
    pixels = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR)
    read = cv2.cvtColor(pixels, cv2.COLOR_BGR2RGB).tobytes()
    check(read.startswith(text), "another text")
    check(not read[len(text) :].strip(b"\n"), "padded with something else")


def write_cbor(choices: Choices) -> None:
    value = a_value(choices, 0)
    read = cbor2.loads(cbor.dumps(value))
    check(repr(read) == repr(value), "another value")  # NaN equals nothing


def a_value(choices: Choices, depth: int) -> Any:
    match choices.byte() % (7 if depth < 5 else 5):
        case 0:
            return choices.integer() % 2**64
        case 1:
            return choices.number()
        case 2:
            return choices.text()
        case 3:
            return choices.happens(128)
        case 4:
            return choices.octets()
        case 5:
            return {choices.text(): a_value(choices, depth + 1) for _ in range(choices.below(4))}
    return [a_value(choices, depth + 1) for _ in range(choices.below(30))]


def corpus() -> list[bytes]:
    plain = b"\x00" + bytes((0, 80, 0, 0, 0, 0, 0))
    return [
        *(
            plain + bytes((0, number, 0, 7, 6, 0, channels, 0, 0, 0, 0)) + b"\x10\x80\xf0"
            for number in range(len(ENCODINGS))
            for channels in (1, 3)
        ),
        b'\x02{"op":"publish","topic":"/odom","msg":{"x":1.5}}',
        b"\x02",
        b"\x03\x05\x03\x01a\x01\x00\x00\x00\x00\x00\x00\xf0\x3f\x01b\x06\x05\x00\x02\x03",
    ]


TARGET = Target("an image becomes a picture of its size, or is refused with words", run, corpus)
