# SPDX-License-Identifier: Apache-2.0
"""Everything that a soak has seen, for the verdicts."""

from dataclasses import dataclass, field
from typing import Any, Final

from tests.soak.accounting import Accounting
from tests.soak.driving import Fault
from tests.soak.machine import Machine
from tests.soak.silences import Gap
from tests.soak.vitals import Leftovers, Vitals

_WARM_UP: Final = 0.15  # of the load: caches fill, arenas of malloc grow to what is needed at once
_WARM_UP_S: Final = (20.0, 300.0)


@dataclass(frozen=True)
class Exit:
    """The end of the gateway, by SIGTERM while a robot moves."""

    code: int
    took_s: float
    waited_s: float
    """Of that: without a core, though ready to run."""
    at_s: float
    zero_s: float
    """Until the robot heard a zero."""
    files_left: tuple[str, ...]
    """Of the gateway and its guard, in /dev/shm."""
    tracebacks: int
    """In all of its log."""
    was_forced: bool = False
    """It has ended itself, as its end took too long."""


@dataclass
class Record:
    """One soak."""

    minutes: float
    begin_s: float
    """Of the load, by the monotonic clock."""
    end_s: float
    link: str
    """The bad link in words."""
    baseline: Leftovers
    final: Leftovers
    vitals: list[Vitals]
    machine: Machine
    accounting: Accounting
    clients: dict[str, dict[str, Any]]
    """The reports of the listeners, by their names."""
    bare: dict[str, Any]
    """The report of the bare subscriber."""
    away: list[Gap]
    """When the publishers were not there, or need not have been found again."""
    faults: list[Fault]
    exit: Exit
    counts: dict[str, int] = field(default_factory=dict)
    """How often each disturbance happened."""

    def waited_s(self, since_s: float, until_s: float) -> float:
        """Return for how long the gateway's threads had no core in about this time."""
        before = [one.waited_s for one in self.vitals if one.at_s <= since_s]
        after = [one.waited_s for one in self.vitals if one.at_s >= until_s]
        if not self.vitals:
            return 0.0
        first = before[-1] if before else self.vitals[0].waited_s
        last = after[0] if after else self.vitals[-1].waited_s
        return max(0.0, last - first)  # a thread that has ended takes its part with it

    @property
    def warm_s(self) -> float:
        """The time from which on growth is judged."""
        load_s = self.end_s - self.begin_s
        return self.begin_s + min(max(_WARM_UP * load_s, _WARM_UP_S[0]), _WARM_UP_S[1])


GOOD: Final = ("good 1", "good 2")
BAD_LINK: Final = "on a bad link"
FROZEN: Final = "frozen half of the time"
