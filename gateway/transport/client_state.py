# SPDX-License-Identifier: Apache-2.0
"""The state of one client, for `/healthz` and `/metrics`."""

from gateway.core.session import Session
from gateway.metrics.state import ClientCounts, ClientState
from gateway.transport.time_budget import Spending


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
