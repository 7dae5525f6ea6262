# SPDX-License-Identifier: Apache-2.0
"""The choices of `ros2-gateway play`. This module imports nothing that takes time."""

from dataclasses import dataclass
from pathlib import Path
from typing import Final

MIN_RATE: Final = 0.01
MAX_RATE: Final = 100.0

# the simulated robot, which drives to a goal
DEMO: Final = Path(__file__).with_name("demo.mcap")


@dataclass(frozen=True)
class PlayOptions:
    """The way in which a recording begins."""

    rate: float = 1.0
    loop: bool = False
    start_s: float = 0.0  # after the first message
    is_paused: bool = False
