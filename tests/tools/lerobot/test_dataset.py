# SPDX-License-Identifier: Apache-2.0
"""A recording becomes a dataset, whose every value is as expected.

``tools/lerobot/check.py`` loads a dataset by LeRobot itself, which is too large for a test.
"""

import hashlib
import json
import os
import shutil
import statistics
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import pytest

from tests.tools.lerobot.recorded import MAPPING, Recording

ROOT: Final = Path(__file__).parents[3]
REQUIREMENTS: Final = ROOT / "tools" / "lerobot" / "requirements.txt"
UNLABELLED: Final = 'it is not labelled with success: set episodes = "all" to keep it'
# in a process that has the packages: tables, and red, green, and blue of the middle of each image
READ: Final = """
import av, json, pathlib, sys
import pyarrow.parquet as pq

folder = pathlib.Path(sys.argv[1])
tables = {}
for path in folder.rglob("*.parquet"):
    table = pq.read_table(path)
    types = {field.name: str(field.type) for field in table.schema}
    tables[path.relative_to(folder).as_posix()] = [types, table.to_pylist()]
videos = {}
for path in folder.rglob("*.mp4"):
    with av.open(path) as container:
        stream = container.streams.video[0]
        size = [stream.codec_context.name, stream.height, stream.width, float(stream.average_rate)]
        images = [
            [float(frame.pts * frame.time_base), frame.to_ndarray(format="rgb24")[8, 8].tolist()]
            for frame in container.decode(stream)
        ]
    videos[path.relative_to(folder).as_posix()] = [size, images]
print(json.dumps([tables, videos]))
"""


@pytest.fixture(scope="module")
def packages() -> Path:
    """Install what the conversion needs next to the gateway, into a directory that stays."""
    name = hashlib.sha256(REQUIREMENTS.read_bytes() + sys.version.encode()).hexdigest()[:12]
    folder = ROOT / ".cache" / f"lerobot-{name}"
    if not folder.exists():
        new = folder.with_name(f"{folder.name}.{os.getpid()}")
        install = ["sh", "tools/pip-install.sh", sys.executable, "--no-deps", "--no-compile"]
        install += ["--target", str(new), "-r", str(REQUIREMENTS)]
        installed = subprocess.run(install, cwd=ROOT, capture_output=True, text=True, check=False)
        if "no network" in installed.stderr:
            pytest.skip(f"cannot install {REQUIREMENTS.name}: {installed.stderr.strip()}")
        assert installed.returncode == 0, installed.stderr
        try:
            new.rename(folder)
        except OSError:  # another worker was faster
            shutil.rmtree(new)
    return folder


def run(packages: Path, *arguments: object) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": f"{packages}:{ROOT}"}
    command = [sys.executable, *map(str, arguments)]
    return subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False, timeout=300
    )


def convert(
    packages: Path,
    output: Path,
    *recordings: Path,
    program: Sequence[str] = ("-m", "tools.lerobot"),
) -> subprocess.CompletedProcess[str]:
    mapping = output.parent / "mapping.toml"
    mapping.write_text(MAPPING)
    return run(packages, *program, *recordings, "-m", mapping, "-o", output)


def test_a_recording_becomes_a_dataset(packages: Path, tmp_path: Path):
    recording = Recording(tmp_path / "a")
    recording.episode(0, 0, 400, "true", "pick")
    recording.episode(1, 500, 600, "")  # nobody has said whether it succeeded
    recording.note("2/start", 650, task="pick", operator="")
    recording.episode(3, 700, 1000, "false")
    recording.command(0, 0.5)
    for at_ms in range(0, 1001, 50):
        recording.odometry(at_ms, at_ms / 1000)
        recording.images(at_ms, at_ms // 5)
    output = tmp_path / "dataset"
    done = convert(packages, output, recording.finish())
    assert done.stderr.splitlines() == [
        "a, episode 0: 5 frames, 'pick'",
        f"a, episode 1 is left out: {UNLABELLED}",
        "a, episode 2 is left out: it has no end, because the recording ended before",
        "a, episode 3: 4 frames, 'wait'",
        f"wrote {output}: 2 episodes, 9 frames",
    ]
    assert done.returncode == 0
    read = run(packages, "-c", READ, output)
    assert read.returncode == 0, read.stderr
    tables, videos = json.loads(read.stdout)
    check_data(*tables.pop("data/chunk-000/file-000.parquet"))
    check_episodes(tables.pop("meta/episodes/chunk-000/file-000.parquet")[1])
    assert tables.pop("meta/tasks.parquet")[1] == [
        {"task_index": 0, "task": "pick"},
        {"task_index": 1, "task": "wait"},
    ]
    assert tables == {}
    check_videos(videos)
    check_meta(json.loads((output / "meta/info.json").read_text()))
    check_stats(json.loads((output / "meta/stats.json").read_text()))
    assert sorted(each.name for each in tmp_path.iterdir()) == ["a", "dataset", "mapping.toml"]


TIMES_MS: Final = (0, 100, 200, 300, 400, 700, 800, 900, 1000)


def check_data(types: dict[str, str], rows: list[dict[str, Any]]) -> None:
    assert types == {
        "observation.state": "fixed_size_list<element: float>[2]",
        "action": "float",
        "next.reward": "float",
        "next.done": "bool",
        "next.success": "bool",
        "timestamp": "float",
        **dict.fromkeys(("frame_index", "episode_index", "index", "task_index"), "int64"),
    }
    for number, (row, at_ms) in enumerate(zip(rows, TIMES_MS, strict=True)):
        episode, begin = (0, 0) if number < 5 else (1, 5)
        assert row == {
            "observation.state": pytest.approx([at_ms / 1000, at_ms / 500]),
            "action": 0.5 if at_ms <= 250 else 0.0,
            "next.reward": 1.0 if number == 4 else 0.0,
            "next.done": number in (4, 8),
            "next.success": number == 4,
            "timestamp": pytest.approx((number - begin) / 10),
            "frame_index": number - begin,
            "episode_index": episode,
            "index": number,
            "task_index": episode,
        }


def check_episodes(episodes: list[dict[str, Any]]) -> None:
    for episode, (number, task, begin, length) in zip(
        episodes, [(0, "pick", 0, 5), (1, "wait", 5, 4)], strict=True
    ):
        described = {key: each for key, each in episode.items() if not key.startswith("stats/")}
        place = {"chunk_index": 0, "file_index": 0}
        time = {"from_timestamp": begin / 10, "to_timestamp": (begin + length) / 10}
        assert described == {
            "episode_index": number,
            "tasks": [task],
            "length": length,
            "dataset_from_index": begin,
            "dataset_to_index": begin + length,
            **{f"{key}/{name}": 0 for key in ("data", "meta/episodes") for name in place},
            **{
                f"videos/observation.images.{camera}/{name}": value
                for camera in ("front", "wrist")
                for name, value in {**place, **time}.items()
            },
        }
        assert episode["stats/index/min"] == [begin]
        assert episode["stats/index/count"] == [length]
        assert episode["stats/observation.images.front/count"] == [length]


def check_videos(videos: dict[str, Any]) -> None:
    (front, wrist) = (
        videos.pop(f"videos/observation.images.{name}/chunk-000/file-000.mp4")
        for name in ("front", "wrist")
    )
    assert videos == {}
    assert front[0] == ["h264", 48, 64, 10]
    assert wrist[0] == ["h264", 16, 32, 10]
    for number, at_ms in enumerate(TIMES_MS):
        grey = at_ms // 5
        expected = {"front": [255 - grey, grey, grey], "wrist": [grey] * 3}
        for (_, images), colour in zip((front, wrist), expected.values(), strict=True):
            at_s, pixel = images[number]
            assert at_s == pytest.approx(number / 10)
            assert pixel == pytest.approx(colour, abs=4)  # JPEG, H.264, and their colours
    assert len(front[1]) == len(wrist[1]) == len(TIMES_MS)


def check_meta(info: dict[str, Any]) -> None:
    features = info.pop("features")
    assert info == {
        "codebase_version": "v3.0",
        "robot_type": "tested",
        "total_episodes": 2,
        "total_frames": 9,
        "total_tasks": 2,
        "chunks_size": 1000,
        "data_files_size_in_mb": 100,
        "video_files_size_in_mb": 200,
        "fps": 10,
        "splits": {"train": "0:2"},
        "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        "video_path": "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4",
    }
    state = {"dtype": "float32", "shape": [2], "names": ["x", "first"]}
    assert features["observation.state"] == state
    assert features["action"] == {"dtype": "float32", "shape": [1], "names": ["speed"]}
    assert features["next.done"] == {"dtype": "bool", "shape": [1], "names": None}
    wrist = features["observation.images.wrist"]
    assert (wrist["dtype"], wrist["shape"]) == ("video", [16, 32, 3])
    assert wrist["names"] == ["height", "width", "channels"]
    assert wrist["info"]["video.codec"] == "h264"


def check_stats(stats: dict[str, Any]) -> None:
    state = stats["observation.state"]
    assert (state["min"], state["max"], state["count"]) == ([0, 0], [1, 2], [9])
    mean, spread = statistics.mean(TIMES_MS) / 1000, statistics.pstdev(TIMES_MS) / 1000
    assert state["mean"] == pytest.approx([mean, 2 * mean])
    assert state["std"] == pytest.approx([spread, 2 * spread])
    assert state["q50"] == pytest.approx([0.4, 0.8])
    assert stats["next.success"]["mean"] == pytest.approx([1 / 9])
    wrist = stats["observation.images.wrist"]
    assert wrist["min"] == [[[0]], [[0]], [[0]]]
    assert wrist["max"] == [[[200 / 255]]] * 3
    assert wrist["mean"] == [[[pytest.approx(mean * 200 / 255)]]] * 3
    assert wrist["std"] == [[[pytest.approx(spread * 200 / 255)]]] * 3
    assert wrist["q50"] == [[[80 / 255]]] * 3
    red, green, _ = stats["observation.images.front"]["mean"]
    assert red[0][0] == pytest.approx(1 - green[0][0], abs=0.02)


def test_nothing_is_written_where_something_is_or_where_no_episode_is_usable(
    packages: Path, tmp_path: Path
):
    recording = Recording(tmp_path / "a")
    recording.odometry(0, 1)
    recording.command(0, 1)
    recording.images(0, 1)
    folder = recording.finish()
    done = convert(packages, tmp_path / "dataset", folder)
    assert done.returncode == 1
    assert f"{folder} has no episodes" in done.stderr
    assert "no episode is left, nothing is written" in done.stderr
    assert not (tmp_path / "dataset").exists()
    done = convert(packages, folder, folder)
    assert done.returncode == 1
    assert f"{folder} is not empty: name a new directory" in done.stderr


def test_recordings_are_joined_and_an_episode_may_begin_the_next_file(
    packages: Path, tmp_path: Path
):
    folders = []
    for name, width in (("a", 64), ("b", 64), ("c", 32)):
        recording = Recording(tmp_path / name)
        recording.episode(0, 0, 100, "true", "pick")
        recording.odometry(0, 1)
        recording.command(0, 1)
        recording.images(0, 1, width=width)
        folders.append(recording.finish())
    without_commands = Recording(tmp_path / "d")
    without_commands.odometry(0, 1)
    folders = [tmp_path / "missing", without_commands.finish(), *folders]
    program = "import sys, tools.lerobot.video as video; video.FILE_BYTES = 0"
    program += "; from tools.lerobot.__main__ import main; sys.exit(main())"
    output = tmp_path / "dataset"
    done = convert(packages, output, *folders, program=("-c", program))
    assert f"{folders[0]} is left out: cannot read" in done.stderr
    assert f"{folders[1]} is left out: topic /cmd_vel is not in the recording" in done.stderr
    assert "c, episode 0 is left out: its images have other sizes" in done.stderr
    assert f"wrote {output}: 2 episodes, 4 frames" in done.stderr
    tables, videos = json.loads(run(packages, "-c", READ, output).stdout)
    key = "videos/observation.images.front"
    episodes = tables["meta/episodes/chunk-000/file-000.parquet"][1]
    assert [each[f"{key}/file_index"] for each in episodes] == [0, 1]
    assert [each[f"{key}/from_timestamp"] for each in episodes] == [0, 0]
    for number in (0, 1):
        assert len(videos[f"{key}/chunk-000/file-00{number}.mp4"][1]) == 2


def test_without_the_packages_the_command_says_how_to_get_them(tmp_path: Path):
    done = convert(tmp_path / "missing", tmp_path / "dataset", tmp_path)
    assert done.returncode == 1
    assert "pip install '.[record]' -r tools/lerobot/requirements.txt" in done.stderr
