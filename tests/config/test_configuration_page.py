# SPDX-License-Identifier: Apache-2.0
"""The examples of docs/reference/configuration.md do what the page says."""

import os
import subprocess
import sys
from pathlib import Path

from gateway.config.settings import load
from tests.doc_blocks import texts, with_outputs

PAGE = "reference/configuration.md"
WITH_MISTAKES = 'port = "x"\n\n[limits]\nmax_client = 64\n'
TIMEOUT_S = 60


def test_the_file_of_the_page_is_valid(tmp_path: Path):
    (text,) = texts(PAGE, "toml")
    file = tmp_path / "gateway.toml"
    file.write_text(text)
    loaded = load(file=file)
    given = {key for key, source in loaded.origins.items() if source != "default"}
    assert given == {"port", "ros.domain_id", "limits.client_time_share"}


def test_each_command_of_the_page_prints_the_shown_lines(tmp_path: Path):
    (tmp_path / "gateway.toml").write_text(WITH_MISTAKES)
    environment = os.environ | {"PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}
    commands = with_outputs(PAGE, "sh")
    assert len(commands) == 2
    for command, lines in commands:
        finished = subprocess.run(
            ["sh", "-c", command],
            cwd=tmp_path,
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=TIMEOUT_S,
            check=False,
        )
        assert finished.stdout.splitlines() == lines
