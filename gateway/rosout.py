# SPDX-License-Identifier: Apache-2.0
"""The gateway's own log on /rosout."""

import asyncio
import logging
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

from gateway.log_fields import text_of
from gateway.log_rate import LogRate
from gateway.sources.source import Diagnosis, LogLevel

logger = logging.getLogger("gateway")


@contextmanager
def logging_to_rosout(ros: Diagnosis) -> Iterator[None]:
    """Send the gateway's own log to /rosout as well."""
    handler = _RosoutHandler(ros, asyncio.get_running_loop())
    logger.addHandler(handler)
    try:
        yield
    finally:
        logger.removeHandler(handler)


class _RosoutHandler(logging.Handler):
    def __init__(self, ros: Diagnosis, loop: asyncio.AbstractEventLoop) -> None:
        super().__init__(logging.INFO)
        self._ros = ros
        self._loop = loop
        self._rate = LogRate()
        self.addFilter(self._rate)

    def emit(self, record: logging.LogRecord) -> None:
        for each in (*self._rate.overdue(), record):
            self._log(each)

    def _log(self, record: logging.LogRecord) -> None:
        text = f"{record.name}: {text_of(record)}"
        self._loop.call_soon_threadsafe(
            self._ros.log, _ROS_LEVELS.get(record.levelno, "info"), text
        )


_ROS_LEVELS: Final[dict[int, LogLevel]] = {
    logging.WARNING: "warning",
    logging.ERROR: "error",
    logging.CRITICAL: "error",
}
