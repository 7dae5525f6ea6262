# SPDX-License-Identifier: Apache-2.0
"""The permissions of roles: what they may do, and with which names.

Names are resolved ones: a check on a name as a client wrote it could be evaded by another spelling.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import groupby
from types import MappingProxyType
from typing import Final, Literal

from gateway.config.access import ROLES, AccessConfig, AnyRole, Role, RoleConfig

_ANY_SEGMENT = "/[^/]+"
_SEGMENT_ENDS = "(?![^/])"

Action = Literal["subscribe", "publish", "call"]
ACTIONS: Final[tuple[Action, ...]] = ("subscribe", "publish", "call")

# rcl offers an action as services and topics below this part of its name
_BEHIND_ACTION: Final = "/_action/"
SEND_GOAL: Final = f"{_BEHIND_ACTION}send_goal"  # sending a goal calls this service
# Decisions that are kept, by action and name: those of a large robot. A client can make up any
# number of names, so the memory is limited.
MAX_REMEMBERED: Final = 4096


class Permissions:
    """The permissions of one role. *all_roles* are those of every role."""

    def __init__(
        self,
        role: AnyRole,
        rules: RoleConfig,
        all_roles: Mapping[AnyRole, "Permissions"] = MappingProxyType({}),
    ) -> None:
        self.role = role
        self.rules = rules
        self._all_roles = all_roles
        self._allowed = {action: compile_globs(getattr(rules, action)) for action in ACTIONS}
        self._denied = {
            action: compile_globs(getattr(rules, f"deny_{action}")) for action in ACTIONS
        }
        self._decided: dict[tuple[Action, str], bool] = {}

    @property
    def is_unlimited(self) -> bool:
        """True if the role may do everything, so that nothing needs to be checked."""
        return self.rules.record and all(
            "**" in getattr(self.rules, action) and not getattr(self.rules, f"deny_{action}")
            for action in ACTIONS
        )

    def may(self, action: Action, name: str) -> bool:
        """Return whether the role may do this with a resolved name."""
        decided = self._decided.get((action, name))
        if decided is None:
            if len(self._decided) >= MAX_REMEMBERED:
                self._decided.clear()
            decided = self._decided[action, name] = self._decide(action, name)
        return decided

    def sees(self, name: str) -> bool:
        """Return whether a name exists for this role: it may do anything at all with it."""
        return any(self.may(action, name) for action in ACTIONS)

    def roles_that_may(self, action: Action, name: str) -> list[Role]:
        """List the roles that may do this, of those that can be given."""
        all_roles = self._all_roles
        return [role for role in ROLES if role in all_roles and all_roles[role].may(action, name)]

    def roles_that_record(self) -> list[Role]:
        """List the roles that may record."""
        return [role for role in ROLES if self._all_roles[role].rules.record]

    def _decide(self, action: Action, name: str) -> bool:
        # without permission for an action, a client must not reach its internal services
        names = {name, name.partition(_BEHIND_ACTION)[0] or name}
        allowed, denied = self._allowed[action], self._denied[action]
        if allowed is None or (denied is not None and any(map(denied.fullmatch, names))):
            return False
        return any(map(allowed.fullmatch, names))


class Policy:
    """The permissions of all roles."""

    def __init__(self, config: AccessConfig) -> None:
        self._by_role: dict[AnyRole, Permissions] = {}
        every: tuple[AnyRole, ...] = ("page", *ROLES)
        for role in every:
            self._by_role[role] = Permissions(role, config.rules(role), self._by_role)

    def of(self, role: AnyRole) -> Permissions:
        """Return the permissions of a role."""
        return self._by_role[role]


@dataclass(frozen=True, slots=True)
class Identity:
    """A client: its name for people, and what it may do."""

    name: str  # of its token, or `anonymous`
    permissions: Permissions
    digest: bytes | None = None  # of its token, if it has one

    @property
    def role(self) -> AnyRole:
        """The role."""
        return self.permissions.role


def compile_globs(globs: Iterable[str]) -> re.Pattern[str] | None:
    """Return a pattern whose `fullmatch` accepts the names that any of the globs accepts.

    ``*`` stands for any characters of one segment. ``**`` is a segment by itself: between others
    it stands for any number of segments, also none, and at the end for one or more. Return
    ``None`` if there are no globs: nothing matches.
    """
    patterns = [_pattern(glob) for glob in globs]
    return re.compile("|".join(patterns)) if patterns else None


def _pattern(glob: str) -> str:
    """Translate a glob.

    The text between two wildcards matches at its first place, which is never wrong. The groups
    are atomic, so that the cost of a name is proportional to its length.
    """
    segments = ("/**" if glob == "**" else glob).split("/")[1:]
    runs = [(is_deep, list(run)) for is_deep, run in groupby(segments, lambda each: each == "**")]
    pattern = ""
    for number, (is_deep, run) in enumerate(runs):
        is_last = number == len(runs) - 1
        if is_deep:
            pattern += f"(?:{_ANY_SEGMENT})+" if is_last else ""
            continue
        text = "".join(f"/{_segment(each)}{_SEGMENT_ENDS}" for each in run)
        if number == 0:
            pattern += text
        elif is_last:
            pattern += f"(?:{_ANY_SEGMENT})*{text}"
        else:
            pattern += f"(?>(?:{_ANY_SEGMENT})*?{text})"
    return pattern


def _segment(segment: str) -> str:
    first, *others = map(re.escape, re.split(r"\*+", segment))
    if not others:
        return first
    between = "".join(f"(?>[^/]*?{text})" for text in others[:-1])
    return f"{first}{between}[^/]*{others[-1]}"


# of every client, if the gateway keeps none out
UNLIMITED: Final = Identity("anonymous", Permissions("admin", RoleConfig()))
