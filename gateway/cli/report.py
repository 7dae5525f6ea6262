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
from gateway.errors import (
    BindError,
    ConfigError,
    GatewayError,
    RosMissingError,
    UsageError,
    system_reason,
)

EXIT_OK: Final = 0  # Ctrl-C and SIGTERM included
EXIT_FAILURE: Final = 1
EXIT_USAGE: Final = 2
EXIT_NO_ROS: Final = 3
EXIT_CANNOT_BIND: Final = 4


def report(error: Exception, arguments: argparse.Namespace) -> int:
    """Report an error, each mistake in one sentence; return its exit code."""
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
        case _:
            bug = f"internal error, {type(error).__name__}: {error} (--debug shows where)"
            sentences, code = (bug,), EXIT_FAILURE
    (_write_json if arguments.log_format == "json" else _write)(sentences, arguments)
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
