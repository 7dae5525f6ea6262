# SPDX-License-Identifier: Apache-2.0
"""Load a dataset with LeRobot itself, and compare what it loads with the files.

Run ``python tools/lerobot/check.py DATASET`` in an environment with the package lerobot.
"""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import av
import numpy as np
import pyarrow.parquet as pq
from numpy.testing import assert_allclose, assert_equal

from lerobot.datasets.lerobot_dataset import LeRobotDataset

MAX_DIFFERENCE = 2 / 255  # of a colour, because decoders round differently


def main(folder: Path) -> None:
    """Compare each frame."""
    dataset = LeRobotDataset("local/check", root=folder)
    rows = pq.read_table(folder / "data").to_pylist()
    tasks = pq.read_table(folder / "meta" / "tasks.parquet").to_pydict()["task"]
    videos = {key: _images(folder / "videos" / key) for key in dataset.meta.video_keys}
    assert_equal(len(dataset), len(rows))
    for number, row in enumerate(rows):
        frame = dataset[number]
        assert_equal(frame["task"], tasks[row["task_index"]])
        for key, value in row.items():
            assert_allclose(frame[key].numpy(), np.array(value), rtol=1e-6)
        for key, images in videos.items():
            expected = next(images).transpose(2, 0, 1) / 255
            assert_allclose(frame[key].numpy(), expected, atol=MAX_DIFFERENCE)
    for key, stats in dataset.meta.stats.items():
        shape = (3, 1, 1) if key in videos else np.atleast_1d(rows[0][key]).shape
        assert_equal({value.shape for name, value in stats.items() if name != "count"}, {shape})
    sys.stdout.write(f"{dataset}\nall {len(rows)} frames are as in the files\n")


def _images(folder: Path) -> Iterator[Any]:
    for path in sorted(folder.rglob("*.mp4")):
        with av.open(path) as container:
            for frame in container.decode(video=0):
                yield frame.to_ndarray(format="rgb24")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
