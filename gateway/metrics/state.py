# SPDX-License-Identifier: Apache-2.0
"""The gateway at one moment, as data: the source of /metrics and /diagnostics."""

from collections.abc import Callable, Mapping
from operator import add
from typing import NamedTuple

from gateway.metrics.histogram import Observed


class Delivery(NamedTuple):
    """The samples that were offered to clients, and what has become of them.

    ``offered == sent + coalesced + dropped + pending`` at every moment.
    """

    offered: int = 0
    sent: int = 0
    sent_bytes: int = 0
    coalesced: int = 0  # a throttle let a newer one pass in their place
    dropped: int = 0  # a full queue, no encoding, or the end of the subscription
    pending: int = 0  # in a queue, or held by a throttle

    def plus(self, other: "Delivery") -> "Delivery":
        """Return the counts of both."""
        return Delivery(*map(add, self, other))


class ClientTopic(NamedTuple):
    """The samples of one topic for one client, by all its subscriptions to it."""

    client: str
    topic: str
    delivery: Delivery


class ClientPublication(NamedTuple):
    """The messages of one client on one topic."""

    client: str
    topic: str
    messages: int
    size: int  # bytes of CDR


class TopicState(NamedTuple):
    """One topic, for all clients, also those that have left."""

    topic: str
    received: int  # from ROS
    received_bytes: int
    lost: int  # on the way from ROS
    clients: int  # that subscribe to it
    delivery: Delivery
    published: int  # by clients
    published_bytes: int
    latency: Observed


class DriveState(NamedTuple):
    """One command topic."""

    topic: str
    motion: str
    is_tripped: bool
    cause: str | None  # of the last stop, in words
    is_leased: bool  # a client has the lease
    listeners: int  # subscriptions of other nodes
    is_guarded: bool
    stops: Mapping[str, int]  # by cause
    clock_offset_ms: float | None = None  # of the client that drives, to the gateway's clock

    @property
    def is_moving(self) -> bool:
        """True while commands move the robot, or a stop is being sent."""
        return self.motion != "stopped"


class Traffic(NamedTuple):
    """The samples and messages that pass between ROS and clients."""

    client_topics: tuple[ClientTopic, ...]
    publications: tuple[ClientPublication, ...]
    topics: tuple[TopicState, ...]


class ControlState(NamedTuple):
    """The command topics, and the guard that stops their robots."""

    drives: tuple[DriveState, ...]
    guard_is_ready: bool
    guard_losses: int


class Relayed(NamedTuple):
    """Messages about driving from another gateway, a relay or a robot, that were left out."""

    malformed: int = 0
    tokens_refused: int = 0
    dropped: int = 0


class ClientCounts(NamedTuple):
    """The counts of one client, or of several together."""

    operations: int = 0
    refused: int = 0
    replaced: int = 0
    frames: int = 0
    dropped_by_full_queue: int = 0  # not all that `Delivery` counts
    coalesced: int = 0

    def plus(self, other: "ClientCounts") -> "ClientCounts":
        """Return the counts of both."""
        return ClientCounts(*map(add, self, other))


class ClientState(NamedTuple):
    """One client, authenticated or not."""

    client: str
    address: str
    counts: ClientCounts
    time_s: float  # of the event loop, for what it has sent
    pauses: int
    latency: Observed
    link_bytes_per_s: float | None  # None: it was never too slow for what goes there
    round_trip_s: float | None  # None: it has answered no ping


class AddressState(NamedTuple):
    """The time budget of an address that has connections."""

    address: str
    time_s: float
    pauses: int


class Summary(NamedTuple):
    """All but the traffic of topics: it is quick to make, also with many of them."""

    version: str
    uptime_s: float
    clients: tuple[ClientState, ...]
    addresses: tuple[AddressState, ...]
    totals: ClientCounts  # of all clients there were
    time_s: float  # of the event loop, for what clients have sent
    pauses: int
    sessions: int  # that were ever opened
    connections: int
    unauthenticated: int
    max_clients: int
    tasks: int
    entities: Mapping[str, int]  # that are open, by kind
    max_ros_entities: int
    control: ControlState
    shared_names: tuple[str, ...]  # of nodes in the ROS graph
    handshakes_refused: Mapping[str, int]  # by reason
    authentication_failures: Mapping[str, int]  # by reason
    ends: Mapping[tuple[str, str, str], int]  # of connections, by who ended it, reason and code
    lag: Observed
    max_lag_s: float  # of the last seconds
    relayed: Relayed = Relayed()

    @property
    def client_count(self) -> int:
        """The clients, authenticated or not."""
        return len(self.clients)

    @property
    def ros_entities(self) -> int:
        """The ROS entities of all kinds."""
        return self.entities["ros_entities"]


class State(NamedTuple):
    """All of it, at one moment."""

    summary: Summary
    traffic: Traffic


def seen_by(state: State, sees: Callable[[str], bool]) -> State:
    """Return a state without the topics that *sees* denies: they do not exist for who asks."""
    summary, traffic = state
    control = summary.control
    return State(
        summary._replace(
            control=control._replace(drives=tuple(d for d in control.drives if sees(d.topic)))
        ),
        Traffic(
            tuple(each for each in traffic.client_topics if sees(each.topic)),
            tuple(each for each in traffic.publications if sees(each.topic)),
            tuple(each for each in traffic.topics if sees(each.topic)),
        ),
    )
