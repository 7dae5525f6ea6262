# SPDX-License-Identifier: Apache-2.0
"""Foreign output on standard output and error, in a separate process."""

import json
import os
import signal
import subprocess
import sys
import textwrap
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

from gateway.cli import foreign_output
from tests.client import TIMEOUT_S

_START = """
import os, subprocess, sys, time
from gateway.cli import foreign_output
from gateway.cli.logs import configure_logging
foreign_output.DRAIN_S = 60  # a busy machine
"""


def run(script: str) -> tuple[str, list[dict[str, str]]]:
    """Run a script, and return its output, and its log as parsed from JSON."""
    finished = subprocess.run(
        [sys.executable, "-c", _START + textwrap.dedent(script)],
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
        check=True,
    )
    return finished.stdout, [json.loads(line) for line in finished.stderr.splitlines()]


def test_output_of_c_code_and_children_becomes_records_and_own_lines_stay_as_they_are():
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


def test_an_error_is_not_half_a_line_of_json_when_the_block_fails():
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


def test_c_code_that_keeps_the_gil_may_write_more_than_a_pipe_takes():
    _, entries = run(
        """
        import ctypes
        holding_the_gil = ctypes.PyDLL(None)
        with foreign_output.foreign_output_logged() as own:
            configure_logging("info", "json", own.stderr)
            at_once = (b"x" * 99 + b"\\n") * 5000
            assert holding_the_gil.write(2, at_once, len(at_once)) == len(at_once)
            bit_by_bit = b"y" * 599 + b"\\n"
            for _ in range(500):
                assert holding_the_gil.write(1, bit_by_bit, 600) == 600
        """
    )
    texts = [each["message"] for each in entries]
    assert texts.count("x" * 99) == 5000
    assert texts.count("y" * 599) == 500


def test_a_process_that_dies_takes_its_reader_along_though_a_child_goes_on():
    died = subprocess.run(
        [
            *(sys.executable, "-c"),
            _START
            + textwrap.dedent(
                """
                import signal
                from pathlib import Path
                with foreign_output.foreign_output_logged() as own:
                    own_children = Path("/proc/thread-self/children")
                    (relay,) = own_children.read_text().split()
                    child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(1e5)"])
                    print(relay, child.pid, file=own.stdout)
                    os.kill(os.getpid(), signal.SIGKILL)
                """
            ),
        ],
        stdout=subprocess.PIPE,
        text=True,
        timeout=TIMEOUT_S,
        check=False,
    )
    relay, child = died.stdout.split()
    try:
        until(lambda: not is_running(relay))
        assert is_running(child)
    finally:
        os.kill(int(child), signal.SIGKILL)


def test_it_is_said_if_the_reader_dies_and_nothing_else_happens():
    stdout, entries = run(
        """
        import signal
        from pathlib import Path
        with foreign_output.foreign_output_logged() as own:
            configure_logging("info", "json", own.stderr)
            (relay,) = Path("/proc/thread-self/children").read_text().split()
            os.kill(int(relay), signal.SIGKILL)
            for thread in foreign_output.threading.enumerate()[1:]:
                thread.join()
            print("own", file=own.stdout)
        """
    )
    assert stdout == "own\n"
    text = "nobody reads this output any more, what is written to it is lost"
    assert sorted((each["logger"], each["message"]) for each in entries) == [
        ("stderr", text),
        ("stdout", text),
    ]


def is_running(pid: str) -> bool:
    """Return whether a process exists and is not a zombie."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def until(is_true: Callable[[], bool]) -> None:
    deadline_s = time.monotonic() + TIMEOUT_S
    while not is_true():
        assert time.monotonic() < deadline_s
        time.sleep(0.01)


def test_the_rest_in_the_pipes_has_half_a_second_at_the_end(monkeypatch):
    deadlines_s: list[float] = []
    output = SimpleNamespace(
        own=sys.stdout, redirect=lambda: None, restore=lambda: None, drain=deadlines_s.append
    )
    relay = SimpleNamespace(stdin=None, kill=lambda: None, wait=lambda: None)
    monkeypatch.setattr(foreign_output, "_Output", lambda *_: output)
    monkeypatch.setattr(foreign_output, "_start_relay", lambda _: relay)
    monkeypatch.setattr(foreign_output, "time", SimpleNamespace(monotonic=lambda: 100.0))
    with foreign_output.foreign_output_logged():
        pass
    assert deadlines_s == [100.5, 100.5]
