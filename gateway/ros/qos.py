# SPDX-License-Identifier: Apache-2.0
"""The quality of service of a subscription, and the reasons why an offer does not match it.

Nothing here needs ROS: offers come in, a profile or sentences come out. Matching follows the table
of "requested versus offered" in the DDS specification (formal/15-04-10, 2.2.3).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Final

from gateway.config.limits import MAX_QUEUE_DEPTH
from gateway.ports import MAX_TAKES_PER_TURN, Durability, Mismatch, Qos, Reliability

# what the loop takes in one turn: DDS need not drop while a turn takes 32 ms at 1 kHz; a topic
# of 1 MB images holds at most 32 MB
NEEDED_DEPTH: Final = MAX_TAKES_PER_TURN
PUBLISHER_DEPTH: Final = 10  # the default of ROS
# DDS watches a deadline with a timer of its own, 1000 times a second at most
MIN_PERIOD_NS: Final = 1_000_000
MAX_PERIOD_NS: Final = 2**63 - 1  # rmw's number for an infinite duration

# rmw's name for the node of an endpoint whose participant has not introduced its nodes yet
UNKNOWN_NODE: Final = "_NODE_NAME_UNKNOWN_"


@dataclass(frozen=True, slots=True)
class Offer:
    """The offer of one publisher of a topic, as discovery reports it."""

    node: str
    type_name: str
    reliability: Reliability = "reliable"
    durability: Durability = "volatile"
    depth: int | None = None  # None: not reported, as by Fast DDS
    deadline_ns: int | None = None


def adopt(asked: Qos, offers: Sequence[Offer], current: Qos | None = None) -> Qos:
    """Fill all that *asked* leaves open with what matches every offer.

    *offers* are those of the subscription's own type. Without any, *current* stays: publishers
    that return mostly return unchanged. Before the first one a reliable, volatile publisher is
    expected, as ROS creates them by default. Only a best-effort publisher does not match that, and
    its next sample soon makes up for the first.

    A subscription that keeps all would grow for as long as the event loop is busy: it keeps the
    last `MAX_QUEUE_DEPTH` instead.
    """
    if not offers and current is not None:
        return current
    reliable = all(offer.reliability == "reliable" for offer in offers)
    retained = bool(offers) and all(offer.durability == "transient_local" for offer in offers)
    return _bounded(
        asked,
        reliability=asked.reliability or ("reliable" if reliable else "best_effort"),
        durability=asked.durability or ("transient_local" if retained else "volatile"),
        depth=max(NEEDED_DEPTH, sum(offer.depth or 1 for offer in offers)),
    )


def is_same_request(one: Qos, other: Qos) -> bool:
    """Return whether two profiles match the same offers, whatever their depths.

    A depth alone is no reason to resubscribe: replacing a subscription may lose a sample, a longer
    queue seldom saves one.
    """
    return replace(one, depth=None) == replace(other, depth=None)


def complete_offer(asked: Qos) -> Qos:
    """Fill what *asked* leaves open with the defaults of ROS publishers.

    A publisher that keeps all waits for its slowest reader while it writes, and would stop the
    event loop: it keeps the last `MAX_QUEUE_DEPTH` instead.
    """
    return _bounded(
        asked,
        reliability=asked.reliability or "reliable",
        durability=asked.durability or "volatile",
        depth=PUBLISHER_DEPTH,
    )


def mismatches(topic: str, type_name: str, qos: Qos, offers: Iterable[Offer]) -> list[Mismatch]:
    """Describe the publishers that a subscription gets nothing from, each reason once."""
    reasons: dict[Mismatch, None] = {}
    for offer in offers:
        if offer.node != UNKNOWN_NODE:  # its name follows within milliseconds
            if offer.type_name != type_name:  # the policies of another type do not matter
                reasons[_other_type(topic, type_name, offer)] = None
                continue
            reasons.update(
                (Mismatch("qos_incompatible", text), None) for text in _mismatch(topic, qos, offer)
            )
    return list(reasons)


def _other_type(topic: str, type_name: str, offer: Offer) -> Mismatch:
    return Mismatch(
        "type_conflict",
        f"topic {topic}: {offer.node} publishes {offer.type_name}, the subscription is for"
        f" {type_name}; subscribe with the type {offer.type_name}",
    )


def _mismatch(topic: str, qos: Qos, offer: Offer) -> Iterable[str]:
    publisher = f"topic {topic}: {offer.node}"
    if qos.reliability == "reliable" and offer.reliability == "best_effort":
        yield (
            f"{publisher} offers reliability best_effort, the subscription asks for reliable;"
            " ask for best_effort or leave the reliability open"
        )
    if qos.durability == "transient_local" and offer.durability == "volatile":
        yield (
            f"{publisher} offers durability volatile, the subscription asks for transient_local;"
            " ask for volatile or leave the durability open"
        )
    if qos.deadline_ns is not None and (
        offer.deadline_ns is None or offer.deadline_ns > qos.deadline_ns
    ):
        yield (
            f"{publisher} offers {_deadline(offer.deadline_ns)}, the subscription asks for"
            f" {_deadline(qos.deadline_ns)}; ask for a longer deadline or none"
        )


def _deadline(deadline_ns: int | None) -> str:
    return "no deadline" if deadline_ns is None else f"a deadline of {deadline_ns / 1e6:g} ms"


def _bounded(asked: Qos, *, reliability: Reliability, durability: Durability, depth: int) -> Qos:
    """Complete a profile; *depth* is for one that leaves its depth open."""
    wanted = MAX_QUEUE_DEPTH if asked.history == "keep_all" else asked.depth or depth
    return Qos(
        reliability,
        durability,
        "keep_last",
        max(1, min(wanted, MAX_QUEUE_DEPTH)),
        deadline_ns=_period(asked.deadline_ns),
        lifespan_ns=_period(asked.lifespan_ns),
    )


def _period(nanoseconds: int | None) -> int | None:
    if nanoseconds is None or nanoseconds >= MAX_PERIOD_NS:
        return None
    return max(nanoseconds, MIN_PERIOD_NS)
