# SPDX-License-Identifier: Apache-2.0
"""The log's two formats."""

import io
import json
import logging
from collections.abc import Iterator

import pytest

from gateway.cli.logs import configure_logging


@pytest.fixture
def stream() -> Iterator[io.StringIO]:
    root = logging.getLogger()
    handlers, level = root.handlers[:], root.level
    root.handlers.clear()  # those of pytest, which force=True would close
    yield io.StringIO()
    root.handlers[:] = handlers
    root.setLevel(level)


def test_a_json_record_is_one_line_even_with_a_traceback(stream):
    configure_logging("info", "json", stream)
    try:
        int("two\nlines")
    except ValueError:
        logging.getLogger("gateway.test").exception("failed at %s", "x")
    (line,) = stream.getvalue().splitlines()
    entry = json.loads(line)
    assert entry["level"] == "error"
    assert entry["logger"] == "gateway.test"
    assert entry["message"] == "failed at x"
    assert entry["traceback"].startswith("Traceback")


def test_records_below_the_level_are_left_out(stream):
    configure_logging("warning", "text", stream)
    logging.getLogger("gateway.test").info("quiet")
    logging.getLogger("gateway.test").warning("loud")
    (line,) = stream.getvalue().splitlines()
    assert line.endswith("WARNING gateway.test: loud")
