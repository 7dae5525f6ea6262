# SPDX-License-Identifier: Apache-2.0
"""Text in a picture: rosbridge's `png` compression."""

import math

import cv2
import numpy as np
import pybase64


def text_as_png(text: bytes) -> bytes:
    """Return the base64 of a PNG whose RGB values, row by row, are the text, padded with newlines.

    Browsers turn each value into one character, so the text must be ASCII. The function may run
    in any thread.
    """
    width = max(1, math.isqrt(len(text) // 3))
    height = -(-len(text) // (3 * width))
    padded = text.ljust(3 * width * height, b"\n")
    rgb = np.frombuffer(padded, np.uint8).reshape(height, width, 3)
    _, encoded = cv2.imencode(".png", cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR))
    return pybase64.b64encode(encoded.data)
