# SPDX-License-Identifier: Apache-2.0
from gateway.core.topic_counts import CountsByTopic
from gateway.metrics.state import ClientPublication, ClientTopic, Delivery

MAX_UNUSED = 256


def names(counts: CountsByTopic) -> list[str]:
    return [state.topic for state in counts.states([], [])]


def test_the_counts_of_a_topic_stay_when_nobody_uses_it():
    counts = CountsByTopic()
    counts.open("/t").received += 5
    counts.open("/t").received += 2
    counts.close("/t")
    counts.close("/t")
    assert [state.received for state in counts.states([], [])] == [7]
    assert counts.open("/t").received == 7
    assert names(counts) == ["/t"]


def test_a_topic_on_which_nothing_passed_is_forgotten():
    counts = CountsByTopic()
    for number in range(1000):
        counts.open(f"/made_up{number}")
        counts.close(f"/made_up{number}")
    assert names(counts) == []


def test_of_topics_that_nobody_uses_256_are_kept_and_used_ones_always():
    counts = CountsByTopic()
    counts.open("/used").published += 1
    for number in range(MAX_UNUSED + 10):
        counts.open(f"/t{number}").published += 1
        counts.close(f"/t{number}")
    assert names(counts) == ["/used", *(f"/t{number}" for number in range(10, MAX_UNUSED + 10))]


def test_counts_of_open_subscriptions_are_added():
    counts = CountsByTopic()
    past = counts.open("/t")
    past.delivery = Delivery(offered=3, sent=2, sent_bytes=20, dropped=1)
    past.published, past.published_bytes = 7, 70
    ours = [
        ClientTopic("a", "/t", Delivery(offered=5, sent=1, sent_bytes=10, coalesced=3, pending=1)),
        ClientTopic("b", "/t", Delivery(offered=1, sent=1, sent_bytes=10)),
        ClientTopic("b", "/unknown", Delivery(offered=9, pending=9)),
    ]
    (state,) = counts.states(ours, [ClientPublication("a", "/t", 2, 20)])
    assert state.delivery == Delivery(9, 4, 40, 3, 1, 1)
    assert (state.clients, state.published, state.published_bytes) == (2, 9, 90)
