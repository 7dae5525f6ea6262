# SPDX-License-Identifier: Apache-2.0
"""The shares of ROS entities that clients and addresses may have.

An entity that clients share counts for each of them: who uses it has a part in keeping it open, and
who opened it may have left. ROS clients that stay open for the next call count for nobody.
"""

from collections.abc import Sequence
from typing import Protocol

from gateway.config.limits import Limits
from gateway.core.errors import ProtocolError, over_limit
from gateway.core.session import Session


class EntityUser(Protocol):
    """A part of the router that opens ROS entities for sessions."""

    def count(self, session: Session) -> int:
        """Count the entities that a client uses in this part."""


class EntityShares:
    """Refuses a further entity to a client or an address that has its share."""

    def __init__(self, limits: Limits, parts: Sequence[EntityUser]) -> None:
        self._per_client = max(1, limits.max_ros_entities // 4)
        self._per_address = max(1, limits.max_ros_entities // 2)
        self._parts = parts
        self._addresses: dict[Session, str] = {}

    def enter(self, session: Session, address: str) -> None:
        """Count a client from now on."""
        self._addresses[session] = address

    def leave(self, session: Session) -> None:
        """Forget a client."""
        self._addresses.pop(session, None)

    def check(self, session: Session) -> None:
        """Check that a client may have one more.

        Raises:
            ProtocolError: ``limit_exceeded``.
        """
        if self._count(session) >= self._per_client:
            raise _too_many(self._per_client, "client")
        address = self._addresses.get(session)
        same = [other for other, at in self._addresses.items() if at == address]
        if sum(map(self._count, same)) >= self._per_address:
            raise _too_many(self._per_address, "address")

    def _count(self, session: Session) -> int:
        return sum(part.count(session) for part in self._parts)


def _too_many(limit: int, per: str) -> ProtocolError:
    what = f"ROS entities per {per}, of all kinds together"
    return over_limit(limit, what, "max_ros_entities")
