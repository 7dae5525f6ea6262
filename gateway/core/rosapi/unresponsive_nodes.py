# SPDX-License-Identifier: Apache-2.0
"""The nodes that did not answer the last time they were asked."""

from dataclasses import dataclass
from typing import Final

# So that a series of requests to a dead node does not wait for each of them, while a request after
# a pause is sent again.
FRESH_S: Final = 0.5
MAX_NODES: Final = 256  # names only. A graph with more dead nodes has other troubles


@dataclass(frozen=True, slots=True)
class _NodeTimeout:
    noticed_s: float
    waited_s: float


class UnresponsiveNodes:
    """Remembers unresponsive nodes until they answer. Times are seconds of any one clock."""

    def __init__(self) -> None:
        self._known: dict[str, _NodeTimeout] = {}

    def add(self, node: str, waited_s: float, now_s: float) -> None:
        """Note that a node did not answer for *waited_s*."""
        self._known.pop(node, None)
        self._known[node] = _NodeTimeout(
            now_s, waited_s
        )  # last in the order: the oldest goes first
        if len(self._known) > MAX_NODES:
            del self._known[next(iter(self._known))]

    def remove(self, node: str) -> None:
        """Note that a node answered."""
        self._known.pop(node, None)

    def has_just_timed_out(self, node: str, timeout_s: float, now_s: float) -> bool:
        """Return whether a request with this timeout or a longer one has just failed."""
        known = self._known.get(node)
        return (
            known is not None and timeout_s <= known.waited_s and now_s - known.noticed_s <= FRESH_S
        )

    def noticed_s(self, node: str) -> float:
        """Return the time of a node's last timeout, 0 for none, so that others are asked first."""
        known = self._known.get(node)
        return 0.0 if known is None else known.noticed_s
