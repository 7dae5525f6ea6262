# SPDX-License-Identifier: Apache-2.0
"""The commands about types, ``schema`` and ``generate``, and their arguments."""

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Final

from gateway.cli.argument_types import assembly_name, folder, seconds

# `schemas.generate.languages` would import pydantic
LANGUAGES: Final = ("csharp", "typescript", "python", "json-schema")
_SOURCES: Final = """\
Installed packages count first, then the folders. With --from a running gateway
is asked instead, so that this machine needs neither ROS nor the packages."""

# name, text and examples of a command to its parser
AddCommand = Callable[[str, str, str], argparse.ArgumentParser]


def add_commands_about_types(command: AddCommand) -> None:
    """Add them by *command*."""
    _add_schema(
        command(
            "schema",
            "print the JSON Schema of a message, service or action type",
            "  ros2-gateway schema geometry_msgs/msg/Twist\n"
            "  ros2-gateway schema 1              the same by its number\n"
            "  ros2-gateway schema std_srvs/srv/SetBool\n"
            "  ros2-gateway schema std_msgs/Header --definition\n"
            "  ros2-gateway schema my_msgs/Cargo --types-path ~/ws/src",
        )
    )
    _add_generate(
        command(
            "generate",
            "write clients' code of any type: C#, TypeScript, Python or JSON Schema",
            "  ros2-gateway generate typescript nav_msgs/msg/Odometry          on standard output\n"
            "  ros2-gateway generate typescript 'nav2_msgs/*' --output src/ros\n"
            "  ros2-gateway generate csharp nav2_msgs/action/NavigateToPose "
            "--types-path ~/ws/src --output Assets/Ros --asmdef Robot.Messages\n"
            "  ros2-gateway generate python /robot_state --from ws://robot:9090\n"
            "  ROS2_GATEWAY_TOKEN=r2g_... ros2-gateway generate json-schema '*' "
            "--from wss://robot:9090 --ca cert.pem --output schemas",
        )
    )


def _add_schema(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "type",
        metavar="TYPE",
        help="pkg/msg/Name, pkg/srv/Name, pkg/action/Name, pkg/Name, or a number",
    )
    parser.add_argument(
        "--definition", action="store_true", help="print the text of its definition instead"
    )
    _add_folders(parser)


def _add_generate(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "language", metavar="LANGUAGE", choices=LANGUAGES, help=f"one of {', '.join(LANGUAGES)}"
    )
    parser.add_argument(
        "types",
        metavar="TYPE",
        nargs="+",
        help="a type as for 'schema', 'pkg/*' for all of a package, 'pkg/srv/*' for its services, "
        "or '*'. With --from, also the name of a topic, a service or an action. Nested types come "
        "along",
    )
    _add_sources(parser.add_argument_group("sources of definitions", _SOURCES))
    parser.add_argument(
        "--output",
        type=folder,
        metavar="DIR",
        help="write files there, of a package each, or of a type each with json-schema (default: "
        "all as one text on standard output)",
    )
    parser.add_argument(
        "--force", action="store_true", help="overwrite files that this command has not written"
    )
    parser.add_argument(
        "--wire",
        choices=("json", "cbor"),
        default="json",
        help="of typescript: as JSON is received (default), or subscriptions with compression cbor",
    )
    parser.add_argument(
        "--complete",
        action="store_true",
        help="of csharp: also the classes that the Unity package has",
    )
    parser.add_argument(
        "--asmdef",
        type=assembly_name,
        metavar="NAME",
        help="of csharp: make the files a Unity assembly of this name, whose classes the package's "
        "components and menus know",
    )


def _add_folders(group: argparse._ActionsContainer) -> None:  # its only name
    group.add_argument(
        "--types-path",
        type=Path,
        action="append",
        default=[],
        metavar="DIR",
        help="folder of definitions, such as the src of a workspace (repeatable)",
    )
    group.add_argument(
        "--config",
        type=Path,
        metavar="FILE",
        help="TOML file whose types.paths also count (default: $ROS2_GATEWAY_CONFIG)",
    )


def _add_sources(group: argparse._ArgumentGroup) -> None:  # its only name
    _add_folders(group)
    group.add_argument(
        "--from", dest="source", metavar="URL", help="ws:// or wss:// address of a running gateway"
    )
    group.add_argument(
        "--token",
        metavar="TOKEN",
        help="its token (default: $ROS2_GATEWAY_TOKEN, which other users of this machine cannot "
        "see)",
    )
    group.add_argument(
        "--ca", type=Path, metavar="FILE", help="certificate in PEM to trust, such as its cert.pem"
    )
    group.add_argument(
        "--timeout",
        type=seconds,
        metavar="SECONDS",
        help="for connecting, and for each answer (default 10)",
    )
