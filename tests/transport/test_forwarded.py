# SPDX-License-Identifier: Apache-2.0
from ipaddress import ip_network

import pytest
from websockets.datastructures import Headers

from gateway.transport.forwarded import client_address

TRUSTED = [ip_network("10.0.0.0/8"), ip_network("fd00::/8"), ip_network("127.0.0.1")]


@pytest.mark.parametrize(
    ("peer", "headers", "address"),
    [
        ("192.0.2.1", {"X-Forwarded-For": "203.0.113.5"}, "192.0.2.1"),
        ("10.0.0.1", {}, "10.0.0.1"),
        ("10.0.0.1", {"X-Forwarded-For": "203.0.113.5"}, "203.0.113.5"),
        ("::ffff:10.0.0.1", {"X-Forwarded-For": "203.0.113.5"}, "203.0.113.5"),
        ("10.0.0.1", {"X-Forwarded-For": "203.0.113.5, 198.51.100.7, 10.0.0.2"}, "198.51.100.7"),
        ("10.0.0.1", {"X-Forwarded-For": "10.0.0.3, 10.0.0.2"}, "10.0.0.3"),
        ("10.0.0.1", {"X-Forwarded-For": "203.0.113.5:1234"}, "203.0.113.5"),
        ("10.0.0.1", {"X-Forwarded-For": "2001:db8::7"}, "2001:db8::7"),
        ("10.0.0.1", {"X-Forwarded-For": "somebody, 10.0.0.2"}, "10.0.0.2"),
        ("10.0.0.1", {"Forwarded": "for=203.0.113.5;proto=https;by=10.0.0.1"}, "203.0.113.5"),
        ("10.0.0.1", {"Forwarded": 'proto=https;For="[2001:db8::7]:4711"'}, "2001:db8::7"),
        ("10.0.0.1", {"Forwarded": "for=198.51.100.7, for=203.0.113.5"}, "203.0.113.5"),
        ("10.0.0.1", {"Forwarded": "for=203.0.113.5, for=_hidden"}, "10.0.0.1"),
        ("10.0.0.1", {"Forwarded": "for=1.2.3.4", "X-Forwarded-For": "203.0.113.5"}, "1.2.3.4"),
        ("fd00::1%eth0", {"X-Forwarded-For": "203.0.113.5"}, "203.0.113.5"),
        ("?", {"X-Forwarded-For": "203.0.113.5"}, "?"),
    ],
)
def test_the_nearest_address_without_a_trusted_proxy_counts(peer, headers, address):
    assert client_address(peer, Headers(headers), TRUSTED) == address


def test_a_header_that_comes_twice_is_read_as_one():
    headers = Headers()
    headers["X-Forwarded-For"] = "203.0.113.5"
    headers["X-Forwarded-For"] = "10.0.0.2"
    assert client_address("10.0.0.1", headers, TRUSTED) == "203.0.113.5"


def test_without_trusted_proxies_nothing_is_believed():
    headers = Headers({"X-Forwarded-For": "203.0.113.5"})
    assert client_address("10.0.0.1", headers, ()) == "10.0.0.1"
