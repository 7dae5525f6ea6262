# SPDX-License-Identifier: Apache-2.0
"""The log's two formats."""

import errno
import gc
import io
import json
import logging
import os
import sys
import threading
import warnings
from collections.abc import Iterator

import pytest

from gateway.access.audit import Audit
from gateway.cli.logs import configure_logging, wanted_format
from gateway.log_rate import BURST


@pytest.fixture(autouse=True)
def root_logger(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    root = logging.getLogger()
    handlers, level = root.handlers[:], root.level
    root.handlers.clear()  # those of pytest, which force=True would close
    monkeypatch.setattr(threading, "excepthook", threading.excepthook)
    monkeypatch.setattr(sys, "unraisablehook", sys.unraisablehook)
    yield
    logging.captureWarnings(False)
    root.handlers[:] = handlers
    root.setLevel(level)


def entries(text: str) -> list[dict[str, object]]:
    return [json.loads(line) for line in text.splitlines()]


def test_a_json_record_is_one_line_even_with_a_traceback(capsys):
    configure_logging("info", "json")
    try:
        int("two\nlines")
    except ValueError:
        logging.getLogger("gateway.test").exception("failed at %s", "x")
    (line,) = capsys.readouterr().err.splitlines()
    entry = json.loads(line)
    assert entry["level"] == "error"
    assert entry["logger"] == "gateway.test"
    assert entry["message"] == "failed at x"
    assert entry["traceback"].startswith("Traceback")


def test_an_event_of_the_audit_log_is_fields_of_its_line(capsys):
    configure_logging("info", "json")
    Audit(lambda: 0).record("stop", client="10.0.0.5#12", topic="/cmd_vel", reason="deadline")
    (entry,) = entries(capsys.readouterr().err)
    assert not entry.pop("time").startswith("1970")  # the log's own
    assert entry == {
        "level": "info",
        "logger": "gateway.audit",
        "message": "stop",
        "event": "stop",
        "client": "10.0.0.5#12",
        "topic": "/cmd_vel",
        "reason": "deadline",
    }


@pytest.mark.parametrize("log_format", ["text", "json"])
def test_the_journal_gets_the_priority_of_each_line(tmp_path, monkeypatch, log_format):
    path = tmp_path / "journal"
    with path.open("w+") as stream:
        status = os.fstat(stream.fileno())
        monkeypatch.setenv("JOURNAL_STREAM", f"{status.st_dev}:{status.st_ino}")
        configure_logging("debug", log_format, stream)
        logger = logging.getLogger("gateway.test")
        for level in ("debug", "info", "warning", "critical"):
            getattr(logger, level)("words")
        logger.error("words", exc_info=ValueError("two\nlines"))
        monkeypatch.setenv("JOURNAL_STREAM", "1:1")  # of another stream
        configure_logging("debug", log_format, stream)
        logger.error("words")
    *before, last = path.read_text().splitlines()
    assert [line[:3] for line in before[:4]] == ["<7>", "<6>", "<4>", "<2>"]
    assert {line[:3] for line in before[4:]} == {"<3>"}
    assert not last.startswith("<")


def test_records_below_the_level_are_left_out(capsys):
    configure_logging("warning", "text")
    logging.getLogger("gateway.test").info("quiet")
    logging.getLogger("gateway.test").warning("loud")
    (line,) = capsys.readouterr().err.splitlines()
    assert line.endswith("WARNING gateway.test: loud")


@pytest.mark.parametrize("log_format", ["text", "json"])
def test_a_line_of_a_client_has_its_client_and_topic(capsys, log_format):
    configure_logging("info", log_format)
    extra = {"client": "10.0.0.5#12", "topic": "/cmd_vel"}
    logging.getLogger("gateway.test").warning("stopped", extra=extra)
    (line,) = capsys.readouterr().err.splitlines()
    if log_format == "text":
        assert line.endswith("WARNING gateway.test: stopped [client 10.0.0.5#12, topic /cmd_vel]")
        return
    entry = json.loads(line)
    assert entry.items() >= {**extra, "message": "stopped"}.items()
    assert set(entry) == {"time", "level", "logger", "message", "client", "topic"}


def test_text_has_one_line_and_then_the_traceback(capsys):
    configure_logging("info", "text")
    try:
        int("two\nlines")
    except ValueError:
        logging.getLogger("gateway.test").exception("one\ntwo", extra={"client": "a#1"})
    first, second, *_ = capsys.readouterr().err.splitlines()
    assert first.endswith("one\\ntwo [client a#1]")
    assert second == "Traceback (most recent call last):"


@pytest.mark.parametrize("log_format", ["text", "json"])
def test_a_flood_of_one_client_leaves_few_lines_and_its_number(capsys, log_format):
    configure_logging("info", log_format)
    logger = logging.getLogger("gateway.test")
    for _ in range(10_000):
        logger.info("refused", extra={"client": "10.0.0.5#12"})
    logger.info("listening")
    logger.info("refused", extra={"client": "10.0.0.6#13"})
    logging.getLogger().handlers[0].close()
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == BURST + 3
    assert "listening" in lines[-3]
    assert "10.0.0.6#13" in lines[-2]
    assert f"refused ... and {10_000 - BURST - 1} more" in lines[-1]
    if log_format == "json":
        assert json.loads(lines[-1])["left_out"] == 10_000 - BURST - 1


def test_a_warning_of_python_is_a_record(capsys):
    configure_logging("info", "json")
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        warnings.warn("old\nway", DeprecationWarning, stacklevel=1)
    (entry,) = entries(capsys.readouterr().err)
    assert (entry["level"], entry["logger"]) == ("warning", "py.warnings")
    assert "DeprecationWarning: old\nway" in str(entry["message"])


def test_an_error_of_a_thread_is_a_record(capsys):
    configure_logging("info", "json")
    thread = threading.Thread(target=int, args=("x",), name="worker")
    thread.start()
    thread.join()
    (entry,) = entries(capsys.readouterr().err)
    assert entry["message"] == "thread worker failed"
    assert "ValueError" in str(entry["traceback"])


def test_an_error_that_nothing_can_raise_is_a_record(capsys):
    class Falling:
        def __del__(self) -> None:
            raise ZeroDivisionError

    configure_logging("info", "json")
    falling = Falling()
    del falling
    gc.collect()
    (entry,) = entries(capsys.readouterr().err)
    assert "exception ignored in" in str(entry["message"]).lower()
    assert "ZeroDivisionError" in str(entry["traceback"])


class Full(io.StringIO):
    """A file on a full disk."""

    def write(self, text: str) -> int:
        raise OSError(errno.ENOSPC, "no space left on device")


def test_a_line_that_cannot_be_written_is_lost_without_another_about_it(capsys):
    configure_logging("info", "json", Full())
    logging.getLogger("gateway.test").info("lost")
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    ("arguments", "environment", "wanted"),
    [
        (["serve"], {}, "text"),
        (["serve", "--log-format", "json"], {}, "json"),
        (["serve", "--log-format=json", "--port", "nine"], {}, "json"),
        (["serve", "--set", "log.format=json"], {}, "json"),
        (["serve", "--set=log.format=json"], {}, "json"),
        (["serve"], {"ROS2_GATEWAY_LOG__FORMAT": "json"}, "json"),
        (["serve", "--log-format", "text"], {"ROS2_GATEWAY_LOG__FORMAT": "json"}, "text"),
        (["serve", "--log-format", "yaml"], {}, "text"),
        (["serve", "log.format=json"], {}, "text"),
        (["serve", "--log-format"], {}, "text"),
    ],
)
def test_the_format_is_known_before_anything_is_parsed(arguments, environment, wanted):
    assert wanted_format(arguments, environment) == wanted
