# SPDX-License-Identifier: Apache-2.0
"""The clients of a command topic: those that drive, and those that hear of its state."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final

from gateway.core.advertisement_ids import AdvertisementIds
from gateway.core.peer import ClientTurns
from gateway.core.requests import Publish
from gateway.core.session import Session
from gateway.drive.freshness import Age, Freshness

# A refused stream is answered once per period: a client with a joystick sends 120 a second.
REPEAT_NS: Final = 1_000_000_000
# Between two `control` frames: a client that toggles must not fill the others' queues.
NOTICE_S: Final = 0.05


@dataclass(slots=True)
class Driver:
    """One client that has the topic open."""

    ids: AdvertisementIds = field(default_factory=AdvertisementIds)
    commands: int = 0  # all that came, also the refused ones
    _freshness: Freshness = field(default_factory=Freshness)
    _answered_ns: dict[str, int] = field(default_factory=dict)  # by the code of the answer

    def judge(self, request: Publish, now_ns: int, waited_ns: int, turns: ClientTurns) -> Age:
        """Count a command, and return its age. See `Freshness.judge`."""
        self.commands += 1
        age = self._freshness.judge(
            request.monotonic_ms, now_ns, waited_ns, is_behind=turns.is_behind
        )
        return "delayed" if turns.is_delayed else age

    def is_due(self, code: str, now_ns: int) -> bool:
        """Note an answer with this code. Return whether it is due, `REPEAT_NS` after the last."""
        last_ns = self._answered_ns.get(code)
        if last_ns is not None and now_ns - last_ns < REPEAT_NS:
            return False
        self._answered_ns[code] = now_ns
        return True


class Watchers:
    """The clients that get the state when it has changed, at a limited rate."""

    def __init__(self, send: Callable[[Session], None]) -> None:
        self._send = send
        self._clients: set[Session] = set()
        self._timer: asyncio.TimerHandle | None = None

    def __contains__(self, session: Session) -> bool:
        """Return whether a client watches."""
        return session in self._clients

    def __len__(self) -> int:
        """Count them."""
        return len(self._clients)

    def add(self, session: Session) -> None:
        """Send the changes to a client from now on."""
        self._clients.add(session)

    def discard(self, session: Session) -> None:
        """Send a client no changes any more."""
        self._clients.discard(session)

    def notify(self) -> None:
        """Send the state soon, because it has changed."""
        if self._clients and self._timer is None:
            self._timer = asyncio.get_running_loop().call_later(NOTICE_S, self._send_all)

    def close(self) -> None:
        """Send nothing any more."""
        self._clients.clear()
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _send_all(self) -> None:
        self._timer = None
        for session in list(self._clients):
            self._send(session)
