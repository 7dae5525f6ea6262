# SPDX-License-Identifier: Apache-2.0
"""The commands of ``ros2-gateway`` and their arguments, with their help."""

import argparse
import sys
from pathlib import Path
from typing import Final, NoReturn

from gateway.config.domain_id import DOMAIN_ID_EXPECTATION, is_domain_id

# Keys with a flag of their own; every other key goes through --set.
CONFIG_FLAGS: Final = {
    "--host": ("host", "ADDRESS", "address to listen on (default 127.0.0.1: this machine alone)"),
    "--port": ("port", "PORT", "TCP port, 0 for any free one (default 9090)"),
    "--path": ("path", "PATH", "path of the WebSocket (default /)"),
    "--domain-id": ("ros.domain_id", "ID", "DDS domain (default: ROS_DOMAIN_ID, or else 0)"),
    "--node-prefix": ("ros.node_prefix", "NAME", "first part of the names of the gateway's nodes"),
    "--namespace": ("ros.namespace", "/NAME", "namespace of the gateway's nodes"),
    "--log-level": ("log.level", "LEVEL", "debug, info, warning or error (default info)"),
    "--log-format": ("log.format", "FORMAT", "text or json (default text)"),
}

_EXIT_CODES: Final = """\
exit codes:
  0  fine, also when ended by Ctrl-C or SIGTERM
  1  anything not listed here
  2  wrong usage or configuration
  3  rclpy is missing
  4  cannot listen: port in use, no such address"""


def argument_parser() -> argparse.ArgumentParser:
    """Build the parser; its namespace has ``command``, ``debug`` and the command's arguments."""
    parser = _Parser(
        prog="ros2-gateway",
        description="ROS 2 topics as JSON over a WebSocket (rosbridge protocol), both ways.",
        epilog=f"{_EXIT_CODES}\n\n'ros2-gateway COMMAND --help' tells more, with examples.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version")
    commands = parser.add_subparsers(
        title="commands", dest="command", metavar="COMMAND", required=True
    )

    def command(name: str, text: str, examples: str) -> argparse.ArgumentParser:
        added = commands.add_parser(
            name,
            help=text,
            description=f"{text[0].upper()}{text[1:]}.",
            epilog=f"examples:\n{examples}",
            formatter_class=argparse.RawDescriptionHelpFormatter,
            allow_abbrev=False,
        )
        added.add_argument("--debug", action="store_true", help="show tracebacks of errors")
        return added

    _add_configuration(
        command(
            "serve",
            "serve the topics of this ROS 2 system",
            "  ros2-gateway serve                         to programs on this machine\n"
            "  ros2-gateway serve --host 0.0.0.0          to everyone on the network\n"
            "  ros2-gateway serve --config gateway.toml   as a file says\n"
            "  ROS2_GATEWAY_PORT=8080 ros2-gateway serve  as the environment says",
        )
    )
    _add_configuration(
        command(
            "demo",
            "serve the topics of a simulated robot, which runs along",
            "  ros2-gateway demo\n  ros2-gateway demo --host 0.0.0.0 --port 8080",
        )
    )
    _add_sim(
        command(
            "sim",
            "run the simulated robot alone",
            "  ros2-gateway sim\n  ros2-gateway sim --no-camera --domain-id 7",
        )
    )
    _add_mock(
        command(
            "mock",
            "publish made-up messages of every type, and print what arrives",
            "  ros2-gateway mock\n"
            "  ros2-gateway mock --rate 10 --type std_msgs/msg/String --type 9\n"
            "  ros2-gateway mock --no-publish",
        )
    )
    _add_schema(
        command(
            "schema",
            "print the JSON Schema of a message, service or action type",
            "  ros2-gateway schema geometry_msgs/msg/Twist\n"
            "  ros2-gateway schema 1              the same by its number in the message table\n"
            "  ros2-gateway schema std_srvs/srv/SetBool\n"
            "  ros2-gateway schema std_msgs/Header --definition",
        )
    )
    _add_check_config(
        command(
            "check-config",
            "say whether the configuration is right",
            "  ros2-gateway check-config gateway.toml\n"
            "  ros2-gateway check-config --keys      all there is to configure, as Markdown",
        )
    )
    return parser


class _Parser(argparse.ArgumentParser):
    """A parser that reports a mistake in one sentence instead of a page of usage."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"ros2-gateway: {message}; see {self.prog} --help\n")


class _Version(argparse.Action):
    """Print the version, looking it up only then."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        from importlib.metadata import version

        sys.stdout.write(f"ros2-gateway {version('ros2-json-gateway')}\n")
        parser.exit()


def _add_configuration(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group(
        "configuration",
        "A flag beats the environment (ROS2_GATEWAY_PORT, ROS2_GATEWAY_LIMITS__MAX_CLIENTS),\n"
        "which beats the file, which beats the default; 'ros2-gateway check-config --keys'\n"
        "lists all keys.",
    )
    group.add_argument(
        "--config", type=Path, metavar="FILE", help="TOML file (default: $ROS2_GATEWAY_CONFIG)"
    )
    for flag, (key, metavar, text) in CONFIG_FLAGS.items():
        group.add_argument(flag, dest=key, metavar=metavar, help=text)
    group.add_argument(
        "--use-sim-time",
        dest="ros.use_sim_time",
        action="store_const",
        const="true",
        help="take ROS time from /clock",
    )
    group.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="any key, such as limits.max_clients=64; may be repeated",
    )
    group.add_argument(
        "--print-config",
        action="store_true",
        help="print the configuration as TOML, and where each value came from, instead of serving",
    )


def _add_sim(parser: argparse.ArgumentParser) -> None:
    _add_domain_id(parser)
    parser.add_argument(
        "--namespace", default="", metavar="/NAME", help="of the robot's node, topics and frames"
    )
    parser.add_argument("--no-camera", action="store_true", help="draw no pictures")
    parser.add_argument(
        "--camera-hz", type=float, default=30.0, metavar="HZ", help="pictures a second (default 30)"
    )
    parser.add_argument("--seed", type=int, help="of slip and noise (default: another each time)")
    parser.add_argument(
        "--until-stdin-closes",
        action="store_true",
        help="end when standard input closes, and so with the process that holds it open",
    )


def _add_domain_id(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--domain-id",
        type=_domain_id,
        metavar="ID",
        help="DDS domain (default: ROS_DOMAIN_ID, or else 0)",
    )


def _domain_id(text: str) -> int:
    if not is_domain_id(text):
        raise argparse.ArgumentTypeError(f"got {text!r}, expected {DOMAIN_ID_EXPECTATION}")
    return int(text)


def _add_mock(parser: argparse.ArgumentParser) -> None:
    _add_domain_id(parser)
    parser.add_argument(
        "--rate", type=float, default=1.0, metavar="HZ", help="messages a second of each type"
    )
    parser.add_argument(
        "--type",
        action="append",
        default=[],
        metavar="TYPE",
        help="only this type, by name or table number; may be repeated",
    )
    parser.add_argument("--no-publish", action="store_true", help="only print what arrives")
    parser.add_argument("--no-listen", action="store_true", help="only publish")


def _add_schema(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "type",
        metavar="TYPE",
        help="pkg/msg/Name, pkg/srv/Name, pkg/action/Name, pkg/Name or a number of the message "
        "table",
    )
    parser.add_argument(
        "--definition", action="store_true", help="print the text of its definition instead"
    )


def _add_check_config(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "file",
        nargs="?",
        type=Path,
        metavar="FILE",
        help="TOML file (default: $ROS2_GATEWAY_CONFIG, if set)",
    )
    parser.add_argument(
        "--keys", action="store_true", help="print all keys with their defaults and meanings"
    )
