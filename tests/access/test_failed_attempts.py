# SPDX-License-Identifier: Apache-2.0
import pytest

from gateway.access.failed_attempts import MAX_ADDRESSES, FailedAttempts, network_of


def test_an_address_may_fail_ten_times_a_minute():
    failed = FailedAttempts()
    outcomes = [failed.add("10.0.0.1", 5.0) for _ in range(12)]
    assert outcomes == [False] * 10 + [True] * 2
    assert not failed.add("10.0.0.2", 5.0)
    assert failed.add("10.0.0.1", 5.0 + 59.9)
    assert not failed.add("10.0.0.1", 5.0 + 60)


def test_ten_thousand_failures_of_ten_thousand_addresses_leave_bounded_memory():
    failed = FailedAttempts()
    for number in range(10_000):
        failed.add(f"10.1.{number // 256}.{number % 256}", number / 1000)
    assert len(failed) == 1024
    for _ in range(10_000):
        failed.add("10.9.9.9", 10.0)
    assert len(failed) == 1024


def test_an_address_that_still_fails_is_remembered_longer_than_one_that_has_stopped():
    failed = FailedAttempts()
    for number in range(MAX_ADDRESSES * 2):
        failed.add(f"10.1.{number // 256}.{number % 256}", 1.0)
        is_too_often = failed.add("10.0.0.1", 1.0)
    assert is_too_often


@pytest.mark.parametrize(
    ("address", "network"),
    [
        ("192.168.1.7", "192.168.1.7"),
        ("2001:db8:1:2:3:4:5:6", "2001:db8:1:2::/64"),
        ("fe80::1%eth0", "fe80::/64"),
        ("::ffff:192.168.1.7", "192.168.1.7"),
        ("?", "?"),
    ],
)
def test_of_an_ipv6_address_its_network_counts(address, network):
    assert network_of(address) == network
