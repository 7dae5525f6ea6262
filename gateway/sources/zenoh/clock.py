# SPDX-License-Identifier: Apache-2.0
"""The time of the robot: the system's, or that of ``/clock`` with ``ros.use_sim_time``."""

import struct
import time
from collections.abc import Callable, Sequence
from typing import Final

from gateway.sources.source import Sample

CLOCK_TOPIC: Final = "/clock"
CLOCK_TYPE: Final = "rosgraph_msgs/msg/Clock"
_NS_PER_S: Final = 1_000_000_000
_HEADER_BYTES: Final = 4
_TIMES: Final = {b"\0\1": struct.Struct("<iI"), b"\0\0": struct.Struct(">iI")}


class RobotClock:
    """Follows ``/clock`` if it hears samples of it, and is the system's clock before."""

    def __init__(self) -> None:
        self._simulated_ns: int | None = None
        self._on_jump_back: dict[ClockWatch, Callable[[], None]] = {}

    def now_ns(self) -> int:
        """Return the time."""
        return time.time_ns() if self._simulated_ns is None else self._simulated_ns

    def hear(self, samples: Sequence[Sample]) -> None:
        """Take the time of samples of ``/clock``."""
        for sample in samples:
            form = _TIMES.get(bytes(sample.cdr[:2]))
            if form is None or len(sample.cdr) < _HEADER_BYTES + form.size:
                continue
            seconds, nanoseconds = form.unpack_from(sample.cdr, _HEADER_BYTES)
            before, self._simulated_ns = self._simulated_ns, seconds * _NS_PER_S + nanoseconds
            if before is not None and self._simulated_ns < before:
                for on_jump in list(self._on_jump_back.values()):
                    on_jump()

    def watch(self, on_jump: Callable[[], None]) -> "ClockWatch":
        """Call *on_jump* when the time has jumped back."""
        watch = ClockWatch(self._on_jump_back)
        self._on_jump_back[watch] = on_jump
        return watch


class ClockWatch:
    """Implements `gateway.sources.source.Watch`."""

    def __init__(self, registered: "dict[ClockWatch, Callable[[], None]]") -> None:
        self._registered = registered

    def close(self) -> None:
        """End it. No callback follows."""
        self._registered.pop(self, None)
