# SPDX-License-Identifier: Apache-2.0
"""The gateway, which fails on demand.

By SIGRTMIN no zero goes out until the next one. By SIGRTMIN + 1 its event loop hangs, by
SIGRTMIN + 2 all of its threads do.
"""

import ctypes
import signal
import sys
import time
from typing import Any

from gateway.cli.main import main
from gateway.core.commands import command_topic
from gateway.drive.twist_cdr import encode
from gateway.drive.velocity import Velocity

HANG_S = 2.0


def block_the_loop(*_: object) -> None:
    time.sleep(HANG_S)


def hold_the_gil(*_: object) -> None:
    # a PyDLL keeps the GIL during the call, unlike any other
    ctypes.PyDLL(None).usleep(round(HANG_S * 1e6))


def fail_at_zero(type_name: str, velocity: Velocity, *rest: Any) -> bytes:
    if velocity.is_zero:
        raise ZeroDivisionError
    return encode(type_name, velocity, *rest)


def keep_zeros_back_or_no_more(*_: object) -> None:
    is_failing = command_topic.encode is fail_at_zero
    command_topic.encode = encode if is_failing else fail_at_zero
    sys.stdout.write("zeros go out\n" if is_failing else "zeros are kept back\n")
    sys.stdout.flush()


if __name__ == "__main__":
    signal.signal(signal.SIGRTMIN, keep_zeros_back_or_no_more)
    signal.signal(signal.SIGRTMIN + 1, block_the_loop)
    signal.signal(signal.SIGRTMIN + 2, hold_the_gil)
    sys.exit(main(sys.argv[1:]))
