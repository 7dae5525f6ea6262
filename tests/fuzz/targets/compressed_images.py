# SPDX-License-Identifier: Apache-2.0
"""Bytes that say they are compressed pictures, as nodes send them."""

import struct
from unittest import mock

import cv2
import numpy as np

from gateway.codec import compressed_images
from gateway.codec.compressed_images import decompress
from gateway.codec.image import ImageOptions, compress
from gateway.codec.image_encodings import ImageError
from tests.fuzz.choices import Choices
from tests.fuzz.target import Target, check

MAX_PIXELS = 1 << 16
FORMATS = ("jpeg", "png", "16UC1; compressedDepth png", "32FC1; compressedDepth png", "")


def run(data: bytes) -> None:
    choices = Choices(data)
    format_name = choices.pick(FORMATS)
    options = ImageOptions(choices.pick(("jpeg", "png")), max_width=choices.pick((None, 1, 9)))
    try:
        # a larger picture takes its time, but that of a worker
        with mock.patch.object(compressed_images, "MAX_DECODED_PIXELS", MAX_PIXELS):
            image = decompress(format_name, choices.rest())
        picture = compress(image, options)
    except ImageError as error:
        check(str(error), "refused without words")
        return
    check(image.width * image.height <= MAX_PIXELS, "larger than it may be")
    check(picture.width <= (options.max_width or image.width), "wider than asked for")


def corpus() -> list[bytes]:
    grey = np.arange(60, dtype=np.uint8).reshape(6, 10)
    depth = grey.astype(np.uint16) * 100
    header = struct.pack("<iff", 0, 200.0, -19.0)
    seeds = [
        bytes((first, 0, 2)) + cv2.imencode(extension, pixels)[1].tobytes()
        for extension, first in ((".jpg", 0), (".png", 1))
        for pixels in (grey, cv2.cvtColor(grey, cv2.COLOR_GRAY2BGR))
    ]
    png = cv2.imencode(".png", depth)[1].tobytes()
    seeds += [bytes((number, 1, 1)) + header + png for number in (2, 3)]
    return seeds


TARGET = Target("a compressed picture is read, or refused with words, and never huge", run, corpus)
