# SPDX-License-Identifier: Apache-2.0
from gateway.rosapi.unresponsive_nodes import FRESH_S, MAX_NODES, Silences


def test_a_node_is_known_to_be_silent_for_a_moment() -> None:
    silences = Silences()
    silences.note("/dead", waited_s=1.0, now_s=10.0)
    assert silences.is_fresh("/dead", 1.0, now_s=10.0)
    assert silences.is_fresh("/dead", 1.0, now_s=10.0 + FRESH_S)
    assert not silences.is_fresh("/dead", 1.0, now_s=10.1 + FRESH_S)
    assert not silences.is_fresh("/other", 1.0, now_s=10.0)


def test_who_has_more_patience_asks_again() -> None:
    silences = Silences()
    silences.note("/slow", waited_s=0.1, now_s=10.0)
    assert silences.is_fresh("/slow", 0.05, now_s=10.0)
    assert not silences.is_fresh("/slow", 0.2, now_s=10.0)


def test_an_answer_ends_it() -> None:
    silences = Silences()
    silences.note("/back", waited_s=1.0, now_s=10.0)
    silences.end("/back")
    silences.end("/never_silent")
    assert not silences.is_fresh("/back", 1.0, now_s=10.0)
    assert silences.noticed_s("/back") == 0.0


def test_nodes_are_sorted_by_when_they_were_silent_last() -> None:
    silences = Silences()
    silences.note("/a", waited_s=1.0, now_s=10.0)
    silences.note("/b", waited_s=1.0, now_s=11.0)
    silences.note("/a", waited_s=1.0, now_s=12.0)
    assert sorted(["/a", "/b", "/c"], key=silences.noticed_s) == ["/c", "/b", "/a"]


def test_of_too_many_nodes_the_one_noted_longest_ago_is_forgotten() -> None:
    silences = Silences()
    for number in range(MAX_NODES):
        silences.note(f"/{number}", waited_s=1.0, now_s=10.0)
    silences.note("/0", waited_s=1.0, now_s=10.0)
    silences.note("/new", waited_s=1.0, now_s=10.0)
    assert silences.is_fresh("/0", 1.0, now_s=10.0)
    assert not silences.is_fresh("/1", 1.0, now_s=10.0)
    assert silences.is_fresh("/2", 1.0, now_s=10.0)
