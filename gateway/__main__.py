# SPDX-License-Identifier: Apache-2.0
"""``python -m gateway`` is ``ros2-gateway``."""

import contextlib
import logging
import os
import sys
from typing import NoReturn

from gateway.cli.main import main
from gateway.cli.output import open_closed_streams


def run() -> NoReturn:
    """Run ``ros2-gateway``, and end the process at once when it is done.

    By then everything is closed. At its end the interpreter would free each object, and libraries
    would wait for their threads. That takes 0.5 s, and several seconds on a busy machine. A service
    manager that sends SIGTERM may not wait so long.
    """
    open_closed_streams()
    code = main()
    logging.shutdown()
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError):  # nobody reads it any more
            stream.flush()
    os._exit(code)


if __name__ == "__main__":
    run()
