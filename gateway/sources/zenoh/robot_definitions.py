# SPDX-License-Identifier: Apache-2.0
"""Definitions of types from the robot's nodes, which those of Humble do not have."""

from collections.abc import Callable, Mapping
from typing import Any, Final

from gateway.sources.node_definitions import NodeDefinitions
from gateway.sources.source import RosError
from gateway.sources.zenoh.token_graph import TokenGraph
from schemas.definition import Definition
from schemas.installed import InstalledDefinitions

_OF_HUMBLE: Final = "nodes of ROS 2 Humble have none to send: add its package to types.paths"


class RobotDefinitions(NodeDefinitions):
    """Asks nodes, as far as their tokens show hashes of types."""

    def __init__(
        self,
        source: Any,  # with services
        definitions: InstalledDefinitions,
        on_change: Callable[[], None],
        graph: TokenGraph,
        *,
        asks: bool,
    ) -> None:
        super().__init__(
            source, definitions, on_change, holders=graph.holders, make_types=_nothing_to_make
        )
        self._graph, self._asks = graph, asks

    async def of(self, type_name: str) -> Mapping[str, Definition] | None:
        """Return the definition of a type. See `gateway.sources.source.Source.definitions`."""
        found = await super().of(type_name) if self._asks else None
        is_known = found is not None or self._known_hash(type_name) is not None
        if not is_known and self._graph.has_without_hash(type_name):
            raise RosError("not_found", _OF_HUMBLE)
        return found


async def _nothing_to_make() -> None:
    """Use types at once: samples stay CDR here."""
