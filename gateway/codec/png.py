# SPDX-License-Identifier: Apache-2.0
"""Text in a picture: rosbridge's `png` compression."""

import math
from collections.abc import Callable, Iterable
from typing import Any

import cv2
import numpy as np
import pybase64


def text_as_png(text: bytes) -> bytes:
    """Return the base64 of a PNG whose RGB values, row by row, are the text, padded with newlines.

    Browsers turn each value into one character, so the text must be ASCII. The function may run
    in any thread.
    """
    width, height = _sides(len(text))
    padded = text.ljust(3 * width * height, b"\n")
    return _as_png(np.frombuffer(padded, np.uint8), width, height)


def large_text_as_png(texts: Iterable[bytes], pause: Callable[[], None]) -> bytes:
    """Return the same of a large text in pieces. *pause* is called between pieces.

    If it releases the GIL, no thread waits for this one for long. OpenCV also releases it.
    """
    pieces = []
    for text in texts:
        pieces.append(text)
        pause()
    size = sum(map(len, pieces))
    width, height = _sides(size)
    padded = np.empty(3 * width * height, np.uint8)
    end = 0
    for piece in pieces:
        begin, end = end, end + len(piece)
        padded[begin:end] = np.frombuffer(piece, np.uint8)
        pause()
    padded[end:] = ord("\n")
    return _as_png(padded, width, height)


def _sides(size: int) -> tuple[int, int]:
    width = max(1, math.isqrt(size // 3))
    return width, -(-size // (3 * width))


def _as_png(octets: "np.ndarray[Any, np.dtype[np.uint8]]", width: int, height: int) -> bytes:
    rgb = octets.reshape(height, width, 3)
    _, encoded = cv2.imencode(".png", cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR))
    return pybase64.b64encode(encoded.data)
