# SPDX-License-Identifier: Apache-2.0
"""The health of the gateway for supervisors: is it alive, is it ready?

An answer also proves that the event loop runs.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import orjson

from gateway.faults import Fault, Severity
from gateway.metrics.state import Summary

PATH: Final = "/healthz"
LIVE: Final = "/healthz/live"
READY: Final = "/healthz/ready"
PATHS: Final = frozenset({PATH, LIVE, READY})

_OK: Final = 200
_UNAVAILABLE: Final = 503
_WORST_FIRST: Final[tuple[Severity, ...]] = ("dead", "not ready", "degraded", "starting")

FindFaults = Callable[[], Iterable[Fault]]


def no_faults() -> Sequence[Fault]:
    """Find nothing wrong."""
    return ()


@dataclass(frozen=True, slots=True)
class Health:
    """The current faults, and the resulting status."""

    faults: tuple[Fault, ...] = ()

    @property
    def status(self) -> str:
        """The severity of the worst fault, or ``ok``."""
        found = {fault.severity for fault in self.faults}
        return next((each for each in _WORST_FIRST if each in found), "ok")

    @property
    def is_live(self) -> bool:
        """False if only a restart helps."""
        return self.status != "dead"

    @property
    def is_ready(self) -> bool:
        """True if clients are served, though perhaps not with everything."""
        return self.status in {"ok", "degraded", "starting"}

    def reasons(self) -> list[str]:
        """Return the faults in words, the worst first."""
        faults = sorted(self.faults, key=lambda fault: _WORST_FIRST.index(fault.severity))
        return [fault.text for fault in faults]

    def page(self, path: str, details: Callable[[], Mapping[str, Any]]) -> tuple[int, str]:
        """Return the HTTP status and the text of one of `PATHS`. *details* are for `PATH`."""
        is_good = self.is_live if path == LIVE else self.is_ready
        body: dict[str, Any] = {
            "status": self.status,
            "live": self.is_live,
            "ready": self.is_ready,
            "reasons": self.reasons(),
        }
        if path == PATH:
            body |= details()
        text = orjson.dumps(body, option=orjson.OPT_INDENT_2 | orjson.OPT_APPEND_NEWLINE)
        return _OK if is_good else _UNAVAILABLE, text.decode()


def counts_of(found: Summary) -> dict[str, Any]:
    """Return the counts of /healthz."""
    totals = found.totals
    return {
        "version": found.version,
        "uptime_s": round(found.uptime_s, 1),
        **found.entities,
        "tasks": found.tasks,
        "operations_time_s": round(found.time_s, 3),
        "reading_pauses": found.pauses,
        "messages_in": totals.operations,
        "refused": totals.refused,
        "frames_out": totals.frames,
        "dropped": totals.dropped_by_full_queue,
        "coalesced": totals.coalesced,
        "replaced": totals.replaced,
        **{f"relayed_{name}": count for name, count in found.relayed._asdict().items()},
    }
