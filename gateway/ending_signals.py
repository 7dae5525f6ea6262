# SPDX-License-Identifier: Apache-2.0
"""Signals from outside that would end a process at once.

Signals of timers and of a crash are not among them.
"""

import signal
from typing import Final

ENDING: Final = (
    *(signal.SIGINT, signal.SIGTERM, signal.SIGQUIT),
    *(signal.SIGUSR1, signal.SIGUSR2, signal.SIGXCPU),
)
