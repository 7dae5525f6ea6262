# SPDX-License-Identifier: Apache-2.0
"""The rows of an episode, and the reasons for which an episode or a mapping is refused."""

import contextlib
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from gateway.access.permissions import UNLIMITED
from gateway.recording.active_recording import Mark
from gateway.sources.recording.recording import open_recording
from tests.core.conftest import bench  # noqa: F401  # a fixture
from tests.doc_blocks import texts
from tests.recording.conftest import Studio, make_studio, studio  # noqa: F401  # fixtures
from tests.tools.lerobot.recorded import MAPPING, MS, START_NS, Recording
from tools.lerobot.episodes import Episode, episodes_of
from tools.lerobot.errors import ConversionError, LeftOutError
from tools.lerobot.mapping import Mapping, read_mapping
from tools.lerobot.rows import Row, Rows

ROOT = Path(__file__).parents[3]


def mapping_of(folder: Path, text: str = MAPPING) -> Mapping:
    (folder / "mapping.toml").write_text(text)
    return read_mapping(folder / "mapping.toml")


def rows_of(folder: Path, end_ms: int, text: str = MAPPING) -> list[Row]:
    """Return the rows of an episode from the start to *end_ms*."""
    mapping = mapping_of(folder.parent, text)
    with contextlib.closing(open_recording([folder], str)) as recording:
        return list(Rows(recording, mapping).of(START_NS, START_NS + end_ms * MS))


@pytest.fixture
def recording(tmp_path: Path) -> Recording:
    return Recording(tmp_path / "a")


async def test_episodes_are_those_that_an_operator_marks(studio: Studio):  # noqa: F811
    folder = await studio.start(task="pick")
    studio.recorder.mark(Mark(episode="end", success=True), UNLIMITED)
    studio.recorder.mark(Mark(episode="start"), UNLIMITED)
    studio.recorder.mark(Mark(episode="start", task="place", success=False), UNLIMITED)
    unfinished = episodes_of(folder)
    await studio.stop()
    first, second, third = episodes_of(folder)
    assert [each.task for each in (first, second, third)] == ["pick", "pick", "place"]
    assert [each.success for each in (first, second, third)] == [True, False, None]
    assert first.end_ns is not None
    assert first.start_ns < first.end_ns < second.start_ns
    assert all(each.end_ns is None or each in (first, second) for each in unfinished)


def test_a_tick_has_the_newest_values_that_had_come_by_then(recording: Recording):
    recording.odometry(-50, 1)
    recording.images(-50, 10)
    recording.command(-50, 0.1)
    recording.odometry(100, 2)  # at a tick
    recording.odometry(101, 3)
    recording.odometry(199, 4)
    recording.images(250, 20)
    recording.odometry(400, 5)
    rows = rows_of(recording.finish(), 450)
    assert [each.state for each in rows] == [[1, 2], [2, 4], [4, 8], [4, 8], [5, 10]]
    # it is 250 ms old at 200 ms, which is allowed, and the default comes after that
    assert [each.action for each in rows] == [[0.1], [0.1], [0.1], [0.0], [0.0]]
    wrist = [int(each.images["observation.images.wrist"][0, 0, 0]) for each in rows]
    assert wrist == [10, 10, 10, 20, 20]
    shapes = {key: image.shape for key, image in rows[0].images.items()}
    assert shapes == {
        "observation.images.front": (48, 64, 3),
        "observation.images.wrist": (16, 32, 3),
    }


def test_an_episode_begins_when_every_topic_has_a_value(recording: Recording):
    recording.command(-300, 1)
    recording.odometry(-501, 1)  # too old
    recording.odometry(150, 2)
    recording.images(250, 10)
    assert [each.state for each in rows_of(recording.finish(), 400)] == [[2, 4], [2, 4]]


@pytest.mark.parametrize(
    ("spoil", "reason"),
    [
        (lambda _: None, "until its end, /camera/compressed has no message of the last 0.5 s"),
        (lambda it: it.images(0, 1), "0.60 s after its start, /camera/compressed has no message"),
        (
            lambda it: (it.images(0, 1), it.odometry(300, float("nan"))),
            "0.30 s after its start, the newest message of /odom is broken: pose.pose.position.x",
        ),
        (
            lambda it: it.add(
                *(0, "/camera/compressed", "sensor_msgs/msg/CompressedImage"),
                format="jpeg",
                data=[1, 2],
            ),
            "0.00 s after its start, the newest message of /camera/compressed is broken",
        ),
    ],
)
def test_an_episode_with_a_gap_or_a_broken_value_is_left_out(
    recording: Recording, spoil: Callable[[Recording], object], reason: str
):
    recording.command(-300, 1)
    for at_ms in range(0, 800, 20):
        recording.odometry(at_ms, 1)
    recording.images(-900, 1)  # which is too old
    spoil(recording)
    with pytest.raises(LeftOutError, match=re.escape(reason)):
        rows_of(recording.finish(), 800)


def test_a_damaged_recording_is_named(recording: Recording):
    recording.command(0, 1)
    recording.images(0, 1)
    for at_ms in range(0, 200, 20):
        recording.odometry(at_ms, at_ms)
    (file,) = recording.finish().iterdir()
    content = bytearray(file.read_bytes())
    content[1000] ^= 0xFF
    file.write_bytes(content)
    with pytest.raises(ConversionError, match="the recording is damaged"):
        rows_of(recording.folder, 200)


@pytest.mark.parametrize(
    ("before", "after", "reason"),
    [
        (
            'topic = "/odom"',
            'topic = "/odon"',
            "/odon is not in the recording; did you mean /odom?",
        ),
        ("position.x", "positon.x", "topic /odom: unknown field pose.pose.positon.x"),
        ("covariance[0]", "covariance[36]", "pose.covariance[36] is not in it"),
        ("pose.pose.position.x", "header.frame_id", "header.frame_id is not a number"),
        ('"/wrist"', '"/odom"', "/odom has type nav_msgs/msg/Odometry: name one with"),
        ("fps = 10", "fsp = 10", "unknown key fsp; did you mean fps?"),
        ("fps = 10", "", "fps is missing: add it"),
        ("fps = 10", "fps = 0", "fps is 0: input should be greater than or equal to 1"),
        ("fields = ", "feilds = ", "unknown key state.0.feilds; did you mean fields?"),
        ('name = "wrist"', 'name = "front"', "image has two columns front: rename one of them"),
        ("fps = 10", "fps = ", "is not TOML"),
    ],
)
def test_a_mistake_in_the_mapping_is_named(
    recording: Recording, before: str, after: str, reason: str
):
    recording.odometry(0, 1)
    recording.command(0, 1)
    recording.images(0, 1)
    assert before in MAPPING
    with pytest.raises((ConversionError, LeftOutError), match=re.escape(reason)):
        rows_of(recording.finish(), 100, MAPPING.replace(before, after, 1))


@pytest.mark.parametrize(
    ("kept", "episode", "reason"),
    [
        ("all", Episode(0, "", 0, None, None), "it has no end"),
        ("labelled", Episode(0, "", 0, 1, None), "it is not labelled with success"),
        ("successful", Episode(0, "", 0, 1, False), "it did not succeed"),
    ],
)
def test_episodes_that_are_not_wanted_are_left_out(
    tmp_path: Path, kept: str, episode: Episode, reason: str
):
    mapping = mapping_of(tmp_path, f'episodes = "{kept}"\n{MAPPING}')
    with pytest.raises(LeftOutError, match=reason):
        episode.require(mapping)


def test_the_example_of_the_page_is_the_file():
    file = ROOT / "tools" / "lerobot" / "sim.toml"
    assert texts("how-to/train.md", "toml") == [file.read_text()]
    assert read_mapping(file).fps == 10


def test_the_task_is_that_of_the_episode_or_of_the_mapping(tmp_path: Path):
    mapping = mapping_of(tmp_path)
    assert Episode(0, "pick", 0, 1, False).require(mapping) == ("pick", 1)
    assert Episode(0, "", 0, 1, True).require(mapping) == ("wait", 1)
    nameless = mapping_of(tmp_path, MAPPING.replace('task = "wait"', 'episodes = "all"'))
    with pytest.raises(LeftOutError, match="set task in the mapping"):
        Episode(0, "", 0, 1, None).require(nameless)
