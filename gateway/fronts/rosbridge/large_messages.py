# SPDX-License-Identifier: Apache-2.0
"""Messages of clients that take long to read, and are carried out in their own turn."""

import time
import weakref
from collections.abc import Callable, Generator
from functools import partial
from typing import Final

from gateway.fronts.rosbridge.operations import ClientOperation
from gateway.fronts.rosbridge.session import Reading, RosbridgeSession

# To read 10 MB of text takes up to 16 ms, as 15 KB of CBOR do. To carry it out may take as long.
LARGE_MESSAGE_BYTES: Final = 8 * 1024
TURN_S: Final = 0.004  # of reading, then the others have theirs


class LargeMessages:
    """Reads one at a time, so that the memory that this takes is that of one.

    Later messages of the client are handled after it, as `RosbridgeSession.next_turn` promises.
    """

    def __init__(self, carry_out: Callable[[RosbridgeSession, ClientOperation], None]) -> None:
        self._carry_out = carry_out
        # the message of a client that is gone is freed
        self._reading: Callable[[], Reading | None] = _none

    def receive(self, session: RosbridgeSession, work: ClientOperation | Reading) -> None:
        """Read what is not read yet, and carry it out when others have had their turn."""
        if isinstance(work, Generator):
            self._read(session, work)
        else:
            session.turns.next_turn(partial(self._carry_out, session, work))

    def _read(self, session: RosbridgeSession, reading: Reading) -> None:
        if self._reading() is None:
            self._reading = weakref.ref(reading)
        if self._reading() is reading:
            end_s = time.monotonic() + TURN_S
            try:
                while time.monotonic() < end_s:
                    next(reading)
            except StopIteration as done:
                self._reading = _none  # a refusal may keep the reading alive, and so hold up others
                if done.value is not None:
                    self.receive(session, done.value)
                return
        session.turns.next_turn(partial(self._read, session, reading))


def _none() -> None:
    return None
