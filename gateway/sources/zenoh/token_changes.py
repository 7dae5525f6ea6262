# SPDX-License-Identifier: Apache-2.0
"""Tokens that come and go, from Zenoh's threads to the event loop. Their number is limited."""

import asyncio
import threading
from collections.abc import Callable
from itertools import islice
from typing import Any, Final

from gateway.sources.zenoh.inbox import LoopWaker
from gateway.sources.zenoh.keys import MAX_KEY_CHARACTERS

# A robot of 100 nodes has 2600. Each takes some kilobytes here.
MAX_TOKENS: Final = 32_768
# Zenoh keeps 2 KB of each, also of those that are left out here. Beyond, no more are followed.
MAX_LEFT_OUT: Final = 32_768
# The loop reads so many in one turn, which takes 3 ms.
TOKENS_PER_TURN: Final = 128

# Begins to report tokens, as `gateway.sources.zenoh.session.ZenohSession.watch_tokens` does.
Watch = Callable[[Callable[[str, bool], None]], Any]


class TokenChanges:
    """Collects changes, and calls *on_change* on the loop with a part of them after the other."""

    def __init__(
        self, loop: asyncio.AbstractEventLoop, on_change: Callable[[dict[str, bool]], None]
    ) -> None:
        self._lock = threading.Lock()
        self._on_change = on_change
        self._known: set[str] = set()  # by the loop, or on the way to it
        self._waiting: dict[str, bool] = {}  # whether each is there now
        self.left_out = 0  # tokens beyond the limit
        self._watch: Watch | None = None
        self._tokens: Any = None
        self._waker = LoopWaker(loop, self._deliver)

    def watch(self, watch: Watch) -> None:
        """Collect what *watch* reports, first all that there is."""
        self._watch = watch
        before, self._tokens = self._tokens, watch(self.put)
        if before is not None:
            before.undeclare()

    def put(self, token: str, is_there: bool) -> None:  # as Zenoh's thread has it
        """Note a change, on any thread."""
        token = token[: MAX_KEY_CHARACTERS + 1]  # the graph refuses one that is too long
        with self._lock:
            is_known = token in self._known
            if is_there and not is_known and len(self._known) >= MAX_TOKENS:
                self.left_out += 1
                if self.left_out > MAX_LEFT_OUT:
                    self._waker.wake()
                return
            if is_there or is_known:
                self._known.add(token)
                self._waiting[token] = is_there
            else:
                self.left_out = max(self.left_out - 1, 0)
        self._waker.wake()

    @property
    def has_stopped(self) -> bool:
        """True once there have been so many that no change is followed any more."""
        return self._watch is not None and self._tokens is None

    def close(self) -> None:
        """Report no more."""
        self._waker.close()

    def _deliver(self) -> None:
        with self._lock:
            taken = list(islice(self._waiting, TOKENS_PER_TURN))
            changes = {token: self._waiting.pop(token) for token in taken}
            self._known -= {token for token, is_there in changes.items() if not is_there}
            room = MAX_TOKENS - len(self._known)
            # half is enough: a token that is declared again and again counts as many
            has_room = self.left_out > 0 and room >= min(self.left_out, MAX_TOKENS // 2)
            if has_room:
                self.left_out = 0
        if self._tokens is not None and self._watch is not None:
            if has_room:
                self.watch(self._watch)  # it reports those that were left out
            elif self.left_out > MAX_LEFT_OUT:
                self._tokens.undeclare()
                self._tokens = None
        try:
            if changes:
                self._on_change(changes)
        finally:
            if self._waiting:
                self._waker.wake()
