# SPDX-License-Identifier: Apache-2.0
"""States to begin with."""

from typing import Any

from gateway.metrics.histogram import NOTHING_OBSERVED
from gateway.metrics.state import (
    AddressState,
    ClientCounts,
    ClientPublication,
    ClientState,
    ClientTopic,
    ControlState,
    Delivery,
    DriveState,
    Relayed,
    State,
    Summary,
    TopicState,
    Traffic,
)

DRIVE = DriveState(
    topic="/cmd_vel",
    motion="stopped",
    is_tripped=False,
    cause=None,
    is_leased=False,
    listeners=1,
    is_guarded=True,
    stops={},
)


def client_state(client: str = "10.0.0.1#1", **counts: int) -> ClientState:
    """Return the state of a client with some counts changed."""
    changed = ClientCounts(operations=1, frames=5)._replace(**counts)
    return ClientState(client, "10.0.0.1", changed, 0.5, 2, NOTHING_OBSERVED, 50_000.0, 0.25)


def summary(**changed: Any) -> Summary:
    state = Summary(
        version="1.2.3",
        uptime_s=60.0,
        clients=(client_state(),),
        addresses=(AddressState("10.0.0.1", 0.5, 2),),
        totals=ClientCounts(operations=11, refused=1, frames=5),
        time_s=0.5,
        pauses=2,
        sessions=3,
        connections=1,
        unauthenticated=0,
        max_clients=32,
        tasks=4,
        entities={"clients": 1, "ros_entities": 2, "subscriptions": 1},
        max_ros_entities=512,
        control=ControlState((DRIVE,), guard_is_ready=True, guard_losses=0),
        shared_names=(),
        handshakes_refused={"origin": 2},
        authentication_failures={"wrong": 1},
        ends={("client", "closed", "1000"): 2},
        lag=NOTHING_OBSERVED,
        max_lag_s=0.001,
        relayed=Relayed(malformed=3, tokens_refused=4, dropped=5),
    )
    return state._replace(**changed)


def state(clients: int = 1, topics: int = 1) -> State:
    """Return a state in which each client subscribes to each topic."""
    delivery = Delivery(offered=10, sent=5, sent_bytes=50, coalesced=1, dropped=2, pending=2)
    labels = [f"10.0.0.{number}#{number}" for number in range(clients)]
    names = [f"/topic{number}" for number in range(topics)]
    return State(
        summary(clients=tuple(map(client_state, labels))),
        Traffic(
            tuple(ClientTopic(label, name, delivery) for label in labels for name in names),
            (ClientPublication(labels[0], "/cmd_vel", 7, 70),),
            tuple(
                TopicState(name, 10, 100, 0, clients, delivery, 0, 0, NOTHING_OBSERVED)
                for name in names
            ),
        ),
    )
