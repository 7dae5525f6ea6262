# SPDX-License-Identifier: Apache-2.0
"""Signals from outside that would end a process at once.

Signals of timers and of a crash are not among them.
"""

import signal
from typing import Final

_NAMES: Final = ("SIGINT", "SIGTERM", "SIGQUIT", "SIGUSR1", "SIGUSR2", "SIGXCPU")
ENDING: Final = tuple(  # Windows has the first two
    signal.Signals[name] for name in _NAMES if name in signal.Signals.__members__
)
