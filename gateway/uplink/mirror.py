# SPDX-License-Identifier: Apache-2.0
"""The robot's graph as tokens in the namespace of the robot: relays see its nodes as they are."""

import itertools
import logging
import re
from collections.abc import Callable, Iterable
from typing import Any, Final

from gateway.sources.zenoh.tokens import NodeToken, endpoint_token, gid_of
from gateway.uplink.offer import DOMAIN, Entity

# Of names that others cannot read, the first are in the log.
MAX_NAMED_ODD: Final = 8
_NAME: Final = re.compile(r"(?:/[A-Za-z_][A-Za-z0-9_]*)+", re.ASCII)

_logger: Final = logging.getLogger(__name__)


class Mirror:
    """Declares and withdraws tokens. *run* has a thread do that: the router may be slow."""

    def __init__(
        self, session: str, liveliness: Any, run: Callable[[Callable[[], object]], None]
    ) -> None:
        self._session, self._liveliness, self._run = session, liveliness, run
        self._ids = itertools.count()
        self._nodes: dict[str, NodeToken] = {}
        self._shown: dict[Entity, str] = {}  # the token of each
        self._odd: set[str] = set()
        self._gids: dict[str, list[bytes]] = {}  # by topic
        self._declared: dict[str, Any] = {}  # by token, of the thread alone

    def show(self, entities: Iterable[Entity]) -> None:
        """Show these and no others."""
        wanted = dict.fromkeys(entities)
        gone = [self._shown.pop(each) for each in list(self._shown) if each not in wanted]
        new = (each for each in wanted if each not in self._shown and self._is_readable(each))
        found = {each: self._token_of(each) for each in new}
        self._shown |= found
        if gone or found:
            self._gids = self._find_gids()
            self._run(lambda: self._change(list(found.values()), gone))

    def gids(self, topic: str) -> tuple[bytes, ...]:
        """Return the ids of the publishers that are shown on a topic."""
        return tuple(self._gids.get(topic, ()))

    def _find_gids(self) -> dict[str, list[bytes]]:
        gids: dict[str, list[bytes]] = {}
        for each, token in self._shown.items():
            if each.kind == "MP" and each.key is not None:
                gids.setdefault(each.key.name, []).append(gid_of(token))
        return gids

    def _is_readable(self, entity: Entity) -> bool:
        """Return whether others can read a token: a participant of DDS may have any name."""
        names = (entity.node, *(() if entity.key is None else (entity.key.name,)))
        odd = next((each for each in names if not _NAME.fullmatch(each)), None)
        if odd is not None and odd not in self._odd and len(self._odd) < MAX_NAMED_ODD:
            self._odd.add(odd)
            _logger.warning("not offered, because it is not a name of ROS: %r", odd[:120])
        return odd is None

    def _token_of(self, entity: Entity) -> str:
        node = self._nodes.get(entity.node)
        if node is None:
            number = next(self._ids)
            node = self._nodes[entity.node] = NodeToken(DOMAIN, self._session, number, entity.node)
        if entity.kind is None or entity.key is None or entity.qos is None:
            return node.text
        return endpoint_token(node, next(self._ids), entity.kind, entity.key, entity.qos)

    def _change(self, new: list[str], gone: list[str]) -> None:  # on the thread
        for token in new:
            self._declared[token] = self._liveliness.declare_token(token)
        for token in gone:
            self._declared.pop(token).undeclare()
