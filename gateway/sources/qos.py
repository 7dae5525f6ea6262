# SPDX-License-Identifier: Apache-2.0
"""The quality of service of a subscription, and the reasons why an offer does not match it.

Nothing here needs ROS: offers come in, a profile or sentences come out. Matching follows the table
of "requested versus offered" in the DDS specification (formal/15-04-10, 2.2.3).
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

from gateway.config.limits import MAX_QUEUE_DEPTH
from gateway.sources.source import (
    BRIEF_LIFESPAN_NS,
    MAX_TAKES_PER_TURN,
    Durability,
    Qos,
    Reliability,
    TopicEvent,
)

# The loop takes so many in one turn: DDS need not drop while a turn takes 32 ms at 1 kHz. A topic
# of 1 MB images holds at most 32 MB.
NEEDED_DEPTH: Final = MAX_TAKES_PER_TURN
# rosbridge's: what a client publishes in one go is written faster than subscribers take it, and the
# 10 of ROS lose some of it
PUBLISHER_DEPTH: Final = 100
# DDS watches a deadline with a separate timer, 1000 times a second at most
MIN_PERIOD_NS: Final = 1_000_000
MAX_PERIOD_NS: Final = 2**63 - 1  # rmw's number for an infinite duration

# rmw's name for the node of an endpoint whose participant has not introduced its nodes yet
UNKNOWN_NODE: Final = "_NODE_NAME_UNKNOWN_"


@dataclass(frozen=True, slots=True)
class Endpoint:
    """One publisher of a topic and its offer, or one subscriber and its request.

    Discovery reports it.
    """

    node: str
    type_name: str
    reliability: Reliability = "reliable"
    durability: Durability = "volatile"
    depth: int | None = None  # None: not reported, as by Fast DDS
    deadline_ns: int | None = None
    lifespan_ns: int | None = None
    lease_ns: int | None = None
    is_manual: bool = False  # of liveliness: MANUAL_BY_TOPIC
    type_hash: str | None = None  # REP-2011. None: not reported, as before Iron


def offered(offers: Iterable[Endpoint]) -> list[Qos]:
    """Return the profiles of publishers. Their history stays open, because discovery has none."""
    return [
        Qos(
            each.reliability,
            each.durability,
            depth=each.depth,
            deadline_ns=each.deadline_ns,
            lifespan_ns=each.lifespan_ns,
            lease_ns=each.lease_ns,
            is_manual=each.is_manual,
        )
        for each in offers
    ]


def adopt(asked: Qos, offers: Sequence[Endpoint], current: Qos | None = None) -> Qos:
    """Fill all that *asked* leaves open with what matches every offer.

    *offers* are those of the subscription's own type. Without any, *current* stays: publishers
    that return mostly return unchanged. Before the first one a reliable, volatile publisher is
    expected, as ROS creates them by default. Only a best-effort publisher does not match that, and
    its next sample soon makes up for the first.

    A subscription that keeps all would grow for as long as the event loop is busy: it keeps the
    last `MAX_QUEUE_DEPTH` instead.

    The lease is the longest, if all publishers have one: DDS then says when one gives no sign of
    life.
    """
    if not offers and current is not None:
        return current
    reliable = all(offer.reliability == "reliable" for offer in offers)
    return _bounded(
        asked,
        reliability=asked.reliability or ("reliable" if reliable else "best_effort"),
        durability=asked.durability or ("transient_local" if is_latched(offers) else "volatile"),
        depth=max(NEEDED_DEPTH, sum(offer.depth or 1 for offer in offers)),
        lease_ns=_longest([offer.lease_ns for offer in offers]),
    )


def is_latched(offers: Sequence[Qos | Endpoint]) -> bool:
    """Return whether the publishers of a topic keep its messages for late subscribers."""
    return all(each.durability == "transient_local" for each in offers) and any(
        map(retains, offers)
    )


def retains(offer: Qos | Endpoint) -> bool:
    """Return whether a publisher keeps samples for late subscribers, and not just briefly.

    rosbridge's publishers are transient local for a second, and clients' through this gateway for
    some more: to match every subscriber. To follow them would replace the reader whenever they
    come, without need.
    """
    lifespan_ns = offer.lifespan_ns
    return offer.durability == "transient_local" and (
        lifespan_ns is None or lifespan_ns > BRIEF_LIFESPAN_NS
    )


def is_same_request(one: Qos, other: Qos) -> bool:
    """Return whether two profiles match the same offers, whatever their depths.

    A depth alone does not justify a new subscription: for seconds each sample would come to two
    readers, and a longer queue seldom saves one.
    """
    return replace(one, depth=None) == replace(other, depth=None)


def is_matched(asked: Qos, offered: Endpoint) -> bool:
    """Return whether a subscription with this profile and lease gets a publisher's samples."""
    is_alive = asked.lease_ns is None or (
        offered.lease_ns is not None and offered.lease_ns <= asked.lease_ns
    )
    return is_alive and not any(_clashes(asked, offered))


def complete_offer(asked: Qos) -> Qos:
    """Fill what *asked* leaves open with the defaults of rosbridge's publishers.

    A publisher that keeps all waits for its slowest reader while it writes, and would stop the
    event loop: it keeps the last `MAX_QUEUE_DEPTH` instead.
    """
    return _bounded(
        asked,
        reliability=asked.reliability or "reliable",
        durability=asked.durability or "volatile",
        depth=PUBLISHER_DEPTH,
    )


def unmatched_publishers(
    topic: str, type_name: str, qos: Qos, publishers: Iterable[Endpoint]
) -> list[TopicEvent]:
    """Describe the publishers that a subscription gets nothing from, each reason once."""

    def reasons() -> Iterator[TopicEvent]:
        for publisher in introduced(publishers):
            node = publisher.node
            if publisher.type_name != type_name:  # the policies of another type do not matter
                published = publisher.type_name
                problem = f"{node} publishes {published}, the subscription is for {type_name}"
                remedy = f"subscribe with the type {published}"
                yield TopicEvent("type_conflict", f"topic {topic}: {problem}", remedy, node)
                continue
            for clash in _clashes(qos, publisher):
                problem = f"{node} offers {clash.offered}, the subscription asks for {clash.asked}"
                problem = f"topic {topic}: {problem}"
                yield TopicEvent("qos_incompatible", problem, clash.for_subscriber, node)

    return list(dict.fromkeys(reasons()))


def unmatched_subscribers(
    topic: str, type_name: str, qos: Qos, subscribers: Iterable[Endpoint]
) -> list[TopicEvent]:
    """Describe the subscriptions that get nothing from a publisher, each reason once."""

    def reasons() -> Iterator[TopicEvent]:
        for subscriber in introduced(subscribers):
            node = subscriber.node
            if subscriber.type_name != type_name:
                wanted = subscriber.type_name
                problem = f"topic {topic}: {node} subscribes to {wanted}, published is {type_name}"
                yield TopicEvent("type_conflict", problem, f"publish {wanted}", node)
                continue
            for clash in _clashes(subscriber, qos):
                problem = f"{node} asks for {clash.asked}, published is with {clash.offered}"
                problem = f"topic {topic}: {problem}"
                yield TopicEvent("qos_incompatible", problem, clash.for_publisher, node)

    return list(dict.fromkeys(reasons()))


def introduced(endpoints: Iterable[Endpoint]) -> Iterable[Endpoint]:
    """Leave out those whose node is not known yet: its name follows within milliseconds."""
    return (endpoint for endpoint in endpoints if endpoint.node != UNKNOWN_NODE)


class _Clash(NamedTuple):
    """One policy that keeps two endpoints apart, in words, and what either side can do."""

    asked: str
    offered: str
    for_subscriber: str
    for_publisher: str


def _clashes(asked: Qos | Endpoint, offered: Qos | Endpoint) -> Iterable[_Clash]:
    if asked.reliability == "reliable" and offered.reliability == "best_effort":
        yield _Clash(
            "reliability reliable",
            "reliability best_effort",
            "ask for best_effort or leave the reliability open",
            "offer reliable or leave the reliability open",
        )
    if asked.durability == "transient_local" and offered.durability == "volatile":
        yield _Clash(
            "durability transient_local",
            "durability volatile",
            "ask for volatile or leave the durability open",
            "offer transient_local or leave the durability open",
        )
    if asked.deadline_ns is not None and (
        offered.deadline_ns is None or offered.deadline_ns > asked.deadline_ns
    ):
        yield _Clash(
            _deadline(asked.deadline_ns),
            _deadline(offered.deadline_ns),
            "ask for a longer deadline or none",
            f"offer {_deadline(asked.deadline_ns)}",
        )
    # Publishers here are automatic, without a lease. Subscriptions adopt what is offered.
    if isinstance(asked, Endpoint) and (asked.lease_ns is not None or asked.is_manual):
        kind = "manual" if asked.is_manual else "automatic"
        lease = "no lease" if asked.lease_ns is None else f"a lease of {asked.lease_ns / 1e6:g} ms"
        yield _Clash(
            f"{kind} liveliness with {lease}",
            "automatic liveliness with no lease",
            "",
            "let it ask for that",
        )


def _deadline(deadline_ns: int | None) -> str:
    return "no deadline" if deadline_ns is None else f"a deadline of {deadline_ns / 1e6:g} ms"


def _longest(leases_ns: Sequence[int | None]) -> int | None:
    finite = [lease_ns for lease_ns in leases_ns if lease_ns is not None]
    return max(finite) if finite and len(finite) == len(leases_ns) else None


def _bounded(
    asked: Qos,
    *,
    reliability: Reliability,
    durability: Durability,
    depth: int,
    lease_ns: int | None = None,
) -> Qos:
    """Complete a profile. *depth* is for one that leaves its depth open."""
    wanted = MAX_QUEUE_DEPTH if asked.history == "keep_all" else asked.depth or depth
    return Qos(
        reliability,
        durability,
        "keep_last",
        max(1, min(wanted, MAX_QUEUE_DEPTH)),
        deadline_ns=_period(asked.deadline_ns),
        lifespan_ns=_period(asked.lifespan_ns),
        lease_ns=lease_ns,
    )


def _period(nanoseconds: int | None) -> int | None:
    if nanoseconds is None or nanoseconds >= MAX_PERIOD_NS:
        return None
    return max(nanoseconds, MIN_PERIOD_NS)


def gone(topic: str, before: Iterable[Endpoint], now: Sequence[Endpoint]) -> list[TopicEvent]:
    """Describe the nodes that have published before and do not now."""
    left = Counter(each.node for each in introduced(before))
    left.subtract(each.node for each in now)
    events = []
    for node, number in left.items():
        if number > 0:
            rest = "others do" if now else "nobody does"
            problem = f"topic {topic}: {node} publishes no longer, {rest}"
            events.append(TopicEvent("publisher_gone", problem, node=node))
    return events
