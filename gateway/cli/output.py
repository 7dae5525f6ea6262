# SPDX-License-Identifier: Apache-2.0
"""Standard output, which may be a pipe that somebody closed, or a disk that is full."""

import os
import sys

from gateway.errors import system_reason


def announce(text: str) -> None:
    """Print what people need for a start; a full disk does not hinder it."""
    try:
        print(text, flush=True)  # our parent process may wait for it behind a pipe
    except BrokenPipeError:
        raise
    except OSError as error:  # a full disk: the gateway serves all the same
        discard_output()
        print(f"ros2-gateway: cannot write this, {system_reason(error)}: {text}", file=sys.stderr)


def discard_output() -> None:
    """Write to nowhere from now on, also what waits: at its end Python would fail to write it."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
