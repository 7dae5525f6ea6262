# SPDX-License-Identifier: Apache-2.0
"""The output of libraries and child processes, as lines of the log.

C code writes there by itself: Fast DDS its errors, rcutils an error within an error. A collector
that expects JSON on each line would fail on those. So both descriptors become pipes while the
gateway runs, and a thread for each turns the output into records. Between them stands the process
of `gateway.cli.output_relay`: C code that holds the GIL while it writes to a full pipe would wait
forever for a thread of ours.
"""

import contextlib
import logging
import os
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final, TextIO

from gateway.cli import output_relay

MAX_LINE_BYTES: Final = 8192  # of a line, longer ones become several records
# At the end, for the rest in the pipes, if the reader of our standard error takes nothing.
DRAIN_S: Final = 0.5

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
    """Log everything that is written to descriptors 1 and 2, and lend the real ones.

    The log must go to the real standard error.
    """
    outputs = [
        _Output(sys.stdout, _STDOUT, logging.INFO),
        _Output(sys.stderr, _STDERR, logging.WARNING),
    ]
    relay = _start_relay(outputs)
    for output in outputs:
        output.redirect()
    try:
        yield OwnOutput(*(output.own for output in outputs))
    finally:
        for output in outputs:
            output.restore()
        if relay.stdin:
            relay.stdin.close()  # it hands on what is in the pipes, and ends
        deadline_s = time.monotonic() + DRAIN_S
        for output in outputs:
            output.drain(deadline_s)
        relay.kill()
        relay.wait()


def _start_relay(outputs: Sequence["_Output"]) -> "subprocess.Popen[bytes]":
    """Start the process that reads what is written, and hand over its descriptors."""
    descriptors = [number for output in outputs for number in (output.written, output.relayed)]
    relay = subprocess.Popen(
        # neither site nor the environment: it needs none, and starts in a third of the time
        [sys.executable, "-I", "-S", output_relay.__file__, *map(str, descriptors)],
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        pass_fds=descriptors,
        process_group=0,  # Ctrl-C in a terminal is for the gateway
    )
    for descriptor in descriptors:
        os.close(descriptor)
    return relay


class _Output:
    """One of the two descriptors, and the thread that logs what is written there."""

    def __init__(self, stream: TextIO, descriptor: int, level: int) -> None:
        self._stream = stream
        self._descriptor = descriptor
        self._level = level
        self.written, self._beginning = os.pipe()
        self._end, self.relayed = os.pipe()
        self._is_over = False
        stream.flush()
        before = os.dup(descriptor)
        self.own = os.fdopen(before, "w", buffering=1, encoding="utf-8", errors="backslashreplace")
        name = {_STDOUT: "stdout", _STDERR: "stderr"}[descriptor]
        self._logger = logging.getLogger(name)
        self._thread = threading.Thread(target=self._log_lines, name=name, daemon=True)

    def redirect(self) -> None:
        """Log what is written from now on."""
        os.dup2(self._beginning, self._descriptor)
        os.close(self._beginning)
        self._thread.start()

    def restore(self) -> None:
        """Have the descriptor be what it was before."""
        self._is_over = True
        with contextlib.suppress(OSError, ValueError):
            self._stream.flush()
        os.dup2(self.own.fileno(), self._descriptor)  # which closes our end of the pipe

    def drain(self, deadline_s: float) -> None:
        """Log what is in the pipes still, unless that takes too long."""
        self._thread.join(max(0.0, deadline_s - time.monotonic()))

    def _log_lines(self) -> None:
        with os.fdopen(self._end, "rb") as stream:
            while line := stream.readline(MAX_LINE_BYTES):
                text = line.decode(errors="backslashreplace").rstrip()
                if text:
                    self._logger.log(self._level, "%s", text)
        if not self._is_over:
            self._logger.error("nobody reads this output any more, what is written to it is lost")
