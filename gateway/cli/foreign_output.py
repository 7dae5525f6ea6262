# SPDX-License-Identifier: Apache-2.0
"""The output of libraries and child processes, as lines of the log.

C code writes there by itself: Fast DDS its errors, rcutils an error within an error. A collector
that expects JSON on each line would choke on those, so both descriptors become pipes while the
gateway runs, and a thread for each turns what comes out into records.
"""

import contextlib
import logging
import os
import sys
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, TextIO

MAX_LINE_BYTES: Final = 8192  # of a line; longer ones become several records
# At the end, for what is in the pipes; a child that outlives us must hold up nothing.
DRAIN_S: Final = 0.3

_STDIN: Final = 0
_STDOUT: Final = 1
_STDERR: Final = 2


@dataclass(frozen=True, slots=True)
class OwnOutput:
    """Standard output and error as they were, for the gateway's own lines."""

    stdout: TextIO
    stderr: TextIO

    @property
    def streams(self) -> tuple[int, int, int]:
        """The descriptors of standard input, output and error as they were."""
        return (_STDIN, self.stdout.fileno(), self.stderr.fileno())


@contextlib.contextmanager
def foreign_output_logged() -> Iterator[OwnOutput]:
    """Log whatever is written to descriptors 1 and 2; lend the real ones.

    The log must go to the real standard error.
    """
    with contextlib.ExitStack() as stack:
        own = OwnOutput(
            _redirected(stack, _STDOUT, logging.INFO), _redirected(stack, _STDERR, logging.WARNING)
        )
        yield own


def _redirected(stack: contextlib.ExitStack, descriptor: int, level: int) -> TextIO:
    """Have a thread log what is written to a descriptor; return what it was before."""
    name = {_STDOUT: "stdout", _STDERR: "stderr"}[descriptor]
    python_stream = {_STDOUT: sys.stdout, _STDERR: sys.stderr}[descriptor]
    python_stream.flush()
    before = os.dup(descriptor)
    end, beginning = os.pipe()
    os.dup2(beginning, descriptor)
    os.close(beginning)
    thread = threading.Thread(target=_log_lines, args=(end, name, level), name=name, daemon=True)
    thread.start()
    own = os.fdopen(before, "w", buffering=1, encoding="utf-8", errors="backslashreplace")

    def restore() -> None:
        with contextlib.suppress(OSError, ValueError):
            python_stream.flush()
        os.dup2(before, descriptor)  # which closes our end of the pipe
        thread.join(DRAIN_S)

    stack.callback(restore)
    return own


def _log_lines(end: int, name: str, level: int) -> None:
    logger = logging.getLogger(name)
    with os.fdopen(end, "rb") as stream:
        while line := stream.readline(MAX_LINE_BYTES):
            text = line.decode(errors="backslashreplace").rstrip()
            if text:
                logger.log(level, "%s", text)
