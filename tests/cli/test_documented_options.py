# SPDX-License-Identifier: Apache-2.0
"""The options that the pages name, accepted by the command line."""

import re
import shlex
import shutil
import subprocess
import sys

import pytest

from gateway.cli.report import EXIT_NO_ROS, EXIT_USAGE
from tests.doc_blocks import DOCS, texts

ROSBRIDGE = DOCS / "how-to/switch-from-rosbridge.md"
AT_BOOT = "how-to/run-at-boot.md"
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


def test_systemd_takes_the_unit_of_the_page(tmp_path):
    verify = shutil.which("systemd-analyze")
    if verify is None:
        pytest.skip("systemd-analyze is not installed")
    (unit,) = texts(AT_BOOT, "ini")
    file = tmp_path / "ros2-gateway.service"
    file.write_text(unit.replace("USER", "root"))
    finished = subprocess.run([verify, "verify", file], capture_output=True, text=True, check=False)
    assert (finished.returncode, finished.stderr) == (0, "")


def test_systemd_does_not_repeat_what_fails_each_time():
    (unit,) = texts(AT_BOOT, "ini")
    assert f"RestartPreventExitStatus={EXIT_USAGE} {EXIT_NO_ROS}\n" in unit
    assert "KillMode" not in unit, "the guard process outlives a gateway that is killed"
