# SPDX-License-Identifier: Apache-2.0
"""A burst is judged by itself: what arrived, what the server reports as lost, and the time."""

import pytest

from benchmarks.actors.burst_client import Burst
from benchmarks.samples import SAMPLES

MS = 1_000_000
NOW_NS = 1_795_280_256_507_552_000


@pytest.fixture
def burst():
    return Burst(SAMPLES["string"].clockwork)


def frame(stamp_ns, dropped=None):
    meta = "" if dropped is None else f'"seq":7,"dropped":{dropped},'
    return f'{{"op":"publish","topic":"/x",{meta}"msg":{{"data":"{stamp_ns}"}}}}'.encode()


def test_arrived_and_lost_messages_are_of_one_burst(burst):
    burst.note(frame(NOW_NS, dropped=5), NOW_NS)
    burst.clear()
    burst.note(frame(NOW_NS + 1 * MS, dropped=6), NOW_NS + 3 * MS)
    burst.note(frame(NOW_NS + 2 * MS, dropped=9), NOW_NS + 8 * MS)
    assert burst.summary() == {"distinct": 2, "reported": 4, "took_ms": 7}


def test_of_nothing_there_is_no_time_and_without_meta_no_report(burst):
    burst.note(b'{"op":"status","level":"warning","msg":"3 messages were lost"}', NOW_NS)
    assert burst.count() == 0
    assert burst.summary() == {"distinct": 0, "reported": None, "took_ms": None}
    burst.note(frame(NOW_NS), NOW_NS)
    assert burst.summary()["reported"] is None
