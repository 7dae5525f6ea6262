# SPDX-License-Identifier: Apache-2.0
"""The metric families: their names, and where their values are in a `State`.

Labels have few values: open topics and clients, and closed sets of words. Users rely on the names.
docs/reference/metrics.md lists them with their texts.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from operator import attrgetter
from typing import Any, Final, Literal, NamedTuple

from gateway.metrics.histogram import Observed
from gateway.metrics.state import State, Summary

PREFIX: Final = "ros2_gateway_"

Kind = Literal["counter", "gauge", "histogram"]
Rows = Iterable[tuple[tuple[str, ...], float | Observed]]


class Family(NamedTuple):
    """Values of one kind. In Prometheus' format the name of a counter ends with ``_total``."""

    name: str
    kind: Kind
    text: str
    rows: Callable[[State], Rows]
    labels: tuple[str, ...] = ()


# Each line of a table has the name of a family, the place of its value, and its text.

_GATEWAY: Final = """
uptime_seconds              uptime_s            Time since the start.
clients                     client_count        Connected clients, with or without a token yet.
clients_limit               max_clients         Maximum number of clients.
clients_unauthenticated     unauthenticated     Clients that have not sent their token.
connections                 connections         \
Open sockets, including handshakes and HTTP requests.
tasks                       tasks               Tasks of the event loop.
ros_entities                ros_entities        Open ROS entities of all kinds.
ros_entities_limit          max_ros_entities    Maximum number of ROS entities.
sessions_total              sessions            Clients that connected since the start.
operations_total            totals.operations   Operations that clients sent.
operations_refused_total    totals.refused      Operations that were answered with an error.
operations_replaced_total   totals.replaced     \
Published messages that a newer one replaced before they reached ROS.
frames_sent_total           totals.frames       Frames sent to clients.
operations_seconds_total    time_s              Time of the event loop for operations of clients.
reading_pauses_total        pauses              \
Pauses in reading from clients that used up their time share.
event_loop_lag_max_seconds  max_lag_s           Largest lag of the event loop in the last 10 s.
event_loop_lag_seconds      lag                 \
Lag of the event loop, measured four times a second.
guard_up                    control.guard_is_ready  1 while the guard process is ready.
guard_losses_total          control.guard_losses    Losses of the guard process.
relayed_malformed_total     relayed.malformed       \
Messages about driving between a relay and a robot that could not be read.
relayed_tokens_refused_total  relayed.tokens_refused  \
Clients of relays that came when there were too many to remember.
relayed_dropped_total       relayed.dropped         \
Messages about driving from relays that found no room.
"""
_CLIENTS: Final = """
client_operations_total           counts.operations  Operations that the client sent.
client_operations_refused_total   counts.refused     \
Operations of the client that were answered with an error.
client_frames_sent_total          counts.frames      Frames sent to the client, including answers.
client_link_bytes_per_second      link_bytes_per_s   \
Speed of the connection. Measured only after it was too slow for the client's data.
client_round_trip_seconds         round_trip_s       \
Round-trip time of the latest WebSocket ping that the client answered.
client_operations_seconds_total   time_s   Time of the event loop for operations of the client.
client_reading_pauses_total       pauses   Pauses in reading from the client.
client_latency_seconds            latency  \
Time from the arrival of a message to the write of its frame, for one client.
"""
_ADDRESSES: Final = """
address_operations_seconds_total  time_s   \
Time of the event loop for operations of all clients of the address.
address_reading_pauses_total      pauses   Pauses in reading from the clients of the address.
"""
_TOPICS: Final = """
topic_received_total         received         Messages received from ROS.
topic_received_bytes_total   received_bytes   Bytes received from ROS, as CDR.
topic_lost_total             lost             \
Messages that nodes published but the gateway did not get.
topic_clients                clients          Clients that subscribe to the topic.
topic_published_total        published        Messages that clients published.
topic_published_bytes_total  published_bytes  Bytes that clients published, as CDR.
topic_latency_seconds        latency          \
Time from the arrival of a message to the write of its frame. Measured for some frames.
"""
_PUBLICATIONS: Final = """
client_published_total        messages  Messages that the client published.
client_published_bytes_total  size      Bytes that the client published, as CDR.
"""
_DELIVERIES: Final = """
messages_received_total    delivery.offered     Messages offered to subscriptions
messages_sent_total        delivery.sent        Messages written to sockets
messages_sent_bytes_total  delivery.sent_bytes  Bytes of frames written to sockets
messages_coalesced_total   delivery.coalesced   Messages that a throttle replaced with newer ones
messages_dropped_total     delivery.dropped     \
Messages dropped by a full queue, an error, or the end of a subscription
messages_pending           delivery.pending     Messages that wait in queues and throttles
"""
_DRIVES: Final = """
drive_moving   is_moving   1 while commands move the robot or a stop is being sent.
drive_tripped  is_tripped  1 during a safety stop, which ends with a zero command.
drive_held     is_leased   1 while a client has control.
drive_guarded  is_guarded  1 while the guard process is ready for this topic.
"""


def _families(
    table: str,
    things: Callable[[State], Iterable[Any]],
    labels: Sequence[str] = (),
    *,
    before: str = "",
    after: str = "",
) -> Iterator[Family]:
    """Yield the families of a table, with a value for each of these *things* that has one."""
    for line in table.strip().splitlines():
        name, place, text = line.split(maxsplit=2)
        name, is_counter = name.removesuffix("_total"), name.endswith("_total")
        is_histogram = place in {"lag", "latency"}
        kind: Kind = "histogram" if is_histogram else "counter" if is_counter else "gauge"
        rows = _rows(things, attrgetter(place), labels)
        yield Family(before + name, kind, text + after, rows, tuple(labels))


def _rows(
    things: Callable[[State], Iterable[Any]],
    value_of: Callable[[Any], float | Observed | None],
    labels: Sequence[str],
) -> Callable[[State], Rows]:
    def rows(state: State) -> Iterator[tuple[tuple[str, ...], float | Observed]]:
        for thing in things(state):
            value = value_of(thing)
            if value is not None:  # such as the speed of a link that was never full
                yield tuple(getattr(thing, label) for label in labels), value

    return rows


def _by_word(
    name: str, kind: Kind, text: str, label: str, counts: Callable[[Summary], Mapping[str, int]]
) -> Family:
    def rows(state: State) -> Rows:
        return (((word,), count) for word, count in counts(state.summary).items())

    return Family(name, kind, text, rows, (label,))


FAMILIES: Final[tuple[Family, ...]] = (
    _by_word("info", "gauge", "Version of the gateway.", "version", lambda s: {s.version: 1}),
    *_families(_GATEWAY, lambda state: (state.summary,)),
    _by_word(
        *("open", "gauge"),
        "Open subscriptions, publishers, calls, goals, and others of clients, by kind.",
        "kind",
        lambda s: {k: n for k, n in s.entities.items() if k not in {"clients", "ros_entities"}},
    ),
    _by_word(
        *("handshakes_refused", "counter"),
        *("Connections that did not become a client, by reason.", "reason"),
        lambda s: s.handshakes_refused,
    ),
    _by_word(
        *("authentication_failures", "counter"),
        *("Tokens that were wrong or late, by reason.", "reason"),
        lambda s: s.authentication_failures,
    ),
    Family(
        *("connections_ended", "counter"),
        "Ended connections, by who ended them, reason, and code.",
        lambda state: state.summary.ends.items(),
        ("by", "reason", "code"),
    ),
    *_families(_CLIENTS, lambda state: state.summary.clients, ["client"]),
    *_families(_ADDRESSES, lambda state: state.summary.addresses, ["address"]),
    *_families(_TOPICS, lambda state: state.traffic.topics, ["topic"]),
    *_families(_PUBLICATIONS, lambda state: state.traffic.publications, ["client", "topic"]),
    *_families(
        *(_DELIVERIES, lambda state: state.traffic.client_topics, ["client", "topic"]),
        before="client_",
        after=", for one client.",
    ),
    *_families(
        *(_DELIVERIES, lambda state: state.traffic.topics, ["topic"]),
        before="topic_",
        after=", for all clients.",
    ),
    *_families(_DRIVES, lambda state: state.summary.control.drives, ["topic"]),
    Family(
        *("drive_stops", "counter", "Stops, by cause."),
        lambda state: (
            ((drive.topic, cause), count)
            for drive in state.summary.control.drives
            for cause, count in drive.stops.items()
        ),
        ("topic", "cause"),
    ),
)
