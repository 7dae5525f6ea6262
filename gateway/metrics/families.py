# SPDX-License-Identifier: Apache-2.0
"""The metric families: their names, and where their values are in a `State`.

Labels have few values: open topics and clients, and closed sets of words. Users rely on the names.
docs/reference/metrics.md lists them with their texts.
"""

from collections.abc import Callable, Iterable, Iterator
from typing import Final, Literal, NamedTuple

from gateway.metrics.histogram import Observed
from gateway.metrics.state import ClientState, ClientTopic, Delivery, State, Summary, TopicState

PREFIX: Final = "ros2_gateway_"

Rows = Iterable[tuple[tuple[str, ...], float]]
TimeRows = Iterable[tuple[tuple[str, ...], Observed]]


class Family(NamedTuple):
    """Values of one kind. In Prometheus' format the name of a counter ends with ``_total``."""

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


def _gauge(name: str, text: str, value: Callable[[Summary], float]) -> Family:
    return Family(name, "gauge", text, _one(value))


def _counter(name: str, text: str, value: Callable[[Summary], float]) -> Family:
    return Family(name, "counter", text, _one(value))


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
            f"client_{name}", kind, f"{text}, for one client.", _of_deliveries(value), _CLIENT_TOPIC
        ),
        Family(
            f"topic_{name}",
            kind,
            f"{text}, for all clients.",
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
        "Version of the gateway.",
        lambda state: [((state.summary.version,), 1)],
        ("version",),
    ),
    _gauge("uptime_seconds", "Time since the start.", lambda state: state.uptime_s),
    _gauge(
        "clients",
        "Connected clients, with or without a token yet.",
        lambda state: len(state.clients),
    ),
    _gauge("clients_limit", "Maximum number of clients.", lambda state: state.max_clients),
    _gauge(
        "clients_unauthenticated",
        "Clients that have not sent their token.",
        lambda state: state.unauthenticated,
    ),
    _gauge(
        "connections",
        "Open sockets, including handshakes and HTTP requests.",
        lambda state: state.connections,
    ),
    _gauge("tasks", "Tasks of the event loop.", lambda state: state.tasks),
    _gauge(
        "ros_entities",
        "Open ROS entities of all kinds.",
        lambda state: state.entities["ros_entities"],
    ),
    _gauge(
        "ros_entities_limit",
        "Maximum number of ROS entities.",
        lambda state: state.max_ros_entities,
    ),
    Family(
        "open",
        "gauge",
        "Open subscriptions, publishers, calls, goals, and others of clients, by kind.",
        lambda state: (
            ((kind,), count)
            for kind, count in state.summary.entities.items()
            if kind not in {"clients", "ros_entities"}
        ),
        ("kind",),
    ),
    _counter("sessions", "Clients that connected since the start.", lambda state: state.sessions),
    _counter("operations", "Operations that clients sent.", lambda state: state.totals.operations),
    _counter(
        "operations_refused",
        "Operations that were answered with an error.",
        lambda state: state.totals.refused,
    ),
    _counter(
        "operations_replaced",
        "Published messages that a newer one replaced before they reached ROS.",
        lambda state: state.totals.replaced,
    ),
    _counter("frames_sent", "Frames sent to clients.", lambda state: state.totals.frames),
    _counter(
        "operations_seconds",
        "Time of the event loop for operations of clients.",
        lambda state: state.time_s,
    ),
    _counter(
        "reading_pauses",
        "Pauses in reading from clients that used up their time share.",
        lambda state: state.pauses,
    ),
    _gauge(
        "event_loop_lag_max_seconds",
        "Largest lag of the event loop in the last 10 s.",
        lambda state: state.max_lag_s,
    ),
    Family(
        "handshakes_refused",
        "counter",
        "Connections that did not become a client, by reason.",
        lambda state: (((each,), n) for each, n in state.summary.handshakes_refused.items()),
        ("reason",),
    ),
    Family(
        "authentication_failures",
        "counter",
        "Tokens that were wrong or late, by reason.",
        lambda state: (((each,), n) for each, n in state.summary.authentication_failures.items()),
        ("reason",),
    ),
    Family(
        "connections_ended",
        "counter",
        "Ended connections, by who ended them, reason, and code.",
        lambda state: state.summary.ends.items(),
        ("by", "reason", "code"),
    ),
    Family(
        "client_operations",
        "counter",
        "Operations that the client sent.",
        _of_clients(lambda client: client.counts.operations),
        _CLIENT,
    ),
    Family(
        "client_operations_refused",
        "counter",
        "Operations of the client that were answered with an error.",
        _of_clients(lambda client: client.counts.refused),
        _CLIENT,
    ),
    Family(
        "client_frames_sent",
        "counter",
        "Frames sent to the client, including answers.",
        _of_clients(lambda client: client.counts.frames),
        _CLIENT,
    ),
    Family(
        "client_link_bytes_per_second",
        "gauge",
        "Speed of the connection. Measured only after it was too slow for the client's data.",
        _of_clients_known(lambda client: client.link_bytes_per_s),
        _CLIENT,
    ),
    Family(
        "client_round_trip_seconds",
        "gauge",
        "Round-trip time of the latest WebSocket ping that the client answered.",
        _of_clients_known(lambda client: client.round_trip_s),
        _CLIENT,
    ),
    Family(
        "client_operations_seconds",
        "counter",
        "Time of the event loop for operations of the client.",
        _of_clients(lambda client: client.time_s),
        _CLIENT,
    ),
    Family(
        "client_reading_pauses",
        "counter",
        "Pauses in reading from the client.",
        _of_clients(lambda client: client.pauses),
        _CLIENT,
    ),
    Family(
        "address_operations_seconds",
        "counter",
        "Time of the event loop for operations of all clients of the address.",
        lambda state: (((each.address,), each.time_s) for each in state.summary.addresses),
        ("address",),
    ),
    Family(
        "address_reading_pauses",
        "counter",
        "Pauses in reading from the clients of the address.",
        lambda state: (((each.address,), each.pauses) for each in state.summary.addresses),
        ("address",),
    ),
    Family(
        "topic_received",
        "counter",
        "Messages received from ROS.",
        _of_topics(lambda topic: topic.received),
        _TOPIC,
    ),
    Family(
        "topic_received_bytes",
        "counter",
        "Bytes received from ROS, as CDR.",
        _of_topics(lambda topic: topic.received_bytes),
        _TOPIC,
    ),
    Family(
        "topic_lost",
        "counter",
        "Messages that nodes published but the gateway did not get.",
        _of_topics(lambda topic: topic.lost),
        _TOPIC,
    ),
    Family(
        "topic_clients",
        "gauge",
        "Clients that subscribe to the topic.",
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
        "Bytes that clients published, as CDR.",
        _of_topics(lambda topic: topic.published_bytes),
        _TOPIC,
    ),
    Family(
        "client_published",
        "counter",
        "Messages that the client published.",
        lambda state: (
            ((each.client, each.topic), each.messages) for each in state.traffic.publications
        ),
        _CLIENT_TOPIC,
    ),
    Family(
        "client_published_bytes",
        "counter",
        "Bytes that the client published, as CDR.",
        lambda state: (
            ((each.client, each.topic), each.size) for each in state.traffic.publications
        ),
        _CLIENT_TOPIC,
    ),
    *_deliveries(
        "messages_received", "counter", "Messages offered to subscriptions", lambda d: d.offered
    ),
    *_deliveries("messages_sent", "counter", "Messages written to sockets", lambda d: d.sent),
    *_deliveries(
        "messages_sent_bytes",
        "counter",
        "Bytes of frames written to sockets",
        lambda d: d.sent_bytes,
    ),
    *_deliveries(
        "messages_coalesced",
        "counter",
        "Messages that a throttle replaced with newer ones",
        lambda d: d.coalesced,
    ),
    *_deliveries(
        "messages_dropped",
        "counter",
        "Messages dropped by a full queue, an error, or the end of a subscription",
        lambda d: d.dropped,
    ),
    *_deliveries(
        "messages_pending",
        "gauge",
        "Messages that wait in queues and throttles",
        lambda d: d.pending,
    ),
    _gauge(
        "guard_up",
        "1 while the guard process is ready.",
        lambda state: state.control.guard_is_ready,
    ),
    _counter(
        "guard_losses", "Losses of the guard process.", lambda state: state.control.guard_losses
    ),
    Family(
        "drive_moving",
        "gauge",
        "1 while commands move the robot or a stop is being sent.",
        lambda state: (
            ((each.topic,), each.motion != "stopped") for each in state.summary.control.drives
        ),
        _TOPIC,
    ),
    Family(
        "drive_tripped",
        "gauge",
        "1 during a safety stop, which ends with a zero command.",
        lambda state: (((each.topic,), each.is_tripped) for each in state.summary.control.drives),
        _TOPIC,
    ),
    Family(
        "drive_held",
        "gauge",
        "1 while a client has control.",
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
        "Stops, by cause.",
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
        "Lag of the event loop, measured four times a second.",
        lambda state: [((), state.summary.lag)],
    ),
    TimeFamily(
        "topic_latency_seconds",
        "Time from the arrival of a message to the write of its frame. Measured for some frames.",
        lambda state: (((each.topic,), each.latency) for each in state.traffic.topics),
        _TOPIC,
    ),
    TimeFamily(
        "client_latency_seconds",
        "Time from the arrival of a message to the write of its frame, for one client.",
        lambda state: (((each.client,), each.latency) for each in state.summary.clients),
        _CLIENT,
    ),
)
