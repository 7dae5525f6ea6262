# SPDX-License-Identifier: Apache-2.0
"""Names and rates."""

import pytest

from gateway.core.errors import ProtocolError
from gateway.core.names import resolve_topic
from gateway.core.token_bucket import TokenBucket

SECOND = 1_000_000_000


@pytest.mark.parametrize(
    ("written", "resolved"),
    [("/odom", "/odom"), ("odom", "/odom"), ("a/b_1/_c", "/a/b_1/_c"), ("/_hidden", "/_hidden")],
)
def test_a_name_without_slash_is_global(written, resolved):
    assert resolve_topic(written, 200) == resolved


@pytest.mark.parametrize(
    "name",
    [
        "",
        "/",
        "//a",
        "/a/",
        "/a//b",
        "/1a",
        "/a b",
        "~/a",
        "/{node}",
        "/a\0b",
        "/ä",
        "/a\n",
        "/a-b",
    ],
)
def test_an_invalid_topic_name_is_refused(name):
    with pytest.raises(ProtocolError, match=r"topic: .* is not a valid topic name") as caught:
        resolve_topic(name, 200)
    assert caught.value.code == "bad_name"


def test_a_name_over_the_limit_is_refused():
    assert resolve_topic("/" + "a" * 9, 10)
    with pytest.raises(ProtocolError, match="11 characters, at most 10 allowed"):
        resolve_topic("/" + "a" * 10, 10)


def test_a_bucket_allows_a_burst_and_then_the_rate():
    bucket = TokenBucket(10, 3, 0)
    assert [bucket.allow(0) for _ in range(4)] == [True, True, True, False]
    assert not bucket.allow(SECOND // 20)
    assert bucket.allow(SECOND // 10)
    assert not bucket.allow(SECOND // 10)


def test_a_bucket_fills_no_higher_than_its_burst():
    bucket = TokenBucket(10, 3, 0)
    assert sum(bucket.allow(100 * SECOND) for _ in range(10)) == 3


def test_a_rate_of_zero_allows_all():
    bucket = TokenBucket(0, 1, 0)
    assert all(bucket.allow(0) for _ in range(1000))
