# SPDX-License-Identifier: Apache-2.0
"""The fields of log records, in addition to their text.

``client`` is a client's address and number, such as ``10.0.0.5#12``. ``topic`` is a topic, an
action, or a service. Clients can cause any number of such lines, so `gateway.log_rate` limits them.
"""

import logging
from typing import Any, Final

# those of a connection's end (`gateway.transport.end`) included
FIELDS: Final = (
    "client",
    "topic",
    "reason",
    "by",
    "code",
    "lasted_s",
    "bytes_in",
    "messages_in",
    "frames_out",
    "left_out",  # lines of this kind before this one
)
_SHOWN: Final = ("client", "topic")  # in text, while the message has the others


def fields_of(record: logging.LogRecord) -> dict[str, Any]:
    """Return the fields that a record has."""
    values = {name: getattr(record, name, None) for name in FIELDS}
    return {name: value for name, value in values.items() if value is not None}


def message_of(record: logging.LogRecord) -> str:
    """Return the message of a record, and how many like it were left out."""
    left_out = getattr(record, "left_out", None)
    message = record.getMessage()
    return f"{message} ... and {left_out} more" if left_out else message


def text_of(record: logging.LogRecord) -> str:
    """Return the message of a record with its client and topic, on one line."""
    fields = fields_of(record)
    shown = ", ".join(f"{name} {fields[name]}" for name in _SHOWN if name in fields)
    message = message_of(record)
    if record.name.partition(".")[0] == "gateway":  # libraries may use several lines
        message = _on_one_line(message)
    return f"{message} [{_on_one_line(shown)}]" if shown else message


def counted(count: int, noun: str) -> str:
    """Return a number of things in words: ``1 token``, ``2 tokens``."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def _on_one_line(text: str) -> str:
    """Escape characters that could begin another line, or control a terminal."""
    if text.isprintable():
        return text
    return "".join(
        each if each.isprintable() else each.encode("unicode_escape").decode() for each in text
    )
