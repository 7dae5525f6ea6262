# SPDX-License-Identifier: Apache-2.0
"""Removal of the shared memory that killed participants left."""

import fcntl
import logging
import os
import re
from pathlib import Path

import pytest

from gateway.cli.logs import LogHandler
from gateway.sources.rclpy.shared_memory import (
    check_room,
    remove_abandoned_segments,
    without_shared_memory,
)
from gateway.sources.source import RosError

MIN_AGE_S = 2
NEEDED_BYTES = 16 * 1024


@pytest.fixture
def segment(tmp_path: Path) -> Path:
    return abandoned(tmp_path / "fastrtps_0123456789abcdef")


def abandoned(segment: Path, *, age_s: float = 60) -> Path:
    for path in (segment, lock_of(segment)):
        path.touch()
        os.utime(path, times=(path.stat().st_mtime - age_s,) * 2)
    return segment


def lock_of(segment: Path) -> Path:
    return segment.with_name(f"{segment.name}_el")


def test_the_segment_of_a_dead_participant_is_removed_with_its_lock(tmp_path: Path, segment: Path):
    newer = abandoned(tmp_path / "fastdds_0123456789abcdee")
    assert remove_abandoned_segments(tmp_path) == 2
    assert list(tmp_path.iterdir()) == []
    assert not newer.exists()


def test_the_log_says_how_much_was_removed(tmp_path: Path, segment: Path, caplog):
    with caplog.at_level("INFO"):
        remove_abandoned_segments(tmp_path)
    assert caplog.messages == ["removed 1 segment of shared memory that killed programs left"]


def test_a_lock_without_a_segment_is_removed(tmp_path: Path, segment: Path):
    segment.unlink()
    assert remove_abandoned_segments(tmp_path) == 1
    assert list(tmp_path.iterdir()) == []


def test_the_segment_of_a_living_participant_stays(tmp_path: Path, segment: Path):
    with lock_of(segment).open() as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        assert remove_abandoned_segments(tmp_path) == 0
    assert segment.exists()


def test_a_participant_that_has_just_begun_keeps_its_segment(tmp_path: Path):
    beginning = abandoned(tmp_path / "fastrtps_0123456789abcdef", age_s=MIN_AGE_S - 1)
    assert remove_abandoned_segments(tmp_path) == 0
    assert beginning.exists()


def test_an_empty_segment_of_a_participant_that_was_refused_is_removed_without_a_word(
    tmp_path: Path, segment: Path, caplog
):
    full, new = (abandoned(tmp_path / f"fastdds_{each * 16}") for each in "ab")
    full.write_text("content")
    os.utime(full, times=(0, 0))
    new.touch()
    for each in (segment, full, new):
        lock_of(each).unlink()
    with caplog.at_level("INFO"):
        assert remove_abandoned_segments(tmp_path) == 0
    assert set(tmp_path.iterdir()) == {full, new}
    assert caplog.messages == []


def test_an_empty_segment_of_another_user_stays(tmp_path: Path, segment: Path, monkeypatch):
    lock_of(segment).unlink()
    monkeypatch.setattr(os, "geteuid", lambda: segment.stat().st_uid + 1)
    remove_abandoned_segments(tmp_path)
    assert segment.exists()


def test_the_segment_of_another_user_stays(tmp_path, segment, monkeypatch):
    monkeypatch.setattr(os, "geteuid", lambda: segment.stat().st_uid + 1)
    assert remove_abandoned_segments(tmp_path) == 0
    assert segment.exists()


@pytest.mark.parametrize("name", ["fastrtps_port7411", "fastrtps_0123", "other_0123456789abcdef"])
def test_a_file_that_is_not_a_segment_stays(tmp_path: Path, name: str):
    abandoned(tmp_path / name)
    assert remove_abandoned_segments(tmp_path) == 0
    assert len(list(tmp_path.iterdir())) == 2


def test_a_link_is_not_followed(tmp_path: Path, segment: Path):
    lock_of(segment).rename(tmp_path / "elsewhere")
    lock_of(segment).symlink_to(tmp_path / "elsewhere")
    assert remove_abandoned_segments(tmp_path) == 0
    assert segment.exists()


def test_the_log_is_complete_after_a_time_without_shared_memory(tmp_path: Path):
    file = tmp_path / "log"
    with file.open("w", buffering=1) as stream:
        logger = logging.Logger("here")  # noqa: LOG001  # not one that outlives this test
        logger.addHandler(LogHandler(stream, "text"))
        with without_shared_memory():
            logger.info("said meanwhile")
            assert file.read_text() == ""
        logger.info("said later")
    assert re.findall("said .*", file.read_text()) == ["said meanwhile", "said later"]


def test_ros_is_not_started_where_there_is_no_room_at_all(tmp_path, monkeypatch):
    found = os.statvfs(tmp_path)
    fields = list(found)
    fields[4] = (NEEDED_BYTES - 1) // found.f_frsize  # f_bavail
    check_room(tmp_path)
    monkeypatch.setattr(os, "statvfs", lambda folder: os.statvfs_result(fields))
    page = tmp_path / f"lttng-ust-wait-6-{os.geteuid()}"
    os.truncate(os.open(page, os.O_CREAT | os.O_WRONLY), 4096)  # without memory behind it
    with pytest.raises(RosError, match=f"no space left in {tmp_path}, "):
        check_room(tmp_path)
    page.write_bytes(bytes(4096))
    check_room(tmp_path)


def test_a_machine_without_the_folder_has_room_elsewhere(tmp_path: Path):
    check_room(tmp_path / "none")


def test_a_machine_without_the_folder_has_nothing_to_remove(tmp_path: Path):
    assert remove_abandoned_segments(tmp_path / "none") == 0
