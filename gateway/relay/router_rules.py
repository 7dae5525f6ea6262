# SPDX-License-Identifier: Apache-2.0
"""The rules of a router: what robots and relays may do. Everything else is refused."""

from collections.abc import Mapping, Sequence
from typing import Any, Final

from gateway.relay.robot_watch import ALIVE, PREFIX, namespace_of
from gateway.relay.router_file import Credentials, RouterConfig

_IN: Final = ("ingress",)  # from the one whom the rule concerns
_OUT: Final = ("egress",)
_BOTH: Final = (*_IN, *_OUT)
_TOKENS: Final = ("liveliness_token", "declare_liveliness_subscriber", "liveliness_query")
_EVERYTHING: Final = (
    *("put", "delete", "declare_subscriber", "query", "reply", "declare_queryable"),
    *_TOKENS,
)

Rule = dict[str, Any]


def access_control(config: RouterConfig) -> dict[str, Any]:
    """Return the access control of Zenoh for the robots and relays of a file."""
    rules: list[Rule] = []
    policies: list[dict[str, Any]] = []
    for robot in config.robots:
        own = _robot_rules(robot)
        rules += own
        policies.append({"rules": [each["id"] for each in own], "subjects": [_robot(robot)]})
    if config.relays:
        shared = [rule for robot in config.robots for rule in _relay_rules(robot)]
        shared += _finding_robots()
        if config.relays_publish:
            shared += [_publishing(robot) for robot in config.robots]
        rules += shared
        subjects = [_relay(name) for name in config.relays]
        policies.append({"rules": [each["id"] for each in shared], "subjects": subjects})
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": rules,
        "subjects": [
            *_subjects({_robot(name): (name, each) for name, each in config.robots.items()}),
            *_subjects({_relay(name): (name, each) for name, each in config.relays.items()}),
        ],
        "policies": policies,
    }


def _robot(name: str) -> str:
    return f"robot {name}"


def _relay(name: str) -> str:
    return f"relay {name}"


def _subjects(named: Mapping[str, tuple[str, Credentials]]) -> Sequence[dict[str, Any]]:
    return [
        {"id": subject, "usernames": [name]}
        if isinstance(credentials, str)
        else {"id": subject, "cert_common_names": [credentials.certificate]}
        for subject, (name, credentials) in named.items()
    ]


def _rule(name: str, keys: Sequence[str], messages: Sequence[str], flows: Sequence[str]) -> Rule:
    return {
        "id": name,
        "permission": "allow",
        "key_exprs": list(keys),
        "messages": list(messages),
        "flows": list(flows),
    }


def _robot_rules(robot: str) -> Sequence[Rule]:
    """Let a robot do everything in its namespace."""
    own = namespace_of(robot)
    # ** leaves out what begins with @
    keys = (f"{own}/**", f"{own}/@ros2_lv/**", f"{own}/0/**/@adv/**")
    return [_rule(f"{robot}: itself", keys, _EVERYTHING, _BOTH)]


def _finding_robots() -> Sequence[Rule]:
    """Let relays see which robots are there."""
    keys = (f"{PREFIX}/*/{ALIVE}",)
    return [_rule("robots that are there", keys, _TOKENS[1:], _IN), _told("their tokens", keys)]


def _publishing(robot: str) -> Rule:
    """Let relays publish on topics of a robot, which other relays then hear as well."""
    keys = (f"{namespace_of(robot)}/0/*/**",)
    return _rule(f"{robot}: publish", keys, ("put", "declare_subscriber"), _BOTH)


def _told(name: str, keys: Sequence[str]) -> Rule:
    return _rule(name, keys, _TOKENS[:1], _OUT)


def _relay_rules(robot: str) -> Sequence[Rule]:
    """Let relays see a robot, call its services, and hand over commands, which the robot judges.

    A subscription to ``**`` is larger than any of the keys, so it is refused.
    """
    own = namespace_of(robot)
    kept = f"{own}/0/**/@adv/**"  # messages that latched topics keep
    seen = (f"{own}/0/*/**", f"{own}/beat", f"{own}/control/**", kept)
    asked = (f"{own}/0/*/**", f"{own}/lease", f"{own}/lease/**", kept)
    tokens = (f"{own}/@ros2_lv/**", f"{own}/client/**", kept)
    return [
        _rule(f"{robot}: subscribe", seen, ("declare_subscriber",), _IN),
        _rule(f"{robot}: data", seen, ("put", "delete"), _OUT),
        _rule(f"{robot}: ask", asked, ("query",), _IN),
        _rule(f"{robot}: answers", (f"{own}/0/**", *asked), ("reply", "declare_queryable"), _OUT),
        _rule(f"{robot}: tokens", tokens, _TOKENS, _BOTH),
        _rule(f"{robot}: commands", (f"{own}/cmd/**",), ("put",), _IN),
        _rule(f"{robot}: who takes commands", (f"{own}/cmd/**",), ("declare_subscriber",), _OUT),
    ]
