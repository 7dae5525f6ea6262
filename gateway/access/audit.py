# SPDX-License-Identifier: Apache-2.0
"""The audit log: who connected, who was refused, who took control, and every stop.

Each event is one line of JSON, for the logger `gateway.audit` and, if the operator names one, a
file. It holds no tokens and no payloads: only names, roles, addresses, reasons.
"""

import json
import logging
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timezone
from typing import Final

MAX_VALUE_CHARACTERS: Final = 200  # a name of ROS fits
# Lines of one kind of event in a window, so that no flood fills the disk or the log. Each kind
# has its own limit, so that no flood can hide a stop.
MAX_LINES: Final = 100
WINDOW_NS: Final = 10 * 1_000_000_000

AuditValue = str | int | float | bool | None

logger = logging.getLogger("gateway.audit")


@dataclass(slots=True)
class _Window:
    began_ns: int
    lines: int = 0
    left_out: int = 0


class Audit:
    """Writes events, a bounded number of each kind.

    *write* gets each line and must not wait. *clock_ns* is the time of day. *level* is the level of
    the records in the log.
    """

    def __init__(
        self,
        clock_ns: Callable[[], int],
        write: Callable[[str], None] | None = None,
        level: int = logging.INFO,
    ) -> None:
        self._clock_ns = clock_ns
        self._write = write
        self._level = level
        self._windows: dict[str, _Window] = {}
        self._following: list[Callable[[str], None]] = []

    def follow(self, write: Callable[[str], None]) -> None:
        """Give each line to *write* as well, until `unfollow`."""
        self._following.append(write)

    def unfollow(self, write: Callable[[str], None]) -> None:
        """Give no more lines to *write*. Doing so twice is harmless."""
        if write in self._following:
            self._following.remove(write)

    def record(self, event: str, *, client: str | None = None, **values: AuditValue) -> None:
        """Record an event. *event* is one of the gateway's own words, never a client's.

        *client* is the address and number of the client that it is about, for the log only. Values
        that are ``None`` are left out. Texts are truncated.
        """
        now_ns = self._clock_ns()
        window = self._windows.get(event)
        # also after the clock was set back
        if window is None or not 0 <= now_ns - window.began_ns < WINDOW_NS:
            left_out = 0 if window is None else window.left_out
            window = self._windows[event] = _Window(now_ns)
            if left_out:
                values = {**values, "left_out_before": left_out}
        if window.lines >= MAX_LINES:
            window.left_out += 1
            return
        window.lines += 1
        self._emit(now_ns, event, client, values)

    def _emit(
        self, now_ns: int, event: str, client: str | None, values: dict[str, AuditValue]
    ) -> None:
        time = datetime.fromtimestamp(now_ns / 1e9, timezone.utc).isoformat(timespec="milliseconds")
        entry: dict[str, AuditValue] = {"time": time, "event": event}
        entry |= {name: _shown(value) for name, value in values.items() if value is not None}
        line = json.dumps(entry)  # ASCII: no text can begin a new line
        # the lines are limited already, and other lines must not displace a stop
        extra = {"client": client, "topic": entry.get("topic"), "is_bounded": True, "audit": entry}
        logger.log(self._level, "%s", line, extra=extra)
        if self._write is not None:
            self._write(line)
        for write in self._following:
            write(line)


def _shown(value: AuditValue) -> AuditValue:
    return value[:MAX_VALUE_CHARACTERS] if isinstance(value, str) else value
