# SPDX-License-Identifier: Apache-2.0
"""The end of the load, which everything waits for that is done in turns."""

import asyncio


class Over:
    """An event that may be waited for with a bound."""

    def __init__(self) -> None:
        self._event = asyncio.Event()

    def set(self) -> None:
        """It is over."""
        self._event.set()

    async def within(self, seconds: float) -> bool:
        """Wait; return whether it is over by then."""
        try:
            async with asyncio.timeout(seconds):
                await self._event.wait()
        except TimeoutError:
            return False
        return True
