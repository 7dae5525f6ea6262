# SPDX-License-Identifier: Apache-2.0
"""The log on standard error: lines for people, or JSON for log collectors."""

import json
import logging
import os
import sys
import threading
from collections.abc import Mapping, Sequence
from datetime import datetime, timezone
from itertools import pairwise
from typing import TYPE_CHECKING, Final, Literal, TextIO

from gateway.log_fields import fields_of, message_of, text_of
from gateway.log_rate import LogRate

if TYPE_CHECKING:
    from sys import UnraisableHookArgs

LogFormat = Literal["text", "json"]

# a failure may come before the configuration is read, and must be JSON where JSON is expected
_FLAG: Final = "--log-format"
_KEY: Final = "log.format"
_VARIABLE: Final = "ROS2_GATEWAY_LOG__FORMAT"


def wanted_format(arguments: Sequence[str], environment: Mapping[str, str]) -> LogFormat:
    """Return the format that arguments or environment name, as far as can be told unparsed."""
    found = environment.get(_VARIABLE, "")
    for name, value in pairwise(["", *arguments]):
        if name == _FLAG:
            found = value
        assignment = f"--set={value}" if name == "--set" else value
        for prefix in (f"{_FLAG}=", f"--set={_KEY}="):
            if assignment.startswith(prefix):
                found = assignment.removeprefix(prefix)
    return "json" if found == "json" else "text"


def json_line(created_s: float, level: str, logger: str, message: str, **fields: object) -> str:
    """Return a line of a log in JSON, as ASCII."""
    time = datetime.fromtimestamp(created_s, timezone.utc)
    return json.dumps(
        {
            "time": time.isoformat(timespec="milliseconds"),
            "level": level,
            "logger": logger,
            "message": message,
            **fields,
        },
        default=str,
    )


class JsonFormatter(logging.Formatter):
    """Write each record as one JSON object on one line."""

    def format(self, record: logging.LogRecord) -> str:
        """Return ``{"time": ..., "level": ..., "logger": ..., "message": ..., "client": ...}``."""
        fields = fields_of(record)
        message = message_of(record)
        if audited := getattr(record, "audit", None):  # an event, whose message is its line
            fields = {**fields, **audited}
            message = audited["event"]
            del fields["time"]
        if record.exc_info:
            fields["traceback"] = self.formatException(record.exc_info)
        return json_line(record.created, record.levelname.lower(), record.name, message, **fields)


class TextFormatter(logging.Formatter):
    """Write each record as a line for people, and a traceback below it."""

    def __init__(self) -> None:
        super().__init__("%(asctime)s %(levelname)-7s %(name)s: %(message)s", "%H:%M:%S")

    def formatMessage(self, record: logging.LogRecord) -> str:  # noqa: N802  # of `logging`
        """Return the line, which ends with the record's client and topic."""
        record.message = text_of(record)
        return super().formatMessage(record)


# of sd-daemon(3), from the highest level of `logging` down
_PRIORITIES: Final = (
    (logging.CRITICAL, 2),
    (logging.ERROR, 3),
    (logging.WARNING, 4),
    (logging.INFO, 6),
    (logging.NOTSET, 7),
)


class LogHandler(logging.StreamHandler):  # type: ignore[type-arg]  # no generic on Python 3.10
    """Writes records, and a bounded number of those that clients cause."""

    def __init__(self, stream: TextIO, log_format: LogFormat) -> None:
        super().__init__(stream)
        self.setFormatter(JsonFormatter() if log_format == "json" else TextFormatter())
        self._is_journal = _is_journal(stream)
        self._rate = LogRate()
        self.addFilter(self._rate)

    def emit(self, record: logging.LogRecord) -> None:
        """Write a record, and before it how many others were left out, if that is due."""
        for late in self._rate.overdue():
            super().emit(late)
        super().emit(record)

    def format(self, record: logging.LogRecord) -> str:
        """Return the text, with the priority before each line if systemd's journal reads it."""
        text = super().format(record)
        if not self._is_journal:
            return text
        priority = next(number for level, number in _PRIORITIES if record.levelno >= level)
        return "\n".join(f"<{priority}>{line}" for line in text.splitlines())

    def handleError(self, record: logging.LogRecord) -> None:  # noqa: N802  # of `logging`
        """Lose a line that cannot be written: the disk is full, or nobody reads it any more."""
        if not isinstance(sys.exc_info()[1], OSError | ValueError):
            super().handleError(record)

    def close(self) -> None:
        """Write how many lines were left out."""
        for late in self._rate.overdue(all_of_them=True):
            super().emit(late)
        super().close()


def _is_journal(stream: TextIO) -> bool:
    """Return whether a stream goes to systemd's journal (systemd.exec(5), $JOURNAL_STREAM)."""
    try:
        status = os.fstat(stream.fileno())
    except (OSError, ValueError):  # closed, or no file
        return False
    return os.environ.get("JOURNAL_STREAM") == f"{status.st_dev}:{status.st_ino}"


def configure_logging(
    level: Literal["debug", "info", "warning", "error"],
    log_format: LogFormat,
    stream: TextIO | None = None,
) -> None:
    """Send the log of the whole process to *stream*, or standard error.

    So are warnings of Python, and errors that nobody catches in threads and destructors.
    """
    handler = LogHandler(stream or sys.stderr, log_format)
    logging.basicConfig(level=level.upper(), handlers=[handler], force=True)
    logging.captureWarnings(True)
    threading.excepthook = _log_thread
    sys.unraisablehook = _log_unraisable


def _log_thread(failed: threading.ExceptHookArgs) -> None:
    if failed.exc_type is SystemExit or failed.exc_value is None:
        return
    name = failed.thread.name if failed.thread else "?"
    logging.getLogger("gateway").error("thread %s failed", name, exc_info=failed.exc_value)


def _log_unraisable(failed: "UnraisableHookArgs") -> None:
    what = failed.err_msg or "exception ignored in"
    logging.getLogger("gateway").error(
        "%s %r", what, failed.object, exc_info=failed.exc_value or failed.exc_type()
    )
