# SPDX-License-Identifier: Apache-2.0
"""The last lines of ``/rosout``, for clients that connect later.

Nodes keep their own lines for 10 s only: that is the lifespan of the topic in ROS.
"""

import logging
from collections import deque
from collections.abc import Sequence
from typing import Any, Final

from gateway.codec.cdr import Cdr
from gateway.codec.error_text import CodecError
from gateway.codec.types import Types
from gateway.sources.source import Qos, Ros, RosError, RosSubscription, Sample

logger = logging.getLogger(__name__)

ROSOUT: Final = "/rosout"
LOG: Final = "rcl_interfaces/msg/Log"
MAX_LINES: Final = 1000  # as many as each node keeps
MAX_LINE_BYTES: Final = 16 * 1024  # a longer line would take the place of a hundred others
MAX_LOG_BYTES: Final = 256 * 1024  # of all lines: an answer goes out as one frame


class KeptLog:
    """Receives ``/rosout`` from the start to the end, and keeps the newest lines."""

    def __init__(self, ros: Ros, types: Types) -> None:
        self._lines: deque[tuple[int, dict[str, Any]]] = deque()
        self._bytes = 0
        self._type = types.get(LOG)
        self._subscription: RosSubscription | None = None
        try:
            self._subscription = ros.subscribe(
                ROSOUT, LOG, Qos(depth=MAX_LINES), self._on_samples, lambda _: None
            )
        except RosError as error:
            logger.warning("lines of %s are not kept for later clients: %s", ROSOUT, error)

    @property
    def lines(self) -> list[dict[str, Any]]:
        """The lines that are kept, oldest first, as ``rcl_interfaces/msg/Log``."""
        return [line for _, line in self._lines]

    @property
    def entities(self) -> int:
        """The number of ROS entities that this takes."""
        return int(self._subscription is not None)

    def close(self) -> None:
        """End the subscription."""
        if self._subscription is not None:
            self._subscription.close()

    def _on_samples(self, samples: Sequence[Sample]) -> None:
        for sample in samples:
            self._keep(sample.cdr)

    def _keep(self, cdr: Cdr) -> None:
        size = len(cdr)
        if size > MAX_LINE_BYTES:
            return
        try:
            line = self._type.decode(cdr)
        except CodecError:
            return  # a subscriber is told
        self._lines.append((size, line))
        self._bytes += size
        while len(self._lines) > MAX_LINES or self._bytes > MAX_LOG_BYTES:
            self._bytes -= self._lines.popleft()[0]
