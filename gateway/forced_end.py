# SPDX-License-Identifier: Apache-2.0
"""The end of a process whose shutdown takes too long."""

import logging
import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Final

SHUTDOWN_S: Final = 1.8  # of the 2 s that there are

logger = logging.getLogger("gateway")


@contextmanager
def forced_end() -> Iterator[Callable[[], None]]:
    """Lend a function that ends the process after `SHUTDOWN_S`, unless this context ends before.

    A service manager that sends SIGTERM sends SIGKILL later, and a library may wait for long.
    """

    def end() -> None:
        logger.error("shutdown has taken %g s, ending by force", SHUTDOWN_S)
        os._exit(1)

    timer = threading.Timer(SHUTDOWN_S, end)
    timer.daemon = True
    yield timer.start
    timer.cancel()
