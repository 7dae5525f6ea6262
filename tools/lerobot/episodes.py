# SPDX-License-Identifier: Apache-2.0
"""The episodes of a recording, as its metadata records tell them."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from mcap.records import Metadata
from mcap.stream_reader import StreamReader

from tools.lerobot.errors import LeftOutError
from tools.lerobot.mapping import Mapping

_NAME: Final = re.compile(r"episode/(\d+)/(start|end)")


@dataclass(frozen=True)
class Episode:
    """One demonstration. Times are nanoseconds of the gateway's clock. No end: it was aborted."""

    number: int
    task: str
    start_ns: int
    end_ns: int | None
    success: bool | None

    def require(self, mapping: Mapping) -> tuple[str, int]:
        """Return its task and its end, if the mapping wants the episode.

        Raises:
            LeftOutError: it does not, or the episode is not complete.
        """
        task = self.task or mapping.task
        if self.end_ns is None:
            raise LeftOutError("it has no end, because the recording ended before")
        if self.success is None and mapping.episodes != "all":
            raise LeftOutError('it is not labelled with success: set episodes = "all" to keep it')
        if not self.success and mapping.episodes == "successful":
            raise LeftOutError("it did not succeed")
        if not task:
            raise LeftOutError("it has no task: set task in the mapping")
        return task, self.end_ns


def episodes_of(path: Path) -> list[Episode]:
    """Return the episodes of a recording, which is a directory or one of its files."""
    files = sorted(path.glob("*.mcap*")) if path.is_dir() else [path]
    notes = {each.name: each.metadata for file in files for each in _notes(file)}
    episodes = []
    for name, start in notes.items():
        match = _NAME.fullmatch(name)
        if match is None or match[2] != "start":
            continue
        end = notes.get(f"episode/{match[1]}/end")
        episodes.append(
            Episode(
                number=int(match[1]),
                task=start["task"],
                start_ns=int(start["time_ns"]),
                end_ns=None if end is None else int(end["time_ns"]),
                success={"true": True, "false": False}.get(end["success"]) if end else None,
            )
        )
    return sorted(episodes, key=lambda each: each.start_ns)


def _notes(path: Path) -> Iterator[Metadata]:
    with path.open("rb") as file:
        try:
            for record in StreamReader(file, emit_chunks=True).records:
                if isinstance(record, Metadata):
                    yield record
        except OSError:
            raise
        except Exception:  # noqa: BLE001  # the end of a file that is not complete, or not MCAP
            return
