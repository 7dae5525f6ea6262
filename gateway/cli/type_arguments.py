# SPDX-License-Identifier: Apache-2.0
"""The commands about types, ``schema`` and ``generate``, and their arguments."""

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Final

from gateway.cli.argument_types import (
    Group,
    add_access,
    assembly_name,
    folder,
    option,
    several,
    switch,
)

# `schemas.generate.languages` would import pydantic
LANGUAGES: Final = ("csharp", "typescript", "python", "json-schema")
_SOURCES: Final = """\
Installed packages count first, then the folders. With --from a running gateway
is asked instead, so that this machine needs neither ROS nor the packages."""

# name, text and examples of a command to its parser
AddCommand = Callable[[str, str, str], argparse.ArgumentParser]


def add_commands_about_types(command: AddCommand) -> None:
    """Add them by *command*."""
    _add_schema(command)
    _add_generate(command)


def _add_schema(command: AddCommand) -> None:
    parser = command(
        "schema",
        "print the JSON Schema of a message, service or action type",
        "  ros2-gateway schema geometry_msgs/msg/Twist\n"
        "  ros2-gateway schema 1              the same by its number\n"
        "  ros2-gateway schema std_srvs/srv/SetBool\n"
        "  ros2-gateway schema std_msgs/Header --definition\n"
        "  ros2-gateway schema my_msgs/Cargo --types-path ~/ws/src",
    )
    forms = "pkg/msg/Name, pkg/srv/Name, pkg/action/Name, pkg/Name, or a number"
    option(parser, "type", "TYPE", forms)
    switch(parser, "--definition", "print the text of its definition instead")
    _add_folders(parser)


def _add_generate(command: AddCommand) -> None:
    parser = command(
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
    option(parser, "language", "LANGUAGE", f"one of {', '.join(LANGUAGES)}", choices=LANGUAGES)
    option(
        *(parser, "types", "TYPE"),
        "a type as for 'schema', 'pkg/*' for all of a package, 'pkg/srv/*' for its services, "
        "or '*'. With --from, also the name of a topic, a service or an action. Nested types come "
        "along",
        nargs="+",
    )
    _add_sources(parser.add_argument_group("sources of definitions", _SOURCES))
    option(
        *(parser, "--output", "DIR"),
        "write files there, of a package each, or of a type each with json-schema (default: "
        "all as one text on standard output)",
        type=folder,
    )
    switch(parser, "--force", "overwrite files that this command has not written")
    parser.add_argument(
        "--wire",
        choices=("json", "cbor"),
        default="json",
        help="of typescript: as JSON is received (default), or subscriptions with compression cbor",
    )
    switch(parser, "--complete", "of csharp: also the classes that the Unity package has")
    option(
        *(parser, "--asmdef", "NAME"),
        "of csharp: make the files a Unity assembly of this name, whose classes the package's "
        "components and menus know",
        type=assembly_name,
    )


def _add_folders(group: Group) -> None:
    folders = "folder of definitions, such as the src of a workspace"
    several(group, "--types-path", "DIR", folders, type=Path)
    config = "TOML file whose types.paths also count (default: $ROS2_GATEWAY_CONFIG)"
    option(group, "--config", "FILE", config, type=Path)


def _add_sources(group: Group) -> None:
    _add_folders(group)
    option(group, "--from", "URL", "ws:// or wss:// address of a running gateway", dest="source")
    add_access(group)
