# SPDX-License-Identifier: Apache-2.0
"""Callbacks for simulated time that jumps back.

It jumps back if a simulation was reset, or a recording starts over.
"""

import asyncio
from collections.abc import Callable
from typing import Final

from rclpy.clock import Clock, JumpThreshold, TimeJump
from rclpy.duration import Duration

# any jump, as for tf2's listeners. Without simulated time it never jumps
_BACK: Final = JumpThreshold(
    min_forward=None, min_backward=Duration(nanoseconds=-1), on_clock_change=False
)


class JumpWatch:
    """Calls *on_jump* on the event loop that runs now, whichever thread sets the time."""

    def __init__(self, clock: Clock, on_jump: Callable[[], None]) -> None:
        loop = asyncio.get_running_loop()
        self._on_jump: Callable[[], None] | None = on_jump

        def pass_on(_: TimeJump) -> None:
            loop.call_soon_threadsafe(self._notify)

        self._handle = clock.create_jump_callback(_BACK, post_callback=pass_on)

    def close(self) -> None:
        """End it. No callback comes after. Closing twice is harmless."""
        self._on_jump = None
        self._handle.unregister()

    def _notify(self) -> None:
        if self._on_jump is not None:
            self._on_jump()
