# SPDX-License-Identifier: Apache-2.0
"""The examples of the pages about configuration do what the pages say."""

import itertools
import os
import subprocess
import sys
from pathlib import Path

from gateway.config.settings import load
from tests.doc_blocks import blocks, texts, with_outputs

PAGE = "reference/configuration.md"
FLEET = "how-to/configure-a-fleet.md"
WITH_MISTAKES = 'port = "x"\n\n[limits]\nmax_client = 64\n'
TIMEOUT_S = 60


def test_the_file_of_the_page_is_valid(tmp_path: Path):
    (text,) = texts(PAGE, "toml")
    file = tmp_path / "gateway.toml"
    file.write_text(text)
    loaded = load(file=file)
    given = {key for key, source in loaded.origins.items() if source != "default"}
    assert given == {"port", "ros.domain_id", "limits.client_time_share"}


def printed(command: str, folder: Path) -> list[str]:
    environment = os.environ | {"PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}
    finished = subprocess.run(
        ["sh", "-c", command],
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=TIMEOUT_S,
        check=False,
    )
    return finished.stdout.splitlines()


def test_each_command_of_the_page_prints_the_shown_lines(tmp_path: Path):
    (tmp_path / "gateway.toml").write_text(WITH_MISTAKES)
    commands = with_outputs(PAGE, "sh")
    assert len(commands) == 2
    for command, lines in commands:
        assert printed(command, tmp_path) == lines


def test_the_files_of_a_fleet_are_checked_as_the_page_shows(tmp_path: Path):
    folder = tmp_path / "gateway/config.d"
    folder.mkdir(parents=True)
    for name, text in zip(("10-fleet.toml", "50-robot.toml"), texts(FLEET, "toml"), strict=True):
        (folder / name).write_text(text)
    (check, shown), *_ = [
        (block.text, following.text)
        for block, following in itertools.pairwise(blocks(FLEET))
        if following.language == "text"
    ]
    assert printed(check, tmp_path) == shown.splitlines()
