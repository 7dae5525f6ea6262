# SPDX-License-Identifier: Apache-2.0
"""Files whose writer was killed are completed."""

import errno
import json
import logging
import os
import random
import shutil
from pathlib import Path
from typing import Any

import pytest
from mcap.exceptions import McapError
from mcap.writer import Writer

from gateway.config.recording import RecordingConfig
from gateway.recording import disk, mcap_file
from gateway.recording.entries import RecordedMessage, RecordedNote, RecordedTopic, qos_text
from gateway.recording.folder import repair_all, write_metadata
from gateway.recording.mcap_file import CHUNK_BYTES, RecordingFile
from gateway.sources.source import Qos
from tests.recording.readers import by_all, by_mcap, by_play, notes

CONFIG = RecordingConfig(min_free_bytes=0)  # the disk of a test may be nearly full
HASH = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
TOPIC = RecordedTopic("/x", "std_msgs/msg/String", "string data\n", HASH, qos_text([Qos()]))
MESSAGES = [
    RecordedMessage(number, number, TOPIC, b"\0\1\0\0\x05\0\0\0%04d\0" % number)
    for number in range(1000, 1100)
]


def written(folder: Path) -> RecordingFile:
    """Write half of the messages safely, and the others nowhere yet."""
    folder.mkdir(exist_ok=True)
    file = RecordingFile(folder / "x_0.mcap", "test")
    file.note(RecordedNote("episode/0/start", {"task": "pick"}))
    for number, message in enumerate(MESSAGES):
        if number == 50:
            file.sync()
        file.add(message)
    return file


def test_a_repair_keeps_all_that_was_synchronized(tmp_path: Path):
    file = written(tmp_path / "x")
    file.abandon()
    with pytest.raises(McapError):
        by_mcap_of(tmp_path / "x" / "x_0.mcap.active")
    safe = {"/x": [each.cdr for each in MESSAGES[:50]]}
    assert by_play(tmp_path / "x") == safe
    repair_all(tmp_path, CONFIG, "test", "jazzy")
    write_metadata(tmp_path / "x", "kilted")  # which another gateway has
    assert by_all(tmp_path / "x") == safe
    assert '"ros_distro": "jazzy"' in (tmp_path / "x" / "metadata.yaml").read_text()
    assert notes(tmp_path / "x") == {"episode/0/start": {"task": "pick"}}
    assert sorted(each.name for each in (tmp_path / "x").iterdir()) == ["metadata.yaml", "x_0.mcap"]


def by_mcap_of(path: Path) -> object:
    path.with_name("copy.mcap").write_bytes(path.read_bytes())
    try:
        return by_mcap(path.parent)
    finally:
        path.with_name("copy.mcap").unlink()


def test_a_file_is_repaired_wherever_it_was_cut(tmp_path: Path):
    file = written(tmp_path / "whole")
    file.sync()
    file.abandon()
    whole = (tmp_path / "whole" / "x_0.mcap.active").read_bytes()
    random_places = random.Random(1).sample(range(len(whole)), 40)
    found = set()
    for place in (0, 5, *random_places, len(whole)):
        folder = tmp_path / f"cut_{place}"
        folder.mkdir()
        for tail in (b"", b"\0" * 512):  # which a lost power may leave
            (folder / "x_0.mcap.active").write_bytes(whole[:place] + tail)
            repair_all(tmp_path, CONFIG, "test")
            assert not (folder / "x_0.mcap.active").exists()
            messages = by_all(folder).get("/x", [])
            assert messages == [each.cdr for each in MESSAGES[: len(messages)]]
            found.add(len(messages))
    assert found == {0, 50, 100}


def test_an_interrupted_repair_begins_again(tmp_path: Path):
    written(tmp_path / "x").abandon()
    (tmp_path / "x" / "x_0.mcap.repaired").write_bytes(b"half")
    repair_all(tmp_path, CONFIG, "test")
    assert len(by_all(tmp_path / "x")["/x"]) == 50


def test_a_file_that_is_being_written_is_not_repaired(tmp_path: Path):
    file = written(tmp_path / "x")
    repair_all(tmp_path, CONFIG, "test")
    assert (tmp_path / "x" / "x_0.mcap.active").exists()
    file.finish()
    assert len(by_mcap(tmp_path / "x")["/x"]) == 100


@pytest.mark.parametrize("where", ["flock", "rename", "finish"])
def test_nobody_else_completes_a_file_at_the_same_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, where: str
):
    """Another process looks for files to repair at each of these moments."""
    owners = {"flock": mcap_file.fcntl, "rename": Path, "finish": Writer}
    plain = getattr(owners[where], where)

    def repaired_at_that_moment(*given: Any) -> Any:
        with monkeypatch.context() as undone:
            undone.setattr(owners[where], where, plain)
            repair_all(tmp_path, CONFIG, "other")
        return plain(*given)

    with monkeypatch.context() as patched:
        patched.setattr(owners[where], where, repaired_at_that_moment)
        written(tmp_path / "x").finish()
        written(tmp_path / "killed").abandon()
        repair_all(tmp_path, CONFIG, "test")
    assert len(by_mcap(tmp_path / "x")["/x"]) == 100
    assert len(by_all(tmp_path / "killed")["/x"]) == 50
    assert "cannot repair" not in caplog.text


def test_a_recording_may_be_removed_during_a_repair(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    for name in ("a", "b", "c"):
        written(tmp_path / name).abandon()
    scandir = os.scandir

    def removed(path: Any) -> Any:
        if str(path).endswith("b"):
            shutil.rmtree(tmp_path / "b", ignore_errors=True)
        return scandir(path)

    monkeypatch.setattr(os, "scandir", removed)
    repair_all(tmp_path, CONFIG, "test")
    monkeypatch.undo()
    assert sorted(each.name for each in tmp_path.glob("*/*.mcap")) == ["x_0.mcap"] * 2


def test_a_file_that_cannot_be_repaired_stays(tmp_path: Path, caplog: pytest.LogCaptureFixture):
    written(tmp_path / "x").abandon()
    (tmp_path / "x" / "x_0.mcap.repaired").mkdir()
    with caplog.at_level(logging.ERROR):
        repair_all(tmp_path, CONFIG, "test")
    assert "cannot repair" in caplog.text
    assert "check who owns it" in caplog.text
    assert (tmp_path / "x" / "x_0.mcap.active").exists()


@pytest.mark.parametrize(
    ("error", "text"),
    [(OSError(errno.ENOSPC, "no space"), "make room on the disk"), (MemoryError(), "MemoryError")],
)
def test_a_failed_repair_leaves_nothing_but_the_file(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
    error: Exception,
    text: str,
):
    written(tmp_path / "x").abandon()

    def fail(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr("mcap.stream_reader.breakup_chunk", fail)
    repair_all(tmp_path, CONFIG, "test")
    assert text in caplog.text
    assert [each.name for each in (tmp_path / "x").iterdir()] == ["x_0.mcap.active"]


def test_a_repair_does_not_fill_the_disk(tmp_path: Path, caplog: pytest.LogCaptureFixture):
    (tmp_path / "x").mkdir()
    (tmp_path / "x" / "x_0.mcap.active").touch()
    free = os.statvfs(tmp_path)
    os.truncate(tmp_path / "x" / "x_0.mcap.active", 2 * free.f_bavail * free.f_frsize)
    repair_all(tmp_path, CONFIG, "test")
    assert "0 MB are to stay free: delete old recordings" in caplog.text
    assert [each.name for each in (tmp_path / "x").iterdir()] == ["x_0.mcap.active"]


def test_a_repair_keeps_what_it_could_not_read(tmp_path: Path, caplog: pytest.LogCaptureFixture):
    file = written(tmp_path / "x")
    file.sync()
    file.abandon()
    active = tmp_path / "x" / "x_0.mcap.active"
    damaged = bytearray(active.read_bytes())
    damaged[damaged.index(b"\x28\xb5\x2f\xfd") + 20] ^= 255  # in the first chunk of two
    active.write_bytes(damaged)
    repair_all(tmp_path, CONFIG, "test")
    assert by_all(tmp_path / "x") == {}
    assert (tmp_path / "x" / "x_0.mcap.damaged").read_bytes() == damaged
    assert "x_0.mcap.damaged" in caplog.text


def test_a_file_of_another_program_hinders_no_repair(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
):
    for name in ("a", "b", "c"):
        written(tmp_path / name).abandon()
    (tmp_path / "a" / "broken.mcap").write_bytes(b"broken")
    for name in ("a/foreign.mcap", "b/x_0.mcap.active"):
        with (tmp_path / name).open("wb") as file:
            writer = Writer(file, use_chunking=False)
            writer.start()
            writer.register_channel("/x", "json", 0)  # it has no schema
            writer.finish()
    repair_all(tmp_path, CONFIG, "test")
    described = {
        each.parent.name: json.loads(each.read_text())["rosbag2_bagfile_information"]
        for each in tmp_path.glob("*/metadata.yaml")
    }
    assert {name: each["relative_file_paths"] for name, each in described.items()} == {
        "a": ["x_0.mcap"],
        "c": ["x_0.mcap"],
    }
    assert "foreign.mcap is not in metadata.yaml" in caplog.text
    assert (tmp_path / "b" / "x_0.mcap.active").exists()


def test_a_repair_lets_the_loop_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    written(tmp_path / "x").abandon()
    pauses: list[float] = []
    monkeypatch.setattr(mcap_file.time, "sleep", pauses.append)
    repair_all(tmp_path, CONFIG, "test")
    assert pauses == [disk.PAUSE_S] * (50 // disk.MOST_AT_ONCE)


def test_a_chunk_ends_when_it_is_full(tmp_path: Path):
    tmp_path.joinpath("x").mkdir()
    file = RecordingFile(tmp_path / "x" / "x_0.mcap", "test")
    size = file.size
    noise = random.Random(1)
    for _ in range(3):
        file.add(MESSAGES[0]._replace(cdr=noise.randbytes(CHUNK_BYTES // 4)))
    assert file.size == size
    file.add(MESSAGES[0]._replace(cdr=noise.randbytes(CHUNK_BYTES // 4)))
    assert size + 1024**2 < file.size < size + 1024**2 + 1024
    file.abandon()


def test_a_profile_has_all_its_fields():
    (profile,) = json.loads(qos_text([Qos(lifespan_ns=1_500_000_000)]))
    assert profile["lifespan"] == {"sec": 1, "nsec": 500_000_000}
    assert profile["deadline"] == {"sec": 9223372036, "nsec": 854775807}
    assert (profile["depth"], len(profile)) == (10, 9)
