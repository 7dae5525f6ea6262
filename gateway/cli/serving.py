# SPDX-License-Identifier: Apache-2.0
"""The commands that serve: `serve` and `demo`. They import what they need when they run."""

import argparse
import logging
import os
import signal
import sys
from collections.abc import Callable
from functools import partial
from importlib import import_module
from typing import TYPE_CHECKING, Any

from gateway.cli.arguments import CONFIG_FLAGS, CONFIG_SWITCHES
from gateway.cli.output import announce, discard_output, write, write_elsewhere
from gateway.cli.report import EXIT_OK
from gateway.cli.ros_environment import require_rclpy, use_ros
from gateway.errors import ConfigError, UsageError

if TYPE_CHECKING:
    from gateway.app import Listening
    from gateway.config.model import Config
    from gateway.config.settings import Given, Loaded

WasInterrupted = Callable[[], bool]


def serve(was_interrupted: WasInterrupted, arguments: argparse.Namespace) -> int:
    """Serve the topics of this ROS 2 system, or of the source that ``--source`` names."""
    loaded = _configuration(arguments)
    if arguments.print_config:
        return _print_config(loaded)
    if arguments.source is None:
        use_ros(loaded.config.ros.domain_id)
    _begin_log(loaded)
    return _run_gateway(arguments, loaded, was_interrupted)


def demo(was_interrupted: WasInterrupted, arguments: argparse.Namespace) -> int:
    """Serve the topics of a simulated robot, which runs as long."""
    from gateway.cli import demo

    loaded = _configuration(arguments)
    loaded = loaded._replace(config=demo.with_robot(loaded.config))
    if arguments.print_config:
        return _print_config(loaded)
    use_ros(loaded.config.ros.domain_id)  # the robot inherits it
    require_rclpy()
    from gateway.access.posture import posture_of

    config = loaded.config
    for port in (config.port, config.tls.port):
        if port is not None:
            demo.require_free_port(posture_of(config).hosts[0], port)
    # The robot on this desk is not for the network. The middleware reads this when it starts.
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")

    hint = demo.lines_to_paste(config, twist_stamped=arguments.twist_stamped)
    _begin_log(loaded)
    return demo.run(
        lambda: _run_gateway(
            arguments, loaded, was_interrupted, hint, opens_page=not arguments.no_browser
        ),
        demo.robot_command(config, twist_stamped=arguments.twist_stamped),
    )


def _configuration(arguments: argparse.Namespace) -> "Loaded":
    from gateway.config.settings import load

    loaded = load(_given(arguments), os.environ, arguments.config)
    arguments.log_format = loaded.config.log.format  # also of errors, from now on
    return loaded


def _given(arguments: argparse.Namespace) -> list["Given"]:
    from gateway.config.settings import Given

    flags = {key: flag for flag, (key, *_) in CONFIG_FLAGS.items()}
    flags |= {key: flag for flag, (key, *_) in CONFIG_SWITCHES.items()}
    given = []
    for assignment in arguments.set:
        key, equals, value = assignment.partition("=")
        if not equals:
            raise ConfigError(f"--set: got {assignment!r}, expected KEY=VALUE")
        given.append(Given(key, value, f"--set {key}"))
    for key, flag in flags.items():
        value = getattr(arguments, key)
        if value is not None:
            given.append(Given(key, value, flag))
    return given


def _print_config(loaded: "Loaded") -> int:
    from gateway.config.settings import to_toml

    sys.stdout.write(to_toml(loaded))
    return EXIT_OK


def _begin_log(loaded: "Loaded") -> None:
    from gateway.cli.logs import configure_logging

    configure_logging(loaded.config.log.level, loaded.config.log.format)


def _run_gateway(
    arguments: argparse.Namespace,
    loaded: "Loaded",
    was_interrupted: WasInterrupted,
    hint: str = "",
    *,
    opens_page: bool = False,
) -> int:
    # the simulated robot has no other source, and no front
    source, fronts = getattr(arguments, "source", None), getattr(arguments, "front", None)
    open_source = None if source is None else _named("source", source)
    open_fronts = [_named("front", name) for name in fronts or ()]
    if open_source is None:
        require_rclpy()
    from gateway import app

    return app.run(
        _with_certificate(loaded.config),
        announce=partial(_announce, loaded.config, hint, opens_page),
        open_source=open_source,
        open_fronts=open_fronts,
        load=lambda: _with_certificate(_configuration(arguments).config),
        was_interrupted=was_interrupted,
    )


def _announce(
    config: "Config", hint: str, opens_page: bool, listening: "Listening"
) -> Callable[[], None]:
    """Show how to connect. Return a function that shows the *hint*, once clients can drive."""
    from gateway.cli import announcement, tokens

    listening = tokens.kept_from_logs(listening, sys.stdout)
    is_json = config.log.format == "json"
    show = partial(_announce_in_json, listening) if is_json else announce
    show(announcement.announcement(listening))
    if config.qr and not is_json:
        _announce_qr_code(listening)
    if opens_page:
        announcement.open_page(announcement.own_page(listening))

    def invite() -> None:
        try:
            if hint:
                show(announcement.filled(hint, listening))
        except BrokenPipeError:  # as above, where it also ends the gateway
            discard_output()
            signal.raise_signal(signal.SIGTERM)

    return invite


def _announce_in_json(listening: "Listening", lines: str) -> None:
    from gateway.cli import announcement

    text = "\n".join(announcement.in_json(listening, lines))
    why = write(text, sys.stdout)
    if why is not None:
        # without the text, which may contain a token: the log goes to /rosout as well
        logging.getLogger("gateway").warning("cannot write standard output, %s", why)
        write_elsewhere(text, sys.stderr)


def _announce_qr_code(listening: "Listening") -> None:
    from gateway.cli import announcement

    if listening.posture.is_open and sys.stdout.isatty():
        text = announcement.qr_text(listening, announcement.own_addresses())
        if text is not None:
            announce(f"{announcement.qr_code(text)}for a phone: {text}")


def _with_certificate(config: "Config") -> "Config":
    """Return a configuration in which a port for TLS has a certificate: this machine's, if none."""
    if config.tls.port is None or config.tls.cert is not None or config.tls.key is not None:
        return config
    from gateway.access.token_file import default_path
    from gateway.cli.certificate import own_certificate

    cert, key = own_certificate(default_path(os.environ).parent)
    tls = config.tls.model_copy(update={"cert": str(cert), "key": str(key)})
    return config.model_copy(update={"tls": tls})


def _named(part: str, name: str) -> Any:
    """Return the function that ``--source`` or ``--front MODULE:FUNCTION`` names."""
    module_name, _, function = name.partition(":")
    try:
        found = getattr(import_module(module_name), function)
    except (ImportError, AttributeError, ValueError) as error:
        remedy = "name it as MODULE:FUNCTION, and its directory in PYTHONPATH"
        raise UsageError(f"--{part}: unknown {part} {name!r}, {error}: {remedy}") from error
    if not callable(found):
        raise UsageError(f"--{part}: {name} is not a function: name one that opens a {part}")
    return found
