# SPDX-License-Identifier: Apache-2.0
"""The errors of the event loop that nobody awaits."""

import asyncio
import errno
import logging
import math
from typing import Any, Final

from gateway.errors import system_reason

logger = logging.getLogger("gateway")

WARN_AGAIN_S: Final = 10.0


class LoopErrors:
    """Reports what nobody awaits.

    While no descriptor is left, asyncio tries a hundred times a second to accept a client. It tries
    once more a second later, and raises ValueError if its server was closed.
    """

    def __init__(self) -> None:
        self._warned_s = -math.inf

    def __call__(self, loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        """Report an error, unless asyncio meets it again and again."""
        error = context.get("exception")
        if isinstance(error, ValueError) and "_start_serving" in context.get("message", ""):
            return
        if not isinstance(error, OSError) or error.errno not in {errno.EMFILE, errno.ENFILE}:
            loop.default_exception_handler(context)
        elif loop.time() - self._warned_s > WARN_AGAIN_S:
            self._warned_s = loop.time()
            logger.warning(
                "no client can connect, %s: allow more, for example with `ulimit -n`",
                system_reason(error),
            )
