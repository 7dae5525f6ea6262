# SPDX-License-Identifier: Apache-2.0
"""The commands and options that pages on safety and security show, run on an empty home."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.test_main import ROOT, TIMEOUT_S
from tests.doc_blocks import DOCS, blocks, texts

PAGES = [
    f"how-to/{name}.md"
    for name in ("drive-safely", "limit-access", "open-to-network", "https-and-headsets")
]
SEES_THE_NETWORK = "ros2-gateway find"
OPTIONS = sorted(
    {
        option
        for page in PAGES
        for option in re.findall(
            r"`(?:serve )?(--[a-z][^`]* [^`]*)`", (DOCS / page).read_text("utf-8")
        )
    }
)


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return an empty home and current directory, with the command `ros2-gateway`."""
    command = tmp_path / "bin/ros2-gateway"
    command.parent.mkdir()
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m gateway "$@"\n')
    command.chmod(0o755)
    monkeypatch.setenv("PATH", f"{command.parent}:{os.environ['PATH']}")
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv("XDG_CONFIG_HOME", raising=False)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def printed(text: str) -> str:
    """Run commands in a shell, and return their output. A gateway only prints its configuration."""
    if text.startswith("ros2-gateway serve"):
        text += " --print-config"
    command = ["sh", "-ec", text]
    finished = subprocess.run(
        command, capture_output=True, text=True, timeout=TIMEOUT_S, check=False
    )
    assert finished.returncode == 0, finished.stderr
    return finished.stdout


@pytest.mark.parametrize("page", PAGES)
def test_the_commands_of_a_page_run_in_their_order(page: str, home: Path):
    count = 0
    for block in blocks(page):
        if block.language == "toml":
            (home / "gateway.toml").write_text(block.text)
        for line in block.text.splitlines():
            is_command = block.language == "sh" and line.startswith("ros2-gateway ")
            if is_command and line != SEES_THE_NETWORK:
                printed(line)
                count += 1
    assert count > 0


def test_the_list_of_tokens_is_as_the_page_shows(home: Path):
    page = "how-to/limit-access.md"
    create = texts(page, "sh")[0]
    shown = texts(page, "text")[0]
    without_dates = [re.sub(r"\d", "0", text) for text in (printed(create), shown)]
    tokens, expected = without_dates
    assert tokens.endswith(expected)


@pytest.mark.parametrize("options", OPTIONS)
def test_an_option_of_the_pages_is_accepted(options: str, home: Path):
    printed(f"ros2-gateway serve {options.replace('ADDRESS', '192.0.2.1')}")


def test_the_pages_have_options():
    assert len(OPTIONS) > 8
