# SPDX-License-Identifier: Apache-2.0
"""The encodings of ROS images, as in sensor_msgs/image_encodings.hpp: from memory to colours.

Pixels mean the same as in cv_bridge: 8UC3 and 16UC4 are bgr8 and bgra16, YUV is BT.601 in video
range, 16-bit intensities span the full 16 bits. Numbers that mean no colour and no depth, signed
ones and several floats per pixel, are stretched to 8 bits: the least of a picture is black, the
greatest white. Of two channels the first is blue and the second green.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final, Literal, NamedTuple

import cv2
import numpy as np
from cv2.typing import MatLike

from gateway.codec.error_text import CodecError

MAX_SIDE_PX: Final = 8192  # the largest sensors that stream. A wrong header states more
MAX_PIXELS: Final = 7680 * 4320  # 8K UHD
MAX_BYTES: Final = MAX_PIXELS * 8  # as rgba16, and as much again while converting

_NO_CHROMA: Final = 128  # grey


class ImageError(CodecError):
    """An image contradicts itself or cannot be shown. The text gives the reason."""


class RawImage(NamedTuple):
    """The fields of sensor_msgs/msg/Image without its header. *data* is not copied."""

    height: int
    width: int
    encoding: str
    is_bigendian: bool
    step: int  # bytes from one row to the next
    data: bytes | memoryview


def _bt601(pixels: MatLike) -> MatLike:
    """Convert YUV with a sample of chroma for each pixel, which OpenCV knows in full range only."""
    return cv2.transform(pixels, _BT601_TO_BGR)


# ITU-R BT.601 in video range, for Y from 16 to 235 and U and V from 16 to 240
_BT601_TO_BGR: Final = np.array(
    [
        [1.164383, 2.017232, 0.0, -276.835826],
        [1.164383, -0.391762, -0.812968, 135.575295],
        [1.164383, 0.0, 1.596027, -222.921560],
    ]
)

_Dtype = Literal["u1", "u2", "i1", "i2", "i4", "f4", "f8"]
_Chroma = Literal["none", "packed", "half plane", "full plane"]


@dataclass(frozen=True, slots=True)
class Layout:
    """The memory layout of an encoding, and the conversion of it to grey, BGR or BGRA.

    *chroma* that is packed belongs to two pixels of a row. A plane of it follows that of luma, with
    U and V in turn, for each square of four pixels (half) or for each pixel (full).
    """

    dtype: _Dtype
    channels: int = 1
    conversion: int | Callable[[MatLike], MatLike] | None = None  # a number is OpenCV's
    chroma: _Chroma = "none"
    metres: float | None = None  # the unit of a depth image

    @property
    def row_item_bytes(self) -> int:
        """The bytes of one pixel in a row (of the luma plane if chroma has its own)."""
        return self.channels * int(self.dtype[1])

    @property
    def has_colours(self) -> bool:
        """True if a number is an intensity, with the greatest of its type for the brightest."""
        return self.dtype in {"u1", "u2"}

    def rows(self, height: int) -> int:
        """Return the rows in memory, those of a plane of chroma included."""
        match self.chroma:
            case "half plane":
                return height + (height + 1) // 2
            case "full plane":
                return height * 3
        return height


_ABSTRACT: Final[tuple[tuple[str, _Dtype, float | None], ...]] = (
    # name, type, and the unit of depth of a single channel
    ("8U", "u1", None),
    ("8S", "i1", None),
    ("16U", "u2", 0.001),
    ("16S", "i2", None),
    ("32S", "i4", None),
    ("32F", "f4", 1.0),
    ("64F", "f8", 1.0),
)


def _abstract_layouts() -> Iterator[tuple[str, Layout]]:
    """Yield the encodings by OpenCV's types, as `8UC3`. Without a number there is one channel."""
    for name, dtype, metres in _ABSTRACT:
        yield f"{name}C", Layout(dtype, metres=metres)
        yield f"{name}C1", Layout(dtype, metres=metres)
        for channels in (2, 3, 4):
            yield f"{name}C{channels}", Layout(dtype, channels)


# OpenCV's four-letter Bayer names start at the top left pixel, as ROS's do. Its older two-letter
# ones start at the second row's second pixel.
LAYOUTS: Final = {
    "rgb8": Layout("u1", 3, cv2.COLOR_RGB2BGR),
    "bgr8": Layout("u1", 3),
    "rgba8": Layout("u1", 4, cv2.COLOR_RGBA2BGRA),
    "bgra8": Layout("u1", 4),
    "mono8": Layout("u1"),
    "rgb16": Layout("u2", 3, cv2.COLOR_RGB2BGR),
    "bgr16": Layout("u2", 3),
    "rgba16": Layout("u2", 4, cv2.COLOR_RGBA2BGRA),
    "bgra16": Layout("u2", 4),
    "mono16": Layout("u2"),
    **dict(_abstract_layouts()),
    "bayer_rggb8": Layout("u1", 1, cv2.COLOR_BayerRGGB2BGR),
    "bayer_bggr8": Layout("u1", 1, cv2.COLOR_BayerBGGR2BGR),
    "bayer_gbrg8": Layout("u1", 1, cv2.COLOR_BayerGBRG2BGR),
    "bayer_grbg8": Layout("u1", 1, cv2.COLOR_BayerGRBG2BGR),
    "bayer_rggb16": Layout("u2", 1, cv2.COLOR_BayerRGGB2BGR),
    "bayer_bggr16": Layout("u2", 1, cv2.COLOR_BayerBGGR2BGR),
    "bayer_gbrg16": Layout("u2", 1, cv2.COLOR_BayerGBRG2BGR),
    "bayer_grbg16": Layout("u2", 1, cv2.COLOR_BayerGRBG2BGR),
    "uyvy": Layout("u1", 2, cv2.COLOR_YUV2BGR_UYVY, "packed"),
    "yuv422": Layout("u1", 2, cv2.COLOR_YUV2BGR_UYVY, "packed"),
    "yuyv": Layout("u1", 2, cv2.COLOR_YUV2BGR_YUYV, "packed"),
    "yuv422_yuy2": Layout("u1", 2, cv2.COLOR_YUV2BGR_YUYV, "packed"),
    "nv12": Layout("u1", 1, cv2.COLOR_YUV2BGR_NV12, "half plane"),
    "nv21": Layout("u1", 1, cv2.COLOR_YUV2BGR_NV21, "half plane"),
    "nv24": Layout("u1", 1, _bt601, "full plane"),
}
_LAYOUTS_BY_LOWER_NAME: Final = {name.lower(): layout for name, layout in LAYOUTS.items()}

ENCODINGS: Final = tuple(LAYOUTS)  # `compress` takes them in upper or lower case


def pixels_of(image: RawImage) -> tuple[MatLike, Layout]:
    """Return rows of pixels as they lie in memory, copied only where OpenCV could not read them.

    Raises:
        ImageError: the encoding is unknown, or the sizes contradict it or each other.
    """
    layout = _layout_of(image)
    _check_sizes(image, layout)
    return _view(image, layout), layout


def _layout_of(image: RawImage) -> Layout:
    layout = _LAYOUTS_BY_LOWER_NAME.get(image.encoding.lower())
    if layout is None:
        raise ImageError(
            f"unknown image encoding {image.encoding[:32]!r}, known are rgb8, bgr8, mono8, 16UC1,"
            f" 32FC1 and {len(ENCODINGS) - 5} others"
        )
    return layout


def _check_sizes(image: RawImage, layout: Layout) -> None:
    width, height = image.width, image.height
    if width < 1 or height < 1:
        raise ImageError(f"image is {width}x{height}, needs at least 1x1 px")
    if max(width, height) > MAX_SIDE_PX:
        raise ImageError(f"image is {width}x{height}, at most {MAX_SIDE_PX} px a side")
    if width * height > MAX_PIXELS:
        raise ImageError(f"image is {width}x{height}, at most {MAX_PIXELS} px in all")
    if len(image.data) > MAX_BYTES:
        raise ImageError(f"image has {len(image.data)} bytes, at most {MAX_BYTES} in all")
    row_bytes = width * layout.row_item_bytes
    if image.step < row_bytes:
        raise ImageError(
            f"image step is {image.step}, a row of {width} {image.encoding} pixels has"
            f" {row_bytes} bytes"
        )
    rows = layout.rows(height)
    # refuse both fewer and more, as cv_bridge does
    if len(image.data) != image.step * rows:
        raise ImageError(
            f"image data has {len(image.data)} bytes, {rows} rows of step {image.step} have"
            f" {image.step * rows}"
        )


def _view(image: RawImage, layout: Layout) -> MatLike:
    if layout.chroma == "full plane":
        return _with_full_chroma(image)
    stored = np.dtype(layout.dtype).newbyteorder(">" if image.is_bigendian else "<")
    columns = image.width
    if layout.chroma in {"packed", "half plane"} and image.step >= (
        (columns + 1) * layout.row_item_bytes
    ):
        columns += columns % 2  # the chroma of an odd row's last pixel
    shape: tuple[int, ...] = (layout.rows(image.height), columns)
    strides: tuple[int, ...] = (image.step, layout.row_item_bytes)
    if layout.channels > 1:
        shape, strides = (*shape, layout.channels), (*strides, stored.itemsize)
    pixels: MatLike = np.ndarray(shape, stored, buffer=image.data, strides=strides)
    # a step that is not a multiple of the item, or the other byte order
    return np.require(pixels, stored.newbyteorder("="), "A")


def _with_full_chroma(image: RawImage) -> MatLike:
    """Return Y, U and V of each pixel. A row of chroma takes two steps."""
    size, step = (image.height, image.width), image.step
    luma: MatLike = np.ndarray(size, np.uint8, image.data, strides=(step, 1))
    chroma: MatLike = np.ndarray(
        (*size, 2), np.uint8, image.data, offset=image.height * step, strides=(2 * step, 2, 1)
    )
    return np.dstack([luma, chroma])


def as_colours(pixels: MatLike, image: RawImage, layout: Layout, *, has_8_bits: bool) -> MatLike:
    """Turn pixels that are not depth into grey, BGR or BGRA, of 8 bits if *has_8_bits*."""
    if not layout.has_colours:
        pixels = _stretched(pixels)
    elif has_8_bits and layout.dtype == "u2":
        pixels = cv2.convertScaleAbs(pixels, alpha=255 / 65535)
    if layout.chroma == "packed":
        pixels = _even_packed(pixels)
    elif layout.chroma == "half plane":
        pixels = _even_half_plane(pixels, image.height)
    elif layout.channels == 2:
        pixels = np.dstack([pixels, np.zeros_like(pixels[..., 0])])
    if callable(layout.conversion):
        pixels = layout.conversion(pixels)
    elif layout.conversion is not None:
        pixels = cv2.cvtColor(pixels, layout.conversion)
    return pixels[: image.height, : image.width]


def _stretched(numbers: MatLike) -> MatLike:
    """Map the least to black and the greatest to white. NaN is black."""
    known = numbers[np.isfinite(numbers)]
    if not known.size:
        return np.zeros(numbers.shape, np.uint8)
    least, greatest = float(np.min(known)), float(np.max(known))
    # halves, as the difference of two numbers may be beyond the greatest
    above = numbers / 2 - least / 2
    share = above / ((greatest / 2 - least / 2) or 1.0)
    grey: MatLike = np.rint(np.where(np.isfinite(numbers), share, 0) * 255).astype(np.uint8)
    return grey


def _even_packed(pixels: MatLike) -> MatLike:
    """Complete the last pair of an odd row by the chroma of the one before, or by none."""
    if not pixels.shape[1] % 2:
        return pixels
    last = pixels[:, -2:-1] if pixels.shape[1] > 1 else np.full_like(pixels, _NO_CHROMA)
    return np.hstack([pixels, last])


def _even_half_plane(rows: MatLike, height: int) -> MatLike:
    """Complete odd sides: luma by its last pixels, chroma by the one before, or by none."""
    width = rows.shape[1]
    if not (width % 2 or height % 2):
        return rows
    luma = np.pad(rows[:height], ((0, height % 2), (0, width % 2)), "edge")
    chroma = rows[height:]
    if width % 2:
        last = chroma[:, -2:-1] if width > 1 else np.full_like(chroma, _NO_CHROMA)
        chroma = np.hstack([chroma, last])
    return np.vstack([luma, chroma])
