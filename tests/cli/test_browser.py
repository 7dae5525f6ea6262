# SPDX-License-Identifier: Apache-2.0
"""The page that opens by itself, with a stand-in for the browser."""

import os
import pty
import signal
import subprocess
import sys
import threading
import webbrowser
from pathlib import Path

import pytest

from gateway.cli.announcement import open_page

TIMEOUT_S = 120
URL = "http://localhost:9090/"


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch):
    """Return a function that returns what is opened."""
    urls: list[str] = []
    done = threading.Event()
    monkeypatch.setattr(webbrowser, "open", lambda url: (urls.append(url), done.set()))
    for variable in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)

    def wait() -> list[str]:
        assert done.wait(TIMEOUT_S)
        return urls

    return wait


@pytest.mark.parametrize("variable", ["DISPLAY", "WAYLAND_DISPLAY"])
def test_it_is_opened_on_a_desktop(opened, monkeypatch, variable):
    monkeypatch.setenv(variable, ":0")
    assert open_page(URL)
    assert opened() == [URL]


def test_it_is_not_opened_without_a_desktop(opened):
    assert not open_page(URL)


def test_it_is_not_opened_where_nobody_reads_the_output(opened, monkeypatch):
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(sys.stdout, "isatty", lambda: False, raising=False)
    assert not open_page(URL)


@pytest.mark.parametrize(("flags", "is_opened"), [((), True), (("--no-browser",), False)])
def test_the_demonstration_opens_its_page(tmp_path: Path, flags: tuple[str, ...], is_opened: bool):
    opened, script = tmp_path / "opened", tmp_path / "browser"
    script.write_text(f'#!/bin/sh\necho "$1" > {opened}.part\nmv {opened}.part {opened}\n')
    script.chmod(0o755)
    terminal, end = pty.openpty()
    process = subprocess.Popen(
        [sys.executable, "-m", "tests.patient_gateway", "demo", "--port", "0", *flags],
        cwd=Path(__file__).parents[2],
        env=os.environ | {"DISPLAY": ":0", "BROWSER": str(script)},
        stdout=end,
        stderr=subprocess.DEVNULL,
    )
    os.close(end)
    seen = ""
    while "Ctrl-C ends" not in seen or (is_opened and not opened.exists()):
        seen += os.read(terminal, 4096).decode(errors="replace") if "Ctrl-C" not in seen else ""
    process.send_signal(signal.SIGINT)
    assert process.wait(TIMEOUT_S) == 0
    os.close(terminal)
    assert opened.exists() is is_opened
    if is_opened:
        assert f"open  {opened.read_text().strip()}" in seen
