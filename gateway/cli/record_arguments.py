# SPDX-License-Identifier: Apache-2.0
"""The arguments of the command `record`."""

from pathlib import Path
from typing import Final

from gateway.cli.argument_types import option, several
from gateway.cli.type_arguments import AddCommand

# Settings that have a flag here.
RECORDING_FLAGS: Final = {
    "--output": ("recording.directory", "DIR", "directory that gets one for this recording"),
    "--max-size": ("recording.max_file_bytes", "BYTES", "begin another file after so many bytes"),
    "--max-duration": ("recording.max_file_s", "SECONDS", "begin another file after so long"),
}


def add_record(command: AddCommand) -> None:
    """Add the command."""
    parser = command(
        "record",
        "record topics as MCAP files, which ros2 bag and other tools read",
        "  ros2-gateway record                          all topics, until Ctrl-C\n"
        "  ros2-gateway record -t '/camera/**' -t /odom\n"
        "  ros2-gateway record --images jpeg -o ~/recordings",
    )
    parser.add_argument(
        *("-t", "--topic"),
        action="append",
        default=[],
        metavar="GLOB",
        help="only these topics, with * for a part of a name and ** for several (repeatable)",
    )
    images = "images as they come, or as JPEG (default raw)"
    parser.add_argument("--images", choices=("raw", "jpeg"), default="raw", help=images)
    for flag, (key, metavar, text) in RECORDING_FLAGS.items():
        short = ("-o",) if flag == "--output" else ()
        parser.add_argument(*short, flag, dest=key, metavar=metavar, help=text)
    option(parser, "--config", "FILE", "TOML file (default: $ROS2_GATEWAY_CONFIG)", type=Path)
    domain = "DDS domain (default: ROS_DOMAIN_ID, or else 0)"
    option(parser, "--domain-id", "ID", domain, dest="ros.domain_id")
    several(parser, "--set", "KEY=VALUE", "any setting, such as recording.queue_bytes=500000000")
