# SPDX-License-Identifier: Apache-2.0
"""What is closed but kept until what it wrote last has been heard.

DDS tells of an entity's end and of what it has written by different ways, and a reader drops what
comes from a writer that has ended: of messages and responses that were written just before, one in
fifteen was lost on one machine, of those written 10 ms before none.
"""

import asyncio
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

LAST_WORDS_S: Final = 0.5  # a lost packet is sent again well within
FAREWELL_S: Final = 0.05  # when all ends: the loop waits for it
MAX_KEPT: Final = 64  # a client may open and close as fast as it likes


@dataclass(eq=False, slots=True)
class Kept:
    """One thing that is kept."""

    subject: str
    type_name: str
    destroy: Callable[[], None]
    timer: asyncio.TimerHandle | None = None


class LastWords:
    """Destroys what it is given a little later."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._kept: dict[Kept, None] = {}  # the oldest first

    def keep(self, subject: str, type_name: str, destroy: Callable[[], None]) -> Kept:
        """Call *destroy* in `LAST_WORDS_S`; *subject* is such as ``service /reset``."""
        kept = Kept(subject, type_name, destroy)
        kept.timer = self._loop.call_later(LAST_WORDS_S, self._end, kept)
        self._kept[kept] = None
        if len(self._kept) > MAX_KEPT:
            self._end(next(iter(self._kept)))
        return kept

    def revive(self, kept: Kept) -> None:
        """Destroy nothing: it is in use again."""
        if kept.timer is not None:
            kept.timer.cancel()
        del self._kept[kept]

    def keeps(self, subject: str) -> bool:
        """Whether something is kept of a subject."""
        return any(kept.subject == subject for kept in self._kept)

    def end(self, subject: str, *, but: str | None = None) -> None:
        """Destroy at once what is kept of a subject, unless its type is *but*."""
        for kept in list(self._kept):
            if kept.subject == subject and kept.type_name != but:
                self._end(kept)

    def close(self) -> None:
        """Destroy all that is left, once it has been heard."""
        if self._kept:
            time.sleep(FAREWELL_S)
        while self._kept:
            self._end(next(iter(self._kept)))

    def _end(self, kept: Kept) -> None:
        self.revive(kept)
        kept.destroy()
