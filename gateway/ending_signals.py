# SPDX-License-Identifier: Apache-2.0
"""The signals that somebody may send to end a process, and that would end it at once.

Those of its own timers are not among them, nor those of a crash.
"""

import signal
from typing import Final

ENDING: Final = (
    *(signal.SIGINT, signal.SIGTERM, signal.SIGQUIT),
    *(signal.SIGUSR1, signal.SIGUSR2, signal.SIGXCPU),
)
