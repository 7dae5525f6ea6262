# SPDX-License-Identifier: Apache-2.0
"""The time by which a request must be answered: one clock for all the steps that it takes."""

import asyncio
import contextlib
from collections.abc import AsyncIterator
from dataclasses import dataclass

from gateway.backports import timeout_at
from gateway.core.errors import ProtocolError


@dataclass(frozen=True, slots=True)
class Deadline:
    """A timeout that has begun. It passes from step to step, so that no step starts it again."""

    timeout_s: float
    at_s: float  # loop time

    @classmethod
    def within(cls, timeout_s: float) -> "Deadline":
        """Begin a timeout now."""
        return cls(timeout_s, asyncio.get_running_loop().time() + timeout_s)

    @contextlib.asynccontextmanager
    async def limit(self, event: str) -> AsyncIterator[None]:
        """Cancel what is awaited inside when the time is over. See `error`.

        Raises:
            ProtocolError: ``timeout``.
        """
        try:
            async with timeout_at(self.at_s):
                yield
        except TimeoutError:
            raise self.error(event) from None

    def error(self, event: str) -> ProtocolError:
        """Return ``timeout`` for an event, such as "node /a has not answered", in time."""
        return ProtocolError("timeout", f"{event} within {self.timeout_s:g} s")
