# SPDX-License-Identifier: Apache-2.0
"""ROS images to pictures. Depth as in REP 118.

Everything here may run in any thread. OpenCV releases the GIL for all of the heavy work.
"""

from dataclasses import dataclass
from typing import Final, NamedTuple

import cv2
import numpy as np
from cv2.typing import MatLike

from gateway.codec.image_encodings import ImageError, RawImage, as_colours, pixels_of
from gateway.codec.picture_formats import PICTURE_FORMATS, PictureFormat

MAX_DEPTH_M: Final = 1000.0  # beyond any depth camera
MIN_DEPTH_RANGE_M: Final = 0.1  # below, float32 at the maximum is coarser than a grey value

_SMALLEST_FLOAT: Final = float(np.finfo(np.float32).tiny)
_LARGEST_FLOAT: Final = float(np.finfo(np.float32).max)


@dataclass(frozen=True, slots=True)
class ImageOptions:
    """The options of a picture. Equal options give equal pictures.

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
    reduction: int = 1  # within these bounds, one pixel stands for so many in each direction

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
        # written so that NaN is also refused
        if not (0.0 <= near <= far - MIN_DEPTH_RANGE_M and far <= MAX_DEPTH_M):
            raise ValueError(
                f"depth range is {near} to {far}, needs 0 to {MAX_DEPTH_M:g} m, rising by at least"
                f" {MIN_DEPTH_RANGE_M} m"
            )


class Picture(NamedTuple):
    """A compressed picture.

    ``depth_range_m`` is the range that depth in a format of 8 bits shows, else ``None``. The
    nearest depth is 255, the farthest 1, linear in between. Depths outside are clamped, and 0 means
    no measurement. A PNG of depth holds 16-bit millimetres. 0 means no measurement.
    """

    data: bytes
    width: int
    height: int
    format: str
    depth_range_m: tuple[float, float] | None = None


def compress(image: RawImage, options: ImageOptions) -> Picture:
    """Compress one image, scaled down to the options' bounds with its aspect kept.

    JPEG drops alpha and has 8 bits per channel. PNG keeps alpha and 16 bits. Depth is scaled by
    picking measurements, not by averaging them: a mean across an edge is a point in empty space.

    Raises:
        ImageError: the encoding is unknown, or the sizes contradict it or each other.
    """
    picture_format = PICTURE_FORMATS[options.format]
    pixels, layout = pixels_of(image)
    depth_range_m = None
    if layout.metres is not None:
        if layout.dtype == "f8":
            with np.errstate(over="ignore"):  # infinite, and no measurement
                pixels = pixels.astype(np.float32)
        if picture_format.has_8_bits:
            depth_range_m = options.depth_range_m
            pixels = _shaded(pixels, layout.metres, depth_range_m)
        elif pixels.dtype == np.float32:
            pixels = _millimetres(pixels)
    else:
        pixels = as_colours(pixels, image, layout, has_8_bits=picture_format.has_8_bits)
    width, height = size = _fitted(image, options)
    if size != (image.width, image.height):
        if layout.metres is None:
            pixels = _reduced(pixels, size)
        else:  # by picking pixels
            pixels = cv2.resize(pixels, size, interpolation=cv2.INTER_NEAREST)
    data = _encoded(pixels, picture_format, options.quality)
    return Picture(data, width, height, picture_format.name, depth_range_m)


def confine_to_calling_thread() -> None:
    """Turn OpenCV's own thread pool off, for the whole process.

    Call it once at start-up if worker threads compress the pictures. The pool's threads spin
    between jobs: for VGA they double the CPU time of a frame and save nothing.
    """
    cv2.setNumThreads(1)


def _shaded(depth: MatLike, metres: float, range_m: tuple[float, float]) -> MatLike:
    """Map depth to grey: near to 255, far to 1, no measurement to 0."""
    near, far = (bound / metres for bound in range_m)
    gain = -254 / (far - near)
    _, clamped = cv2.threshold(depth, far, 0.0, cv2.THRESH_TRUNC)
    # clamped, nothing is below 1. A depth nearer than near saturates
    grey = cv2.convertScaleAbs(clamped, alpha=gain, beta=1 - gain * far)
    return cv2.copyTo(grey, _measured(depth))


def _millimetres(depth: MatLike) -> MatLike:
    """Turn metres into the 16 bits of 16UC1. Greater depths get the largest value."""
    _, clamped = cv2.threshold(depth, 65.535, 0.0, cv2.THRESH_TRUNC)
    millimetres = cv2.addWeighted(clamped, 1000.0, clamped, 0.0, 0.0, dtype=cv2.CV_16U)
    return cv2.copyTo(millimetres, _measured(depth))


def _measured(depth: MatLike) -> MatLike:
    """Return a mask of the positive and finite depths. NaN is in no range."""
    if depth.dtype == np.uint16:
        return cv2.inRange(depth, 1.0, 65535.0)
    return cv2.inRange(depth, _SMALLEST_FLOAT, _LARGEST_FLOAT)


def _fitted(image: RawImage, options: ImageOptions) -> tuple[int, int]:
    scale = min(
        1.0,
        (options.max_width or image.width) / image.width,
        (options.max_height or image.height) / image.height,
    )
    scale /= options.reduction
    return max(1, round(image.width * scale)), max(1, round(image.height * scale))


def _reduced(pixels: MatLike, size: tuple[int, int]) -> MatLike:
    """Scale down by averaging.

    OpenCV's averaging by a fractional factor takes longer than the JPEG encoder. By a whole
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


def _encoded(pixels: MatLike, picture_format: PictureFormat, quality: int) -> bytes:
    parameters = picture_format.parameters(quality)
    done, encoded = cv2.imencode(picture_format.extension, pixels, parameters)
    if not done:  # OpenCV gives no reason
        height, width = pixels.shape[:2]
        raise ImageError(f"{picture_format.name} encoder refused a picture of {width}x{height} px")
    return encoded.tobytes()
