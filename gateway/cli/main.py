# SPDX-License-Identifier: Apache-2.0
"""The command line: argv to configuration to exit code.

Each subcommand imports its modules when it runs, so that ``--help`` is instant and commands that
need no ROS work without it.
"""

import argparse
import os
import signal
import sys
import threading
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Final, NoReturn

from gateway.cli import serving
from gateway.cli.arguments import argument_parser
from gateway.cli.output import announce, discard_output
from gateway.cli.report import EXIT_OK, report
from gateway.cli.ros_arguments import without_ros_arguments
from gateway.cli.ros_environment import ros_imports, use_ros
from gateway.ending_signals import ENDING
from gateway.errors import ConfigError, RobotDiedError, UsageError

if TYPE_CHECKING:
    from gateway.config.model import Config

_interrupted: Final = threading.Event()  # by a signal: an import may lose the exception


def main(argv: Sequence[str] | None = None) -> int:
    """Run ``ros2-gateway`` with *argv* (default: this process's) and return its exit code."""
    _interrupted.clear()
    # Until a subcommand handles signals itself, they must end the process just as quietly. A shell
    # that starts us in the background has set SIGINT to be ignored.
    for signal_number in ENDING:
        signal.signal(signal_number, _interrupt)
    arguments = argparse.Namespace(debug=False, log_format=None)
    given = sys.argv[1:] if argv is None else argv
    try:
        argument_parser().parse_args(without_ros_arguments(given), arguments)
        code = _run(arguments)
        sys.stdout.flush()
    except KeyboardInterrupt:
        return EXIT_OK
    except BrokenPipeError:  # the reader of our output, such as head, has closed it
        discard_output()
        return EXIT_OK
    except Exception as error:  # noqa: BLE001  # the outermost frame reports every error
        # An extension module that is interrupted while it loads may raise anything.
        if _interrupted.is_set() and not isinstance(error, RobotDiedError):
            return EXIT_OK
        if arguments.log_format is None:  # the configuration is not read
            from gateway.cli.logs import wanted_format

            serving_ones = (["serve"], ["demo"], ["play"], ["relay"])  # the others have no log
            serves = given[:1] in serving_ones
            arguments.log_format = wanted_format(given, os.environ) if serves else "text"
        return report(error, arguments)
    return code


def _interrupt(*_: object) -> NoReturn:
    _interrupted.set()
    raise KeyboardInterrupt


def _run(arguments: argparse.Namespace) -> int:
    commands: dict[str, Callable[[argparse.Namespace], int]] = {
        "serve": partial(serving.serve, _interrupted.is_set),
        "demo": partial(serving.demo, _interrupted.is_set),
        "play": partial(serving.play, _interrupted.is_set),
        "router": _router,
        "relay": partial(serving.relay, _interrupted.is_set),
        "record": partial(serving.record, _interrupted.is_set),
        "sim": _sim,
        "mock": _mock,
        "schema": _schema,
        "generate": _generate,
        "check-config": _check_config,
        "token": _token,
        "cert": _cert,
        "install-service": _install_service,
        "find": _find,
        "doctor": _doctor,
    }
    return commands[arguments.command](arguments)


def _without_own_certificate(config: "Config") -> "Config":
    """Return a configuration to check, without files that only `serve` would make."""
    if config.tls.cert is not None:
        return config
    return config.model_copy(update={"tls": config.tls.model_copy(update={"port": None})})


def _sim(arguments: argparse.Namespace) -> int:
    if arguments.until_stdin_closes:
        from gateway.cli.demo import end_with_stdin

        end_with_stdin()
    use_ros(arguments.domain_id)
    with ros_imports():
        from gateway_sim import node
    return node.run(
        node.SimOptions(
            namespace=arguments.namespace,
            camera=not arguments.no_camera,
            camera_hz=arguments.camera_hz,
            seed=arguments.seed,
            twist_stamped=arguments.twist_stamped,
        )
    )


def _mock(arguments: argparse.Namespace) -> int:
    use_ros(arguments.domain_id)
    with ros_imports():
        from gateway_sim import mock
    return mock.run(
        mock.MockOptions(
            rate_hz=arguments.rate,
            types=tuple(arguments.type),
            publish=not arguments.no_publish,
            listen=not arguments.no_listen,
            write=announce,
        )
    )


def _schema(arguments: argparse.Namespace) -> int:
    import json

    from gateway.cli.type_names import TypeNames, local_definitions
    from schemas.build import json_schema
    from schemas.definition import DefinitionError
    from schemas.installed import UnknownTypeError

    definitions = local_definitions(arguments, os.environ)
    names = TypeNames(definitions)
    name = names.resolve(arguments.type)
    try:
        if arguments.definition:
            text = definitions.get_any(name).text.rstrip()
        else:
            text = json.dumps(json_schema(name, definitions), indent=2, ensure_ascii=False)
    except UnknownTypeError as error:
        near = names.nearest(name)
        hint = ": install its package, or name a folder with its definition by --types-path"
        raise UsageError(f"{error}, did you mean {near}" if near else f"{error}{hint}") from error
    except DefinitionError as error:
        raise UsageError(str(error)) from error
    print(text)
    return EXIT_OK


def _generate(arguments: argparse.Namespace) -> int:
    from gateway.cli.generate import generate

    generated = generate(arguments, os.environ)
    for note in generated.notes:
        print(f"ros2-gateway: {note}", file=sys.stderr)
    sys.stdout.write(generated.text)
    return EXIT_OK


def _token(arguments: argparse.Namespace) -> int:
    from gateway.access import token_file
    from gateway.access_files import token_path
    from gateway.cli import tokens
    from gateway.config.settings import load

    path = arguments.file
    if path is None:
        path = token_path(load(environment=os.environ, file=arguments.config).config)
    match arguments.token_command:
        case "create":
            text = tokens.create(path, arguments.name, arguments.role)
            try:
                print(text, flush=True)
            except OSError:
                tokens.revoke(path, arguments.name)  # nobody has read it
                raise
            note = f"the token of {arguments.name}, {arguments.role}, is shown only this once"
        case "revoke":
            tokens.revoke(path, arguments.name)
            note = f"the token of {arguments.name} is revoked"
        case _:
            for line in tokens.listed(path):
                print(line)
            return EXIT_OK
    from gateway.cli.service import RELOAD, TOKENS, installed_service

    how = f"by {RELOAD}" if path == TOKENS else "on kill -HUP"
    print(f"{note}. A running gateway reads {path} again {how}", file=sys.stderr)
    if arguments.file is None and path == token_file.default_path(os.environ):
        service = installed_service()
        if service is not None:
            command = tokens.create_command(TOKENS, service.user)
            print(f"the service of this machine has other tokens: {command}", file=sys.stderr)
    return EXIT_OK


def _cert(arguments: argparse.Namespace) -> int:
    from gateway.access.token_file import default_path
    from gateway.cli.certificate import make_certificate

    folder = arguments.folder or default_path(os.environ).parent
    subjects = make_certificate(folder, arguments.name, replace=arguments.replace)
    cert, key = folder / "cert.pem", folder / "key.pem"
    print(f"a certificate for {', '.join(subjects)}. To use it, serve with")
    print(f"  --tls-cert {cert} --tls-key {key}")
    return EXIT_OK


def _install_service(arguments: argparse.Namespace) -> int:
    from gateway.cli.service import install, unit_of
    from gateway.config.settings import load

    wanted = unit_of(
        *(arguments.user, arguments.setup, os.environ), config=arguments.config, lan=arguments.lan
    )
    if arguments.dry_run:
        print(wanted.text, end="")
    else:
        from gateway.config.files import Given

        lan = [Given("lan", "true", "--lan")] if arguments.lan else []
        for line in install(wanted, load(lan, file=arguments.config)):
            print(line, flush=True)
    return EXIT_OK


def _check_config(arguments: argparse.Namespace) -> int:
    from gateway.access.posture import posture_of
    from gateway.access_files import exposed_secrets, read_access
    from gateway.config.files import FOLDER_VARIABLE
    from gateway.config.reference import example, reference
    from gateway.config.settings import given_lines, load

    if arguments.keys or arguments.example:
        print(reference() if arguments.keys else example(), end="")
        return EXIT_OK
    file, environment = arguments.file, dict(os.environ)
    if file is not None and file.is_dir():
        file, environment[FOLDER_VARIABLE] = None, str(file)
    loaded = load(environment=environment, file=file)
    try:
        posture_of(loaded.config)  # an error if values contradict each other
        read_access(_without_own_certificate(loaded.config))
        if paths := loaded.config.types.paths:
            from gateway.definitions import known_definitions

            known_definitions(paths, "types.paths")
    except ConfigError as error:
        raise loaded.located(error) from error
    for note in (*exposed_secrets(loaded.config), *map(_ignored, loaded.ignored)):
        print(f"ros2-gateway: {note}", file=sys.stderr)
    for path in loaded.files:
        print(f"read {path}")
    lines = given_lines(loaded)
    for line in lines:
        print(f"  {line}")
    values = "1 value" if len(lines) == 1 else f"{len(lines)} values"
    print(f"the configuration is right: {values} given, the others have their defaults")
    return EXIT_OK


def _ignored(path: Path) -> str:
    return f"{path} is ignored: end its name with .toml, without a dot before it, or remove it"


def _doctor(arguments: argparse.Namespace) -> int:
    from gateway.cli.doctor.command import doctor

    return doctor(arguments, os.environ)


def _router(arguments: argparse.Namespace) -> int:
    from gateway.cli.router import router

    return router(arguments)


def _find(arguments: argparse.Namespace) -> int:
    from gateway.cli.find import lines

    print("\n".join(lines(arguments.wait)))
    return EXIT_OK
