# SPDX-License-Identifier: Apache-2.0
"""A picture of the ratios: what a message costs as a multiple of what it costs the floor."""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Final
from xml.sax.saxutils import escape

from benchmarks.errors import BenchmarkError
from benchmarks.figures import Figure, read

# colours that are distinct on light and on dark pages
_TEXT: Final = "#7d8590"
_BAR: Final = "#2f81f7"
_LINE: Final = "#d29922"

_LABEL: Final = 170  # px, before the bars
_UNIT: Final = 240  # px for a ratio of 1
_ROW: Final = 26
_HEIGHT: Final = 16
_TOP: Final = 34
_VALUE: Final = 50  # px behind the longest bar


def draw(figures: Sequence[Figure]) -> str:
    """Return an SVG with a bar for each ratio, and a line at the floor.

    Raises:
        BenchmarkError: the figures have no ratio.
    """
    ratios = [one for one in figures if one.is_ratio]
    if not ratios:
        raise BenchmarkError("no ratio among the figures")
    width = round(_LABEL + _UNIT * max(1.0, *(one.value for one in ratios)) + _VALUE)
    height = _TOP + _ROW * len(ratios) + 8
    floor_x = _LABEL + _UNIT
    rows = [_row(one, _TOP + _ROW * number) for number, one in enumerate(ratios)]
    size = f'width="{width}" height="{height}" viewBox="0 0 {width} {height}"'
    font = 'font-family="sans-serif" font-size="13"'
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" {size} {font}>',
            "<title>CPU time of a message, as a multiple of a bare rclpy subscriber's</title>",
            *rows,
            f'<path d="M{floor_x} {_TOP - 8}V{height - 4}" stroke="{_LINE}" stroke-width="2"/>',
            _text(floor_x, _TOP - 14, "the floor", "middle"),
            "</svg>\n",
        ]
    )


def _row(figure: Figure, top: int) -> str:
    length = round(_UNIT * figure.value)
    baseline = top + _HEIGHT - 4
    bar = f'<rect x="{_LABEL}" y="{top}" width="{length}" height="{_HEIGHT}" fill="{_BAR}"/>'
    label = _text(_LABEL - 8, baseline, figure.scenario, "end")
    return f"{label}{bar}{_text(_LABEL + length + 6, baseline, f'{figure.value:.2f}', 'start')}"


def _text(x: int, y: int, text: str, anchor: str) -> str:
    return f'<text x="{x}" y="{y}" text-anchor="{anchor}" fill="{_TEXT}">{escape(text)}</text>'


def main() -> None:
    """Draw the figures that the command line names."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.chart", description=__doc__)
    parser.add_argument("figures", help="a file that --json wrote, or a name in reference/")
    parser.add_argument("picture", type=Path, help="the SVG to write")
    options = parser.parse_args()
    try:
        options.picture.write_text(draw(read(options.figures)))
    except (BenchmarkError, OSError) as error:
        parser.error(str(error))


if __name__ == "__main__":
    main()
