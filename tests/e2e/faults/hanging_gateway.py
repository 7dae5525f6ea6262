# SPDX-License-Identifier: Apache-2.0
"""The gateway, which hangs on demand: by SIGUSR1 its event loop, by SIGUSR2 all of its threads."""

import ctypes
import signal
import sys
import time

from gateway.cli.main import main

HANG_S = 2.0


def block_the_loop(*_: object) -> None:
    time.sleep(HANG_S)


def hold_the_gil(*_: object) -> None:
    # a PyDLL keeps the GIL during the call, unlike any other
    ctypes.PyDLL(None).usleep(round(HANG_S * 1e6))


if __name__ == "__main__":
    signal.signal(signal.SIGUSR1, block_the_loop)
    signal.signal(signal.SIGUSR2, hold_the_gil)
    sys.exit(main(sys.argv[1:]))
