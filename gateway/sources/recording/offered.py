# SPDX-License-Identifier: Apache-2.0
"""The qualities of service that the publishers of a recorded robot offered."""

from collections.abc import Sequence

from rosbags.interfaces import Qos as OfferedQos
from rosbags.interfaces import QosDurability, QosReliability
from rosbags.rosbag2.metadata import parse_qos

from gateway.sources.recording.tracks import DEFAULT_QOS
from gateway.sources.source import BRIEF_LIFESPAN_NS, Qos


def offered_qos(text: str) -> Qos:
    """Return what the profiles of YAML come to, or the default if one of them is incomplete."""
    try:
        return common_qos(parse_qos(text))
    except Exception:  # noqa: BLE001  # of the library, about what somebody else has written
        return DEFAULT_QOS


def common_qos(offers: Sequence[OfferedQos]) -> Qos:
    """Return what all publishers of a topic offered, and how many messages they kept together.

    As on a robot, a topic is latched if all its publishers are, and one of them keeps its messages
    for longer than discovery takes.
    """
    if not offers:
        return DEFAULT_QOS
    keep = all(each.durability == QosDurability.TRANSIENT_LOCAL for each in offers)
    is_latched = keep and any(_keeps_for_late_readers(each) for each in offers)
    is_reliable = all(each.reliability != QosReliability.BEST_EFFORT for each in offers)
    return Qos(
        "reliable" if is_reliable else "best_effort",
        "transient_local" if is_latched else "volatile",
        "keep_last",
        sum(each.depth or DEFAULT_QOS.depth or 1 for each in offers),
    )


def _keeps_for_late_readers(offer: OfferedQos) -> bool:
    lifespan_ns = offer.lifespan.sec * 10**9 + offer.lifespan.nsec  # 0 in old files: unlimited
    return not 0 < lifespan_ns <= BRIEF_LIFESPAN_NS
