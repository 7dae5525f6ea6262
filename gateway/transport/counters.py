# SPDX-License-Identifier: Apache-2.0
"""The server's counts: sessions, ends of connections, refused handshakes, the loop's lag."""

from collections import Counter, deque
from typing import Final

from gateway.core.session import Session
from gateway.metrics.histogram import Histogram
from gateway.metrics.state import ClientCounts, ClientState
from gateway.transport.end import ConnectionEnd
from gateway.transport.time_budget import Spending

RECENT: Final = 40  # lags, ten seconds of them: /diagnostics is read by people

# of RFC 6455. Clients can use any number from 1000 to 4999, so the others count together
_CODES: Final = frozenset({*range(1000, 1004), *range(1005, 1016)})
# of responses that begin no WebSocket, by the rule that refuses them
_REFUSALS: Final = {
    400: "malformed",
    401: "token",
    403: "origin",
    404: "path",
    405: "method",
    421: "host",
    426: "upgrade",
    431: "headers",
    500: "internal_error",
    503: "busy",
    504: "no_picture",
}


class ServerCounters:
    """The counts. Clients cannot add labels."""

    def __init__(self) -> None:
        self.sessions = 0
        self.ends: Counter[tuple[str, str, str]] = Counter()  # by whom, reason, code
        self.handshakes_refused: Counter[str] = Counter()
        self.lag = Histogram()
        self._recent_s: deque[float] = deque(maxlen=RECENT)

    @property
    def max_lag_s(self) -> float:
        """The largest lag of the last ten seconds."""
        return max(self._recent_s, default=0.0)

    def began(self) -> None:
        """Count a session."""
        self.sessions += 1

    def late(self, late_s: float) -> None:
        """Count how late the loop was."""
        self.lag.observe(late_s)
        self._recent_s.append(late_s)

    def ended(self, end: ConnectionEnd, *, was_client: bool) -> None:
        """Count the end of a connection."""
        cause = end.cause
        code = cause.code
        if cause.by == "client" and code is not None and code not in _CODES:
            shown = "other"
        else:
            shown = "" if code is None else str(code)
        self.ends[cause.by, cause.reason, shown] += 1
        if not was_client and cause.reason != "http":
            refusal = "none" if cause.by != "gateway" else _REFUSALS.get(code or 0, cause.reason)
            self.handshakes_refused[refusal] += 1


def client_state(session: Session, spending: Spending, round_trip_s: float | None) -> ClientState:
    """Return the state of a client that is connected."""
    return ClientState(
        client=session.client,
        address=session.address,
        counts=client_counts(session),
        time_s=spending.spent_s,
        pauses=spending.pauses,
        latency=session.latency.observed(),
        link_bytes_per_s=session.outbox.bytes_per_s,
        round_trip_s=round_trip_s,
    )


def client_counts(session: Session) -> ClientCounts:
    """Return the counts of a client."""
    return ClientCounts(
        operations=session.received,
        refused=session.refused,
        replaced=session.replaced,
        frames=session.outbox.sent,
        dropped_by_full_queue=session.outbox.dropped,
        coalesced=session.outbox.coalesced,
    )
