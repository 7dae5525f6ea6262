# SPDX-License-Identifier: Apache-2.0
import pytest

from gateway.protocol.operations.topics import Advertise
from gateway.router.topics.requested_qos import offered


@pytest.mark.parametrize(("queue_size", "depth"), [(0, None), (1, 1), (1024, 1024), (1025, 1024)])
def test_a_queue_size_asks_for_as_many_samples_up_to_1024(queue_size, depth):
    assert offered(Advertise(topic="/t", type="x", queue_size=queue_size)).depth == depth


def test_a_latched_topic_keeps_the_last_message():
    assert offered(Advertise(topic="/t", type="x", latch=True, queue_size=9)).depth == 1
