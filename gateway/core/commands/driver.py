# SPDX-License-Identifier: Apache-2.0
"""A client of a command topic."""

from dataclasses import dataclass, field
from typing import Final

from gateway.core.advertisement_ids import AdvertisementIds
from gateway.core.requests import Publish
from gateway.drive.freshness import Age, Freshness

# A refused stream is answered once per period: a client with a joystick sends 120 a second.
REPEAT_NS: Final = 1_000_000_000


@dataclass(slots=True)
class Driver:
    """One client that has the topic open."""

    ids: AdvertisementIds = field(default_factory=AdvertisementIds)
    commands: int = 0  # all that came, also the refused ones
    _freshness: Freshness = field(default_factory=Freshness)
    _answered_ns: dict[str, int] = field(default_factory=dict)  # by the code of the answer

    def judge(self, request: Publish, now_ns: int, waited_ns: int, *, is_behind: bool) -> Age:
        """Count a command, and return its age. See `Freshness.judge`."""
        self.commands += 1
        return self._freshness.judge(request.monotonic_ms, now_ns, waited_ns, is_behind=is_behind)

    def is_due(self, code: str, now_ns: int) -> bool:
        """Note an answer with this code. Return whether it is due, `REPEAT_NS` after the last."""
        last_ns = self._answered_ns.get(code)
        if last_ns is not None and now_ns - last_ns < REPEAT_NS:
            return False
        self._answered_ns[code] = now_ns
        return True
