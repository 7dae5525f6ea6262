# SPDX-License-Identifier: Apache-2.0
"""The figures of a run are of all clients, and images dropped on purpose are not a loss."""

import pytest

from benchmarks.robot import AGED, CAMERAS, ODOMETRY, PICTURE_OPTIONS
from benchmarks.scenarios.robot import Run


def run(scans=100, pictures=30):
    """Return a run of 2 s with 100 scans and 30 pictures of each camera."""
    sent = {"scan": 100, **dict.fromkeys(CAMERAS, 30)}
    got = {"scan": 2 * scans, **dict.fromkeys(CAMERAS, 2 * pictures), "map": 0}
    ages = {name: {"count": 9, "p50_ms": 2.0, "p99_ms": 3.0} for name in AGED}
    return Run(
        sent,
        seconds=2.0,
        spent_s=0.5,
        memory_mb=100.0,
        got=dict.fromkeys(PICTURE_OPTIONS, got),
        ages=dict.fromkeys(PICTURE_OPTIONS, ages),
    )


def test_all_that_arrives_is_counted_once_for_each_client():
    assert run().delivered == 1
    assert run().frames_per_s == 10 * (100 + 2 * 30) / 2
    assert run().core_share == 0.25
    assert run(scans=99).delivered == pytest.approx(0.99)  # one client misses one
    assert run(pictures=10).delivered == 1  # images may be dropped, which lowers their rate
    assert run(pictures=10).pictures_per_s("max_fps") == 5
    assert run().pictures_per_s("default") == 15


def test_the_share_of_a_topic_is_that_of_the_clients_with_some_options():
    one = run(pictures=15)
    assert one.share(["scan"]) == 1
    assert one.share(CAMERAS, ["default"]) == 0.5
    assert one.share(CAMERAS, ["default", "cbor"]) == 0.5


def test_ages_of_missing_messages_are_not_numbers():
    nothing = {name: {"count": 0} for name in AGED}
    ages = {name: {**nothing, ODOMETRY: {"p50_ms": 4.0}} for name in PICTURE_OPTIONS}
    one = Run({}, 1.0, 0.0, 0.0, {}, ages)
    assert one.odometry_ms("p50") == 4
    assert one.picture_ms("p50", "cbor") != one.picture_ms("p50", "cbor")
