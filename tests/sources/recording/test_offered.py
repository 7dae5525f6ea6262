# SPDX-License-Identifier: Apache-2.0
"""The offers of several publishers, taken together when a topic is played."""

import pytest
from rosbags.interfaces import (
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)

from gateway.sources.recording.offered import common_qos
from gateway.sources.source import BRIEF_LIFESPAN_NS

FOREVER = QosTime(9223372036, 854775807)
BRIEF = QosTime(*divmod(BRIEF_LIFESPAN_NS, 10**9))
UNSAID = QosTime(0, 0)  # in files of old versions


def offer(durability: str = "TRANSIENT_LOCAL", lifespan: QosTime = FOREVER, depth: int = 1) -> Qos:
    return Qos(
        QosHistory.KEEP_LAST,
        depth,
        QosReliability.RELIABLE,
        QosDurability[durability],
        FOREVER,
        lifespan,
        QosLiveliness.AUTOMATIC,
        FOREVER,
        avoid_ros_namespace_conventions=False,
    )


@pytest.mark.parametrize(
    ("offers", "durability"),
    [
        ([offer()], "transient_local"),
        ([offer(lifespan=UNSAID)], "transient_local"),
        ([offer(lifespan=BRIEF)], "volatile"),  # as clients of a gateway publish by default
        ([offer(), offer(lifespan=BRIEF)], "transient_local"),
        ([offer(), offer("VOLATILE")], "volatile"),
        ([offer("VOLATILE"), offer()], "volatile"),
    ],
)
def test_a_topic_is_latched_as_it_was_on_the_robot(offers, durability):
    assert common_qos(offers).durability == durability


def test_as_many_messages_are_kept_as_all_publishers_kept():
    assert common_qos([offer(depth=1), offer(depth=3)]).depth == 4
