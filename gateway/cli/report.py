# SPDX-License-Identifier: Apache-2.0
"""Errors as sentences on standard error, and the exit codes."""

import argparse
import errno
import sys
import time
import traceback
from collections.abc import Sequence
from typing import Final

from gateway.cli.output import discard_output
from gateway.config.secrets import without_tokens
from gateway.errors import (
    BindError,
    ConfigError,
    GatewayError,
    RosMissingError,
    UsageError,
    system_reason,
)

EXIT_OK: Final = 0  # an end by a signal included
EXIT_FAILURE: Final = 1
EXIT_USAGE: Final = 2
EXIT_NO_ROS: Final = 3
EXIT_CANNOT_BIND: Final = 4

_REMEDIES: Final = {
    errno.EMFILE: "allow this process more, for example by `ulimit -n 1024`",
    errno.ENFILE: "allow this machine more, by `sysctl fs.file-max`",
    errno.ENOMEM: "end programs that use much memory",
}


def report(error: Exception, arguments: argparse.Namespace) -> int:
    """Report an error, each mistake in one sentence, and return its exit code."""
    match error:
        case ConfigError():
            sentences, code = error.problems, EXIT_USAGE
        case UsageError():
            sentences, code = (str(error),), EXIT_USAGE
        case RosMissingError():
            sentences, code = (str(error),), EXIT_NO_ROS
        case BindError():
            sentences, code = (str(error),), EXIT_CANNOT_BIND
        case GatewayError():
            sentences, code = (str(error),), EXIT_FAILURE
        case OSError(errno=errno.ENOSPC):
            discard_output()
            sentences, code = (f"cannot write the output, {system_reason(error)}",), EXIT_FAILURE
        case OSError():  # of the machine, not of the program
            where = f", at {error.filename}" if error.filename else ""
            remedy = _REMEDIES.get(error.errno or 0, "add --debug to see where")
            sentences, code = (f"{system_reason(error)}{where}: {remedy}",), EXIT_FAILURE
        case ImportError():
            remedy = "install what the gateway needs, by `pip install .` in the source tree"
            missing = f"a Python package is missing or too old ({error}): {remedy}"
            sentences, code = (missing,), EXIT_FAILURE
        case _:
            bug = f"internal error, {type(error).__name__}: {error} (add --debug to see where)"
            sentences, code = (bug,), EXIT_FAILURE
    shown = [without_tokens(sentence) for sentence in sentences]
    (_write_json if arguments.log_format == "json" else _write)(shown, arguments)
    return code


def _write(sentences: Sequence[str], arguments: argparse.Namespace) -> None:
    if arguments.debug:
        traceback.print_exc()
    for sentence in sentences:
        print(f"ros2-gateway: {sentence}", file=sys.stderr)


def _write_json(sentences: Sequence[str], arguments: argparse.Namespace) -> None:
    from gateway.cli.logs import json_line

    more = {"traceback": traceback.format_exc()} if arguments.debug else {}
    for sentence in sentences:
        print(json_line(time.time(), "error", "gateway", sentence, **more), file=sys.stderr)
