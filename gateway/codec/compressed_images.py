# SPDX-License-Identifier: Apache-2.0
"""Pixels of a sensor_msgs/msg/CompressedImage, depth of compressed_depth_image_transport included.

Everything here may run in any thread. OpenCV releases the GIL for the heavy work.
"""

import struct
from typing import Final

import cv2
import numpy as np
from cv2.typing import MatLike

from gateway.codec.error_text import truncate
from gateway.codec.image_encodings import MAX_SIDE_PX, ImageError, RawImage

# 12 megapixels: of 16-bit RGBA 100 MB, and half a second of a worker. A small file may state more.
MAX_DECODED_PIXELS: Final = 4096 * 3072

_PNG: Final = b"\x89PNG\r\n\x1a\n"
_JPEG: Final = b"\xff\xd8"
# the name of the first chunk, width, height, bits of a sample, type of colour
_PNG_SIZE: Final = struct.Struct(">12x4sIIBB")
_PNG_CHANNELS: Final = {0: 1, 2: 3, 3: 3, 4: 4, 6: 4}  # as decoded, by type of colour
_PNG_CHUNK: Final = struct.Struct(">I4s")
_PNG_CHECKSUM_BYTES: Final = 4
MAX_CHUNKS: Final = 1 << 14  # as many of 8 KiB, which is usual, are 128 MiB
# length of the segment, bits per channel, height, width, components
_JPEG_FRAME: Final = struct.Struct(">HBHHB")
_JPEG_LENGTH: Final = struct.Struct(">H")
# markers that begin a frame, without those of tables: Huffman, a reserved one, arithmetic coding
_FRAME_MARKERS: Final = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
# Markers of segments with a length that may stand before the frame. These are tables of Huffman,
# arithmetic coding and quantization, a number of lines, a restart interval, APP0 to APP15, a
# comment.
_SEGMENT_MARKERS: Final = frozenset({0xC4, 0xCC, 0xDB, 0xDC, 0xDD, *range(0xE0, 0xF0), 0xFE})
# Before the frame, bytes of padding included. A colour profile and EXIF take some dozens. A file of
# 10 MB could have millions, and a second of the worker's time would go to its header.
MAX_SEGMENTS: Final = 1024
# compressed_depth_image_transport: a number of the codec, then two of the quantization
_DEPTH_HEADER: Final = struct.Struct("<iff")
_ENCODINGS: Final = {
    ("u1", 1): "mono8",
    ("u1", 3): "bgr8",
    ("u1", 4): "bgra8",
    ("u2", 1): "mono16",
    ("u2", 3): "bgr16",
    ("u2", 4): "bgra16",
}


def decompress(
    format_name: str, data: bytes | memoryview, max_bytes: int | None = None
) -> RawImage:
    """Return the pixels of a JPEG or PNG, as it says itself which of them it is.

    *format_name* is that of the message. With ``compressedDepth`` in it, *data* is 16-bit depth
    behind a header, as compressed_depth_image_transport has it. Values are millimetres, or for
    ``32FC1`` the inverse of the distance, and 0 means no measurement. With *max_bytes*, a picture
    of more bytes of pixels is refused before it is decoded.

    Raises:
        ImageError: it is neither, too large, or broken.
    """
    if "compressedDepth" in format_name:
        return _depth(format_name, data, max_bytes)
    pixels = _decoded(data, max_bytes)
    channels = 1 if pixels.ndim == 2 else pixels.shape[2]
    encoding = _ENCODINGS.get((pixels.dtype.str[1:], channels))
    if encoding is None:
        raise ImageError(f"a picture of {channels} channels of {pixels.dtype}, expected 1, 3 or 4")
    return _raw(pixels, encoding)


def _depth(format_name: str, data: bytes | memoryview, max_bytes: int | None) -> RawImage:
    if len(data) < _DEPTH_HEADER.size:
        raise ImageError(f"compressedDepth of {len(data)} bytes, its header alone has 12")
    _, a, b = _DEPTH_HEADER.unpack_from(data)
    coded = memoryview(data)[_DEPTH_HEADER.size :]
    if bytes(coded[: len(_PNG)]) != _PNG:
        raise ImageError(
            f"format is {truncate(format_name)!r}, of compressedDepth only png is known"
        )
    is_inverse = format_name.startswith("32FC1")  # and becomes twice as large
    pixels = _decoded(coded, max_bytes // 2 if max_bytes and is_inverse else max_bytes)
    if pixels.ndim != 2 or pixels.dtype != np.uint16:
        raise ImageError("compressedDepth holds no picture of one channel of 16 bits")
    if not is_inverse:
        return _raw(pixels, "16UC1")
    with np.errstate(all="ignore"):
        metres = np.float32(a) / (pixels.astype(np.float32) - np.float32(b))
    metres[pixels == 0] = np.nan
    return _raw(metres, "32FC1")


def _decoded(data: bytes | memoryview, max_bytes: int | None) -> MatLike:
    width, height, pixel_bytes = _stated_size(data)
    if not (width and height):  # libpng writes to the log about it, for each picture
        raise ImageError(f"a picture of {width}x{height} px")
    if max(width, height) > MAX_SIDE_PX or width * height > MAX_DECODED_PIXELS:
        raise ImageError(
            f"a picture of {width}x{height} px is too large to encode again: at most {MAX_SIDE_PX}"
            f" px a side and {MAX_DECODED_PIXELS} px in all"
        )
    if max_bytes is not None and width * height * pixel_bytes > max_bytes:
        raise ImageError(
            f"a picture of {width}x{height} px has {width * height * pixel_bytes} bytes of pixels,"
            f" at most {max_bytes} go into a message"
        )
    try:
        pixels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error as error:
        raise ImageError(f"the picture is broken: {error.err}") from error
    if pixels is None:  # OpenCV gives no reason
        raise ImageError("the picture is broken")
    return pixels


def _stated_size(data: bytes | memoryview) -> tuple[int, int, int]:
    """Return width, height and bytes per pixel by the header alone.

    A small file may state a huge picture.
    """
    start = bytes(data[: len(_PNG)])
    try:
        if start == _PNG:
            return _png_size(data)
        if start.startswith(_JPEG):
            return _jpeg_size(data)
    except (struct.error, IndexError) as error:
        raise ImageError("the picture ends in its header") from error
    raise ImageError("data is neither JPEG nor PNG")


def _png_size(data: bytes | memoryview) -> tuple[int, int, int]:
    chunk, width, height, bits, colour = _PNG_SIZE.unpack_from(data)
    if chunk != b"IHDR":
        raise ImageError("the header of the PNG is broken")
    at = len(_PNG)
    for _ in range(MAX_CHUNKS):
        length, kind = _PNG_CHUNK.unpack_from(data, at)
        at += _PNG_CHUNK.size + length + _PNG_CHECKSUM_BYTES
        # OpenCV takes as much memory as a chunk states, up to 4 GB, before it looks for its bytes
        if at > len(data):
            raise ImageError("a chunk of the PNG is longer than its file")
        if kind == b"IEND":
            if length or at != len(data):  # it reads on behind what is not quite the end
                raise ImageError("the PNG has something behind its end")
            return width, height, _PNG_CHANNELS.get(colour, 4) * (2 if bits > 8 else 1)
    raise ImageError(f"the PNG has over {MAX_CHUNKS} chunks")


def _jpeg_size(data: bytes | memoryview) -> tuple[int, int, int]:
    at = len(_JPEG)
    for _ in range(MAX_SEGMENTS):
        marker = data[at + 1]
        if data[at] == marker == 0xFF:  # padding
            at += 1
        elif data[at] == 0xFF and marker in _FRAME_MARKERS:
            _, _, height, width, components = _JPEG_FRAME.unpack_from(data, at + 2)
            return width, height, 1 if components == 1 else 3
        elif data[at] == 0xFF and marker in _SEGMENT_MARKERS:
            (length,) = _JPEG_LENGTH.unpack_from(data, at + 2)
            at += 2 + length
        else:
            # The decoder passes over markers without a length (stuffing, TEM, RST) and finds
            # another frame than who skips a length there.
            raise ImageError("the header of the JPEG is broken")
    raise ImageError(f"the JPEG has no frame within {MAX_SEGMENTS} segments")


def _raw(pixels: MatLike, encoding: str) -> RawImage:
    height, width = pixels.shape[:2]
    rows = np.ascontiguousarray(pixels)
    return RawImage(height, width, encoding, False, rows.strides[0], rows.data.cast("B"))
