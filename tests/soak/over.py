# SPDX-License-Identifier: Apache-2.0
"""The end of the load, which everything waits for that is done in turns."""

import asyncio
import time
from typing import Final

FORGOTTEN_S: Final = 25.0  # Fast DDS waits 20 s for a participant, and then looks every few


class Over:
    """An event that may be waited for with a bound, and is planned."""

    def __init__(self, in_s: float) -> None:
        self._event = asyncio.Event()
        self._planned_s = time.monotonic() + in_s

    @property
    def may_kill(self) -> bool:
        """True until so soon before the end that DDS would not yet have forgotten the dead."""
        return time.monotonic() < self._planned_s - FORGOTTEN_S

    def set(self) -> None:
        """It is over."""
        self._event.set()

    async def within(self, seconds: float) -> bool:
        """Wait. Return whether it is over by then."""
        try:
            async with asyncio.timeout(seconds):
                await self._event.wait()
        except TimeoutError:
            return False
        return True
