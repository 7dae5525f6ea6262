# SPDX-License-Identifier: Apache-2.0
import pytest

from gateway.access.posture import LOOPBACKS, is_loopback, posture_of
from gateway.config.access import AccessConfig
from gateway.config.model import Config
from gateway.errors import ConfigError

EVERYWHERE = ("0.0.0.0", "::")  # noqa: S104  # compared, not bound


@pytest.mark.parametrize(
    ("config", "access", "hosts", "is_open", "anonymous"),
    [
        ({}, {}, LOOPBACKS, False, "admin"),
        ({"host": "127.0.0.1"}, {}, ("127.0.0.1",), False, "admin"),
        ({"lan": True}, {}, EVERYWHERE, True, None),
        ({"lan": True}, {"authentication": "none"}, EVERYWHERE, True, "viewer"),
        (
            {"lan": True},
            {"authentication": "none", "anonymous_role": "operator"},
            EVERYWHERE,
            True,
            "operator",
        ),
        ({"host": "0.0.0.0"}, {}, ("0.0.0.0",), True, None),  # noqa: S104
        ({"host": "::"}, {}, ("::",), True, None),
        ({"host": "192.168.1.7"}, {}, ("192.168.1.7",), True, None),
        ({"host": "robot"}, {}, ("robot",), True, None),
        ({"host": "robot", "lan": True}, {}, ("robot",), True, None),
        ({"host": "::1"}, {}, ("::1",), False, "admin"),
        ({"host": "localhost"}, {}, ("localhost",), False, "admin"),
        ({}, {"authentication": "token"}, LOOPBACKS, False, None),
        ({}, {"anonymous_role": "viewer"}, LOOPBACKS, False, "viewer"),
        ({}, {"authentication": "none"}, LOOPBACKS, False, "admin"),
    ],
)
def test_a_gateway_that_other_machines_reach_asks_for_tokens(
    config, access, hosts, is_open, anonymous
):
    posture = posture_of(Config(**config, access=AccessConfig(**access)))
    assert (posture.hosts, posture.is_open, posture.anonymous_role) == (hosts, is_open, anonymous)
    assert posture.needs_token is (anonymous is None)


def test_a_role_for_nobody_is_an_error():
    with pytest.raises(ConfigError, match="--no-auth"):
        posture_of(Config(lan=True, access=AccessConfig(anonymous_role="operator")))


@pytest.mark.parametrize("host", ["127.0.0.1", "::1", "localhost"])
def test_the_network_and_this_machine_alone_is_a_contradiction(host):
    with pytest.raises(ConfigError, match=f"lan: got true, but host is {host}"):
        posture_of(Config(lan=True, host=host))


@pytest.mark.parametrize(
    ("host", "expected"),
    [("127.0.0.2", True), ("::1", True), ("localhost", True), ("localhost.evil", False)],
)
def test_only_loopback_is_loopback(host, expected):
    assert is_loopback(host) is expected
