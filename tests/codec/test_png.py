# SPDX-License-Identifier: Apache-2.0
import base64

import cv2
import numpy as np
import pytest
from cv2.typing import MatLike
from hypothesis import given
from hypothesis import strategies as st

from gateway.codec.png import large_text_as_png, text_as_png


def pixels_of(picture: bytes) -> MatLike:
    pixels = cv2.imdecode(np.frombuffer(base64.b64decode(picture), np.uint8), cv2.IMREAD_COLOR)
    assert pixels is not None
    return pixels


def text_in(picture: bytes) -> bytes:
    """Read as roslib does: the red, green and blue values in a row."""
    return cv2.cvtColor(pixels_of(picture), cv2.COLOR_BGR2RGB).tobytes()


@given(st.binary(min_size=1, max_size=400))
def test_the_picture_holds_the_text_and_then_newlines(text):
    found = text_in(text_as_png(text))
    assert found.startswith(text)
    assert set(found[len(text) :]) <= {ord("\n")}


@pytest.mark.parametrize(("length", "width"), [(1, 1), (12, 2), (2700, 30), (2701, 30)])
def test_the_width_is_the_root_of_a_third_of_the_length(length, width):
    assert pixels_of(text_as_png(b"x" * length)).shape[1] == width


@pytest.mark.parametrize("length", [1, 3, 299, 300, 5000])
def test_a_text_in_pieces_has_the_picture_of_the_whole_and_pauses_after_each(length):
    text = bytes(32 + at % 90 for at in range(length))
    pieces = [text[at : at + 100] for at in range(0, length, 100)]
    pauses = []
    picture = large_text_as_png(iter(pieces), lambda: pauses.append(None))
    assert picture == text_as_png(text)
    assert len(pauses) == 2 * len(pieces)
