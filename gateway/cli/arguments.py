# SPDX-License-Identifier: Apache-2.0
"""The commands of ``ros2-gateway`` and their arguments, with their help."""

import argparse
import site
import sys
from functools import partial
from pathlib import Path
from typing import Any, Final, NoReturn

from gateway.cli.argument_types import (
    add_access,
    domain_id,
    option,
    seconds,
    several,
    switch,
    zenoh_address,
)
from gateway.cli.play_arguments import add_play
from gateway.cli.record_arguments import add_record
from gateway.cli.relay_arguments import add_relay_commands
from gateway.cli.type_arguments import AddCommand, add_commands_about_types
from gateway.codec.error_text import misspelt, suggestion
from gateway.config.secrets import ADVICE, FILE_ADVICE, is_secret_name
from gateway.errors import UsageError

ROLES: Final = ("viewer", "operator", "admin")  # `gateway.config.access` would import pydantic

_CONFIG: Final = "TOML file, over those of /etc/ros2-gateway (default: $ROS2_GATEWAY_CONFIG)"
_DOMAIN_ID: Final = "DDS domain (default: ROS_DOMAIN_ID, or else 0)"
_TWIST_STAMPED: Final = (
    "take commands as TwistStamped, as ros2_control does since Jazzy, instead of Twist"
)

# Settings that have a flag. Every other setting goes through --set.
CONFIG_FLAGS: Final = {
    "--host": ("host", "ADDRESS", "address to listen on (default 127.0.0.1: only this machine)"),
    "--port": ("port", "PORT", "TCP port, 0 for any free one (default 9090)"),
    "--path": ("path", "PATH", "path of the WebSocket (default /)"),
    "--domain-id": ("ros.domain_id", "ID", _DOMAIN_ID),
    "--node-prefix": ("ros.node_prefix", "NAME", "first part of the names of the gateway's nodes"),
    "--namespace": ("ros.namespace", "/NAME", "namespace of the gateway's nodes"),
    "--uplink": (
        "uplink.endpoint",
        "ADDRESS",
        "offer the robot to relays behind this Zenoh router",
    ),
    "--robot-name": (
        "uplink.robot_name",
        "NAME",
        "name of the robot there (default: that of this machine)",
    ),
    "--log-level": ("log.level", "LEVEL", "debug, info, warning or error (default info)"),
    "--log-format": ("log.format", "FORMAT", "text or json (default text)"),
    "--tls-cert": ("tls.cert", "FILE", "certificate in PEM (clients then need wss://)"),
    "--tls-key": ("tls.key", "FILE", "its private key in PEM"),
    "--tls-port": (
        "tls.port",
        "PORT",
        "a second port with TLS, which VR in a browser needs (https://)",
    ),
}
# Flags without a value: the key, and the value that they set.
CONFIG_SWITCHES: Final = {
    "--lan": ("lan", "true", "listen on all networks (clients then need a token)"),
    "--no-auth": ("access.authentication", "none", "need no token: every client may watch"),
    "--anyone-may-drive": (
        "access.anonymous_role",
        "operator",
        "also let clients without a token move the robot",
    ),
    "--no-qr": ("qr", "false", "show no QR code of the address"),
    "--use-sim-time": ("ros.use_sim_time", "true", "take ROS time from /clock"),
}

_EXIT_CODES: Final = """\
exit codes:
  0  fine, also when ended by Ctrl-C, SIGTERM or SIGUSR1
  1  anything not listed here
  2  wrong usage or configuration
  3  rclpy is missing
  4  cannot listen: port in use, no such address"""


def argument_parser() -> argparse.ArgumentParser:
    """Build the parser. Its namespace has ``command``, ``debug`` and the command's arguments."""
    parser = _Parser(
        prog="ros2-gateway",
        description="ROS 2 topics as JSON over a WebSocket (rosbridge protocol), both ways.",
        epilog=f"{_EXIT_CODES}\n\n"
        "'ros2-gateway COMMAND --help' tells more, with examples.\n"
        f"The documentation: {_documentation()}",
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

    for add in (
        _add_serve,
        _add_demo,
        partial(add_play, add_configuration=_add_configuration),
        partial(add_relay_commands, add_configuration=_add_configuration),
        add_record,
        _add_sim,
        _add_mock,
        add_commands_about_types,
    ):
        add(command)
    for add in (_add_check_config, _add_token, _add_cert, _add_service, _add_find, _add_doctor):
        add(command)
    return parser


class _Parser(argparse.ArgumentParser):
    """A parser that reports a mistake in one sentence instead of a page of usage."""

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse, and refuse a flag that this command does not have: the others are known here."""
        parsed, unknown = super().parse_known_args(args, namespace)
        if unknown:
            flag = next((each for each in unknown if each.startswith("-")), "").partition("=")[0]
            if is_secret_name(flag):
                is_client = "--token-file" in self._option_string_actions
                self.error(f"{flag}: {FILE_ADVICE if is_client else ADVICE}")
            hint = suggestion(misspelt(flag, self._option_string_actions))
            self.error(f"unknown arguments: {' '.join(unknown)}{hint}")
        return parsed, unknown

    def error(self, message: str) -> NoReturn:
        end = "" if message.endswith("?") else "."
        raise UsageError(f"{message}{end} See {self.prog} --help")


class _Version(argparse.Action):
    """Print the version, looking it up only then."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        from importlib.metadata import version

        sys.stdout.write(f"ros2-gateway {version('ros2-json-gateway')}\n")
        parser.exit()


def _documentation() -> str:
    """Return where the documentation is, which comes with the source tree and with the package."""
    if (Path(__file__).parents[2] / "docs/index.md").exists():
        return "docs/index.md in the source tree"
    user = site.getuserbase() or sys.prefix  # of `pip install --user`
    places = (Path(base, "share/doc/ros2-json-gateway/index.md") for base in (sys.prefix, user))
    return next((str(place) for place in places if place.exists()), "docs/ in the source archive")


def _add_configuration(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group(
        "configuration",
        "A flag beats the environment (ROS2_GATEWAY_PORT, ROS2_GATEWAY_LIMITS__MAX_CLIENTS),\n"
        "which beats --config, which beats config.d/*.toml and then config.toml in\n"
        "/etc/ros2-gateway (demo does not read these two). 'ros2-gateway check-config --example'\n"
        "lists all settings.",
    )
    option(group, "--config", "FILE", _CONFIG, type=Path)
    for flag, (key, metavar, text) in CONFIG_FLAGS.items():
        group.add_argument(flag, dest=key, metavar=metavar, help=text)
    for flag, (key, value, text) in CONFIG_SWITCHES.items():
        group.add_argument(flag, dest=key, action="store_const", const=value, help=text)
    several(group, "--set", "KEY=VALUE", "any setting, such as limits.max_clients=64")
    switch(
        *(group, "--print-config"),
        "print the configuration as TOML, and where each value came from, instead of serving",
    )


def _add_serve(command: AddCommand) -> None:
    parser = command(
        "serve",
        "serve the topics of this ROS 2 system",
        "  ros2-gateway serve                         to programs on this machine\n"
        "  ros2-gateway serve --lan                   to the network, by token\n"
        "  ros2-gateway serve --config gateway.toml   as a file says\n"
        "  ros2-gateway serve --zenoh tcp/robot:7447  of a robot with rmw_zenoh, without ROS here\n"
        "  ros2-gateway serve --uplink tls/relays.example:7447 --robot-name r1   also to relays\n"
        "  ROS2_GATEWAY_PORT=8080 ros2-gateway serve  as the environment says",
    )
    zenoh = "serve the robot behind this Zenoh router, without ROS on this machine"
    option(parser, "--zenoh", "ADDRESS", zenoh, type=zenoh_address)
    # for who writes a source: docs/contributing/adding-a-source.md
    parser.add_argument("--source", metavar="MODULE:FUNCTION", help=argparse.SUPPRESS)
    # for who writes a front: docs/contributing/adding-a-front.md
    parser.add_argument(
        "--front", action="append", metavar="MODULE:FUNCTION", help=argparse.SUPPRESS
    )
    _add_configuration(parser)


def _add_demo(command: AddCommand) -> None:
    parser = command(
        "demo",
        "serve the topics of a simulated robot, which runs along",
        "  ros2-gateway demo\n  ros2-gateway demo --lan --port 8080\n"
        "  ros2-gateway demo --recorded             without ROS, and without driving\n"
        "  ros2-gateway demo --namespace /robot1   also for the names and frames of the robot",
    )
    switch(parser, "--no-browser", "open no page, also on a desktop")
    switch(parser, "--recorded", "play a recording of the robot, which needs no ROS")
    switch(parser.add_argument_group("robot"), "--twist-stamped", _TWIST_STAMPED)
    _add_configuration(parser)


def _add_sim(command: AddCommand) -> None:
    parser = command(
        "sim",
        "run the simulated robot alone",
        "  ros2-gateway sim\n  ros2-gateway sim --no-camera --domain-id 7",
    )
    option(parser, "--domain-id", "ID", _DOMAIN_ID, type=domain_id)
    option(parser, "--namespace", "/NAME", "of the robot's node, topics and frames", default="")
    switch(parser, "--no-camera", "draw no pictures")
    option(parser, "--camera-hz", "HZ", "pictures a second (default 30)", type=float, default=30.0)
    parser.add_argument("--seed", type=int, help="of slip and noise (default: another each time)")
    switch(parser, "--twist-stamped", _TWIST_STAMPED)
    switch(
        *(parser, "--until-stdin-closes"),
        "end when standard input closes, and so with the process that holds it open",
    )


def _add_mock(command: AddCommand) -> None:
    parser = command(
        "mock",
        "publish made-up messages of every type, and print what arrives",
        "  ros2-gateway mock\n"
        "  ros2-gateway mock --rate 10 --type std_msgs/msg/String --type 9\n"
        "  ros2-gateway mock --no-publish",
    )
    option(parser, "--domain-id", "ID", _DOMAIN_ID, type=domain_id)
    option(parser, "--rate", "HZ", "messages a second of each type", type=float, default=1.0)
    several(parser, "--type", "TYPE", "only this type, by name or number")
    switch(parser, "--no-publish", "only print what arrives")
    switch(parser, "--no-listen", "only publish")


def _add_service(command: AddCommand) -> None:
    parser = command(
        "install-service",
        "start the gateway at boot, by systemd",
        "  sudo ros2-gateway install-service --lan\n"
        "  sudo ros2-gateway install-service --user robot --setup ~/ws/install/setup.bash\n"
        "  ros2-gateway install-service --user robot --dry-run   only print the unit",
    )
    option(
        parser,
        "--user",
        "NAME",
        "the user that runs your ROS nodes (default: the one that called sudo)",
    )
    setup = "a setup.bash of ROS or of a workspace (default: of the only ROS in /opt/ros)"
    several(parser, "--setup", "FILE", setup, type=Path)
    option(parser, "--config", "FILE", "TOML file, over those of /etc/ros2-gateway", type=Path)
    switch(parser, "--lan", CONFIG_SWITCHES["--lan"][2])
    switch(parser, "--dry-run", "print the unit, and change nothing")


def _add_find(command: AddCommand) -> None:
    parser = command(
        "find",
        "list the gateways on this network",
        "  ros2-gateway find\n  ros2-gateway find --wait 5",
    )
    wait = "seconds to listen for answers (default 1.5)"
    option(parser, "--wait", "SECONDS", wait, type=seconds, default=1.5)


def _add_doctor(command: AddCommand) -> None:
    parser = command(
        "doctor",
        "find what is wrong with this machine, or with a running gateway",
        "  ros2-gateway doctor                  in the shell that starts the robot\n"
        "  ros2-gateway doctor --json           for scripts. Exit code 1 if there is an error\n"
        "  ros2-gateway doctor --from ws://robot:9090 --token-file token",
    )
    option(parser, "--config", "FILE", _CONFIG, type=Path)
    switch(parser, "--json", "print JSON")
    group = parser.add_argument_group("a running gateway")
    option(group, "--from", "URL", "its address: ws://, wss://, http:// or https://", dest="source")
    add_access(group, "for each check (default 20), or for each answer of a gateway (default 10)")


def _add_check_config(command: AddCommand) -> None:
    parser = command(
        "check-config",
        "check the configuration",
        "  ros2-gateway check-config             as `serve` would start here\n"
        "  ros2-gateway check-config gateway.toml\n"
        "  ros2-gateway check-config --example > gateway.toml",
    )
    file = f"{_CONFIG}, or a directory in place of /etc/ros2-gateway"
    option(parser, "file", "FILE", file, nargs="?", type=Path)
    switch(parser, "--keys", "print all settings with their defaults and meanings, as Markdown")
    switch(parser, "--example", "print a file with all settings as comments")


def _add_token(command: AddCommand) -> None:
    parser = command(
        "token",
        "make, list or revoke the tokens of clients",
        "  ros2-gateway token create tablet                  an operator\n"
        "  ros2-gateway token create wall --role viewer\n"
        "  ros2-gateway token list\n"
        "  ros2-gateway token revoke tablet",
    )
    option(parser, "--config", "FILE", _CONFIG, type=Path)
    option(parser, "--file", "FILE", "token file (default: as configured)", type=Path)
    commands = parser.add_subparsers(dest="token_command", metavar="ACTION", required=True)
    create = commands.add_parser("create", help="make a token, shown once", allow_abbrev=False)
    option(create, "name", "NAME", "such as tablet: letters, digits and . _ -")
    create.add_argument(
        "--role", choices=ROLES, default="operator", help="its permissions (default operator)"
    )
    commands.add_parser("list", help="list names, roles and dates", allow_abbrev=False)
    revoke = commands.add_parser("revoke", help="revoke a token", allow_abbrev=False)
    option(revoke, "name", "NAME", "name of the token")


def _add_cert(command: AddCommand) -> None:
    parser = command(
        "cert",
        "make a certificate for wss://, signed by this machine itself",
        "  ros2-gateway cert\n  ros2-gateway cert --name robot.lan --folder /etc/gateway",
    )
    several(parser, "--name", "NAME", "a further host name or address of this machine")
    where = "where to write cert.pem and key.pem (default: next to the token file)"
    option(parser, "--folder", "FOLDER", where, type=Path)
    switch(parser, "--replace", "replace files that exist")
