# SPDX-License-Identifier: Apache-2.0
"""The command ``play`` and its arguments."""

import argparse
from collections.abc import Callable
from pathlib import Path

from gateway.cli.argument_types import option, play_rate, seconds_from_start, switch
from gateway.cli.type_arguments import AddCommand


def add_play(
    command: AddCommand, add_configuration: Callable[[argparse.ArgumentParser], None]
) -> None:
    """Add the command, and the flags of all that serve."""
    parser = command(
        "play",
        "play a recording, without ROS: clients see the robot that was recorded",
        "  ros2-gateway play drive.mcap\n"
        "  ros2-gateway play rosbag2_2026_11_28/ --rate 2 --loop\n"
        "  ros2-gateway play first.bag second.bag --start 30 --paused",
    )
    files = "MCAP file, rosbag2 folder or database, or bag of ROS 1"
    parser.add_argument("files", metavar="FILE", nargs="+", type=_path, help=files)
    rate = "times as fast as it was (default 1)"
    option(parser, "--rate", "FACTOR", rate, type=play_rate, default=1.0)
    start = "begin so many seconds after the first message (default 0)"
    option(parser, "--start", "SECONDS", start, type=seconds_from_start, default=0.0)
    switch(parser, "--loop", "begin again at the end")
    switch(parser, "--paused", "wait until a client resumes it (/rosbag2_player/resume)")
    add_configuration(parser)


def _path(text: str) -> Path:
    if not text:
        raise argparse.ArgumentTypeError("it is empty, name a recording")
    return Path(text)
