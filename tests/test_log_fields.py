# SPDX-License-Identifier: Apache-2.0
"""The fields of a line of the log."""

import logging
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from gateway.log_fields import counted, fields_of, message_of, text_of


def record(message: str, name: str = "gateway.x", **extra: Any) -> logging.LogRecord:
    made = logging.LogRecord(name, logging.INFO, "", 0, "%s", (message,), None)
    made.__dict__.update(extra)
    return made


def test_client_and_topic_are_behind_the_message():
    assert text_of(record("taken")) == "taken"
    assert text_of(record("taken", client="10.0.0.5#12")) == "taken [client 10.0.0.5#12]"
    both = record("stopped: disconnect", client="::1#3", topic="/cmd_vel")
    assert text_of(both) == "stopped: disconnect [client ::1#3, topic /cmd_vel]"


def test_the_number_of_lines_that_were_left_out_is_said():
    assert message_of(record("connected", left_out=1234)) == "connected ... and 1234 more"
    assert message_of(record("connected", left_out=0)) == "connected"


def test_fields_that_have_no_value_are_absent_and_others_are_not_fields():
    fields = fields_of(record("x", client="::1#3", code=None, bytes_in=0, asctime="no field"))
    assert fields == {"client": "::1#3", "bytes_in": 0}


@given(st.text(), st.text())
def test_nothing_that_a_client_wrote_begins_a_line_or_speaks_to_a_terminal(message, topic):
    text = text_of(record(message, topic=topic))
    assert text.isprintable()
    assert len(f"x{text}x".splitlines()) == 1


def test_libraries_may_use_several_lines():
    assert text_of(record("one\ntwo", "asyncio")) == "one\ntwo"


def test_one_thing_is_counted_in_the_singular():
    assert [counted(count, "segment") for count in (0, 1, 2)] == [
        "0 segments",
        "1 segment",
        "2 segments",
    ]
