# SPDX-License-Identifier: Apache-2.0
import errno
import json
import logging
import os
import stat
import threading
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gateway import forced_end
from gateway.access import audit_file
from gateway.access.audit import MAX_LINES, MAX_VALUE_CHARACTERS, Audit
from gateway.access.audit_file import AuditFile
from gateway.errors import ConfigError
from gateway.guard import supervisor
from tests.client import TIMEOUT_S


def close(file: AuditFile) -> None:
    """Close a file, and wait longer for its lines than the gateway would."""
    file.close()
    file._thread.join(TIMEOUT_S)


class Clock:
    def __init__(self) -> None:
        self.now_ns = 1_767_323_045_000_000_000

    def __call__(self) -> int:
        return self.now_ns


@pytest.fixture
def clock() -> Clock:
    return Clock()


def test_an_event_is_one_line_of_json_for_the_log_and_the_file(clock, caplog):
    lines: list[str] = []
    with caplog.at_level(logging.INFO, "gateway.audit"):
        Audit(clock, lines.append).record("connected", name="tablet", role="operator", page=None)
    (line,) = lines
    assert json.loads(line) == {
        "time": "2026-01-02T03:04:05.000+00:00",
        "event": "connected",
        "name": "tablet",
        "role": "operator",
    }
    assert [record.getMessage() for record in caplog.records] == [line]
    assert caplog.records[0].name == "gateway.audit"


def test_a_record_has_its_client_and_topic_and_is_not_bounded_twice(clock, caplog):
    with caplog.at_level(logging.INFO, "gateway.audit"):
        Audit(clock).record("stop", client="10.0.0.5#7", topic="/cmd_vel", address="10.0.0.5")
    (record,) = caplog.records
    assert (record.client, record.topic, record.is_bounded) == ("10.0.0.5#7", "/cmd_vel", True)
    assert "10.0.0.5#7" not in record.getMessage()  # its number is of this run alone


@given(st.text())
def test_no_text_ends_its_line_or_is_longer_than_allowed(text):
    lines: list[str] = []
    Audit(Clock(), lines.append).record("refused", reason=text)
    (line,) = lines
    assert line.isascii()
    assert line.isprintable()
    assert json.loads(line)["reason"] == text[:MAX_VALUE_CHARACTERS]


def test_a_long_text_is_truncated(clock):
    lines: list[str] = []
    Audit(clock, lines.append).record("refused", reason="x" * 10_000)
    assert json.loads(lines[0])["reason"] == "x" * 200


def test_a_flood_of_one_kind_is_bounded_counted_and_hides_no_other(clock):
    lines: list[str] = []
    audit = Audit(clock, lines.append)
    for _ in range(10_000):
        audit.record("refused", reason="x")
    assert len(lines) == 100
    audit.record("stop", cause="deadline")
    clock.now_ns += 10_000_000_000 - 1
    audit.record("refused", reason="x")
    assert json.loads(lines[-1])["event"] == "stop"
    clock.now_ns += 1
    audit.record("refused", reason="y")
    assert json.loads(lines[-1])["left_out_before"] == 10_001 - 100
    audit.record("refused", reason="z")
    assert "left_out_before" not in json.loads(lines[-1])


def test_a_clock_that_is_set_back_silences_nothing(clock):
    lines: list[str] = []
    audit = Audit(clock, lines.append)
    for _ in range(MAX_LINES):
        audit.record("refused")
    clock.now_ns -= 3600 * 1_000_000_000
    audit.record("refused")
    assert len(lines) == MAX_LINES + 1


def test_the_file_is_for_its_owner_and_keeps_what_it_had(tmp_path):
    path = tmp_path / "audit.jsonl"
    path.write_text("before\n")
    path.chmod(0o644)
    file = AuditFile(path, 1_000_000)
    file.write("one")
    file.write("two")
    close(file)
    assert path.read_text() == "before\none\ntwo\n"
    assert stat.S_IMODE(path.stat().st_mode) == 0o600


def test_a_full_file_becomes_the_former_one_and_both_are_bounded(tmp_path):
    path = tmp_path / "audit.jsonl"
    file = AuditFile(path, 1000)
    for number in range(100):
        file.write(f"{number:03}".ljust(99, "."))
    close(file)
    assert path.stat().st_size <= 1000
    former = path.with_name("audit.jsonl.1")
    assert former.stat().st_size == 1000
    assert stat.S_IMODE(former.stat().st_mode) == 0o600
    kept = (former.read_text() + path.read_text()).splitlines()
    assert [int(line[:3]) for line in kept] == list(range(100 - len(kept), 100))
    assert sorted(each.name for each in tmp_path.iterdir()) == ["audit.jsonl", "audit.jsonl.1"]


def test_a_full_disk_at_the_moment_of_a_new_file_is_survived(tmp_path, monkeypatch, caplog):
    path = tmp_path / "audit.jsonl"
    file = AuditFile(path, 10)
    done = threading.Semaphore(0)
    is_full = True
    opened, append = AuditFile._open, AuditFile._append

    def full(self: AuditFile) -> int:
        if is_full:
            raise OSError(errno.ENOSPC, "no space left on device")
        return opened(self)

    def appended(self: AuditFile, data: bytes) -> None:
        try:
            append(self, data)
        finally:
            done.release()

    monkeypatch.setattr(AuditFile, "_open", full)
    monkeypatch.setattr(AuditFile, "_append", appended)
    for text in ("the first", "lost", "lost, too"):
        file.write(text)
        assert done.acquire(timeout=TIMEOUT_S)
    is_full = False
    file.write("kept")
    close(file)
    assert path.read_text() == "kept\n"
    assert path.with_name("audit.jsonl.1").read_text() == "the first\n"
    assert "2 lines are missing" in caplog.text


def test_a_file_that_cannot_be_written_is_an_error_of_the_configuration(tmp_path):
    with pytest.raises(ConfigError, match=f"audit.file: cannot write {tmp_path}, is a directory"):
        AuditFile(tmp_path, 1000)


def test_a_disk_that_hangs_delays_nothing_and_a_bounded_number_of_lines_wait(
    tmp_path, monkeypatch, caplog
):
    began, go_on = threading.Event(), threading.Event()
    append = AuditFile._append

    def hang(self: AuditFile, data: bytes) -> None:
        began.set()
        go_on.wait(TIMEOUT_S)
        append(self, data)

    monkeypatch.setattr(AuditFile, "_append", hang)
    file = AuditFile(tmp_path / "audit.jsonl", 10_000_000)
    file.write("first")
    assert began.wait(TIMEOUT_S)
    for number in range(1000 + 50):
        file.write(str(number))
    go_on.set()
    close(file)
    assert len((tmp_path / "audit.jsonl").read_text().splitlines()) == 1 + 1000
    assert "50 lines are missing" in caplog.text


def test_a_disk_that_hangs_leaves_the_shutdown_its_time(tmp_path, monkeypatch):
    file = AuditFile(tmp_path / "audit.jsonl", 1000)
    close(file)
    waits_s: list[float] = []
    file._lines = SimpleNamespace(put=lambda line, timeout: waits_s.append(timeout))
    monkeypatch.setattr(file._thread, "join", waits_s.append)
    file.close()
    assert waits_s == [0.3, 0.3]  # for room, and for what is written
    assert sum(waits_s) + supervisor.END_S < forced_end.SHUTDOWN_S


def test_a_full_disk_is_logged_once_and_when_it_is_over(tmp_path, monkeypatch, caplog):
    file = AuditFile(tmp_path / "audit.jsonl", 10_000_000)
    done = threading.Semaphore(0)
    is_full = True
    write = os.write

    def full(descriptor: int, data: bytes) -> int:
        try:
            return write(descriptor, data[:2] if is_full else data)
        finally:
            done.release()

    monkeypatch.setattr(audit_file.os, "write", full)
    for _ in range(3):
        file.write("lost")
        assert done.acquire(timeout=TIMEOUT_S)
    assert [fault.severity for fault in file.faults()] == ["degraded"]
    is_full = False
    file.write("kept")
    close(file)
    monkeypatch.undo()
    assert (tmp_path / "audit.jsonl").read_text() == "kept\n"
    assert caplog.text.count("no space left on device") == 1
    assert "3 lines are missing" in caplog.text
