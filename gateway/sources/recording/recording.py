# SPDX-License-Identifier: Apache-2.0
"""A recording: one or several files, as one sequence of messages."""

import contextlib
import re
import stat
from collections import deque
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from heapq import heappop, heappush
from itertools import chain, takewhile
from pathlib import Path
from typing import Final

from gateway.errors import system_reason
from gateway.sources.recording.bag_file import BAG1_MAGIC, SQLITE_MAGIC, BagFile
from gateway.sources.recording.definition_parts import differs
from gateway.sources.recording.errors import RecordingError
from gateway.sources.recording.mcap_file import MAGIC as MCAP_MAGIC
from gateway.sources.recording.mcap_file import McapFile
from gateway.sources.recording.tracks import (
    ZSTD_MAGIC,
    NewestMessages,
    Recorded,
    RecordedFile,
    Track,
)
from schemas.definition import Definition

# Latched messages are searched for backwards, in windows that double.
FIRST_WINDOW_NS: Final = 1_000_000_000

# A longer time without any message, between two files, looks like a player that hangs.
MAX_GAP_NS: Final = 60_000_000_000

_NAME: Final = re.compile(r"(?:/[A-Za-z_][A-Za-z0-9_]*)+")
_METADATA: Final = "metadata.yaml"
_MCAP_NAMES: Final = ("*.mcap", "*.mcap.active")
_BAG_NAMES: Final = ("*.db3", "*.bag")


Note = Callable[[str], object]


class Recording:
    """All files that are played together. One thread at a time uses it."""

    def __init__(self, files: Sequence[RecordedFile]) -> None:
        self._files = files
        found = [track for file in files for track in file.tracks]
        self.tracks: Sequence[Track] = [each for each in found if _NAME.fullmatch(each.topic)]
        with_messages = [file for file in files if file.start_ns < file.end_ns]
        self.start_ns = min((file.start_ns for file in with_messages), default=0)
        self.end_ns = max((file.end_ns for file in with_messages), default=0)
        self.definitions: Mapping[str, Definition] = {
            name: each for file in reversed(files) for name, each in file.definitions.items()
        }
        self.skipped = {topic: why for file in files for topic, why in file.skipped.items()}
        self.skipped |= {
            track.topic: "ROS 2 does not allow its name"
            for track in found
            if track not in self.tracks
        }

    def messages(self, start_ns: int) -> Iterator[Recorded]:
        """Yield all messages from a time on, ordered by time."""
        return self._read(self.tracks, start_ns, self.end_ns)

    def latched_before(
        self, time_ns: int, is_wanted: Callable[[], bool] = lambda: True
    ) -> Sequence[Recorded]:
        """Return what the latched topics hold at a time, ordered by time.

        The result is incomplete once it is not wanted any more.
        """
        held: dict[Track, list[Recorded]] = {each: [] for each in self.tracks if each.held}
        stop_ns, window_ns = min(time_ns, self.end_ns), FIRST_WINDOW_NS
        while stop_ns > self.start_ns and is_wanted():
            missing = {
                track: NewestMessages[Recorded](track.held - len(found))
                for track, found in held.items()
                if len(found) < track.held
            }
            if not missing:
                break
            start_ns = max(self.start_ns, stop_ns - window_ns)
            for each in takewhile(lambda _: is_wanted(), self._read(missing, start_ns, stop_ns)):
                missing[each.track].add(each)
            for track, newest in missing.items():
                held[track][:0] = newest.messages
            stop_ns, window_ns = start_ns, 2 * window_ns
        return sorted((each for found in held.values() for each in found), key=_time)

    def close(self) -> None:
        """Close all files."""
        for file in self._files:
            file.close()

    def _read(self, tracks: Collection[Track], start_ns: int, stop_ns: int) -> Iterator[Recorded]:
        """Merge the files by time. Each is read only once its first message is near."""
        later = deque(sorted(self._files, key=lambda file: file.start_ns))
        heads: list[tuple[int, int, Recorded, Iterator[Recorded]]] = []
        while heads or later:
            if later and (not heads or later[0].start_ns <= heads[0][0]):
                messages = later.popleft().messages(tracks, start_ns, stop_ns)
                number = -len(later)  # of files that begin together, the first one first
            else:
                _, number, message, messages = heappop(heads)
                yield message
            found = next(messages, None)
            if found is not None:
                heappush(heads, (found.time_ns, number, found, messages))


def open_recording(
    paths: Sequence[Path], note: Note, show: Note = lambda progress: None
) -> Recording:
    """Open files and folders. *note* gets sentences about what is not as it should be.

    *show* gets the progress in large files. It may raise a `RecordingError` to end the reading.

    Raises:
        RecordingError: one of them is missing, foreign, or damaged, or there is no message.
    """
    with contextlib.ExitStack() as stack:
        files: list[RecordedFile] = []
        spans: list[tuple[int, int, Path]] = []
        for path in _each_once(chain.from_iterable(map(_files_of, paths)), note):
            file = _open(path, show)
            spans.append((file.start_ns, file.end_ns, path))
            stack.callback(file.close)
            if file.is_unfinished:
                note(f"{path} was not finished, all that is complete in it is played")
            files.append(file)
        _require_one_definition(files)
        recording = Recording(files)
        _note_gaps(spans, note)
        for topic, why in recording.skipped.items():
            note(f"topic {topic} is not played, {why}")
        if recording.start_ns >= recording.end_ns or not recording.tracks:
            names = ", ".join(map(str, paths))
            raise RecordingError(f"{names} contains no message to play: name another recording")
        stack.pop_all()
        return recording


def _files_of(path: Path) -> Sequence[Path]:
    """Return the files of a folder that can be read one by one, otherwise the path itself."""
    with _reading(path):
        if not path.is_dir():
            return [path]
        found = sorted(each for name in _MCAP_NAMES for each in path.glob(name))
        if found or (path / _METADATA).exists():
            return found or [path]
        found = sorted(each for name in _BAG_NAMES for each in path.glob(name))
        if not found:
            raise RecordingError(f"folder {path} has no recording: name a file, or another folder")
        return found


def _each_once(paths: Iterable[Path], note: Note) -> Iterator[Path]:
    known = set()
    for path in paths:
        with _reading(path):
            found = path.stat()
        if (found.st_dev, found.st_ino) in known:
            note(f"{path} is the same file as another one, it is played once")
        else:
            known.add((found.st_dev, found.st_ino))
            yield path


def _note_gaps(spans: Iterable[tuple[int, int, Path]], note: Note) -> None:
    latest_ns = None
    for start_ns, end_ns, path in sorted(each for each in spans if each[0] < each[1]):
        if latest_ns is not None and start_ns - latest_ns > MAX_GAP_NS:
            seconds = (start_ns - latest_ns) // 1_000_000_000
            note(f"nothing was recorded for {seconds} s before {path}, seek there or play it alone")
        latest_ns = max(latest_ns or 0, end_ns)


def _open(path: Path, show: Note) -> McapFile | BagFile:
    with _reading(path):
        if path.is_dir():
            return BagFile(path, is_ros1=False)
        if not stat.S_ISREG(path.stat().st_mode):
            raise RecordingError(f"{path} is not a file: name a recording")
        with path.open("rb") as stream:
            start = stream.read(len(SQLITE_MAGIC))
        if start.startswith(MCAP_MAGIC):
            return McapFile(path, show)
        if start.startswith(SQLITE_MAGIC) and path.suffix != ".db3":
            raise RecordingError(f"{path} is a database with another ending: rename it to .db3")
        if start.startswith(ZSTD_MAGIC):
            raise RecordingError(f"{path} is compressed: name its folder, or run `zstd -d` on it")
        if start.startswith((SQLITE_MAGIC, BAG1_MAGIC)):
            return BagFile(path, is_ros1=start.startswith(BAG1_MAGIC))
        what = "is empty" if not start else "is no recording"
        raise RecordingError(f"{path} {what}: name an MCAP file, a rosbag2 folder, or a ROS 1 bag")


@contextlib.contextmanager
def _reading(path: Path) -> Iterator[None]:
    """Say in a `RecordingError` which file cannot be read, and why."""
    try:
        yield
    except RecordingError:
        raise
    except OSError as error:
        raise RecordingError(
            f"cannot read {path}, {system_reason(error)}: name a recording that you can read"
        ) from error
    except Exception as error:  # of the libraries, whose kinds are many
        reason = " ".join(str(error).split()).rstrip(".") or type(error).__name__
        raise RecordingError(
            f"cannot read {path}, {reason}: repair it, for example with `mcap recover`,"
            " `ros2 bag reindex`, or `rosbag reindex`"
        ) from error


def _require_one_definition(files: Sequence[RecordedFile]) -> None:
    known: dict[str, Definition] = {}
    for file in files:
        for name, each in file.definitions.items():
            if differs(known, name, each):
                raise RecordingError(
                    f"the files define {name} in two ways: play them one at a time"
                )
            known[name] = each


def _time(each: Recorded) -> int:
    return each.time_ns
