# SPDX-License-Identifier: Apache-2.0
"""The picture has a bar for every ratio, as long as it is large."""

import xml.etree.ElementTree as ET

import pytest

from benchmarks.chart import draw
from benchmarks.errors import BenchmarkError
from benchmarks.figures import Figure, ratio

SVG = "{http://www.w3.org/2000/svg}"


def test_each_ratio_has_a_bar_and_nothing_else_has():
    figures = [ratio("a & b", "x", 0.5), Figure("a", "p50", 7.0, "ms"), ratio("c", "x", 2.0)]
    picture = ET.fromstring(draw(figures))  # noqa: S314  # our own
    bars = [int(bar.attrib["width"]) for bar in picture.iter(f"{SVG}rect")]
    texts = [text.text for text in picture.iter(f"{SVG}text")]
    assert bars[1] == 4 * bars[0]
    assert int(picture.attrib["width"]) > bars[1]
    assert texts == ["a & b", "0.50", "c", "2.00", "the floor"]


def test_without_a_ratio_there_is_no_picture():
    with pytest.raises(BenchmarkError, match="no ratio"):
        draw([Figure("a", "p50", 7.0, "ms")])
