# SPDX-License-Identifier: Apache-2.0
"""The metric families: their names, and where their values are in a `State`.

Labels have few values: topics and clients that are there, and closed sets of words. Names are
part of what users rely on; docs/reference/observability.md lists them all.
"""

from collections.abc import Callable, Iterable, Iterator
from typing import Final, Literal, NamedTuple

from gateway.metrics.histogram import Observed
from gateway.metrics.state import ClientState, ClientTopic, Delivery, State, Summary, TopicState

PREFIX: Final = "ros2_gateway_"

Rows = Iterable[tuple[tuple[str, ...], float]]
TimeRows = Iterable[tuple[tuple[str, ...], Observed]]


class Family(NamedTuple):
    """Values of one kind; a counter's samples are named with ``_total``."""

    name: str
    kind: Literal["counter", "gauge"]
    text: str
    rows: Callable[[State], Rows]
    labels: tuple[str, ...] = ()


class TimeFamily(NamedTuple):
    """A histogram of times."""

    name: str
    text: str
    rows: Callable[[State], TimeRows]
    labels: tuple[str, ...] = ()


def _one(value: Callable[[Summary], float]) -> Callable[[State], Rows]:
    return lambda state: [((), value(state.summary))]


def _of_clients(value: Callable[[ClientState], float]) -> Callable[[State], Rows]:
    return lambda state: (((each.client,), value(each)) for each in state.summary.clients)


def _of_clients_known(value: Callable[[ClientState], float | None]) -> Callable[[State], Rows]:
    def rows(state: State) -> Iterator[tuple[tuple[str, ...], float]]:
        for each in state.summary.clients:
            if (known := value(each)) is not None:
                yield (each.client,), known

    return rows


def _of_topics(value: Callable[[TopicState], float]) -> Callable[[State], Rows]:
    return lambda state: (((each.topic,), value(each)) for each in state.traffic.topics)


def _of_deliveries(value: Callable[[Delivery], float]) -> Callable[[State], Rows]:
    def rows(state: State) -> Iterator[tuple[tuple[str, ...], float]]:
        each: ClientTopic
        for each in state.traffic.client_topics:
            yield (each.client, each.topic), value(each.delivery)

    return rows


def _deliveries(
    name: str,
    kind: Literal["counter", "gauge"],
    text: str,
    value: Callable[[Delivery], float],
) -> tuple[Family, Family]:
    """Return the families of one count, per client and topic, and per topic."""
    return (
        Family(
            f"client_{name}", kind, f"{text}, of one client.", _of_deliveries(value), _CLIENT_TOPIC
        ),
        Family(
            f"topic_{name}",
            kind,
            f"{text}, of all clients.",
            _of_topics(lambda topic: value(topic.delivery)),
            _TOPIC,
        ),
    )


_CLIENT: Final = ("client",)
_TOPIC: Final = ("topic",)
_CLIENT_TOPIC: Final = ("client", "topic")

FAMILIES: Final[tuple[Family, ...]] = (
    Family(
        "info",
        "gauge",
        "The version of the gateway.",
        lambda state: [((state.summary.version,), 1)],
        ("version",),
    ),
    Family("uptime_seconds", "gauge", "Time since start.", _one(lambda state: state.uptime_s)),
    Family("clients", "gauge", "Open sessions.", _one(lambda state: len(state.clients))),
    Family(
        "clients_limit", "gauge", "As many as may be open.", _one(lambda state: state.max_clients)
    ),
    Family(
        "clients_unauthenticated",
        "gauge",
        "Clients that have yet to send their token.",
        _one(lambda state: state.unauthenticated),
    ),
    Family(
        "connections",
        "gauge",
        "Sockets, also those during the handshake or a page.",
        _one(lambda state: state.connections),
    ),
    Family("tasks", "gauge", "Tasks of the event loop.", _one(lambda state: state.tasks)),
    Family(
        "ros_entities",
        "gauge",
        "Open ROS entities of all kinds.",
        _one(lambda state: state.entities["ros_entities"]),
    ),
    Family(
        "ros_entities_limit",
        "gauge",
        "As many as may be open.",
        _one(lambda state: state.max_ros_entities),
    ),
    Family(
        "open",
        "gauge",
        "What clients have open, by kind.",
        lambda state: (
            ((kind,), count)
            for kind, count in state.summary.entities.items()
            if kind not in {"clients", "ros_entities"}
        ),
        ("kind",),
    ),
    Family("sessions", "counter", "Sessions opened.", _one(lambda state: state.sessions)),
    Family(
        "operations", "counter", "Messages of clients.", _one(lambda state: state.totals.operations)
    ),
    Family(
        "operations_refused",
        "counter",
        "Operations answered with an error.",
        _one(lambda state: state.totals.refused),
    ),
    Family(
        "operations_replaced",
        "counter",
        "Messages to publish that a newer one replaced, as the client was behind,"
        " or a picture was being decoded.",
        _one(lambda state: state.totals.replaced),
    ),
    Family(
        "frames_sent", "counter", "Frames sent to clients.", _one(lambda state: state.totals.frames)
    ),
    Family(
        "operations_seconds",
        "counter",
        "Time of the event loop for what clients sent.",
        _one(lambda state: state.time_s),
    ),
    Family(
        "reading_pauses",
        "counter",
        "Pauses in reading from clients whose time budget was spent.",
        _one(lambda state: state.pauses),
    ),
    Family(
        "event_loop_lag_max_seconds",
        "gauge",
        "Largest lag of the event loop within the last ten seconds.",
        _one(lambda state: state.max_lag_s),
    ),
    Family(
        "handshakes_refused",
        "counter",
        "Requests that did not become a client.",
        lambda state: (((each,), n) for each, n in state.summary.handshakes_refused.items()),
        ("reason",),
    ),
    Family(
        "authentication_failures",
        "counter",
        "Tokens that were wrong, or did not come in time.",
        lambda state: (((each,), n) for each, n in state.summary.authentication_failures.items()),
        ("reason",),
    ),
    Family(
        "connections_ended",
        "counter",
        "Ends of connections, by who ended them, why, and the code.",
        lambda state: state.summary.ends.items(),
        ("by", "reason", "code"),
    ),
    Family(
        "client_operations",
        "counter",
        "Messages of a client.",
        _of_clients(lambda client: client.counts.operations),
        _CLIENT,
    ),
    Family(
        "client_operations_refused",
        "counter",
        "Operations of a client answered with an error.",
        _of_clients(lambda client: client.counts.refused),
        _CLIENT,
    ),
    Family(
        "client_frames_sent",
        "counter",
        "Frames sent to a client, answers included.",
        _of_clients(lambda client: client.counts.frames),
        _CLIENT,
    ),
    Family(
        "client_link_bytes_per_second",
        "gauge",
        "Rate of the link to a client, once it was too slow for what the client gets.",
        _of_clients_known(lambda client: client.link_bytes_per_s),
        _CLIENT,
    ),
    Family(
        "client_round_trip_seconds",
        "gauge",
        "Time from the newest WebSocket ping that a client has answered to its answer.",
        _of_clients_known(lambda client: client.round_trip_s),
        _CLIENT,
    ),
    Family(
        "client_operations_seconds",
        "counter",
        "Time of the event loop for what a client sent.",
        _of_clients(lambda client: client.time_s),
        _CLIENT,
    ),
    Family(
        "client_reading_pauses",
        "counter",
        "Pauses in reading from a client.",
        _of_clients(lambda client: client.pauses),
        _CLIENT,
    ),
    Family(
        "address_operations_seconds",
        "counter",
        "Time of the event loop for all clients of an address.",
        lambda state: (((each.address,), each.time_s) for each in state.summary.addresses),
        ("address",),
    ),
    Family(
        "address_reading_pauses",
        "counter",
        "Pauses in reading from the clients of an address.",
        lambda state: (((each.address,), each.pauses) for each in state.summary.addresses),
        ("address",),
    ),
    Family(
        "topic_received",
        "counter",
        "Samples from ROS.",
        _of_topics(lambda topic: topic.received),
        _TOPIC,
    ),
    Family(
        "topic_received_bytes",
        "counter",
        "Bytes of samples from ROS, in CDR.",
        _of_topics(lambda topic: topic.received_bytes),
        _TOPIC,
    ),
    Family(
        "topic_lost",
        "counter",
        "Samples that were published and never came.",
        _of_topics(lambda topic: topic.lost),
        _TOPIC,
    ),
    Family(
        "topic_clients",
        "gauge",
        "Clients that subscribe.",
        _of_topics(lambda topic: topic.clients),
        _TOPIC,
    ),
    Family(
        "topic_published",
        "counter",
        "Messages that clients published.",
        _of_topics(lambda topic: topic.published),
        _TOPIC,
    ),
    Family(
        "topic_published_bytes",
        "counter",
        "Bytes that clients published, in CDR.",
        _of_topics(lambda topic: topic.published_bytes),
        _TOPIC,
    ),
    Family(
        "client_published",
        "counter",
        "Messages that a client published.",
        lambda state: (
            ((each.client, each.topic), each.messages) for each in state.traffic.publications
        ),
        _CLIENT_TOPIC,
    ),
    Family(
        "client_published_bytes",
        "counter",
        "Bytes that a client published, in CDR.",
        lambda state: (
            ((each.client, each.topic), each.size) for each in state.traffic.publications
        ),
        _CLIENT_TOPIC,
    ),
    *_deliveries(
        "messages_received", "counter", "Samples offered to subscriptions", lambda d: d.offered
    ),
    *_deliveries("messages_sent", "counter", "Samples written to sockets", lambda d: d.sent),
    *_deliveries(
        "messages_sent_bytes",
        "counter",
        "Bytes of frames written to sockets",
        lambda d: d.sent_bytes,
    ),
    *_deliveries(
        "messages_coalesced",
        "counter",
        "Samples that a throttle replaced by newer ones",
        lambda d: d.coalesced,
    ),
    *_deliveries(
        "messages_dropped",
        "counter",
        "Samples that a full queue, an error or the end of the subscription discarded",
        lambda d: d.dropped,
    ),
    *_deliveries(
        "messages_pending",
        "gauge",
        "Samples that wait in queues and throttles",
        lambda d: d.pending,
    ),
    Family(
        "guard_up",
        "gauge",
        "1 while the guard process is ready.",
        _one(lambda state: state.control.guard_is_ready),
    ),
    Family(
        "guard_losses",
        "counter",
        "How often a guard process was lost.",
        _one(lambda state: state.control.guard_losses),
    ),
    Family(
        "drive_moving",
        "gauge",
        "1 while commands move the robot, or a stop is being sent.",
        lambda state: (
            ((each.topic,), each.motion != "stopped") for each in state.summary.control.drives
        ),
        _TOPIC,
    ),
    Family(
        "drive_tripped",
        "gauge",
        "1 while commands to move are refused until one of zero comes.",
        lambda state: (((each.topic,), each.is_tripped) for each in state.summary.control.drives),
        _TOPIC,
    ),
    Family(
        "drive_held",
        "gauge",
        "1 while a client has the lease.",
        lambda state: (((each.topic,), each.is_leased) for each in state.summary.control.drives),
        _TOPIC,
    ),
    Family(
        "drive_guarded",
        "gauge",
        "1 while the guard process is ready for this topic.",
        lambda state: (((each.topic,), each.is_guarded) for each in state.summary.control.drives),
        _TOPIC,
    ),
    Family(
        "drive_stops",
        "counter",
        "Stops, by their cause.",
        lambda state: (
            ((each.topic, cause), count)
            for each in state.summary.control.drives
            for cause, count in each.stops.items()
        ),
        ("topic", "cause"),
    ),
)

TIME_FAMILIES: Final[tuple[TimeFamily, ...]] = (
    TimeFamily(
        "event_loop_lag_seconds",
        "How late the event loop wakes up, four times a second.",
        lambda state: [((), state.summary.lag)],
    ),
    TimeFamily(
        "topic_latency_seconds",
        "From a sample's arrival from DDS until a frame of it was handed to a socket, of some.",
        lambda state: (((each.topic,), each.latency) for each in state.traffic.topics),
        _TOPIC,
    ),
    TimeFamily(
        "client_latency_seconds",
        "The same, of all topics of one client.",
        lambda state: (((each.client,), each.latency) for each in state.summary.clients),
        _CLIENT,
    ),
)
