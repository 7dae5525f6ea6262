# SPDX-License-Identifier: Apache-2.0
"""Statistics of columns, by which policies normalize: as LeRobot names and shapes them."""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

Stats = dict[str, list[Any]]

_QUANTILES: Final = {"q01": 0.01, "q10": 0.1, "q50": 0.5, "q90": 0.9, "q99": 0.99}
_PIXELS: Final = 150  # of the shorter side that count


def stats_of_numbers(rows: NDArray[Any]) -> Stats:
    """Return the statistics of each column of *rows*."""
    rows = rows.astype(np.float64)
    found = {
        "min": rows.min(axis=0),
        "max": rows.max(axis=0),
        "mean": rows.mean(axis=0),
        "std": rows.std(axis=0),
        **{name: np.quantile(rows, share, axis=0) for name, share in _QUANTILES.items()},
    }
    return {"count": [len(rows)]} | {name: value.tolist() for name, value in found.items()}


def count_pixels(counts: NDArray[Any], pixels: NDArray[Any]) -> None:
    """Add a part of the pixels of an image, which is BGR, to *counts*.

    These have a row for each channel, red first, and a number for each of the 256 values.
    """
    step = max(1, min(pixels.shape[:2]) // _PIXELS)
    for channel, row in zip((2, 1, 0), counts, strict=True):
        row += np.bincount(pixels[::step, ::step, channel].ravel(), minlength=256)


def stats_of_counts(counts: NDArray[Any], images: int) -> Stats:
    """Return the statistics of each channel, from 0 to 1, with the axes of an image."""
    channels = [_of_channel(row) for row in counts]
    return {"count": [images]} | {
        name: [[[channel[name]]] for channel in channels] for name in channels[0]
    }


def _of_channel(counts: NDArray[Any]) -> dict[str, float]:
    values = np.arange(256) / 255
    total = counts.sum()
    used = values[counts > 0]
    mean = counts @ values / total
    places = {
        name: np.searchsorted(counts.cumsum(), share * total) for name, share in _QUANTILES.items()
    }
    return {
        "min": float(used[0]),
        "max": float(used[-1]),
        "mean": float(mean),
        "std": float(np.sqrt(counts @ (values - mean) ** 2 / total)),
        **{name: float(values[place]) for name, place in places.items()},
    }
