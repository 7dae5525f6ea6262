# SPDX-License-Identifier: Apache-2.0
"""The options that the pages name, accepted by the command line."""

import re
import shlex
import subprocess
import sys

import pytest

from tests.doc_blocks import DOCS

ROSBRIDGE = DOCS / "how-to/switch-from-rosbridge.md"
ROWS = re.findall(r"^\|.*\| (.*?) \|$", ROSBRIDGE.read_text(encoding="utf-8"), re.MULTILINE)
OPTIONS = [each for row in ROWS for each in re.findall(r"`(--[^`]*)`", row)]


@pytest.mark.parametrize("options", sorted(set(OPTIONS)))
def test_each_replacement_of_an_argument_of_rosbridge_is_accepted(options):
    if options == "--tls-cert":  # named once more, without its value
        return
    command = [sys.executable, "-m", "gateway", "serve", *shlex.split(options), "--print-config"]
    finished = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (finished.returncode, finished.stderr) == (0, "")


def test_rosbridges_arguments_are_replaced():
    assert len(OPTIONS) > 12
