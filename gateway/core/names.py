# SPDX-License-Identifier: Apache-2.0
"""Names of topics, services and actions: resolved from names as requested."""

import re
from functools import lru_cache
from typing import Final, Literal, NewType

from gateway.codec.error_text import truncate
from gateway.core.errors import ProtocolError

# fully resolved: "/odom", never "odom"
TopicName = NewType("TopicName", str)
ServiceName = NewType("ServiceName", str)
ActionName = NewType("ActionName", str)

# https://design.ros2.org/articles/topic_and_service_names.html, fully qualified names only.
# `~`, `{node}` and remapping are left to nodes: a name means the same for every client.
_RESOLVED: Final = re.compile(r"(?:/[A-Za-z_][A-Za-z0-9_]*)+", re.ASCII)


def resolve_topic(name: str, max_characters: int) -> TopicName:
    """Return the full name of a topic. A name without a leading slash is global.

    Raises:
        ProtocolError: the name is invalid or too long.
    """
    return TopicName(_resolve("topic", name, max_characters))


def resolve_service(name: str, max_characters: int) -> ServiceName:
    """Return the full name of a service. See `resolve_topic`."""
    return ServiceName(_resolve("service", name, max_characters))


def resolve_action(name: str, max_characters: int) -> ActionName:
    """Return the full name of an action. See `resolve_topic`."""
    return ActionName(_resolve("action", name, max_characters))


@lru_cache(maxsize=1024)  # a client names its topic in every message that it publishes
def _resolve(kind: Literal["topic", "service", "action"], name: str, max_characters: int) -> str:
    if len(name) > max_characters:
        raise ProtocolError(
            "bad_name",
            f"{kind}: {len(name)} characters, at most {max_characters} allowed"
            " (limits.max_name_characters)",
        )
    resolved = name if name.startswith("/") else f"/{name}"
    if not _RESOLVED.fullmatch(resolved):
        raise ProtocolError(
            "bad_name",
            f"{kind}: {truncate(name)!r} is not a valid {kind} name: use letters, digits, and _"
            " between slashes, and start no part with a digit",
        )
    return resolved
