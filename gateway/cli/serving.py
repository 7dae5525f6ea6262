# SPDX-License-Identifier: Apache-2.0
"""The commands that serve: `serve` and `demo`. They import what they need when they run."""

import argparse
import logging
import os
import signal
import sys
from collections.abc import Callable, Sequence
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gateway.cli.arguments import CONFIG_FLAGS, CONFIG_SWITCHES
from gateway.cli.output import announce, discard_output, write, write_elsewhere
from gateway.cli.record_arguments import RECORDING_FLAGS
from gateway.cli.report import EXIT_OK
from gateway.cli.ros_environment import require_rclpy, use_ros
from gateway.errors import HOW_TO_GET_RECORDINGS, HOW_TO_GET_ZENOH, ConfigError, UsageError
from gateway.sources.recording.options import DEMO, PlayOptions

if TYPE_CHECKING:
    from gateway.app import Listening, OpenSource
    from gateway.config.files import Given
    from gateway.config.model import Config
    from gateway.config.settings import Loaded

WasInterrupted = Callable[[], bool]


def serve(was_interrupted: WasInterrupted, arguments: argparse.Namespace) -> int:
    """Serve the topics of this ROS 2 system, or of the source that a flag names."""
    loaded = _configuration(arguments)
    if arguments.print_config:
        return _print_config(loaded)
    if arguments.source is None and arguments.zenoh is None:
        use_ros(loaded.config.ros.domain_id)
    opening = None if arguments.zenoh is None else _opening_zenoh(arguments.zenoh)
    _begin_log(loaded)
    return _run_gateway(arguments, loaded, was_interrupted, open_source=opening)


def demo(was_interrupted: WasInterrupted, arguments: argparse.Namespace) -> int:
    """Serve the topics of a simulated robot, which runs as long."""
    from gateway.cli import demo

    if arguments.recorded:
        opens_page, hint = not arguments.no_browser, "in a browser, open  PAGE"
        options = PlayOptions(loop=True)
        return _play(was_interrupted, arguments, [DEMO], options, hint, opens_page=opens_page)
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


def play(was_interrupted: WasInterrupted, arguments: argparse.Namespace) -> int:
    """Serve a recording, without ROS."""
    options = PlayOptions(arguments.rate, arguments.loop, arguments.start, arguments.paused)
    return _play(was_interrupted, arguments, arguments.files, options)


def relay(was_interrupted: WasInterrupted, arguments: argparse.Namespace) -> int:
    """Serve the robots behind a Zenoh router."""
    loaded = _configuration(arguments)
    if arguments.print_config:
        return _print_config(loaded)
    if sys.platform == "win32":
        raise UsageError("relay: it does not run on Windows: start it on Linux")
    require_zenoh("relay")
    _begin_log(loaded)
    from gateway.relay.serve import run

    try:
        return run(
            _with_certificate(loaded.config),
            arguments.router,
            announce=partial(_announce, loaded.config, "", False),
            load=lambda: _with_certificate(_configuration(arguments).config),
            was_interrupted=was_interrupted,
        )
    except ConfigError as error:
        raise loaded.located(error) from error


def record(was_interrupted: WasInterrupted, arguments: argparse.Namespace) -> int:
    """Record the topics of this ROS 2 system."""
    from gateway.cli.record import record

    loaded = _configuration(arguments)
    _begin_log(loaded)
    return record(arguments, loaded, was_interrupted)


def _play(
    was_interrupted: WasInterrupted,
    arguments: argparse.Namespace,
    files: Sequence[Path],
    options: PlayOptions,
    hint: str = "",
    *,
    opens_page: bool = False,
) -> int:
    loaded = _configuration(arguments)
    if arguments.print_config:
        return _print_config(loaded)
    opening = _opening(files, options)
    _begin_log(loaded)
    return _run_gateway(
        arguments, loaded, was_interrupted, hint, opens_page=opens_page, open_source=opening
    )


def _opening(files: Sequence[Path], options: PlayOptions) -> "OpenSource":
    """Return the function that opens a recording.

    Raises:
        UsageError: the packages that read recordings are missing.
    """
    try:
        from gateway.sources.recording.port import open_source
    except ModuleNotFoundError as error:
        package = str(error.name).partition(".")[0]
        raise UsageError(f"{package} is missing: {HOW_TO_GET_RECORDINGS}") from error
    return partial(open_source, files, options)


def _opening_zenoh(router: str) -> "OpenSource":
    """Return the function that connects to a Zenoh router.

    Raises:
        UsageError: the packages that speak Zenoh are missing, or this is Windows.
    """
    if sys.platform == "win32":  # its event loops cannot read the pipe of the guard process
        what = "the process that stops the robot does not run on Windows"
        raise UsageError(f"--zenoh: {what}: start the gateway on Linux")
    require_zenoh("--zenoh")
    from gateway.sources.zenoh.options import ZenohOptions
    from gateway.sources.zenoh.port import open_source

    overrides = os.environ.get("ZENOH_CONFIG_OVERRIDE", "")
    return partial(open_source, ZenohOptions(router, overrides))


def require_zenoh(what: str) -> None:
    """Raise UsageError if the packages that speak Zenoh are missing."""
    for package in ("zenoh", "xxhash"):
        if find_spec(package) is None:
            raise UsageError(f"{what}: {package} is missing: {HOW_TO_GET_ZENOH}")


def _configuration(arguments: argparse.Namespace) -> "Loaded":
    from gateway.config.settings import load

    # A demonstration is not the robot of this machine, and not for the robot's network.
    is_demo = arguments.command == "demo"
    loaded = load(_given(arguments), os.environ, arguments.config, only_named=is_demo)
    arguments.log_format = loaded.config.log.format  # also of errors, from now on
    return loaded


def _given(arguments: argparse.Namespace) -> list["Given"]:
    from gateway.config.files import Given

    flags = {key: flag for flag, (key, *_) in CONFIG_FLAGS.items()}
    flags |= {key: flag for flag, (key, *_) in (CONFIG_SWITCHES | RECORDING_FLAGS).items()}
    given = []
    for assignment in arguments.set:
        key, equals, value = assignment.partition("=")
        if not equals:
            raise ConfigError(f"--set: got {assignment!r}, expected KEY=VALUE")
        given.append(Given(key, value, f"--set {key}"))
    for key, flag in flags.items():
        value = getattr(arguments, key, None)  # a command need not have all
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
    open_source: "OpenSource | None" = None,
) -> int:
    # only `serve` has flags for these
    source, fronts = getattr(arguments, "source", None), getattr(arguments, "front", None)
    if source is not None:
        open_source = _named("source", source)
    open_fronts = [_named("front", name) for name in fronts or ()]
    if open_source is None:
        require_rclpy()
    from gateway import app

    try:
        return app.run(
            _with_certificate(loaded.config),
            announce=partial(_announce, loaded.config, hint, opens_page),
            open_source=open_source,
            open_fronts=open_fronts,
            load=lambda: _with_certificate(_configuration(arguments).config),
            was_interrupted=was_interrupted,
        )
    except ConfigError as error:
        raise loaded.located(error) from error


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
