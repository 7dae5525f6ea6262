# SPDX-License-Identifier: Apache-2.0
"""Which profile follows from which offers. No ROS takes part."""

import itertools
from dataclasses import replace

import pytest
from rclpy.duration import Infinite

from gateway.codec.types import Types
from gateway.core.requests import Advertise
from gateway.core.topics.requested_qos import offered
from gateway.sources.qos import (
    UNKNOWN_NODE,
    Endpoint,
    adopt,
    complete_offer,
    is_matched,
    is_same_request,
    unmatched_publishers,
    unmatched_subscribers,
)
from gateway.sources.rclpy.versions import other_versions
from gateway.sources.source import Durability, Qos, Reliability
from schemas.installed import InstalledDefinitions

SMALL = Types(InstalledDefinitions()).get("std_msgs/msg/String")
TYPE = "std_msgs/msg/String"
MAX_QUEUE_DEPTH = 1024
NEEDED_DEPTH = 32
RELIABLE = Endpoint("/a", TYPE)
BEST_EFFORT = Endpoint("/b", TYPE, "best_effort")
LATCHED = Endpoint("/c", TYPE, durability="transient_local")
BRIEF = replace(LATCHED, lifespan_ns=4_000_000_000)
LONGER = replace(LATCHED, lifespan_ns=4_000_000_001)
RELIABILITIES: tuple[Reliability, ...] = ("reliable", "best_effort")
DURABILITIES: tuple[Durability, ...] = ("volatile", "transient_local")
ALL = [
    Endpoint("/n", TYPE, reliability, durability)
    for reliability, durability in itertools.product(RELIABILITIES, DURABILITIES)
]


@pytest.mark.parametrize("offers", [*itertools.combinations_with_replacement(ALL, 3)])
def test_an_open_profile_matches_every_offer(offers: tuple[Endpoint, ...]) -> None:
    assert unmatched_publishers("/t", TYPE, adopt(Qos(), offers), offers) == []


@pytest.mark.parametrize(
    ("offers", "reliability", "durability"),
    [
        ([], "reliable", "volatile"),
        ([RELIABLE], "reliable", "volatile"),
        ([RELIABLE, RELIABLE], "reliable", "volatile"),
        ([BEST_EFFORT], "best_effort", "volatile"),
        ([RELIABLE, BEST_EFFORT], "best_effort", "volatile"),
        ([LATCHED], "reliable", "transient_local"),
        ([LATCHED, LATCHED], "reliable", "transient_local"),
        ([LATCHED, RELIABLE], "reliable", "volatile"),
        ([LATCHED, LONGER], "reliable", "transient_local"),
        ([LATCHED, BRIEF], "reliable", "transient_local"),
        ([BRIEF, BRIEF], "reliable", "volatile"),
    ],
)
def test_reliable_and_transient_local_only_if_all_are(offers, reliability, durability):
    adopted = adopt(Qos(), offers)
    assert (adopted.reliability, adopted.durability) == (reliability, durability)


def test_values_that_are_asked_for_are_not_adopted() -> None:
    asked = Qos("reliable", "transient_local", "keep_last", 5, 10_000_000, 20_000_000)
    assert adopt(asked, [BEST_EFFORT]) == asked


def test_without_publishers_the_current_profile_stays() -> None:
    current = adopt(Qos(), [BEST_EFFORT])
    assert adopt(Qos(), [], current) == current
    assert adopt(Qos(), [RELIABLE], current).reliability == "reliable"


def test_the_depth_is_what_is_needed_or_offered_within_the_bound() -> None:
    assert adopt(Qos(), [RELIABLE]).depth == NEEDED_DEPTH
    assert adopt(Qos(), [Endpoint("/a", TYPE, depth=100)]).depth == 100
    assert adopt(Qos(), [LATCHED] * 50).depth == 50  # each may retain one, all come at once
    assert adopt(Qos(), [Endpoint("/a", TYPE, depth=10**6)]).depth == MAX_QUEUE_DEPTH
    assert adopt(Qos(depth=10**9), []).depth == MAX_QUEUE_DEPTH
    assert adopt(Qos(depth=-1), []).depth == 1


def test_a_subscription_that_keeps_all_keeps_as_much_as_is_bounded() -> None:
    kept = Qos("reliable", "volatile", "keep_last", MAX_QUEUE_DEPTH)
    assert adopt(Qos(history="keep_all"), []) == kept
    assert adopt(Qos(history="keep_all", depth=5), [RELIABLE]) == kept


def test_a_depth_alone_is_not_another_request() -> None:
    assert is_same_request(Qos(depth=1), Qos(depth=2))
    assert not is_same_request(Qos("reliable", depth=1), Qos("best_effort", depth=1))


def test_durations_are_kept_within_what_dds_can_watch() -> None:
    adopted = adopt(Qos(deadline_ns=1, lifespan_ns=2**70), [])
    assert (adopted.deadline_ns, adopted.lifespan_ns) == (1_000_000, None)
    endless_ns = Infinite.nanoseconds
    adopted = adopt(Qos(deadline_ns=endless_ns, lifespan_ns=endless_ns - 1), [])
    assert (adopted.deadline_ns, adopted.lifespan_ns) == (None, endless_ns - 1)


def test_a_publisher_gets_the_defaults_of_ros() -> None:
    assert complete_offer(Qos()) == Qos("reliable", "volatile", "keep_last", 100)
    asked = Qos("best_effort", "transient_local", "keep_last", 3)
    assert complete_offer(asked) == asked


def test_a_publisher_that_keeps_all_keeps_as_much_as_never_blocks() -> None:
    assert complete_offer(Qos(history="keep_all")) == Qos(
        "reliable", "volatile", "keep_last", MAX_QUEUE_DEPTH
    )


def test_a_mismatch_names_topic_policy_both_sides_and_the_way_out() -> None:
    qos = Qos("reliable", "transient_local", deadline_ns=50_000_000)
    reliability, durability, deadline = (
        each.text for each in unmatched_publishers("/t", TYPE, qos, [BEST_EFFORT])
    )
    assert reliability == (
        "topic /t: /b offers reliability best_effort, the subscription asks for reliability"
        " reliable; ask for best_effort or leave the reliability open"
    )
    assert durability == (
        "topic /t: /b offers durability volatile, the subscription asks for durability"
        " transient_local; ask for volatile or leave the durability open"
    )
    assert deadline == (
        "topic /t: /b offers no deadline, the subscription asks for a deadline of 50 ms;"
        " ask for a longer deadline or none"
    )


def test_a_subscription_that_gets_nothing_is_told_to_the_publisher_in_words() -> None:
    asking = Endpoint("/rviz", TYPE, "reliable", "transient_local", deadline_ns=50_000_000)
    qos = Qos("best_effort", "volatile", "keep_last", 1)
    reliability, durability, deadline = unmatched_subscribers("/t", TYPE, qos, [asking, asking])
    assert reliability.text == (
        "topic /t: /rviz asks for reliability reliable, published is with reliability best_effort;"
        " offer reliable or leave the reliability open"
    )
    assert durability.text == (
        "topic /t: /rviz asks for durability transient_local, published is with durability"
        " volatile; offer transient_local or leave the durability open"
    )
    assert deadline.text == (
        "topic /t: /rviz asks for a deadline of 50 ms, published is with no deadline;"
        " offer a deadline of 50 ms"
    )
    unknown = replace(asking, node=UNKNOWN_NODE)
    assert unmatched_subscribers("/t", TYPE, qos, [unknown]) == []


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        (replace(RELIABLE, lease_ns=200_000_000), "automatic liveliness with a lease of 200 ms"),
        (replace(RELIABLE, is_manual=True), "manual liveliness with no lease"),
    ],
)
def test_a_subscription_that_asks_for_signs_of_life_gets_nothing_from_a_client(asked, words):
    [reason] = unmatched_subscribers("/t", TYPE, complete_offer(Qos()), [asked])
    assert reason.code == "qos_incompatible"
    assert reason.text == (
        f"topic /t: /a asks for {words}, published is with automatic liveliness with no lease;"
        " let it ask for that"
    )


def test_a_subscription_to_another_type_is_told_to_the_publisher() -> None:
    other = Endpoint("/rviz", "std_msgs/msg/Int32", durability="transient_local")
    [reason] = unmatched_subscribers("/t", TYPE, Qos("reliable", "volatile"), [other])
    assert reason.code == "type_conflict"
    assert reason.text == (
        "topic /t: /rviz subscribes to std_msgs/msg/Int32, published is std_msgs/msg/String;"
        " publish std_msgs/msg/Int32"
    )


@pytest.mark.parametrize("asked", ALL)
def test_the_default_offer_of_a_client_matches_every_subscription(asked):
    qos = complete_offer(offered(Advertise(topic="/t", type=TYPE), SMALL))
    assert unmatched_subscribers("/t", TYPE, qos, [asked]) == []


def test_a_deadline_matches_offers_that_are_as_short() -> None:
    qos = Qos("reliable", "volatile", deadline_ns=50_000_000)
    assert (
        unmatched_publishers("/t", TYPE, qos, [Endpoint("/a", TYPE, deadline_ns=50_000_000)]) == []
    )
    [reason] = unmatched_publishers("/t", TYPE, qos, [Endpoint("/a", TYPE, deadline_ns=60_000_000)])
    assert "/a offers a deadline of 60 ms" in reason.text


@pytest.mark.parametrize(
    ("asked", "offered", "matches"),
    [
        (Qos("reliable", "volatile"), LATCHED, True),
        (Qos("reliable", "volatile"), BEST_EFFORT, False),
        (Qos("reliable", "transient_local"), RELIABLE, False),
        (Qos("reliable", "volatile", lease_ns=1), RELIABLE, False),
        (Qos("reliable", "volatile", lease_ns=1), replace(RELIABLE, lease_ns=2), False),
        (Qos("reliable", "volatile", lease_ns=2), replace(RELIABLE, lease_ns=2), True),
    ],
)
def test_a_subscription_gets_the_samples_of_what_it_matches_with_its_lease(asked, offered, matches):
    assert is_matched(asked, offered) == matches


def test_the_same_reason_is_told_once() -> None:
    assert len(unmatched_publishers("/t", TYPE, Qos("reliable"), [BEST_EFFORT, BEST_EFFORT])) == 1


def test_a_publisher_whose_node_is_not_known_yet_is_not_told_of() -> None:
    offer = Endpoint(UNKNOWN_NODE, TYPE, "best_effort")
    assert unmatched_publishers("/t", TYPE, Qos("reliable"), [offer]) == []


def test_another_definition_of_a_type_is_told_of_once_for_each_node():
    others = [
        replace(BEST_EFFORT, node=node, type_hash=hashed)
        for node, hashed in (("/old", "RIHS01_1"), ("/old", "RIHS01_1"), ("/same", "RIHS01_2"))
    ]
    silent = replace(BEST_EFFORT, node="/iron", type_hash=None)
    of_another_type = replace(others[0], type_name="std_msgs/msg/Empty")
    unknown = replace(others[0], node=UNKNOWN_NODE)
    found = other_versions("/t", TYPE, "RIHS01_2", [*others, silent, of_another_type, unknown])
    (event,) = found
    assert (event.code, event.node) == ("type_conflict", "/old")
    assert event.text.startswith(f"topic /t: /old has another definition of {TYPE} than this")
    assert other_versions("/t", TYPE, None, others) == []
