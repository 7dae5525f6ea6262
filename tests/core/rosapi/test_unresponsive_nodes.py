# SPDX-License-Identifier: Apache-2.0
from gateway.core.rosapi.unresponsive_nodes import UnresponsiveNodes

FRESH_S = 0.5
MAX_NODES = 256


def test_a_node_is_known_to_be_silent_for_a_moment() -> None:
    unresponsive = UnresponsiveNodes()
    unresponsive.add("/dead", waited_s=1.0, now_s=10.0)
    assert unresponsive.has_just_timed_out("/dead", 1.0, now_s=10.0)
    assert unresponsive.has_just_timed_out("/dead", 1.0, now_s=10.0 + FRESH_S)
    assert not unresponsive.has_just_timed_out("/dead", 1.0, now_s=10.01 + FRESH_S)
    assert not unresponsive.has_just_timed_out("/other", 1.0, now_s=10.0)


def test_a_request_with_a_longer_time_out_is_sent() -> None:
    unresponsive = UnresponsiveNodes()
    unresponsive.add("/slow", waited_s=0.1, now_s=10.0)
    assert unresponsive.has_just_timed_out("/slow", 0.05, now_s=10.0)
    assert not unresponsive.has_just_timed_out("/slow", 0.2, now_s=10.0)


def test_an_answer_ends_it() -> None:
    unresponsive = UnresponsiveNodes()
    unresponsive.add("/back", waited_s=1.0, now_s=10.0)
    unresponsive.remove("/back")
    unresponsive.remove("/never_silent")
    assert not unresponsive.has_just_timed_out("/back", 1.0, now_s=10.0)
    assert unresponsive.noticed_s("/back") == 0.0


def test_nodes_are_sorted_by_when_they_were_silent_last() -> None:
    unresponsive = UnresponsiveNodes()
    unresponsive.add("/a", waited_s=1.0, now_s=10.0)
    unresponsive.add("/b", waited_s=1.0, now_s=11.0)
    unresponsive.add("/a", waited_s=1.0, now_s=12.0)
    assert sorted(["/a", "/b", "/c"], key=unresponsive.noticed_s) == ["/c", "/b", "/a"]


def test_of_too_many_nodes_the_one_noted_longest_ago_is_forgotten() -> None:
    unresponsive = UnresponsiveNodes()
    for number in range(MAX_NODES):
        unresponsive.add(f"/{number}", waited_s=1.0, now_s=10.0)
    unresponsive.add("/0", waited_s=1.0, now_s=10.0)
    unresponsive.add("/new", waited_s=1.0, now_s=10.0)
    assert unresponsive.has_just_timed_out("/0", 1.0, now_s=10.0)
    assert not unresponsive.has_just_timed_out("/1", 1.0, now_s=10.0)
    assert unresponsive.has_just_timed_out("/2", 1.0, now_s=10.0)
