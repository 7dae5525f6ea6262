# SPDX-License-Identifier: Apache-2.0
"""Types of one name and two definitions, as REP-2011's hashes tell them apart.

DDS matches types by name alone, so samples of the other definition arrive, and are read wrongly.
"""

from collections.abc import Iterable
from typing import Final

from gateway.sources.rclpy.qos import Endpoint, introduced
from gateway.sources.source import TopicEvent

REMEDY: Final = "bring its package, or the folder in types.paths, to the same version everywhere"


def other_versions(
    topic: str, type_name: str, own_hash: str | None, endpoints: Iterable[Endpoint]
) -> list[TopicEvent]:
    """Describe the nodes whose type of this name has another hash, each once."""
    if own_hash is None:
        return []
    nodes = dict.fromkeys(
        endpoint.node
        for endpoint in introduced(endpoints)
        if endpoint.type_name == type_name and endpoint.type_hash not in {None, own_hash}
    )
    problem = f"has another definition of {type_name} than this gateway, so messages are misread"
    return [
        TopicEvent("type_conflict", f"topic {topic}: {node} {problem}", REMEDY, node)
        for node in nodes
    ]
