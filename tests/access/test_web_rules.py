# SPDX-License-Identifier: Apache-2.0
import pytest

from gateway.access.web_rules import WebRules, is_plain

OWN = ("localhost", "robot", "robot.local")


@pytest.mark.parametrize(
    ("host", "is_own"),
    [
        ("localhost:9090", True),
        ("LOCALHOST", True),
        ("robot.local:9090", True),
        ("Robot.", True),
        ("192.168.1.7:9090", True),
        ("[fe80::1]:9090", True),
        ("evil.example:9090", False),
        ("robot.evil.example", False),
        ("localhost.evil.example", False),
        ("user@evil.example", False),
    ],
)
def test_an_address_and_a_name_of_this_machine_are_own(host, is_own):
    assert WebRules(OWN).is_own_host(host) is is_own


@pytest.mark.parametrize("host", ["", ":9090", "["])
def test_a_malformed_host_is_an_error(host):
    with pytest.raises(ValueError):  # noqa: PT011  # of urlsplit, or ours
        WebRules(OWN).is_own_host(host)


def test_further_names_and_all_names_can_be_allowed():
    assert WebRules(OWN, ("Robot.lan",)).is_own_host("robot.LAN:9090")
    assert WebRules(OWN, ("*",)).is_own_host("anything.example")


@pytest.mark.parametrize(
    ("origin", "host", "is_own"),
    [
        (None, "localhost:9090", True),
        ("http://localhost:9090", "localhost:9090", True),
        ("https://robot.local", "robot.local", True),
        ("http://robot.local", "robot.local:80", True),
        ("http://[::1]:9090", "[::1]:9090", True),
        ("http://localhost:3000", "localhost:9090", False),
        ("http://localhost", "localhost:9090", False),
        ("http://127.0.0.1:9090", "localhost:9090", False),
        ("https://evil.example", "localhost:9090", False),
        ("null", "localhost:9090", False),
        ("file://", "localhost:9090", False),
        ("file://localhost:9090", "localhost:9090", False),
    ],
)
def test_a_page_of_the_same_host_and_port_is_own(origin, host, is_own):
    standing = WebRules(OWN).standing(origin, host, is_encrypted=False)
    assert standing == ("trusted" if is_own else "foreign")


def test_a_page_that_came_without_encryption_is_not_own_where_the_gateway_encrypts():
    rules = WebRules(OWN)
    host = "robot.local:9443"
    assert rules.standing(f"http://{host}", host, is_encrypted=True) == "foreign"
    assert rules.standing(f"https://{host}", host, is_encrypted=True) == "trusted"
    assert rules.standing(f"https://{host}", host, is_encrypted=False) == "trusted"  # by a proxy


@pytest.mark.parametrize(
    ("origin", "host", "is_local"),
    [
        ("http://localhost:3000", "localhost:9090", True),
        ("http://localhost", "127.0.0.1:9090", True),
        ("https://127.0.0.1:8443", "localhost:9090", True),
        ("http://[::1]:8000", "[::1]:9090", True),
        ("http://127.0.0.1:9090", "localhost:9090", True),  # perhaps another server's
        ("http://localhost:3000", "robot.lan:9090", False),  # by a proxy, from another machine
        ("http://localhost:3000", "192.168.1.7:9090", False),
        ("http://localhost.evil.example", "localhost:9090", False),
        ("http://127.0.0.1.evil.example", "localhost:9090", False),
        ("http://evil.example#localhost", "localhost:9090", False),
        ("http://user@localhost:3000", "localhost:9090", False),
        ("http://127.0.0.2:3000", "localhost:9090", False),
        ("file://localhost", "localhost:9090", False),
        ("chrome-extension://localhost", "localhost:9090", False),
        ("null", "localhost:9090", False),
    ],
)
def test_a_page_of_another_server_on_this_machine_is_local(origin, host, is_local):
    rules = WebRules((*OWN, "robot.lan"), allows_local=True)
    assert rules.standing(origin, host, is_encrypted=False) == ("local" if is_local else "foreign")
    unwelcoming = WebRules((*OWN, "robot.lan"))
    assert unwelcoming.standing(origin, host, is_encrypted=False) == "foreign"


@pytest.mark.parametrize(
    ("allowed", "origin", "is_welcome"),
    [
        (("http://localhost:3000",), "http://localhost:3000", True),
        (("http://localhost:3000",), "http://localhost:3001", False),
        (("http://localhost:3000",), "https://localhost:3000", False),
        (("null",), "null", True),
        (("https://app.foxglove.dev",), "https://app.foxglove.dev", True),
        (("*",), "null", True),
        (("*",), "https://anything.example", True),
    ],
)
def test_an_allowed_page_is_welcome(allowed, origin, is_welcome):
    rules = WebRules(OWN, allowed_origins=allowed)
    standing = rules.standing(origin, "localhost:9090", is_encrypted=False)
    assert standing == ("trusted" if is_welcome else "foreign")


def test_the_setting_for_a_page_keeps_the_others():
    rules = WebRules(OWN, allowed_origins=("https://ui.example",))
    setting = rules.setting_for("http://localhost:3000")
    assert setting == "--set 'allowed_origins=https://ui.example,http://localhost:3000'"


def test_each_origin_is_refused_for_the_first_time_once_and_so_many_are_remembered():
    rules = WebRules(OWN)
    assert rules.first_refusal("http://a")
    assert not rules.first_refusal("http://a")
    firsts = sum(rules.first_refusal(f"http://{number}") for number in range(1000))
    assert firsts == 64 - 1
    assert rules.is_last_logged


@pytest.mark.parametrize(
    ("origin", "expected"),
    [
        ("http://localhost:3000", True),
        ("null", True),
        ("http://a b", False),
        ("http://a'", False),
        ("http://a\n", False),
        ("http://ä", False),
        ("http://a,http://b", False),
        ("http://" + "a" * 200, False),
    ],
)
def test_an_origin_is_shown_only_if_it_is_harmless_in_a_shell_and_a_log(origin, expected):
    assert is_plain(origin) is expected
