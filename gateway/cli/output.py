# SPDX-License-Identifier: Apache-2.0
"""Standard output, which may be closed at the start, a closed pipe, or a full disk."""

import contextlib
import os
import sys
from typing import TextIO

from gateway.errors import system_reason


def open_closed_streams() -> None:
    """Open to nowhere each standard stream that the parent has closed.

    Otherwise the next file or socket gets its number, and printed text goes into that.
    """
    for number, name, mode in ((0, "stdin", "r"), (1, "stdout", "w"), (2, "stderr", "w")):
        if getattr(sys, name) is None:
            nowhere = os.open(os.devnull, os.O_RDWR)
            if nowhere != number:
                os.dup2(nowhere, number)
                os.close(nowhere)
            setattr(sys, name, os.fdopen(number, mode))


def announce(text: str) -> None:
    """Print what people need for a start, even if the disk is full."""
    why = write(text, sys.stdout)
    if why is not None:
        write_elsewhere(f"ros2-gateway: cannot write this, {why}: {text}", sys.stderr)


def write(text: str, stream: TextIO) -> str | None:
    """Write what people need for a start, and return why it cannot be written, or ``None``.

    A stream that cannot be written is discarded from then on, and the gateway still serves.

    Raises:
        BrokenPipeError: the reader of the stream has closed it.
    """
    try:
        print(text, file=stream, flush=True)  # our parent process may wait for it behind a pipe
    except BrokenPipeError:
        raise
    except OSError as error:
        discard_output(stream)
        return system_reason(error)
    return None


def write_elsewhere(text: str, stream: TextIO) -> None:
    """Write a text that another stream did not take. This one may be on the same disk."""
    with contextlib.suppress(OSError):
        stream.write(f"{text}\n")  # at once: other threads write records of the log there
        stream.flush()


def discard_output(stream: TextIO | None = None) -> None:
    """Discard the output from now on, also what waits: at its end Python would fail to write it."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, (stream or sys.stdout).fileno())
    os.close(nowhere)
