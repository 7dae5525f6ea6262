# SPDX-License-Identifier: Apache-2.0
"""Reports of nodes that have another definition of a type."""

from collections.abc import Iterable
from typing import Final

from gateway.sources.qos import Endpoint
from gateway.sources.source import TopicEvent

REMEDY: Final = "bring its package, or the folder in types.paths, to the same version everywhere"


def other_versions(
    topic: str, type_name: str, others: Iterable[Endpoint], effect: str
) -> list[TopicEvent]:
    """Describe each node that has one of these endpoints, and the effect."""
    problem = f"has another definition of {type_name} than this gateway, so {effect}"
    return [
        TopicEvent("type_conflict", f"topic {topic}: {node} {problem}", REMEDY, node)
        for node in dict.fromkeys(each.node for each in others)
    ]


def nobody(_: TopicEvent) -> None:
    """Hear of events that concern no client."""
