# SPDX-License-Identifier: Apache-2.0
"""The thread that writes."""

import os
import sys
import threading
from pathlib import Path

import pytest

from gateway.config.recording import RecordingConfig
from gateway.recording import disk, writer
from gateway.recording.disk import why_full
from gateway.recording.entries import RecordedMessage
from gateway.recording.mcap_file import RecordingFile
from gateway.recording.writer import RecordingWriter
from tests.client import eventually
from tests.recording.readers import by_all
from tests.recording.test_mcap_file import CONFIG, MESSAGES, TOPIC


def message(number: int, size: int = 100_000) -> RecordedMessage:
    text = (b"%05d" % number) * (size // 5) + b"\0"
    return RecordedMessage(number, number, TOPIC, b"\0\1\0\0" + _length(text) + text)


def _length(text: bytes) -> bytes:
    return len(text).to_bytes(4, "little")


async def stopped(recording: RecordingWriter) -> None:
    recording.stop()
    await eventually(lambda: recording.state == "stopped")


async def test_a_kill_loses_less_than_a_second():
    assert writer.SYNC_S + writer.LOOK_S <= 0.9
    # not so often that a disk wears out, nor so slow that a stop waits
    assert (writer.SYNC_S, writer.LOOK_S) == (0.75, 0.1)
    # a fifth of what the other side of the GIL waits for by default
    assert sys.getswitchinterval() >= disk.PAUSE_S * 10


async def test_a_directory_of_the_same_name_is_left_alone(tmp_path: Path):
    for name in ("x", "x_2", "x_3"):
        recording = RecordingWriter(tmp_path / "x", CONFIG, "test", lambda: None)
        await eventually(lambda: recording.state != "starting")  # noqa: B023
        assert recording.folder == tmp_path / name
        await stopped(recording)


async def test_a_slow_disk_costs_the_oldest_messages_and_no_more(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    goes_on, has_begun = threading.Event(), threading.Event()
    add = RecordingFile.add

    def hang(file: RecordingFile, message: RecordedMessage) -> None:
        has_begun.set()
        goes_on.wait(60)
        add(file, message)

    monkeypatch.setattr(RecordingFile, "add", hang)
    config = RecordingConfig(min_free_bytes=0, queue_bytes=1024**2)
    recording = RecordingWriter(tmp_path / "x", config, "test", lambda: None)
    recording.put(message(0))
    await eventually(has_begun.is_set)
    for number in range(1, 30):
        recording.put(message(number))
    assert recording.waiting.size <= 1024**2
    dropped = recording.waiting.dropped()["/x"]
    goes_on.set()
    await stopped(recording)
    numbers = [0, *range(1 + dropped, 30)]
    assert by_all(tmp_path / "x")["/x"] == [message(number).cdr for number in numbers]
    assert recording.waiting.size == 0


async def test_much_wakes_the_thread_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    assert writer.WAKE_BYTES == 4 * 1024**2
    monkeypatch.setattr(writer, "LOOK_S", 3600)
    recording = RecordingWriter(tmp_path / "x", CONFIG, "test", lambda: None)
    await eventually(lambda: recording.state == "recording")
    recording.put(message(0, writer.WAKE_BYTES + 100))
    await eventually(lambda: recording.messages == 1)
    await stopped(recording)


async def test_the_free_space_is_looked_at_for_each_mib(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    assert writer.MAX_UNCHECKED_BYTES == 1024**2
    looks = []
    monkeypatch.setattr(writer, "why_full", lambda *_: looks.append(1) or "")
    recording = RecordingWriter(tmp_path / "x", CONFIG, "test", lambda: None)
    await eventually(lambda: recording.state == "recording")
    before = len(looks)
    with recording.waiting._lock:  # so that all is taken at once
        for number in range(50):
            threading.Thread(target=recording.put, args=(message(number),)).start()
    await eventually(lambda: recording.messages == 50)
    await stopped(recording)
    assert len(looks) - before >= 5


async def test_the_loop_runs_between_a_few_messages(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    assert (disk.MOST_AT_ONCE, disk.MOST_AT_ONCE_BYTES) == (16, 64 * 1024)
    counts = []
    recording = RecordingWriter(tmp_path / "x", CONFIG, "test", lambda: None)
    written = recording.waiting.written
    monkeypatch.setattr(
        recording.waiting, "written", lambda *given: counts.append(given) or written(*given)
    )
    for each in MESSAGES:
        recording.put(each)
    recording.put(message(1, 70_000))
    await stopped(recording)
    assert max(count for count, _ in counts) == 16
    assert sum(count for count, _ in counts) == len(MESSAGES) + 1


async def test_a_disk_that_cannot_be_written_ends_the_recording(tmp_path: Path):
    (tmp_path / "file").write_text("")
    recording = RecordingWriter(tmp_path / "file" / "x", CONFIG, "test", lambda: None)
    await eventually(lambda: recording.state == "stopped")
    assert recording.why == f"cannot write {tmp_path}/file/x, not a directory"


def test_the_smaller_of_share_and_bytes_stays_free(tmp_path: Path):
    of_disk = os.statvfs(tmp_path)
    size = of_disk.f_blocks * of_disk.f_frsize
    free = of_disk.f_bavail * of_disk.f_frsize

    def why(**settings: float) -> str:
        return why_full(tmp_path, RecordingConfig(**settings))

    assert why(min_free_bytes=free // 2, min_free_share=1) == ""
    assert why(min_free_bytes=size * 2, min_free_share=0) == ""
    assert "lower recording.min_free_share" in why(min_free_bytes=size * 2, min_free_share=1)
    assert "lower recording.min_free_bytes" in why(min_free_bytes=size - 1, min_free_share=1)
