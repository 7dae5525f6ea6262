# SPDX-License-Identifier: Apache-2.0
"""The commands that need no ROS, without the modules that Windows lacks."""

import argparse
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from gateway.cli.arguments import argument_parser
from tests import recordings
from tests.client import TIMEOUT_S, client
from tests.gateway_process import gateway_process

MODULE = "tests.without_posix"
ON_THE_ROBOT = {"serve", "demo", "sim", "mock", "record", "install-service"}
TOKENS = ("token", "--file", "TMP/tokens.json")
CASES = [
    (("--help",), 0, "usage: ros2-gateway"),
    (("--version",), 0, "ros2-gateway "),
    (("schema", "geometry_msgs/msg/Twist"), 0, "Vector3"),
    (("generate", "csharp", "nav2_msgs/msg/SpeedLimit"), 0, "class SpeedLimit"),
    (("generate", "typescript", "nav2_msgs/msg/SpeedLimit"), 0, "interface SpeedLimit"),
    (("generate", "python", "nav2_msgs/msg/SpeedLimit"), 0, "class SpeedLimit"),
    (("check-config",), 0, "the configuration is right"),
    ((*TOKENS, "create", "a"), 0, "r2g_"),
    ((*TOKENS, "list"), 0, ""),
    (("cert", "--folder", "TMP"), 0, "a certificate for"),
    (("find", "--wait", "0.1"), 1, "no gateway has answered"),
    (("doctor", "--from", "ws://127.0.0.1:1"), 1, "ws://127.0.0.1:1"),
    (("doctor",), 2, "run doctor on the robot"),
    (("install-service", "--dry-run"), 2, "systemd runs only on Linux"),
    (("serve",), 3, "rclpy cannot be imported"),
    (("relay", "tcp/router:7447"), 2, "relay: it does not run on Windows"),
    (("router",), 2, "router: it does not run on Windows"),
    (("serve", "--zenoh", "tcp/robot:7447"), 2, "does not run on Windows"),
]


@pytest.mark.parametrize(("arguments", "code", "text"), CASES)
def test_a_command_runs(tmp_path: Path, arguments: tuple[str, ...], code: int, text: str):
    command = [each.replace("TMP", str(tmp_path)) for each in arguments]
    finished = subprocess.run(
        [sys.executable, "-m", MODULE, *command], capture_output=True, text=True, timeout=TIMEOUT_S
    )
    assert text in finished.stdout + finished.stderr
    assert (finished.returncode, "halted" in finished.stderr) == (code, False), finished.stderr


def test_no_command_is_left_out():
    commands = next(
        set(action.choices)
        for action in argument_parser()._actions
        if isinstance(action, argparse._SubParsersAction)
    )
    assert commands - ON_THE_ROBOT - {arguments[0] for arguments, *_ in CASES} == {"play"}


async def test_a_recording_is_played(tmp_path: Path):
    bag = recordings.write_bag1(tmp_path / "drive.bag")
    async with gateway_process("play", str(bag), "--loop", module=MODULE) as gateway:
        async with client(gateway.url) as watching:
            await watching.send(op="subscribe", topic="/odom")
            await watching.message("/odom")
        assert await gateway.stop(signal.SIGTERM) == 0
