# SPDX-License-Identifier: Apache-2.0
import json
import struct
from typing import Any

import cv2
import numpy as np
import pybase64
import pytest

from gateway.codec.compressed_images import decompress
from gateway.codec.error_text import CodecError
from gateway.codec.image import ImageOptions
from gateway.codec.image_encodings import ImageError
from gateway.codec.picture import picture_renderer
from gateway.codec.types import Types
from schemas.installed import InstalledDefinitions

COMPRESSED = Types(InstalledDefinitions()).get("sensor_msgs/msg/CompressedImage")
END = struct.pack(">I4s4x", 0, b"IEND")  # the last chunk of a PNG
DEPTH_HEADER = struct.Struct("<iff")


def coded(pixels: Any, extension: str = ".png") -> bytes:
    done, data = cv2.imencode(extension, pixels)
    assert done
    return data.tobytes()


def rendered(options: ImageOptions, **values: Any) -> dict[str, Any]:
    cdr = COMPRESSED.encode(values, 0)
    return json.loads(picture_renderer(COMPRESSED, options)(cdr).json())


def shown(message: dict[str, Any]) -> Any:
    data = np.frombuffer(pybase64.b64decode(message["data"]), np.uint8)
    return cv2.imdecode(data, cv2.IMREAD_UNCHANGED)


def colours(dtype: Any = np.uint8, channels: int = 3) -> Any:
    pixels = np.zeros((40, 60, channels), dtype)
    pixels[:, :30, 0] = np.iinfo(dtype).max
    return pixels if channels > 1 else pixels[:, :, 0]


@pytest.mark.parametrize("extension", [".jpg", ".png"])
@pytest.mark.parametrize("picture_format", ["jpeg", "png"])
def test_a_picture_is_scaled_and_encoded_again(extension, picture_format):
    options = ImageOptions(picture_format, max_width=30)
    message = rendered(
        options, format="bgr8; jpeg compressed bgr8", data=coded(colours(), extension)
    )
    assert (message["format"], message["width"], message["height"]) == (picture_format, 30, 20)
    left, right = shown(message)[10, 5], shown(message)[10, 25]
    assert np.abs(left.astype(int) - [255, 0, 0]).max() < 12
    assert np.abs(right.astype(int)).max() < 12


@pytest.mark.parametrize(
    ("dtype", "channels", "encoding"),
    [
        (np.uint8, 1, "mono8"),
        (np.uint8, 3, "bgr8"),
        (np.uint8, 4, "bgra8"),
        (np.uint16, 1, "mono16"),
        (np.uint16, 3, "bgr16"),
        (np.uint16, 4, "bgra16"),
    ],
)
def test_the_pixels_of_a_png_are_those_that_it_was_made_of(dtype, channels, encoding):
    pixels = colours(dtype, channels)
    image = decompress("png", coded(pixels))
    assert (image.encoding, image.width, image.height) == (encoding, 60, 40)
    assert bytes(image.data) == pixels.tobytes()
    assert image.step == 60 * channels * pixels.itemsize


def test_compressed_depth_comes_in_millimetres_and_as_grey():
    depth = np.full((4, 6), 2000, np.uint16)
    depth[0] = 0
    values = {
        "format": "16UC1; compressedDepth png",
        "data": DEPTH_HEADER.pack(0, 0.0, 0.0) + coded(depth),
    }
    message = rendered(ImageOptions("png"), **values)
    assert np.array_equal(shown(message), depth)
    grey = rendered(ImageOptions(depth_range_m=(0.0, 4.0)), **values)
    assert grey["depth_range_m"] == [0.0, 4.0]
    assert shown(grey)[3, 3] == pytest.approx(128, abs=3)


def test_compressed_depth_of_floats_is_the_inverse_of_the_distance():
    metres = np.linspace(0.5, 10, 24, dtype=np.float32).reshape(4, 6)
    a, b = np.float32(200.0), np.float32(-19.0)
    inverse = np.round(a / metres + b).astype(np.uint16)
    inverse[0, 0] = 0  # no measurement
    data = DEPTH_HEADER.pack(0, a, b) + coded(inverse)
    image = decompress("32FC1; compressedDepth png", data)
    found = np.frombuffer(image.data, np.float32).reshape(4, 6)
    assert np.isnan(found[0, 0])
    assert found[1:] == pytest.approx(metres[1:], rel=0.03)


@pytest.mark.parametrize(
    ("format_name", "data", "words"),
    [
        ("jpeg", b"", "neither JPEG nor PNG"),
        ("tiff", b"II*\0" + bytes(100), "neither JPEG nor PNG"),
        ("jpeg", b"\xff\xd8", "ends in its header"),
        ("jpeg", b"\xff\xd8\xff", "ends in its header"),
        ("jpeg", b"\xff\xd8\xff\xe0\0\4\1\2\7\7", "header of the JPEG is broken"),
        ("jpeg", coded(colours(), ".jpg")[:150], "ends in its header"),
        ("jpeg", b"\xff\xd8" + b"\xff\xe0\0\2" * 1025, "no frame within 1024 segm"),
        ("jpeg", b"\xff\xd8" + b"\xff" * 1026, "no frame within 1024 segments"),
        ("png", b"\x89PNG\r\n\x1a\n" + bytes(4), "ends in its header"),
        ("png", b"\x89PNG\r\n\x1a\n\0\0\0\4aaAa" + bytes(99), "header of the PNG is broken"),
        ("png", coded(colours())[:60], "a chunk of the PNG is longer than its file"),
        ("png", coded(colours())[:33] + END, "the picture is broken"),
        (
            "png",
            coded(colours())[:33] + struct.pack(">I4s", 2**31, b"IDAT") + END,
            "a chunk of the PNG is longer than its file",
        ),
        ("png", coded(colours()) + b"\0", "something behind its end"),
        ("png", coded(colours())[:33] + struct.pack(">I4s5x", 1, b"IEND"), "behind its end"),
        (
            "png",
            coded(colours())[:33] + struct.pack(">I4s4x", 0, b"tEXt") * 2**14 + END,
            "the PNG has over 16384 chunks",
        ),
        ("png", coded(colours())[:16] + bytes(4) + coded(colours())[20:], "a picture of 0x40 px"),
        ("16UC1; compressedDepth png", b"\0" * 8, "of 8 bytes, its header alone has 12"),
        ("16UC1; compressedDepth rvl", b"\0" * 40, "rvl', of compressedDepth only png is known"),
        ("16UC1; compressedDepth png", bytes(12) + coded(colours()), "one channel of 16 bits"),
    ],
)
def test_an_invalid_picture_is_refused_with_the_reason(format_name, data, words):
    with pytest.raises(ImageError, match=words):
        decompress(format_name, data)


@pytest.mark.parametrize("size", [(8193, 1), (1, 8193), (4096, 3073), (2**31, 2**31)])
def test_a_small_file_that_states_a_huge_picture_is_not_decoded(size):
    header = b"\x89PNG\r\n\x1a\n" + struct.pack(">I4sII9x", 13, b"IHDR", *size)
    header += END
    with pytest.raises(
        ImageError,
        match=f"a picture of {size[0]}x{size[1]} px is too large to encode again: at most 8192",
    ):
        decompress("png", header)
    if max(size) < 2**16:
        jpeg = b"\xff\xd8\xff\xff\xc0" + struct.pack(">HBHH", 17, 8, size[1], size[0])
        with pytest.raises(ImageError, match="at most 8192"):
            decompress("jpeg", jpeg + bytes(100))


@pytest.mark.parametrize(
    "marker", [b"\xff\0", b"\xff\1", *(bytes([0xFF, rst]) for rst in range(0xD0, 0xD8))]
)
def test_a_huge_picture_does_not_hide_behind_a_marker_without_a_length(marker):
    jpeg = coded(colours(), ".jpg")
    at = jpeg.find(b"\xff\xc0")
    small = jpeg[at : at + 2 + int.from_bytes(jpeg[at + 2 : at + 4], "big")]
    huge = small[:5] + struct.pack(">HH", 8200, 80) + small[9:]
    # Read as a length, the marker of the frame that the decoder uses leads into this comment.
    filling = bytes(0xFFC0 - len(huge) - 4) + small
    comment = b"\xff\xfe" + struct.pack(">H", 2 + len(filling)) + filling
    hidden = b"\xff\xd8" + marker + huge + comment + jpeg[2:at] + jpeg[at + len(small) :]
    assert cv2.imdecode(np.frombuffer(hidden, np.uint8), cv2.IMREAD_UNCHANGED).shape[0] == 8200
    with pytest.raises(ImageError, match="the header of the JPEG is broken"):
        decompress("jpeg", hidden)


@pytest.mark.parametrize("marker", [0x00, 0x01, 0xD0, 0xD7, 0xD8, 0xD9])
def test_a_jpeg_states_one_size_to_us_and_to_its_decoder(marker: int):
    # libjpeg reads on behind this marker. As one of a segment, it would hide the frame from us
    jpeg = b"\xff\xd8\xff" + bytes((marker,)) + coded(colours(), ".jpg")[2:]
    (hidden,) = struct.unpack_from(">H", jpeg, 4)
    frame = b"\xff\xc0" + struct.pack(">HBHH", 17, 8, 8, 8)
    with pytest.raises(ImageError, match="header of the JPEG is broken"):
        decompress("jpeg", jpeg.ljust(4 + hidden, b"\0") + frame)


def test_a_broken_picture_raises_codec_error():
    with pytest.raises(CodecError):
        rendered(ImageOptions(), format="jpeg", data=b"no picture")
