# SPDX-License-Identifier: Apache-2.0
"""ROS images to pictures; encodings as in sensor_msgs/image_encodings.hpp, depth as in REP 118.

Pixels mean the same as in cv_bridge: 8UC3 and 8UC4 are bgr8 and bgra8, YUV is BT.601 in video
range, 16-bit intensities span the full 16 bits. Everything here may run in any thread; OpenCV
releases the GIL for all of the heavy work.
"""

from dataclasses import dataclass
from typing import Final, Literal, NamedTuple

import cv2
import numpy as np
from cv2.typing import MatLike

from gateway.codec.errors import CodecError
from gateway.codec.picture_formats import PICTURE_FORMATS, PictureFormat

MAX_SIDE_PX: Final = 8192  # the largest sensors that stream; a wrong header states more
MAX_PIXELS: Final = 7680 * 4320  # 8K UHD; as rgba16 265 MB, and as much again while converting

MAX_DEPTH_M: Final = 1000.0  # beyond any depth camera
MIN_DEPTH_RANGE_M: Final = 0.1  # below, float32 at the maximum is coarser than a grey value

_SMALLEST_FLOAT: Final = float(np.finfo(np.float32).tiny)
_LARGEST_FLOAT: Final = float(np.finfo(np.float32).max)


class ImageError(CodecError):
    """An image contradicts itself or cannot be shown; the text gives the reason."""


class RawImage(NamedTuple):
    """The fields of sensor_msgs/msg/Image without its header; *data* is not copied."""

    height: int
    width: int
    encoding: str
    is_bigendian: bool
    step: int  # bytes from one row to the next
    data: bytes | memoryview


@dataclass(frozen=True, slots=True)
class ImageOptions:
    """The options of a picture; equal options give equal pictures.

    ``quality`` applies to lossy formats only, ``depth_range_m`` only to depth in a format of 8
    bits. A bound of ``None`` means that there is no bound.

    Raises:
        ValueError: an option is out of its range.
    """

    format: str = "jpeg"  # a name in `PICTURE_FORMATS`
    quality: int = 80
    max_width: int | None = None
    max_height: int | None = None
    depth_range_m: tuple[float, float] = (0.0, 10.0)

    def __post_init__(self) -> None:
        if self.format not in PICTURE_FORMATS:
            *others, last = PICTURE_FORMATS
            known = f"{', '.join(others)} and {last}"
            raise ValueError(f"unknown picture format {self.format!r}, known are {known}")
        if not 1 <= self.quality <= 100:
            raise ValueError(f"quality is {self.quality}, needs 1 to 100")
        for side, bound in (("max_width", self.max_width), ("max_height", self.max_height)):
            if bound is not None and bound < 1:
                raise ValueError(f"{side} is {bound}, needs at least 1 px")
        near, far = self.depth_range_m
        # written so that NaN is refused, too
        if not (0.0 <= near <= far - MIN_DEPTH_RANGE_M and far <= MAX_DEPTH_M):
            raise ValueError(
                f"depth range is {near} to {far}, needs 0 to {MAX_DEPTH_M:g} m, rising by at least"
                f" {MIN_DEPTH_RANGE_M} m"
            )


class Picture(NamedTuple):
    """A compressed picture.

    ``depth_range_m`` is the range that depth in a format of 8 bits shows, else ``None``: the
    nearest depth is 255, the farthest 1, linear in between, depths outside are clamped, and 0 means
    no measurement. A PNG of depth holds 16-bit millimetres; 0 means no measurement.
    """

    data: bytes
    width: int
    height: int
    format: str
    depth_range_m: tuple[float, float] | None = None


def compress(image: RawImage, options: ImageOptions) -> Picture:
    """Compress one image, scaled down to the options' bounds with its aspect kept.

    JPEG drops alpha and has 8 bits per channel; PNG keeps alpha and 16 bits. Depth is scaled by
    picking measurements, not by averaging them: a mean across an edge is a point in empty space.

    Raises:
        ImageError: the encoding is unknown, or the sizes contradict it or each other.
    """
    picture_format = PICTURE_FORMATS[options.format]
    layout = _layout_of(image)
    _check_sizes(image, layout)
    pixels = _view(image, layout)
    depth_range_m = None
    if layout.metres is not None:
        if picture_format.has_8_bits:
            depth_range_m = options.depth_range_m
            pixels = _shaded(pixels, layout.metres, depth_range_m)
        elif layout.dtype == "f4":
            pixels = _millimetres(pixels)
    else:
        if picture_format.has_8_bits and layout.dtype == "u2":
            pixels = cv2.convertScaleAbs(pixels, alpha=255 / 65535)
        if layout.conversion is not None:
            pixels = cv2.cvtColor(pixels, layout.conversion)
    width, height = size = _fitted(image, options)
    if size != (image.width, image.height):
        pixels = _reduced(pixels, size) if layout.metres is None else _sampled(pixels, size)
    data = _encoded(pixels, picture_format, options.quality)
    return Picture(data, width, height, picture_format.name, depth_range_m)


def confine_to_calling_thread() -> None:
    """Turn OpenCV's own thread pool off, for the whole process.

    Call it once at start-up if worker threads compress the pictures. The pool's threads spin
    between jobs: for VGA they double the CPU time of a frame and save nothing.
    """
    cv2.setNumThreads(1)


@dataclass(frozen=True, slots=True)
class _Layout:
    """The memory layout of an encoding, and OpenCV's conversion of it to grey, BGR or BGRA."""

    dtype: Literal["u1", "u2", "f4"]
    channels: int = 1
    conversion: int | None = None
    subsampling: tuple[int, int] = (1, 1)  # pixels per chroma sample: across, down
    metres: float | None = None  # the unit of a depth image

    @property
    def row_item_bytes(self) -> int:
        """The bytes of one pixel in a row (of the luma plane if chroma has its own)."""
        return self.channels * int(self.dtype[1])

    def rows(self, height: int) -> int:
        """Return the rows in memory: a chroma plane at half height follows the luma plane."""
        return height * 3 // 2 if self.subsampling[1] == 2 else height


# OpenCV's four-letter Bayer names start at the top left pixel, as ROS's do; its older two-letter
# ones start at the second row's second pixel.
_LAYOUTS: Final = {
    "rgb8": _Layout("u1", 3, cv2.COLOR_RGB2BGR),
    "bgr8": _Layout("u1", 3),
    "rgba8": _Layout("u1", 4, cv2.COLOR_RGBA2BGRA),
    "bgra8": _Layout("u1", 4),
    "mono8": _Layout("u1"),
    "rgb16": _Layout("u2", 3, cv2.COLOR_RGB2BGR),
    "bgr16": _Layout("u2", 3),
    "rgba16": _Layout("u2", 4, cv2.COLOR_RGBA2BGRA),
    "bgra16": _Layout("u2", 4),
    "mono16": _Layout("u2"),
    "8UC": _Layout("u1"),
    "8UC1": _Layout("u1"),
    "8UC3": _Layout("u1", 3),
    "8UC4": _Layout("u1", 4),
    "16UC": _Layout("u2", metres=0.001),
    "16UC1": _Layout("u2", metres=0.001),
    "32FC": _Layout("f4", metres=1.0),
    "32FC1": _Layout("f4", metres=1.0),
    "bayer_rggb8": _Layout("u1", 1, cv2.COLOR_BayerRGGB2BGR),
    "bayer_bggr8": _Layout("u1", 1, cv2.COLOR_BayerBGGR2BGR),
    "bayer_gbrg8": _Layout("u1", 1, cv2.COLOR_BayerGBRG2BGR),
    "bayer_grbg8": _Layout("u1", 1, cv2.COLOR_BayerGRBG2BGR),
    "bayer_rggb16": _Layout("u2", 1, cv2.COLOR_BayerRGGB2BGR),
    "bayer_bggr16": _Layout("u2", 1, cv2.COLOR_BayerBGGR2BGR),
    "bayer_gbrg16": _Layout("u2", 1, cv2.COLOR_BayerGBRG2BGR),
    "bayer_grbg16": _Layout("u2", 1, cv2.COLOR_BayerGRBG2BGR),
    "uyvy": _Layout("u1", 2, cv2.COLOR_YUV2BGR_UYVY, (2, 1)),
    "yuv422": _Layout("u1", 2, cv2.COLOR_YUV2BGR_UYVY, (2, 1)),
    "yuyv": _Layout("u1", 2, cv2.COLOR_YUV2BGR_YUYV, (2, 1)),
    "yuv422_yuy2": _Layout("u1", 2, cv2.COLOR_YUV2BGR_YUYV, (2, 1)),
    "nv12": _Layout("u1", 1, cv2.COLOR_YUV2BGR_NV12, (2, 2)),
    "nv21": _Layout("u1", 1, cv2.COLOR_YUV2BGR_NV21, (2, 2)),
}
_LAYOUTS_BY_LOWER_NAME: Final = {name.lower(): layout for name, layout in _LAYOUTS.items()}

ENCODINGS: Final = tuple(_LAYOUTS)  # `compress` takes them in upper or lower case


def _layout_of(image: RawImage) -> _Layout:
    layout = _LAYOUTS_BY_LOWER_NAME.get(image.encoding.lower())
    if layout is None:
        raise ImageError(
            f"unknown image encoding {image.encoding[:32]!r}, known are rgb8, bgr8, mono8, 16UC1,"
            f" 32FC1 and {len(ENCODINGS) - 5} others"
        )
    return layout


def _check_sizes(image: RawImage, layout: _Layout) -> None:
    width, height = image.width, image.height
    if width < 1 or height < 1:
        raise ImageError(f"image is {width}x{height}, needs at least 1x1 px")
    if max(width, height) > MAX_SIDE_PX:
        raise ImageError(f"image is {width}x{height}, at most {MAX_SIDE_PX} px a side")
    if width * height > MAX_PIXELS:
        raise ImageError(f"image is {width}x{height}, at most {MAX_PIXELS} px in all")
    across, down = layout.subsampling
    if width % across or height % down:
        sides = "width" if down == 1 else "width and height"
        raise ImageError(f"{image.encoding} image is {width}x{height}, needs an even {sides}")
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


def _view(image: RawImage, layout: _Layout) -> MatLike:
    """View the data as rows of pixels; copy only what OpenCV cannot read in place."""
    stored = np.dtype(layout.dtype).newbyteorder(">" if image.is_bigendian else "<")
    shape: tuple[int, ...] = (layout.rows(image.height), image.width)
    strides: tuple[int, ...] = (image.step, layout.row_item_bytes)
    if layout.channels > 1:
        shape, strides = (*shape, layout.channels), (*strides, stored.itemsize)
    view: MatLike = np.ndarray(shape, stored, buffer=image.data, strides=strides)
    # a step that is not a multiple of the item, or the other byte order
    return np.require(view, stored.newbyteorder("="), "A")


def _shaded(depth: MatLike, metres: float, range_m: tuple[float, float]) -> MatLike:
    """Map depth to grey: near to 255, far to 1, no measurement to 0."""
    near, far = (bound / metres for bound in range_m)
    gain = -254 / (far - near)
    _, clamped = cv2.threshold(depth, far, 0.0, cv2.THRESH_TRUNC)
    # clamped, nothing is below 1; a depth nearer than near saturates
    grey = cv2.convertScaleAbs(clamped, alpha=gain, beta=1 - gain * far)
    return cv2.copyTo(grey, _measured(depth))


def _millimetres(depth: MatLike) -> MatLike:
    """Turn metres into the 16 bits of 16UC1; greater depths get the largest value."""
    _, clamped = cv2.threshold(depth, 65.535, 0.0, cv2.THRESH_TRUNC)
    millimetres = cv2.addWeighted(clamped, 1000.0, clamped, 0.0, 0.0, dtype=cv2.CV_16U)
    return cv2.copyTo(millimetres, _measured(depth))


def _measured(depth: MatLike) -> MatLike:
    """Return a mask of the positive and finite depths; NaN is in no range."""
    if depth.dtype == np.uint16:
        return cv2.inRange(depth, 1.0, 65535.0)
    return cv2.inRange(depth, _SMALLEST_FLOAT, _LARGEST_FLOAT)


def _fitted(image: RawImage, options: ImageOptions) -> tuple[int, int]:
    scale = min(
        1.0,
        (options.max_width or image.width) / image.width,
        (options.max_height or image.height) / image.height,
    )
    return max(1, round(image.width * scale)), max(1, round(image.height * scale))


def _reduced(pixels: MatLike, size: tuple[int, int]) -> MatLike:
    """Scale down by averaging.

    OpenCV's averaging by a fractional factor takes longer than the JPEG encoder; by a whole
    factor it is fast. So the largest whole factor comes first. The remaining factor is mostly
    below 2: there bilinear interpolation reads every pixel and is five times as fast as averaging.
    """
    height, width = pixels.shape[:2]
    factor = min(width // size[0], height // size[1])
    while width % factor or height % factor:
        factor -= 1
    if factor > 1:
        width, height = width // factor, height // factor
        pixels = cv2.resize(pixels, (width, height), interpolation=cv2.INTER_AREA)
    if (width, height) == size:
        return pixels
    is_near = width < 2 * size[0] and height < 2 * size[1]
    return cv2.resize(pixels, size, interpolation=cv2.INTER_LINEAR if is_near else cv2.INTER_AREA)


def _sampled(depth: MatLike, size: tuple[int, int]) -> MatLike:
    """Scale down by picking pixels."""
    return cv2.resize(depth, size, interpolation=cv2.INTER_NEAREST)


def _encoded(pixels: MatLike, picture_format: PictureFormat, quality: int) -> bytes:
    parameters = picture_format.parameters(quality)
    done, encoded = cv2.imencode(picture_format.extension, pixels, parameters)
    if not done:  # OpenCV gives no reason
        height, width = pixels.shape[:2]
        raise ImageError(f"{picture_format.name} encoder refused a picture of {width}x{height} px")
    return encoded.tobytes()
