# SPDX-License-Identifier: Apache-2.0
"""The files of a LeRobot dataset, version 3."""

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Final

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from tools.lerobot.mapping import Mapping, names_of
from tools.lerobot.rows import Row
from tools.lerobot.stats import Stats, count_pixels, stats_of_counts, stats_of_numbers
from tools.lerobot.video import FILE_BYTES, VideoFiles

_CHUNK: Final = "chunk-000"
_FILE: Final = f"{_CHUNK}/file-000.parquet"
_TYPES: Final = {"float32": pa.float32(), "int64": pa.int64(), "bool": pa.bool_()}

Arrays = dict[str, NDArray[Any]]
Sizes = dict[str, tuple[int, int]]
"""Height and width of the images of each camera."""


class Dataset:
    """Writes episodes into a directory."""

    def __init__(self, folder: Path, mapping: Mapping, sizes: Sizes) -> None:
        self.sizes = sizes
        self.frames = 0
        self.folder = folder
        self._mapping = mapping
        self._features = _features(mapping)
        self._schema = pa.schema({key: _type_of(each) for key, each in self._features.items()})
        self._tasks: dict[str, int] = {}
        self._episodes: list[dict[str, Any]] = []
        self._columns: list[Arrays] = []  # of each episode
        self._pixels: list[Arrays] = []  # how often each value occurs
        self._videos = {
            key: VideoFiles(folder / "videos" / key / _CHUNK, mapping.fps) for key in sizes
        }
        self._data = pq.ParquetWriter(_made(folder / "data" / _FILE), self._schema)

    @property
    def episodes(self) -> int:
        """The number of episodes."""
        return len(self._episodes)

    def add(self, rows: Iterable[Row], task: str, *, success: bool) -> int:
        """Add an episode, and return the number of its frames."""
        places = {key: files.begin_episode(self.sizes[key]) for key, files in self._videos.items()}
        pixels = {key: np.zeros((3, 256), np.int64) for key in self._videos}
        numbers: list[tuple[list[float], list[float]]] = []
        for row in rows:
            numbers.append((row.state, row.action))
            for key, image in row.images.items():
                self._videos[key].add(image)
                count_pixels(pixels[key], image)
        number = self._tasks.setdefault(task, len(self._tasks))
        columns = self._columns_of(numbers, number, success=success)
        self._data.write_table(_table(columns, self._schema))
        self._columns.append(columns)
        self._pixels.append(pixels)
        self._note_episode(len(numbers), task, places)
        return len(numbers)

    def finish(self) -> None:
        """Write what describes the episodes."""
        self._data.close()
        for files in self._videos.values():
            files.finish()
        meta = self.folder / "meta"
        pq.write_table(pa.Table.from_pylist(self._episodes), _made(meta / "episodes" / _FILE))
        pq.write_table(_tasks_table(self._tasks), meta / "tasks.parquet")
        for name, values in (("info", self._info()), ("stats", self._stats(0))):
            text = json.dumps(values, indent=4, ensure_ascii=False)
            (meta / f"{name}.json").write_text(text, "utf-8")

    def _note_episode(self, count: int, task: str, places: dict[str, tuple[int, float]]) -> None:
        episode: dict[str, Any] = {
            "episode_index": self.episodes,
            "tasks": [task],
            "length": count,
            "data/chunk_index": 0,
            "data/file_index": 0,
            "dataset_from_index": self.frames,
            "dataset_to_index": self.frames + count,
            "meta/episodes/chunk_index": 0,
            "meta/episodes/file_index": 0,
        }
        for key, (number, from_s) in places.items():
            episode |= {
                f"videos/{key}/chunk_index": 0,
                f"videos/{key}/file_index": number,
                f"videos/{key}/from_timestamp": from_s,
                f"videos/{key}/to_timestamp": from_s + count / self._mapping.fps,
            }
        for key, stats in self._stats(-1).items():
            episode |= {f"stats/{key}/{name}": value for name, value in stats.items()}
        self._episodes.append(episode)
        self.frames += count

    def _columns_of(
        self, numbers: list[tuple[list[float], list[float]]], task: int, *, success: bool
    ) -> Arrays:
        """Return an array for each feature, with a column for each part of a vector."""
        count = len(numbers)
        ordinals = np.arange(count)
        is_last = ordinals == count - 1
        columns: Arrays = {
            "observation.state": np.array([state for state, _ in numbers]),
            "action": np.array([action for _, action in numbers]),
            "next.reward": is_last & success,
            "next.done": is_last,
            "next.success": is_last & success,
            "timestamp": ordinals / self._mapping.fps,
            "frame_index": ordinals,
            "episode_index": np.full(count, self.episodes),
            "index": ordinals + self.frames,
            "task_index": np.full(count, task),
        }
        return {
            key: values.reshape(count, -1).astype(self._features[key]["dtype"])
            for key, values in columns.items()
        }

    def _stats(self, first: int) -> dict[str, Stats]:
        """Return the statistics from an episode on: 0 for all, -1 for the last one."""
        columns, pixels = self._columns[first:], self._pixels[first:]
        count = sum(len(each["index"]) for each in columns)
        return {
            key: stats_of_numbers(np.concatenate([each[key] for each in columns]))
            for key in self._features
        } | {
            key: stats_of_counts(np.sum([each[key] for each in pixels], axis=0), count)
            for key in self._videos
        }

    def _info(self) -> dict[str, Any]:
        file = "chunk-{chunk_index:03d}/file-{file_index:03d}"
        videos = {key: self._video_feature(*size) for key, size in self.sizes.items()}
        return {
            "codebase_version": "v3.0",
            "robot_type": self._mapping.robot_type,
            "total_episodes": self.episodes,
            "total_frames": self.frames,
            "total_tasks": len(self._tasks),
            "chunks_size": 1000,
            "data_files_size_in_mb": 100,
            "video_files_size_in_mb": FILE_BYTES // 1024**2,
            "fps": self._mapping.fps,
            "splits": {"train": f"0:{self.episodes}"},
            "data_path": f"data/{file}.parquet",
            "video_path": f"videos/{{video_key}}/{file}.mp4" if videos else None,
            "features": videos | self._features,
        }

    def _video_feature(self, height: int, width: int) -> dict[str, Any]:
        return {
            "dtype": "video",
            "shape": [height, width, 3],
            "names": ["height", "width", "channels"],
            "info": {
                "video.height": height,
                "video.width": width,
                "video.codec": "h264",
                "video.pix_fmt": "yuv420p",
                "video.is_depth_map": False,
                "video.fps": self._mapping.fps,
                "video.channels": 3,
                "has_audio": False,
            },
        }


def _features(mapping: Mapping) -> dict[str, dict[str, Any]]:
    vectors = {"observation.state": names_of(mapping.state), "action": names_of(mapping.action)}
    types = {"next.reward": "float32", "next.done": "bool", "next.success": "bool"}
    types |= {"timestamp": "float32", "frame_index": "int64", "episode_index": "int64"}
    types |= {"index": "int64", "task_index": "int64"}
    return {
        key: {"dtype": "float32", "shape": [len(names)], "names": names}
        for key, names in vectors.items()
    } | {key: {"dtype": each, "shape": [1], "names": None} for key, each in types.items()}


def _type_of(feature: dict[str, Any]) -> pa.DataType:
    (width,) = feature["shape"]
    one = _TYPES[feature["dtype"]]
    return one if width == 1 else pa.list_(one, width)


def _table(columns: Arrays, schema: pa.Schema) -> pa.Table:
    arrays = [
        pa.array(values.ravel())
        if values.shape[1] == 1
        else pa.FixedSizeListArray.from_arrays(pa.array(values.ravel()), values.shape[1])
        for values in (columns[key] for key in schema.names)
    ]
    return pa.Table.from_arrays(arrays, schema=schema)


def _tasks_table(tasks: dict[str, int]) -> pa.Table:
    """Return what pandas reads as a table whose index has the texts, as LeRobot does."""
    columns = [
        {"name": name, "field_name": name, "pandas_type": kind, "numpy_type": numpy}
        for name, kind, numpy in (("task_index", "int64", "int64"), ("task", "unicode", "object"))
    ]
    note = {"index_columns": ["task"], "column_indexes": [], "columns": columns}
    table = pa.table({"task_index": pa.array(tasks.values(), pa.int64()), "task": list(tasks)})
    return table.replace_schema_metadata({"pandas": json.dumps(note)})


def _made(path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    return path
