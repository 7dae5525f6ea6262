# SPDX-License-Identifier: Apache-2.0
"""Topic names as clients write them, and as ROS knows them."""

import re
from typing import Final, NewType

from gateway.codec.words import cut
from gateway.protocol.errors import ProtocolError

TopicName = NewType("TopicName", str)  # fully resolved: "/odom", never "odom"

# https://design.ros2.org/articles/topic_and_service_names.html, fully qualified names only.
# `~`, `{node}` and remapping are left to nodes: a name means the same for every client.
_RESOLVED: Final = re.compile(r"(?:/[A-Za-z_][A-Za-z0-9_]*)+", re.ASCII)


def resolve_topic(name: str, max_characters: int) -> TopicName:
    """Return the full name of a topic; a name without a leading slash is global.

    Raises:
        ProtocolError: the name is none, or too long.
    """
    if len(name) > max_characters:
        raise ProtocolError(
            "bad_name", f"topic: {len(name)} characters, at most {max_characters} allowed"
        )
    resolved = name if name.startswith("/") else f"/{name}"
    if not _RESOLVED.fullmatch(resolved):
        raise ProtocolError(
            "bad_name",
            f"topic: {cut(name)!r} is no topic name: expected letters, digits and _ between"
            " slashes, no part starting with a digit",
        )
    return TopicName(resolved)
