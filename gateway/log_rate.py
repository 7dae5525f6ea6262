# SPDX-License-Identifier: Apache-2.0
"""A limit on the log lines that clients can cause.

A flood of connections or refused operations must not fill a disk, or hide lines of another kind.
One address cannot hide the lines of another. If ten addresses flood at once, lines of one kind
share one line per second.
"""

import logging
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any, Final

# Of one address and kind: a classroom of headsets connects without a line being left out.
BURST: Final = 32
EVERY_S: Final = 10.0  # then one line every so often
# Of one kind, whatever the addresses are: an attacker may have many.
ALL_BURST: Final = 128
ALL_EVERY_S: Final = 1.0
MAX_BUCKETS: Final = 1024  # 0.5 MB in all. Further addresses share the limit of their kind
MAX_KEPT_CHARACTERS: Final = 500  # of a line that is left out, until its number is reported


class _Bucket:
    """The number of lines that may be written now. It grows by one every *every_s*."""

    def __init__(self, burst: int, every_s: float, now_s: float) -> None:
        self._burst = burst
        self._every_s = every_s
        self._tokens = float(burst)
        self._last_s = now_s
        self.left_out = 0
        # the first line that was left out, which is written later: its name, level, text and fields
        self.kept: tuple[str, int, str, dict[str, Any]] | None = None

    def _fill(self, now_s: float) -> float:
        earned = (now_s - self._last_s) / self._every_s
        self._last_s = now_s
        self._tokens = min(self._burst, self._tokens + earned)
        return self._tokens

    def has_one(self, now_s: float) -> bool:
        return self._fill(now_s) >= 1

    def is_full(self, now_s: float) -> bool:
        return self._fill(now_s) >= self._burst

    def take(self) -> None:
        """Write one line."""
        self._tokens -= 1

    def take_left_out(self) -> int:
        """Forget the lines that were left out, and return their number."""
        left_out, self.left_out, self.kept = self.left_out, 0, None
        return left_out

    def leave_out(self, record: logging.LogRecord, fields: tuple[str, ...]) -> None:
        """Count a line, and keep the first one with these fields."""
        self.left_out += 1
        if self.kept is None:
            extra = {name: getattr(record, name) for name in fields if hasattr(record, name)}
            message = record.getMessage()[:MAX_KEPT_CHARACTERS]
            self.kept = (record.name, record.levelno, message, extra)

    def late(self) -> logging.LogRecord | None:
        """Take the line that was kept, and the number of the others, or ``None``."""
        if self.kept is None:
            return None
        name, level, message, extra = self.kept
        self.take()
        record = logging.LogRecord(name, level, "", 0, message, None, None)
        record.__dict__.update(extra, left_out=self.take_left_out() - 1)
        return record


class LogRate(logging.Filter):
    """Passes a limited number of the lines that have a client or a topic.

    A record that passes has `left_out`: the number of lines of its address (or topic) and kind that
    were held back since the last one. `overdue` reports the lines that the limit over all addresses
    held back, without a client or a topic. Lines without client and topic always pass. Lines with
    `is_bounded` also pass, because their writer limits them.
    """

    def __init__(self, clock_s: Callable[[], float] = time.monotonic) -> None:
        super().__init__()
        self._clock_s = clock_s
        self._lock = threading.Lock()
        self._kinds: dict[object, _Bucket] = {}  # as many as there are lines of code that log
        self._buckets: dict[object, _Bucket] = {}
        self._swept_s = clock_s()

    def filter(self, record: logging.LogRecord) -> bool:
        """Return whether a record may be written."""
        source = _source(record)
        if source is None:
            return True
        kind = (record.name, record.msg, getattr(record, "reason", None))
        with self._lock:
            now_s = self._clock_s()
            every = self._kinds.setdefault(kind, _Bucket(ALL_BURST, ALL_EVERY_S, now_s))
            own = self._own((source, kind), now_s)
            if own is not None and not own.has_one(now_s):
                own.leave_out(record, ("client", "topic", "reason"))
                return False
            if not every.has_one(now_s):
                every.leave_out(record, ("reason",))  # because the others had other clients
                return False
            every.take()
            left_out = 0
            if own is not None:
                own.take()
                left_out = own.take_left_out()
        record.left_out = left_out or None
        return True

    def overdue(self, *, all_of_them: bool = False) -> Iterator[logging.LogRecord]:
        """Yield a record for each limit that held lines back, at most every `EVERY_S`.

        An address gets its record once it may write again, so the number becomes known after a
        flood. A kind gets one during the flood, because nothing else has its number.
        *all_of_them* yields all records, for the end of the log.
        """
        with self._lock:
            now_s = self._clock_s()
            if now_s - self._swept_s < EVERY_S and not all_of_them:
                return
            self._swept_s = now_s
            own = [each for each in self._buckets.values() if all_of_them or each.has_one(now_s)]
            late = [each.late() for each in (*own, *self._kinds.values())]
            self._forget(now_s)
        yield from (record for record in late if record is not None)

    def _own(self, key: object, now_s: float) -> _Bucket | None:
        bucket = self._buckets.get(key)
        if bucket is None:
            if len(self._buckets) >= MAX_BUCKETS:
                return None
            bucket = self._buckets[key] = _Bucket(BURST, EVERY_S, now_s)
        return bucket

    def _forget(self, now_s: float) -> None:
        """Forget the buckets that a new one would equal."""
        for key, bucket in list(self._buckets.items()):
            if bucket.is_full(now_s):
                del self._buckets[key]


def _source(record: logging.LogRecord) -> str | None:
    """Return the address or the topic behind a record, or ``None`` if a client did not cause it."""
    if getattr(record, "is_bounded", False):
        return None
    client: str | None = getattr(record, "client", None)
    if client is not None:
        return client.partition("#")[0]
    return getattr(record, "topic", None)
