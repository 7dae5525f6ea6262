# SPDX-License-Identifier: Apache-2.0
"""What others write to standard output and error, in a process of its own."""

import json
import subprocess
import sys
import textwrap

from tests.client import TIMEOUT_S

_START = """
import os, subprocess, sys, time
from gateway.cli import foreign_output
from gateway.cli.logs import configure_logging
"""


def run(script: str) -> tuple[str, list[dict[str, str]]]:
    """Run a script; return its output, and its log as parsed from JSON."""
    finished = subprocess.run(
        [sys.executable, "-c", _START + textwrap.dedent(script)],
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
        check=True,
    )
    return finished.stdout, [json.loads(line) for line in finished.stderr.splitlines()]


def test_what_c_code_and_children_write_are_records_and_own_lines_stay_as_they_are():
    stdout, entries = run(
        """
        with foreign_output.foreign_output_logged() as own:
            configure_logging("info", "json", own.stderr)
            os.write(2, b"[RTPS_HISTORY Error] no \\xff more\\nsecond\\n\\n")
            print("printed")
            subprocess.run([sys.executable, "-c", "print('of a child')"], check=True)
            print("own", file=own.stdout)
        print("after")
        """
    )
    assert stdout == "own\nafter\n"
    assert [(each["logger"], each["level"]) for each in entries].count(("stderr", "warning")) == 2
    texts = {(each["logger"], each["message"]) for each in entries}
    assert texts == {
        ("stderr", r"[RTPS_HISTORY Error] no \xff more"),
        ("stderr", "second"),
        ("stdout", "printed"),
        ("stdout", "of a child"),
    }


def test_a_line_without_end_becomes_several_records():
    _, entries = run(
        """
        with foreign_output.foreign_output_logged() as own:
            configure_logging("info", "json", own.stderr)
            os.write(2, b"x" * 20000)
        """
    )
    assert [len(each["message"]) for each in entries] == [8192, 8192, 20000 - 2 * 8192]


def test_a_child_that_goes_on_holds_up_nothing():
    _, entries = run(
        """
        child = None
        with foreign_output.foreign_output_logged() as own:
            configure_logging("info", "json", own.stderr)
            child = subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE)
            os.write(2, b"heard\\n")
        assert child.poll() is None
        child.kill()
        child.wait()
        """
    )
    assert [each["message"] for each in entries] == ["heard"]


def test_an_error_is_no_json_of_half_a_line_when_the_block_fails():
    _, entries = run(
        """
        try:
            with foreign_output.foreign_output_logged() as own:
                configure_logging("info", "json", own.stderr)
                raise KeyError("x")
        except KeyError:
            os.write(2, b"{}\\n")
        """
    )
    assert entries == [{}]
