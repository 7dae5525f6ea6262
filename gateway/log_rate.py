# SPDX-License-Identifier: Apache-2.0
"""A bound on the lines of the log that somebody outside can cause.

No flood of connections or refused operations may fill a disk, nor hide lines of another kind. One
address can hide no line of another; ten that flood at once can: lines of one kind share one a
second then.
"""

import logging
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Final

# Of one address and kind: a classroom of headsets connects without a line being left out.
BURST: Final = 32
EVERY_S: Final = 10.0  # one line, after them
# Of one kind, whatever the addresses are: an attacker may have many.
ALL_BURST: Final = 128
ALL_EVERY_S: Final = 1.0
MAX_BUCKETS: Final = 1024  # 0.5 MB; further addresses share what their kind has
MAX_KEPT_CHARACTERS: Final = 500  # of a line that is left out, until its number is reported


@dataclass(frozen=True, slots=True)
class _Kept:
    """The first line that was left out: written in the end, with the number of the others."""

    name: str
    level: int
    message: str
    extra: dict[str, Any]

    def record(self, left_out: int) -> logging.LogRecord:
        record = logging.LogRecord(self.name, self.level, "", 0, self.message, None, None)
        record.__dict__.update(self.extra)
        record.left_out = left_out
        return record


class _Bucket:
    """As many lines as may be written now; one more every *every_s*."""

    def __init__(self, burst: int, every_s: float, now_s: float) -> None:
        self._burst = burst
        self._every_s = every_s
        self._tokens = float(burst)
        self._last_s = now_s
        self.left_out = 0
        self.kept: _Kept | None = None

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
        """Forget the lines that were left out; return how many they were."""
        left_out, self.left_out, self.kept = self.left_out, 0, None
        return left_out

    def leave_out(self, record: logging.LogRecord, fields: tuple[str, ...]) -> None:
        """Count a line; keep the first one, with these fields."""
        self.left_out += 1
        if self.kept is None:
            extra = {name: getattr(record, name) for name in fields if hasattr(record, name)}
            message = record.getMessage()[:MAX_KEPT_CHARACTERS]
            self.kept = _Kept(record.name, record.levelno, message, extra)

    def late(self) -> logging.LogRecord | None:
        """Take the line that was kept, with the number of the others; ``None`` if nothing was."""
        kept = self.kept
        if kept is None:
            return None
        self.take()
        return kept.record(self.take_left_out() - 1)


class LogRate(logging.Filter):
    """Lets a bounded number of the lines that have a client or a topic pass.

    A record that passes has `left_out`, the number of those of its address (or topic) and kind that
    its own bound held back since the last one that passed. Those that the bound over all addresses
    held back are nobody's: `overdue` reports them, without a client or a topic. Lines with neither
    client nor topic all pass, and so do those whose `is_bounded` says that their writer bounds
    them.
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
                every.leave_out(record, ("reason",))  # as the others had other clients
                return False
            every.take()
            left_out = 0
            if own is not None:
                own.take()
                left_out = own.take_left_out()
        record.left_out = left_out or None
        return True

    def overdue(self, *, all_of_them: bool = False) -> Iterator[logging.LogRecord]:
        """Yield a record for each bound that held lines back, each `EVERY_S` at most.

        Those of an address once it may write again: so their number becomes known after a flood,
        too. Those of a kind also while the flood goes on, as nothing else has their number. With
        *all_of_them*, at the end, whatever there is.
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
    """Return the address or the topic behind a record; ``None`` if nobody outside is."""
    if getattr(record, "is_bounded", False):
        return None
    client: str | None = getattr(record, "client", None)
    if client is not None:
        return client.partition("#")[0]
    return getattr(record, "topic", None)
