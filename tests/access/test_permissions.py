# SPDX-License-Identifier: Apache-2.0
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gateway.access.permissions import ACTIONS, SEND_GOAL, Permissions, Policy
from gateway.cli import arguments
from gateway.config.access import ROLES, AccessConfig, OperatorConfig, RoleConfig, ViewerConfig
from tests.access.test_globs import GLOBS, NAMES, takes

DEFAULT = Policy(AccessConfig())


def permissions(**rules) -> Permissions:
    nothing = dict.fromkeys(ACTIONS, ())
    return Permissions("viewer", RoleConfig(**{**nothing, **rules}))


@pytest.mark.parametrize(
    ("action", "name", "roles"),
    [
        ("subscribe", "/odom", ["viewer", "operator", "admin"]),
        ("publish", "/cmd_vel", ["operator", "admin"]),
        ("call", "/reset", ["operator", "admin"]),
        ("call", "/rosapi/topics", ["viewer", "operator", "admin"]),
        ("call", "/base/get_parameters", ["viewer", "operator", "admin"]),
        ("call", "/base/set_parameters", ["admin"]),
        ("call", "/ns/base/set_parameters_atomically", ["admin"]),
    ],
)
def test_by_default_viewers_look_operators_drive_and_admins_change_parameters(action, name, roles):
    assert DEFAULT.of("viewer").roles_that_may(action, name) == roles


@pytest.mark.parametrize(
    ("action", "name", "may"),
    [
        ("subscribe", "/odom", True),
        ("call", "/reset", True),
        ("call", f"/ns/dock{SEND_GOAL}", False),
        ("call", "/base/get_parameters", True),
        ("call", "/base/set_parameters", False),
        ("publish", "/cmd_vel", False),
    ],
)
def test_by_default_a_local_page_watches_and_calls(action, name, may):
    assert DEFAULT.of("page").may(action, name) is may
    assert "page" not in DEFAULT.of("page").roles_that_may(action, name)


@given(st.lists(GLOBS, max_size=3), st.lists(GLOBS, max_size=3), NAMES)
def test_a_deny_beats_every_allow(allow, deny, name):
    rules = permissions(publish=tuple(allow), deny_publish=tuple(deny))
    is_allowed = any(takes(glob, name) for glob in allow)
    is_denied = any(takes(glob, name) for glob in deny)
    assert rules.may("publish", name) == (is_allowed and not is_denied)
    assert not rules.may("subscribe", name)
    assert not rules.may("call", name)


@pytest.mark.parametrize("action", ACTIONS)
def test_a_name_is_seen_by_a_role_that_may_do_anything_with_it(action):
    rules = permissions(**{action: ("/a/**",)})
    assert rules.sees("/a/b")
    assert not rules.sees("/b")


def test_without_permission_for_an_action_its_services_are_denied_as_well():
    rules = permissions(call=("**",), subscribe=("**",), deny_call=("/dock",))
    assert not rules.may("call", "/dock")
    assert not rules.may("call", "/dock/_action/send_goal")
    assert rules.may("call", "/dock/other")
    assert permissions(call=("/dock",)).may("call", "/dock/_action/send_goal")


def test_only_a_role_without_bounds_is_unlimited():
    everything = dict.fromkeys(ACTIONS, ("**",))
    assert permissions(**everything).is_unlimited
    assert DEFAULT.of("admin").is_unlimited
    assert not DEFAULT.of("operator").is_unlimited
    for action in ACTIONS:
        assert not permissions(**everything, **{f"deny_{action}": ("/a",)}).is_unlimited
        assert not permissions(**{**everything, action: ("/a",)}).is_unlimited


def test_decisions_on_any_number_of_names_take_bounded_memory():
    rules = permissions(publish=("/a/**",))
    remembered = set()
    for number in range(10_000):
        rules.may("publish", f"/a/n{number}")
        remembered.add(len(rules._decided))
    assert max(remembered) == 4096
    assert rules.may("publish", "/a/n0")


def test_each_role_has_the_rules_that_are_configured_for_it():
    config = AccessConfig(
        viewer=ViewerConfig(subscribe=("/a",)),
        operator=OperatorConfig(subscribe=("/b",)),
        admin=RoleConfig(subscribe=("/c",)),
    )
    policy = Policy(config)
    viewer = policy.of("viewer")
    for role, name in zip(ROLES, ("/a", "/b", "/c"), strict=True):
        assert viewer.roles_that_may("subscribe", name) == [role]
        assert policy.of(role).may("subscribe", name)


def test_the_command_line_offers_every_role():
    assert arguments.ROLES == ROLES
