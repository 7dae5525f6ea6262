# SPDX-License-Identifier: Apache-2.0
"""Pictures keep their content, whatever the encoding. Contradictions raise `ImageError`.

The reference is written in numpy alone: a known picture, put into each encoding by the
definitions in sensor_msgs/image_encodings.hpp.
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gateway.codec.error_text import CodecError
from gateway.codec.image import (
    MAX_DEPTH_M,
    ImageOptions,
    Picture,
    compress,
    confine_to_calling_thread,
)
from gateway.codec.image_encodings import (
    ENCODINGS,
    LAYOUTS,
    MAX_BYTES,
    MAX_SIDE_PX,
    ImageError,
    RawImage,
)
from gateway.codec.picture_formats import PICTURE_FORMATS

HEIGHT, WIDTH = 96, 192  # quadrants of whole 16x16 blocks: JPEG mixes nothing across their edges
FINE_JPEG = ImageOptions(quality=95)
PNG = ImageOptions(format="png")


def known_picture():
    """RGB quadrants (red, green / blue, yellow) that get brighter to the right."""
    corners = np.array([[[255, 40, 20], [30, 230, 40]], [[20, 50, 250], [240, 230, 30]]], float)
    picture = corners.repeat(HEIGHT // 2, axis=0).repeat(WIDTH // 2, axis=1)
    return np.rint(picture * np.linspace(0.4, 1.0, WIDTH)[:, None]).astype(np.uint8)


RGB = known_picture()
ALPHA = np.linspace(10, 250, WIDTH).astype(np.uint8) * np.ones((HEIGHT, 1), np.uint8)
RGBA = np.dstack([RGB, ALPHA])
GREY = RGB.mean(axis=2).astype(np.uint8)
DEPTH_MM = (np.arange(HEIGHT)[:, None] * 80 + np.arange(WIDTH) + 500).astype(np.uint16)
DEPTH_MM[:8, :8] = 0  # no measurement


def swapped(pixels):
    """RGB(A) as BGR(A) and back."""
    return pixels[..., [2, 1, 0, 3][: pixels.shape[2]]]


def widened(pixels):
    """8 bits on the full scale of 16."""
    return pixels.astype(np.uint16) * 257


def mosaic(pixels, pattern):
    """The one colour that each pixel of a Bayer sensor sees. The pattern starts top left."""
    seen = np.empty(pixels.shape[:2], pixels.dtype)
    for place, colour in enumerate(pattern):
        cell = np.s_[place // 2 :: 2, place % 2 :: 2]
        seen[cell] = pixels[(*cell, "rgb".index(colour))]
    return seen


def yuv(pixels):
    """ITU-R BT.601, video range."""
    r, g, b = (pixels[..., channel] / 255 for channel in range(3))
    y = 16 + 65.481 * r + 128.553 * g + 24.966 * b
    u = 128 - 37.797 * r - 74.203 * g + 112.0 * b
    v = 128 + 112.0 * r - 93.786 * g - 18.214 * b
    return tuple(np.rint(plane).astype(np.uint8) for plane in (y, u, v))


def packed_422(order):
    y, u, v = yuv(RGB)
    samples = {"u": u[:, ::2], "v": v[:, ::2], "0": y[:, ::2], "1": y[:, 1::2]}
    return np.stack([samples[name] for name in order], axis=2).reshape(HEIGHT, WIDTH * 2)


def semi_planar_420(order):
    y, u, v = yuv(RGB)
    planes = {"u": u[::2, ::2], "v": v[::2, ::2]}
    chroma = np.stack([planes[name] for name in order], axis=2)
    return np.vstack([y, chroma.reshape(HEIGHT // 2, WIDTH)])


def semi_planar_444():
    y, u, v = yuv(RGB)
    return np.vstack([y, np.dstack([u, v]).reshape(2 * HEIGHT, WIDTH)])


def stretched(pixels):
    """The least is black, the greatest white."""
    least, greatest = float(pixels.min()), float(pixels.max())
    return np.rint((pixels - least) / (greatest - least) * 255).astype(np.uint8)


def grey_as_rgb(grey):
    return np.dstack([grey] * 3)


INTENSITIES = {  # encoding: its rows in memory, what a viewer should see
    "rgb8": (RGB, RGB),
    "bgr8": (swapped(RGB), RGB),
    "rgba8": (RGBA, RGB),
    "bgra8": (swapped(RGBA), RGB),
    "rgb16": (widened(RGB), RGB),
    "bgr16": (widened(swapped(RGB)), RGB),
    "rgba16": (widened(RGBA), RGB),
    "bgra16": (widened(swapped(RGBA)), RGB),
    "mono8": (GREY, grey_as_rgb(GREY)),
    "mono16": (widened(GREY), grey_as_rgb(GREY)),
    "8UC": (GREY, grey_as_rgb(GREY)),
    "8UC1": (GREY, grey_as_rgb(GREY)),
    "8UC3": (swapped(RGB), RGB),
    "8UC4": (swapped(RGBA), RGB),
    "uyvy": (packed_422("u0v1"), RGB),
    "yuv422": (packed_422("u0v1"), RGB),
    "yuyv": (packed_422("0u1v"), RGB),
    "yuv422_yuy2": (packed_422("0u1v"), RGB),
    "nv12": (semi_planar_420("uv"), RGB),
    "nv21": (semi_planar_420("vu"), RGB),
    "nv24": (semi_planar_444(), RGB),
    "8UC2": (swapped(RGB)[..., :2], RGB * [0, 1, 1]),
    "16UC2": (widened(swapped(RGB))[..., :2], RGB * [0, 1, 1]),
    "16UC3": (widened(swapped(RGB)), RGB),
    "16UC4": (widened(swapped(RGBA)), RGB),
}
for _name, _type in (
    ("8S", np.int8),
    ("16S", np.int16),
    ("32S", np.int32),
    ("32F", np.float32),
    ("64F", np.float64),
):
    _numbers = (swapped(RGBA).astype(float) - 128).astype(_type)
    for _channels in (1, 2, 3, 4):
        _rows = _numbers[..., :_channels] if _channels > 1 else _numbers[..., 1]
        if _type in (np.float32, np.float64):
            if _channels == 1:
                continue  # of one float per pixel there is depth
            _rows = _rows * _type(1e3)
        _shown = stretched(_rows)
        if _channels == 1:
            _shown = grey_as_rgb(_shown)
            INTENSITIES[f"{_name}C"] = (_rows, _shown)
        elif _channels == 2:
            _shown = np.dstack([np.zeros_like(GREY), _shown[..., 1], _shown[..., 0]])
        else:
            _shown = swapped(_shown[..., :3])
        INTENSITIES[f"{_name}C{_channels}"] = (_rows, _shown)
for _pattern in ("rggb", "bggr", "gbrg", "grbg"):
    INTENSITIES[f"bayer_{_pattern}8"] = (mosaic(RGB, _pattern), RGB)
    INTENSITIES[f"bayer_{_pattern}16"] = (mosaic(widened(RGB), _pattern), RGB)
DEPTHS = {
    "16UC": DEPTH_MM,
    "16UC1": DEPTH_MM,
    "32FC": (DEPTH_MM / 1000).astype(np.float32),
    "32FC1": (DEPTH_MM / 1000).astype(np.float32),
    "64FC": DEPTH_MM / 1000,
    "64FC1": DEPTH_MM / 1000,
}
CHROMA = {name: layout.chroma for name, layout in LAYOUTS.items()}
ROWS = {encoding: rows for encoding, (rows, _) in INTENSITIES.items()} | DEPTHS


def image_of(encoding, rows, *, big=False, padding=0):
    """An Image message of some rows in memory, each followed by dirty padding."""
    chroma = CHROMA.get(encoding)
    height = int(rows.shape[0] / {"half plane": 1.5, "full plane": 3}.get(chroma, 1))
    width = rows.shape[1] // 2 if chroma == "packed" else rows.shape[1]
    stored = np.ascontiguousarray(rows, rows.dtype.newbyteorder(">" if big else "<"))
    octets = stored.view(np.uint8).reshape(len(rows), -1)
    octets = np.pad(octets, ((0, 0), (0, padding)), constant_values=0xAB)
    return RawImage(height, width, encoding, big, octets.shape[1], octets.tobytes())


def image(encoding, **how):
    return image_of(encoding, ROWS[encoding], **how)


def decoded(picture):
    pixels = cv2.imdecode(np.frombuffer(picture.data, np.uint8), cv2.IMREAD_UNCHANGED)
    assert pixels.shape[:2] == (picture.height, picture.width)
    return pixels


def seen(picture):
    """The image that a viewer sees, as RGB."""
    pixels = decoded(picture)
    return grey_as_rgb(pixels) if pixels.ndim == 2 else swapped(pixels)


def assert_similar(shown, expected, *, tolerance, margin):
    """Compare all but the pixels along the edges of the quadrants."""
    difference = np.abs(shown.astype(float) - expected)
    for rows in (np.s_[margin : 48 - margin], np.s_[48 + margin : 96 - margin]):
        for columns in (np.s_[margin : 96 - margin], np.s_[96 + margin : 192 - margin]):
            assert difference[rows, columns].max() <= tolerance


def test_every_encoding_of_ros_is_known():
    """All of sensor_msgs/image_encodings.hpp of Jazzy."""
    colours = {f"{order}{bits}" for order in ("rgb", "bgr", "rgba", "bgra") for bits in (8, 16)}
    patterns = {f"bayer_{order}" for order in ("rggb", "bggr", "gbrg", "grbg")}
    bayer = {f"{pattern}{bits}" for pattern in patterns for bits in (8, 16)}
    types = ("8U", "8S", "16U", "16S", "32S", "32F", "64F")
    abstract = {f"{each}C{channels}" for each in types for channels in (1, 2, 3, 4)}
    yuv = {"yuv422", "uyvy", "yuv422_yuy2", "yuyv", "nv21", "nv24"}
    assert colours | bayer | abstract | yuv | {"mono8", "mono16"} <= set(ENCODINGS)


def test_every_encoding_has_a_known_picture():
    assert set(ROWS) == set(ENCODINGS)


@pytest.mark.parametrize("encoding", INTENSITIES)
def test_a_jpeg_shows_the_known_picture(encoding):
    picture = compress(image(encoding), FINE_JPEG)
    assert (picture.width, picture.height, picture.format) == (WIDTH, HEIGHT, "jpeg")
    assert picture.data.startswith(b"\xff\xd8")
    assert picture.depth_range_m is None
    assert decoded(picture).dtype == np.uint8
    # a colour interpolated across an edge damages the JPEG block that it is in
    margin = 16 if encoding.startswith("bayer") else 2
    assert_similar(seen(picture), INTENSITIES[encoding][1], tolerance=6, margin=margin)


SIGNATURES = {"jpeg": b"\xff\xd8\xff", "png": b"\x89PNG\r\n"}


@pytest.mark.parametrize("name", PICTURE_FORMATS)
def test_every_format_is_what_its_name_says_and_shows_the_known_picture(name):
    picture = compress(image("rgb8"), ImageOptions(name, quality=95))
    assert picture.format == name
    assert picture.data.startswith(SIGNATURES[name])
    assert_similar(seen(picture), RGB, tolerance=12, margin=2)


@pytest.mark.parametrize("name", PICTURE_FORMATS)
def test_every_lossy_format_gets_smaller_with_its_quality(name):
    sizes = [len(compress(image("bgr8"), ImageOptions(name, quality)).data) for quality in (90, 10)]
    is_lossy = PICTURE_FORMATS[name].quality_parameter is not None
    assert (sizes[0] > sizes[1]) == is_lossy


@pytest.mark.parametrize("name", PICTURE_FORMATS)
def test_every_format_has_depth_as_grey_or_in_millimetres(name):
    picture = compress(image("16UC1"), ImageOptions(name))
    if PICTURE_FORMATS[name].has_8_bits:
        assert decoded(picture).dtype == np.uint8
        assert picture.depth_range_m == ImageOptions().depth_range_m
    else:
        assert np.array_equal(decoded(picture), DEPTH_MM)
        assert picture.depth_range_m is None


@pytest.mark.parametrize(
    ("encoding", "expected"),
    [
        ("rgb8", swapped(RGB)),
        ("bgr8", swapped(RGB)),
        ("8UC3", swapped(RGB)),
        ("rgba8", swapped(RGBA)),
        ("bgra8", swapped(RGBA)),
        ("8UC4", swapped(RGBA)),
        ("rgb16", widened(swapped(RGB))),
        ("bgr16", widened(swapped(RGB))),
        ("rgba16", widened(swapped(RGBA))),
        ("bgra16", widened(swapped(RGBA))),
        ("mono8", GREY),
        ("8UC1", GREY),
        ("mono16", widened(GREY)),
        ("16UC1", DEPTH_MM),
        ("32FC1", DEPTH_MM),
    ],
)
def test_a_png_is_lossless(encoding, expected):
    picture = compress(image(encoding), PNG)
    assert picture.format == "png"
    assert decoded(picture).dtype == expected.dtype
    assert np.array_equal(decoded(picture), expected)


@pytest.mark.parametrize("encoding", ["bayer_grbg8", "bayer_grbg16", "uyvy", "nv21"])
def test_a_png_shows_what_has_to_be_interpolated(encoding):
    pixels = decoded(compress(image(encoding), PNG))
    as_8_bit = pixels / 257 if pixels.dtype == np.uint16 else pixels
    assert_similar(swapped(as_8_bit), RGB, tolerance=4, margin=2)


def test_a_bayer_image_of_16_bits_keeps_them_in_a_png():
    assert decoded(compress(image("bayer_rggb16"), PNG)).dtype == np.uint16


@pytest.mark.parametrize("options", [FINE_JPEG, PNG])
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_byte_order_makes_no_difference(encoding, options):
    assert compress(image(encoding, big=True), options) == compress(image(encoding), options)


@pytest.mark.parametrize("padding", [1, 6, 32])
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_padding_after_a_row_makes_no_difference(encoding, padding):
    if encoding == "nv24":  # a row of its chroma takes two steps
        pytest.skip("its rows are not those of memory")
    padded = compress(image(encoding, padding=padding), FINE_JPEG)
    assert padded == compress(image(encoding), FINE_JPEG)


def test_a_view_inside_a_sample_at_an_odd_offset_is_read_in_place():
    plain = image("mono16")
    inside = memoryview(b"\xff" + plain.data)[1:]
    assert compress(plain._replace(data=inside), PNG) == compress(plain, PNG)


@pytest.mark.parametrize("encoding", ["RGB8", "8uc1", "16uc1", "32fC1", "Bayer_RGGB8"])
def test_the_case_of_an_encoding_makes_no_difference(encoding):
    usual = next(name for name in ENCODINGS if name.lower() == encoding.lower())
    assert compress(image(usual)._replace(encoding=encoding), PNG) == compress(image(usual), PNG)


def test_the_same_picture_comes_out_of_every_thread():
    with ThreadPoolExecutor(4) as pool:
        pictures = list(pool.map(lambda _: compress(image("rgb8"), FINE_JPEG), range(32)))
    assert set(pictures) == {compress(image("rgb8"), FINE_JPEG)}


def test_confined_opencv_starts_no_threads():
    before = cv2.getNumThreads()
    try:
        confine_to_calling_thread()
        assert cv2.getNumThreads() == 1
    finally:
        cv2.setNumThreads(before)


# Odd sides


@pytest.mark.parametrize("step_px", [0, 1], ids=["tight", "with the last pair whole"])
@pytest.mark.parametrize("encoding", ["uyvy", "yuyv", "nv12", "nv21"])
@pytest.mark.parametrize("size", [(191, 96), (191, 95), (192, 95), (1, 1), (1, 3)])
def test_odd_sides_of_yuv_lose_no_pixel(encoding, size, step_px):
    width, height = size
    is_packed = CHROMA[encoding] == "packed"
    rows = ROWS[encoding]
    columns = (width + step_px * (width % 2)) * (2 if is_packed else 1)
    if is_packed:
        rows = rows[:height, :columns]
    else:
        rows = np.vstack([rows[:height, :columns], rows[96 : 96 + (height + 1) // 2, :columns]])
    picture = compress(RawImage(height, width, encoding, False, columns, rows.tobytes()), PNG)
    assert (picture.width, picture.height) == size
    difference = np.abs(seen(picture).astype(int) - RGB[:height, :width])
    if size[0] > 1 or step_px:
        assert difference[:, :90].max() <= 4
        assert difference[:44].max() <= (6 if step_px else 12)
    else:  # nothing tells the second half of the chroma
        assert picture.data


def test_a_row_of_chroma_for_each_pixel_takes_two_steps():
    y, u, v = yuv(RGB)
    padded = [np.pad(y, ((0, 0), (0, 6)), constant_values=0xAB)]
    padded += [
        np.pad(np.dstack([u, v]).reshape(HEIGHT, -1), ((0, 0), (0, 12)), constant_values=0xAB)
    ]
    data = b"".join(plane.tobytes() for plane in padded)
    with_steps = RawImage(HEIGHT, WIDTH, "nv24", False, WIDTH + 6, data)
    assert compress(with_steps, PNG) == compress(image("nv24"), PNG)


# Numbers


def floats_row(encoding, numbers):
    dtype = np.float32 if encoding.startswith("32F") else np.float64
    return image_of(encoding, np.array(numbers, dtype).repeat(2).reshape(1, -1, 2))


@pytest.mark.parametrize(
    ("numbers", "shown"),
    [
        ([-3.0, -1.0, 1.0], [0, 128, 255]),
        ([7.0, 7.0], [0, 0]),
        ([np.nan, 1.0, np.inf, 3.0, -np.inf], [0, 0, 0, 255, 0]),
        ([np.nan, np.inf], [0, 0]),
    ],
)
@pytest.mark.parametrize("encoding", ["32FC2", "64FC2"])
def test_numbers_are_stretched_and_nan_is_black(encoding, numbers, shown):
    pixels = decoded(compress(floats_row(encoding, numbers), PNG))
    assert pixels[0, :, 0].tolist() == shown


def test_the_widest_range_of_numbers_is_stretched_too():
    pixels = decoded(compress(floats_row("64FC2", [-1.7e308, 0.0, 1.7e308]), PNG))
    assert pixels[0, :, 0].tolist() == [0, 128, 255]


# Depth


@pytest.mark.parametrize("encoding", DEPTHS)
def test_a_jpeg_of_depth_is_bright_where_it_is_near(encoding):
    picture = compress(image(encoding), FINE_JPEG)
    assert picture.depth_range_m == (0.0, 10.0)
    grey = decoded(picture)
    assert grey.ndim == 2
    assert grey[:6, :6].max() <= 8
    expected = 1 + 254 * (1 - DEPTH_MM / 10_000)
    assert np.abs(grey - expected)[18:, 18:].max() <= 4


def depth_row(encoding, metres):
    """The grey of each depth, unharmed by JPEG: one flat block of 16x16 for each."""
    values = np.array(metres, np.float32) if encoding == "32FC1" else np.array(metres) * 1000
    dtype = np.float32 if encoding == "32FC1" else np.uint16
    return image_of(encoding, values.astype(dtype).repeat(16)[None].repeat(16, axis=0))


@pytest.mark.parametrize("encoding", ["16UC1", "32FC1"])
@pytest.mark.parametrize(
    ("range_m", "metres", "greys"),
    [
        ((1.0, 3.0), [0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 65.0], [0, 255, 255, 128, 1, 1, 1]),
        ((0.0, MAX_DEPTH_M), [0.0, 0.001, 65.0], [0, 255, 238]),
        ((MAX_DEPTH_M - 0.1, MAX_DEPTH_M), [0.0, 0.001, 65.0], [0, 255, 255]),
    ],
)
def test_depth_outside_the_range_is_clamped_to_it(encoding, range_m, metres, greys):
    options = ImageOptions(quality=100, depth_range_m=range_m)
    picture = compress(depth_row(encoding, metres), options)
    assert picture.depth_range_m == range_m
    shown = decoded(picture)[8, 8::16].astype(int)
    assert np.abs(shown - greys).max() <= 1
    assert (shown > 0).tolist() == [depth > 0 for depth in metres]  # 0 means no measurement


NO_MEASUREMENTS = [0.0, -0.0, np.nan, np.inf, -np.inf, -1.0, 1e-40]


@pytest.mark.parametrize("options", [ImageOptions(quality=100), PNG])
def test_depth_without_a_measurement_is_black(options):
    picture = compress(depth_row("32FC1", [*NO_MEASUREMENTS, 0.001]), options)
    pixels = decoded(picture)[8, 8::16]
    assert pixels[:-1].max() == 0
    assert pixels[-1] > 0


def test_a_png_of_depth_in_metres_saturates_at_what_16_bits_of_millimetres_reach():
    picture = compress(depth_row("32FC1", [1.2344, 65.5, 66.0, 1e9, 3e38]), PNG)
    assert list(decoded(picture)[8, 8::16]) == [1234, 65500, 65535, 65535, 65535]
    assert picture.depth_range_m is None


def test_scaled_depth_holds_only_depths_that_were_measured():
    edge = np.where(np.arange(90) % 7 < 3, 1000, 5000).astype(np.uint16)[None].repeat(60, axis=0)
    picture = compress(image_of("16UC1", edge), ImageOptions(format="png", max_width=40))
    assert set(np.unique(decoded(picture))) == {1000, 5000}


# Size


@pytest.mark.parametrize(
    ("max_width", "max_height", "size"),
    [
        (None, None, (192, 96)),
        (192, 96, (192, 96)),
        (1000, 1000, (192, 96)),  # never enlarged
        (96, None, (96, 48)),
        (None, 16, (32, 16)),
        (96, 16, (32, 16)),
        (70, None, (70, 35)),
        (22, 1000, (22, 11)),
        (1, None, (1, 1)),
    ],
)
@pytest.mark.parametrize("encoding", ["rgb8", "nv12", "bayer_gbrg8", "16UC1", "mono16"])
def test_a_picture_fits_its_bounds_and_keeps_its_aspect(encoding, max_width, max_height, size):
    options = ImageOptions(max_width=max_width, max_height=max_height)
    picture = compress(image(encoding), options)
    assert (picture.width, picture.height) == size
    assert decoded(picture).shape[:2] == size[::-1]


@pytest.mark.parametrize("width", [22, 48, 75, 96, 140, 191])
def test_a_scaled_picture_shows_the_same(width):
    picture = compress(image("rgb8"), ImageOptions(format="png", max_width=width))
    shown = seen(picture).astype(int)
    for down in (0.25, 0.75):
        for across in (0.2, 0.4, 0.6, 0.8):
            there = RGB[round(HEIGHT * down), round(WIDTH * across)]
            here = shown[round(picture.height * down), round(picture.width * across)]
            assert np.abs(here - there).max() <= 8


@pytest.mark.parametrize("width", [40, 50, 75, 100, 130, 149])
def test_a_scaled_picture_is_an_average_not_a_pick(width):
    stripes = (np.arange(150) % 2 * 255).astype(np.uint8)[None].repeat(60, axis=0)
    options = ImageOptions(format="png", max_width=width)
    shown = decoded(compress(image_of("mono8", stripes), options))
    assert abs(shown.mean() - 127.5) <= 4
    assert ((shown > 10) & (shown < 245)).mean() > 0.8


@pytest.mark.parametrize("line", [np.full((1, 500), 77, np.uint8), np.full((500, 1), 77, np.uint8)])
def test_an_extreme_aspect_keeps_one_pixel(line):
    options = ImageOptions(format="png", max_width=3, max_height=3)
    assert decoded(compress(image_of("mono8", line), options)).flatten().tolist() == [77] * 3


# Bad input


@dataclass(frozen=True)
class Bad:
    image: RawImage
    reason: str


BAD = {
    "unknown encoding": Bad(
        RawImage(1, 1, "jpeg", False, 1, b"0"), "unknown image encoding 'jpeg', known are rgb8,"
    ),
    "five channels": Bad(
        RawImage(1, 1, "8UC5", False, 5, b"0" * 5), "unknown image encoding '8UC5'"
    ),
    "long encoding": Bad(RawImage(1, 1, "x" * 10_000, False, 1, b"0"), f"'{'x' * 32}', known"),
    "no width": Bad(RawImage(4, 0, "mono8", False, 0, b""), "image is 0x4, needs at least 1x1"),
    "no height": Bad(RawImage(0, 4, "mono8", False, 4, b""), "image is 4x0, needs at least 1x1"),
    "too wide": Bad(
        RawImage(1, MAX_SIDE_PX + 1, "mono8", False, 8193, b"0" * 8193), "at most 8192 px a side"
    ),
    "largest header": Bad(
        RawImage(2**32 - 1, 2**32 - 1, "rgba16", False, 2**32 - 1, b""), "at most 8192 px a side"
    ),
    "too large": Bad(RawImage(4321, 7680, "mono8", False, 7680, b""), "at most 33177600 px in all"),
    "as large as may be": Bad(
        RawImage(4320, 7680, "mono8", False, 7680, b""), "image data has 0 bytes"
    ),
    "too many bytes": Bad(
        RawImage(1, 1, "mono8", False, 1, bytes(MAX_BYTES + 1)),
        "265420801 bytes, at most 265420800",
    ),
    "half a plane": Bad(
        RawImage(3, 2, "nv12", False, 2, b"0" * 8),
        "image data has 8 bytes, 5 rows of step 2 have 10",
    ),
    "short step": Bad(
        RawImage(2, 4, "rgb8", False, 11, b"0" * 22),
        "image step is 11, a row of 4 rgb8 pixels has 12 bytes",
    ),
    "no step": Bad(RawImage(2, 4, "mono8", False, 0, b""), "image step is 0, a row of 4 mono8"),
    "short data": Bad(
        RawImage(2, 4, "16UC1", False, 8, b"0" * 15),
        "image data has 15 bytes, 2 rows of step 8 have 16",
    ),
    "long data": Bad(
        RawImage(2, 4, "mono8", False, 4, b"0" * 9),
        "image data has 9 bytes, 2 rows of step 4 have 8",
    ),
    "no chroma": Bad(
        RawImage(4, 4, "nv21", False, 4, b"0" * 16),
        "image data has 16 bytes, 6 rows of step 4 have 24",
    ),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_raises_image_error_with_subject_value_and_limit(case):
    with pytest.raises(ImageError) as caught:
        compress(BAD[case].image, ImageOptions())
    assert BAD[case].reason in str(caught.value)
    assert len(str(caught.value)) < 150
    assert isinstance(caught.value, CodecError)


def test_an_encoder_that_refuses_raises_image_error(monkeypatch):
    monkeypatch.setattr(cv2, "imencode", lambda *_: (False, np.empty(0, np.uint8)))
    with pytest.raises(ImageError, match="png encoder refused a picture of 192x96"):
        compress(image("rgb8"), PNG)


@pytest.mark.parametrize(
    ("option", "reason"),
    [
        ({"format": "gif"}, "unknown picture format 'gif', known are jpeg"),
        ({"quality": 0}, "quality is 0, needs 1 to 100"),
        ({"quality": 101}, "quality is 101, needs 1 to 100"),
        ({"max_width": 0}, "max_width is 0, needs at least 1 px"),
        ({"max_height": -1}, "max_height is -1, needs at least 1 px"),
        ({"depth_range_m": (2.0, 2.0)}, "depth range is 2.0 to 2.0, needs 0 to 1000 m, rising"),
        ({"depth_range_m": (0.0, 0.09)}, "depth range is 0.0 to 0.09, needs .* at least 0.1 m"),
        ({"depth_range_m": (-1.0, 2.0)}, "depth range is -1.0 to 2.0"),
        (
            {"depth_range_m": (0.0, MAX_DEPTH_M + 1)},
            "depth range is 0.0 to 1001.0",
        ),
        ({"depth_range_m": (0.0, float("nan"))}, "depth range is 0.0 to nan"),
        ({"depth_range_m": (float("nan"), 1.0)}, "depth range is nan to 1.0"),
        ({"depth_range_m": (0.0, float("inf"))}, "depth range is 0.0 to inf"),
    ],
)
def test_an_option_out_of_its_range_raises_value_error(option, reason):
    with pytest.raises(ValueError, match=reason):
        ImageOptions(**option)


def test_equal_options_are_one_key():
    assert len({ImageOptions(), ImageOptions(quality=80), ImageOptions(quality=81)}) == 2


some_options = st.builds(
    ImageOptions,
    format=st.sampled_from(list(PICTURE_FORMATS)),
    quality=st.integers(1, 100),
    max_width=st.none() | st.integers(1, 20),
    max_height=st.none() | st.integers(1, 20),
    depth_range_m=st.tuples(st.floats(0, 400), st.floats(401, MAX_DEPTH_M)),
)


@given(
    header=st.tuples(st.integers(0, 40), st.integers(0, 40)),
    encoding=st.sampled_from([*ENCODINGS, "8UC5", "nv16"]) | st.text(max_size=40),
    big=st.booleans(),
    step=st.integers(0, 400),
    data=st.binary(max_size=400),
    options=some_options,
)
def test_anything_gives_a_picture_or_image_error(header, encoding, big, step, data, options):
    try:
        picture = compress(RawImage(*header, encoding, big, step, data), options)
    except ImageError:
        return
    assert isinstance(picture, Picture)


@given(
    encoding=st.sampled_from(ENCODINGS),
    half_size=st.tuples(st.integers(1, 6), st.integers(1, 6)),
    odd=st.tuples(st.booleans(), st.booleans()),
    big=st.booleans(),
    padding=st.integers(0, 3),
    options=some_options,
    content=st.randoms(use_true_random=False),
)
def test_any_content_of_the_right_size_gives_a_picture(
    encoding, half_size, odd, big, padding, options, content
):
    height, width = (2 * half - is_odd for half, is_odd in zip(half_size, odd, strict=True))
    rows = LAYOUTS[encoding].rows(height)
    sample = ROWS[encoding]
    bytes_per_pixel = sample[0].nbytes // image(encoding).width
    step = width * bytes_per_pixel + padding
    raw = RawImage(height, width, encoding, big, step, content.randbytes(rows * step))
    picture = compress(raw, options)
    assert picture.width <= min(width, options.max_width or width)
    assert picture.height <= min(height, options.max_height or height)
    assert decoded(picture).size
