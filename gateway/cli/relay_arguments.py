# SPDX-License-Identifier: Apache-2.0
"""The commands that serve many robots at once, and their arguments."""

import argparse
from collections.abc import Callable
from pathlib import Path

from gateway.cli.argument_types import option, several, switch, zenoh_address
from gateway.cli.type_arguments import AddCommand


def add_relay_commands(
    command: AddCommand, add_configuration: Callable[[argparse.ArgumentParser], None]
) -> None:
    """Add the commands, and the flags of all that serve."""
    parser = command(
        "relay",
        "serve the robots behind a Zenoh router, each at /ROBOT/",
        "  ros2-gateway relay tcp/localhost:7447\n"
        "  ros2-gateway relay tls/router.example:7447 --config relay.toml --lan\n"
        "On each robot: ros2-gateway serve --uplink tls/router.example:7447 --robot-name r1",
    )
    router = "the Zenoh router, such as tls/router.example:7447"
    option(parser, "router", "ADDRESS", router, type=zenoh_address)
    add_configuration(parser)
    _add_router(command)


def _add_router(command: AddCommand) -> None:
    parser = command(
        "router",
        "run the Zenoh router that robots and relays connect to",
        "  ros2-gateway router                                   on this machine alone\n"
        "  ros2-gateway router --config router.toml              robots and relays of a file\n"
        "  ros2-gateway router --config router.toml --print-config\n"
        "A file:\n"
        '  listen = ["tls/[::]:7447"]\n'
        '  cert = "cert.pem"\n'
        '  key = "key.pem"\n'
        "  [robots]\n"
        '  r1 = "a password of this robot"   # or { certificate = "COMMON NAME" } and client_ca\n'
        "  [relays]\n"
        '  west = "a password of this relay"',
    )
    listen = "address to listen on (default: that of the file, or tcp/127.0.0.1:7447)"
    several(parser, "--listen", "ADDRESS", listen, type=zenoh_address)
    option(parser, "--config", "FILE", "TOML file with the robots and relays", type=Path)
    switch(parser, "--open", "let everybody connect who reaches a network address")
    switch(parser, "--print-config", "print the settings of Zenoh, without passwords")
