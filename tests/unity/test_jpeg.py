# SPDX-License-Identifier: Apache-2.0
"""The C# decoder of JPEG against libjpeg-turbo's, and against bytes that are not picture."""

import itertools
import random
import re
import struct
from typing import Final

import cv2
import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from tests.unity import mono, package, probe
from tests.unity.probe import Probe, Refusal

pytestmark = pytest.mark.skipif(mono.missing() != "", reason=mono.missing())

SAMPLINGS: Final = {
    "4:4:4": cv2.IMWRITE_JPEG_SAMPLING_FACTOR_444,
    "4:4:0": cv2.IMWRITE_JPEG_SAMPLING_FACTOR_440,
    "4:2:2": cv2.IMWRITE_JPEG_SAMPLING_FACTOR_422,
    "4:2:0": cv2.IMWRITE_JPEG_SAMPLING_FACTOR_420,
    "4:1:1": cv2.IMWRITE_JPEG_SAMPLING_FACTOR_411,
}
SIZES: Final = ((1, 1), (2, 1), (1, 9), (3, 5), (8, 8), (16, 16), (17, 33), (40, 23), (97, 64))
MAX_PIXELS: Final = 4096 * 4096
ENOUGH_BYTES: Final = 256 * 1024 * 1024  # Mono alone takes a fifth


@pytest.fixture(scope="module")
def decoder():
    decoder = Probe(package.compiled("Ros2Gateway.Displays.Core", package.EDITOR), probe.JPEG)
    yield decoder
    decoder.close()


def picture(width, height, *, seed=1, noise=40):
    """Return a gradient with an edge and noise: every frequency, and values beyond both ends."""
    numbers = np.random.default_rng(seed)
    x, y = np.meshgrid(np.linspace(0, 255, width), np.linspace(0, 255, height))
    colours = np.stack([x, 255 - y, np.where(x > y, 255.0, 0.0)], axis=-1)
    return np.clip(colours + numbers.normal(0, noise, colours.shape), 0, 255).astype(np.uint8)


def encode(pixels, quality=80, sampling="4:2:0", restarts=0, **others):
    options = {
        cv2.IMWRITE_JPEG_QUALITY: quality,
        cv2.IMWRITE_JPEG_SAMPLING_FACTOR: SAMPLINGS[sampling],
        cv2.IMWRITE_JPEG_RST_INTERVAL: restarts,
        **{getattr(cv2, f"IMWRITE_JPEG_{name.upper()}"): value for name, value in others.items()},
    }
    good, jpeg = cv2.imencode(".jpg", pixels, list(itertools.chain(*options.items())))
    assert good
    return jpeg.tobytes()


def decode(decoder, jpeg):
    """Return a picture as libjpeg-turbo has it: the top row first, three channels."""
    answer = decoder.ask("decode", jpeg)
    assert not isinstance(answer, Refusal), answer
    width, height = struct.unpack_from("<II", answer)
    pixels = np.frombuffer(answer, np.uint8, offset=8).reshape(height, width, 4)
    assert (pixels[..., 3] == 255).all()
    return pixels[::-1, :, 2::-1]


def refusal(decoder, jpeg):
    answer = decoder.ask("decode", jpeg)
    assert isinstance(answer, Refusal)
    return answer.text


def segment(jpeg, code):
    """Return where the marker of a segment is, and where the segment ends."""
    at = 2
    while jpeg[at + 1] != code:
        at += 2 + int.from_bytes(jpeg[at + 2 : at + 4], "big")
    return at, at + 2 + int.from_bytes(jpeg[at + 2 : at + 4], "big")


def assert_equal(decoder, jpeg):
    expected = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)
    np.testing.assert_array_equal(decode(decoder, jpeg), expected)


@pytest.mark.parametrize("sampling", SAMPLINGS)
@pytest.mark.parametrize(("width", "height"), SIZES)
def test_every_sample_is_that_of_libjpeg_turbo(decoder, sampling, width, height):
    for quality in (5, 50, 80, 95, 100):
        for restarts in (0, 1, 3):
            assert_equal(decoder, encode(picture(width, height), quality, sampling, restarts))


@pytest.mark.parametrize("quality", [10, 75, 100])
def test_grey_pictures_are_grey(decoder, quality):
    for width, height in SIZES:
        assert_equal(decoder, encode(picture(width, height)[..., 0], quality))


def test_a_picture_of_a_camera_with_its_own_tables(decoder):
    assert_equal(decoder, encode(picture(640, 480), 80, optimize=1))
    assert_equal(decoder, encode(picture(640, 480, noise=3), 30, optimize=1, rst_interval=40))


def test_flat_and_extreme_pictures(decoder):
    checks = (np.indices((32, 32)).sum(axis=0) % 2 * 255).astype(np.uint8)
    for pixels in (np.zeros((20, 20, 3)), np.full((20, 20, 3), 255), np.dstack([checks] * 3)):
        for quality in (1, 100):
            assert_equal(decoder, encode(pixels.astype(np.uint8), quality))


def one_scan_each(width, height):
    """Return a JPEG with a scan for each component, of three grey ones."""
    greys = [encode(picture(width, height, seed=n)[..., n], 80) for n in range(3)]
    frame, frame_end = segment(greys[0], 0xC0)
    head = bytearray(greys[0][frame:frame_end])
    head[2:4] = (8 + 9).to_bytes(2, "big")
    head[9:] = bytes([3, 1, 0x11, 0, 2, 0x11, 0, 3, 0x11, 0])
    tables = [greys[0][slice(*segment(greys[0], code))] for code in (0xDB, 0xC4)]
    # the second Huffman table: cv2 writes each in its own segment
    tables += [m.group() for m in re.finditer(rb"\xff\xc4\x00.\x10.{178}", greys[0], re.DOTALL)]
    scans = []
    for number, grey in enumerate(greys, 1):
        _, data = segment(grey, 0xDA)
        scans.append(b"\xff\xda\x00\x08\x01" + bytes([number, 0, 0, 63, 0]) + grey[data:-2])
    return b"\xff\xd8" + b"".join(tables) + bytes(head) + b"".join(scans) + b"\xff\xd9"


def test_components_may_come_one_after_the_other(decoder):
    for width, height in SIZES:
        assert_equal(decoder, one_scan_each(width, height))


def test_components_may_be_red_green_and_blue(decoder):
    jpeg = bytearray(encode(picture(40, 23), 90, "4:4:4"))
    frame, _ = segment(jpeg, 0xC0)
    scan, _ = segment(jpeg, 0xDA)
    for n, letter in enumerate(b"RGB"):
        jpeg[frame + 10 + 3 * n] = jpeg[scan + 5 + 2 * n] = letter
    jfif, end = segment(jpeg, 0xE0)
    del jpeg[jfif:end]
    assert_equal(decoder, bytes(jpeg))
    adobe = b"\xff\xee\x00\x0eAdobe\x00\x64\x00\x00\x00\x00\x00"
    assert_equal(decoder, jpeg[:2] + adobe + jpeg[2:])
    assert_equal(decoder, jpeg[:2] + adobe[:-1] + b"\x01" + jpeg[2:])


def test_comments_and_fill_bytes_are_passed_over(decoder):
    jpeg = encode(picture(40, 23))
    assert_equal(decoder, jpeg[:2] + b"\xff\xff\xff\xfe\x00\x05abc" + jpeg[2:])
    assert_equal(decoder, jpeg + b"whatever")
    whole = decode(decoder, jpeg)
    np.testing.assert_array_equal(
        decode(decoder, jpeg[:-2]), whole
    )  # some cameras forget the last marker


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda j: b"", "not a JPEG: it does not begin with FF D8 (byte 0)"),
        (lambda j: b"\x89PNG\r\n\x1a\n" + j, "not a JPEG: it does not begin with FF D8 (byte 0)"),
        (lambda j: j[:2] + b"\x00" + j[2:], "expected a marker, found 00 (byte 2)"),
        (lambda j: j[:2] + b"\xff\xfe\x00\x01" + j[2:], "segment FE is 1 bytes long"),
        (lambda j: j[:30], "segment DB is 67 bytes long, 8 are there (byte 21)"),
        (lambda j: j[: segment(j, 0xDA)[1]], "the data end within the picture"),
        (lambda j: j[: len(j) // 2 + 200], "the data end within the picture"),
        (lambda j: j[:-2] + b"\x55\x55\x55\xff\xd9", None),  # all of it was there before
        (lambda j: j[:2] + b"\xff\xd9", "the picture ends before all of it has come (byte 3)"),
    ],
)
def test_faults_are_said_with_their_place(decoder, change, words):
    answer = decoder.ask("decode", change(encode(picture(97, 64))))
    if words is None:
        assert not isinstance(answer, Refusal)
    else:
        assert isinstance(answer, Refusal)
        assert words in answer.text


@pytest.mark.parametrize(
    ("code", "offset", "value", "words"),
    [
        (0xC0, 4, 12, "not supported: 12 bits per sample, only 8 are read"),
        (0xC0, 9, 4, "not supported: 4 components, only 1 and 3 are read"),
        (0xC0, 9, 0, "a picture without pixels"),
        (0xC0, 11, 0x51, "sampling factors are 1 to 4, not 5 and 1"),
        (0xC0, 11, 0x44, "units of 18 blocks, at most 10"),
        (0xC0, 12, 4, "quantization tables are 0 to 3, not 4"),
        (0xC0, 12, 2, "quantization table 2 is not there"),
        (0xC0, 13, 1, "two components 1"),
        (0xC4, 4, 0x20, "no such Huffman table, 20"),
        (0xC4, 4, 0x01, "not supported: Huffman tables that are not there"),
        (0xC4, 5, 3, "a Huffman table has 3 codes of 1 bits, more than there is room for"),
        (0xC4, 20, 60, "a Huffman table of 72 symbols or more, its segment has 12"),
        (0xDB, 4, 0x23, "no such quantization table, 23"),
        (0xDB, 4, 0x10, "a quantization table takes 129 bytes, its segment has 65"),
        (0xDA, 4, 4, "a scan of 4 components, the frame has 3"),
        (0xDA, 5, 9, "the frame has no component 9"),
        (0xDA, 7, 1, "component 1 comes twice"),
        (0xDA, 11, 5, "a scan of some coefficients, in a baseline JPEG"),
        (0xC0, 1, 0xC2, "not supported: a progressive JPEG, only baseline is read"),
        (0xC0, 1, 0xC3, "not supported: process C3, only baseline is read"),
        (0xC0, 1, 0xCC, "not supported: arithmetic coding, only Huffman's is read"),
    ],
)
def test_each_field_that_cannot_be_is_refused(decoder, code, offset, value, words):
    jpeg = bytearray(encode(picture(97, 64)))
    at, _ = segment(jpeg, code)
    jpeg[at + offset] = value
    text = refusal(decoder, bytes(jpeg))
    assert text.startswith(words), text
    assert re.search(r"\(byte \d+\)$", text)


def test_a_restart_marker_has_its_number(decoder):
    jpeg = encode(picture(97, 64), restarts=2)
    assert jpeg.count(b"\xff\xd1")
    assert "expected restart marker 1, found marker D3" in refusal(
        decoder, jpeg.replace(b"\xff\xd1", b"\xff\xd3", 1)
    )
    assert "belong to no block" in refusal(
        decoder, jpeg.replace(b"\xff\xd1", b"\x12\x34\x56\xff\xd1", 1)
    )


def with_size(jpeg, width, height):
    at, _ = segment(jpeg, 0xC0)
    return jpeg[: at + 5] + struct.pack(">HH", height, width) + jpeg[at + 9 :]


def test_a_size_is_refused_before_there_is_room_for_it(decoder):
    jpeg = encode(picture(97, 64))
    text = refusal(decoder, with_size(jpeg, 8192, 8192))
    assert text.startswith(f"not supported: 8192 x 8192 pixels, at most {MAX_PIXELS}")
    text = refusal(decoder, with_size(jpeg, 4096, 4096))
    assert text.startswith(f"4096 x 4096 pixels in {len(jpeg)} bytes, fewer than so many take")
    assert decoder.peak_bytes() < ENOUGH_BYTES


GOOD: Final = encode(picture(33, 20))
SEEDS: Final = (
    GOOD,
    encode(picture(50, 40), 40, "4:4:4", 2),
    encode(picture(24, 24)[..., 0], 60),
    encode(picture(17, 9), 90, "4:1:1", optimize=1),
    one_scan_each(20, 20),
)


@st.composite
def damaged(draw):
    jpeg = bytearray(draw(st.sampled_from(SEEDS)))
    for _ in range(draw(st.integers(1, 6))):
        at = draw(st.integers(0, len(jpeg) - 1))
        kind = draw(st.sampled_from(["flip", "set", "cut", "insert", "delete", "repeat"]))
        if kind == "flip":
            jpeg[at] ^= 1 << draw(st.integers(0, 7))
        elif kind == "set":
            jpeg[at] = draw(st.sampled_from([0, 1, 0x11, 0x44, 0x7F, 0xD0, 0xDA, 0xFF]))
        elif kind == "cut" and at > 1:
            del jpeg[at:]
        elif kind == "insert":
            jpeg[at:at] = draw(st.binary(min_size=1, max_size=6))
        elif kind == "delete":
            del jpeg[at : at + draw(st.integers(1, 8))]
            jpeg = jpeg or bytearray(b"\xff")
        else:
            jpeg[at:at] = jpeg[at : at + draw(st.integers(1, 200))]
    return bytes(jpeg)


@given(damaged() | st.binary())
@example(b"\xff\xd8\xff\xff")
@example(b"\xff\xd8\xff\xdb\x00\x02")
def test_no_bytes_get_anything_but_a_picture_or_a_format_error(decoder, jpeg):
    decoder.ask("decode", jpeg)  # which raises otherwise


def test_a_good_picture_is_right_after_any_number_of_bad_ones(decoder):
    pick = random.Random(1)
    for _ in range(60):
        bad = bytearray(pick.choice(SEEDS))
        for _ in range(pick.randint(1, 3)):
            bad[pick.randrange(len(bad))] = pick.randrange(256)
        decoder.ask("decode", bytes(bad[: pick.randint(1, len(bad))]))
        assert_equal(decoder, GOOD)
    assert decoder.peak_bytes() < ENOUGH_BYTES


@pytest.mark.parametrize("seed", SEEDS)
def test_every_truncation_is_refused_until_all_blocks_are_there(decoder, seed):
    answers = decoder.ask_all(("decode", seed[:count]) for count in range(len(seed) - 2))
    _, data = segment(seed, 0xDA)
    assert all(isinstance(answer, Refusal) for answer in answers[:-2])
    assert all("not supported" not in answer.text for answer in answers[data:-2])
