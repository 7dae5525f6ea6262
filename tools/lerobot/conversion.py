# SPDX-License-Identifier: Apache-2.0
"""The conversion: all episodes of all recordings, one after the other."""

import contextlib
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final, Protocol

from gateway.errors import GatewayError, system_reason
from gateway.log_fields import counted
from gateway.sources.recording.recording import open_recording
from tools.lerobot.dataset import Dataset, Sizes
from tools.lerobot.episodes import Episode, episodes_of
from tools.lerobot.errors import ConversionError, LeftOutError
from tools.lerobot.mapping import Mapping
from tools.lerobot.rows import Row, Rows

_SHOWN: Final = 100  # frames, then progress is shown again


class Output(Protocol):
    """Shows what happens."""

    def line(self, text: str) -> None:
        """Show a sentence."""

    def progress(self, text: str) -> None:
        """Show what the next text replaces."""


def convert(paths: Sequence[Path], mapping: Mapping, folder: Path, output: Output) -> None:
    """Write a dataset into a directory that is empty or missing.

    Raises:
        ConversionError: there can be no dataset. Then the directory stays as it was.
    """
    try:
        if folder.exists() and any(folder.iterdir()):
            raise ConversionError(f"{folder} is not empty: name a new directory")
        folder.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=f".{folder.name}-", dir=folder.parent) as place:
            conversion = _Conversion(mapping, Path(place) / "dataset", output)
            for path in paths:
                try:
                    conversion.add(path)
                except GatewayError as error:  # of this recording, others may be as they should
                    output.line(f"{path} is left out: {error}")
            dataset = conversion.finish()
            dataset.folder.rename(folder)
    except OSError as error:
        raise ConversionError(
            f"cannot write {folder}, {system_reason(error)}: name another directory"
        ) from error
    size = f"{counted(dataset.episodes, 'episode')}, {counted(dataset.frames, 'frame')}"
    output.line(f"wrote {folder}: {size}")


class _Conversion:
    def __init__(self, mapping: Mapping, folder: Path, output: Output) -> None:
        self._mapping = mapping
        self._folder = folder
        self._output = output
        self._dataset: Dataset | None = None

    def add(self, path: Path) -> None:
        with contextlib.closing(open_recording([path], self._output.line)) as recording:
            rows = Rows(recording, self._mapping)
            try:
                episodes = episodes_of(path)
            except OSError as error:  # one that is being recorded has another name when it ends
                raise ConversionError(
                    f"cannot read it, {system_reason(error)}: try again"
                ) from error
            if not episodes:
                self._output.line(f"{path} has no episodes: record it with this gateway")
            for episode in episodes:
                name = f"{path.name}, episode {episode.number}"
                try:
                    self._add_episode(rows, episode, name)
                except LeftOutError as error:
                    self._output.line(f"{name} is left out: {error}")

    def finish(self) -> Dataset:
        """Complete the dataset."""
        if self._dataset is None:
            raise ConversionError(
                "no episode is left, nothing is written: correct what is said above"
            )
        self._dataset.finish()
        return self._dataset

    def _add_episode(self, rows: Rows, episode: Episode, name: str) -> None:
        task, end_ns = episode.require(self._mapping)

        def read(verb: str) -> Iterator[Row]:
            for number, row in enumerate(rows.of(episode.start_ns, end_ns)):
                if number % _SHOWN == 0:
                    self._output.progress(f"{name}: {verb} frame {number}")
                yield row

        # Read it twice: a video cannot forget the images of an episode that turns out to be wrong.
        sizes = _sizes_of(read("checking"))
        if self._dataset is None:
            self._dataset = Dataset(self._folder, self._mapping, sizes)
        if sizes != self._dataset.sizes:
            others = f"{sizes}, those before have {self._dataset.sizes}"
            raise LeftOutError(f"its images have other sizes, {others}: convert it alone")
        count = self._dataset.add(read("writing"), task, success=bool(episode.success))
        self._output.line(f"{name}: {counted(count, 'frame')}, {task!r}")


def _sizes_of(rows: Iterator[Row]) -> Sizes:
    """Return height and width by camera, after a look at all rows."""
    sizes: dict[str, tuple[int, int]] = {}
    for row in rows:
        for name, pixels in row.images.items():
            height, width = pixels.shape[:2]
            if sizes.setdefault(name, (height, width)) != (height, width):
                raise LeftOutError(f"image {name} changes its size")
    return sizes
