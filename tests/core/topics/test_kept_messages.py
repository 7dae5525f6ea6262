# SPDX-License-Identifier: Apache-2.0
import pytest

from gateway.codec.chunks import Chunks
from gateway.core.topics import kept_messages
from gateway.core.topics.kept_messages import KeptMessages

LIMIT = 1000
ONE, OTHER, THIRD = "one", "other", "third"


@pytest.fixture
def kept(monkeypatch: pytest.MonkeyPatch) -> KeptMessages:
    monkeypatch.setattr(kept_messages, "MAX_KEPT_BYTES", LIMIT)
    return KeptMessages()


def message(size: int) -> Chunks:
    return Chunks.of([b"x" * size])


def test_the_budget_holds_two_large_maps():
    assert 2 * 48_000_000 < kept_messages.MAX_KEPT_BYTES < 3 * 48_000_000


def test_a_message_is_found_by_its_encoding_and_the_origin_of_its_sample(kept: KeptMessages):
    newest = message(10)
    kept.keep(ONE, (5, 1), message(10))
    kept.keep(ONE, (7, 2), newest)
    assert kept.find(ONE, (7, 2)) is newest
    assert [kept.find(ONE, (5, 1)), kept.find(OTHER, (7, 2))] == [None, None]
    assert kept.size == 10


def test_the_oldest_goes_when_all_are_too_large(kept: KeptMessages):
    for encoding in (ONE, OTHER, THIRD):
        kept.keep(encoding, (1, 1), message(LIMIT // 2))
    assert [kept.find(each, (1, 1)) is None for each in (ONE, OTHER, THIRD)] == [True, False, False]
    assert kept.size == LIMIT


def test_a_message_that_is_too_large_replaces_no_other(kept: KeptMessages):
    kept.keep(ONE, (1, 1), message(LIMIT))
    kept.keep(OTHER, (1, 1), message(LIMIT + 1))
    assert kept.find(ONE, (1, 1)) is not None
    assert kept.find(OTHER, (1, 1)) is None


def test_a_sample_without_a_time_is_not_known_again(kept: KeptMessages):
    kept.keep(ONE, (0, None), message(10))
    assert kept.find(ONE, (0, None)) is None


def test_forgotten_messages_take_no_room(kept: KeptMessages):
    kept.keep(ONE, (1, 1), message(10))
    kept.forget(ONE)
    kept.forget(OTHER)
    assert (kept.find(ONE, (1, 1)), kept.size) == (None, 0)
