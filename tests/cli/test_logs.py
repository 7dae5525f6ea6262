# SPDX-License-Identifier: Apache-2.0
"""The log's two formats."""

import json
import logging
from collections.abc import Iterator

import pytest

from gateway.cli.logs import configure_logging


@pytest.fixture(autouse=True)
def root_logger() -> Iterator[None]:
    root = logging.getLogger()
    handlers, level = root.handlers[:], root.level
    root.handlers.clear()  # those of pytest, which force=True would close
    yield
    root.handlers[:] = handlers
    root.setLevel(level)


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


def test_records_below_the_level_are_left_out(capsys):
    configure_logging("warning", "text")
    logging.getLogger("gateway.test").info("quiet")
    logging.getLogger("gateway.test").warning("loud")
    (line,) = capsys.readouterr().err.splitlines()
    assert line.endswith("WARNING gateway.test: loud")
