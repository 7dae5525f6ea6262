# SPDX-License-Identifier: Apache-2.0
"""A warning of nodes that share their full name: a second robot, or a second gateway.

ROS lets them, and nothing distinguishes them afterwards: parameters are set on either, and a robot
drives by the commands that were meant for the other.
"""

import asyncio
import logging
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Sequence
from typing import Final

from gateway.sources.qos import UNKNOWN_NODE

# A killed node stays in the graph for 20 s. Next to its successor it does not count as a second
# one.
PERSISTS_S: Final = 30.0
MAX_NAMED: Final = 8  # names in a line, which people read. Robots of one kind share dozens

_logger = logging.getLogger(__name__)


class SameNames:
    """Looks at the names of nodes whenever the graph has changed. *read* returns them all.

    A node with one of the gateway's *own* names is another gateway's, and runs: discovery hears of
    no node that was killed before this process began.
    """

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        read: Callable[[], Iterable[str]],
        own: Collection[str] = (),
    ) -> None:
        self._loop = loop
        self._read = read
        self._own = frozenset(own)
        self._suspected: set[str] = set()
        self._warned: set[str] = set()
        self._timer: asyncio.TimerHandle | None = None

    @property
    def known(self) -> tuple[str, ...]:
        """The names that were warned of, and are shared still."""
        return tuple(sorted(self._warned))

    def look(self) -> None:
        """Begin to watch names that are shared now. Those watched already keep their time."""
        shared = self._shared()
        self._warned &= shared  # no more than there are. A name that comes back is reported again
        if (own := shared & self._own) and not self._warned & self._own:
            _warn(sorted(own))
        self._warned |= own
        if self._timer is None:
            self._suspect(shared - self._warned)

    def close(self) -> None:
        """End it. Nothing is logged afterwards."""
        if self._timer is not None:
            self._timer.cancel()

    def _suspect(self, names: set[str]) -> None:
        self._suspected = names
        self._timer = self._loop.call_later(PERSISTS_S, self._judge) if names else None

    def _judge(self) -> None:
        shared = self._shared()
        found = sorted(self._suspected & shared)
        if found:
            self._warned.update(found)
            _warn(found)
        self._suspect(shared - self._warned - self._own)

    def _shared(self) -> set[str]:
        # hidden nodes are those of tools, which come and go
        counts = Counter(each for each in self._read() if "/_" not in each and each != UNKNOWN_NODE)
        return {name for name, count in counts.items() if count > 1}


def _warn(names: Sequence[str]) -> None:
    more = f" and {len(names) - MAX_NAMED} more" if len(names) > MAX_NAMED else ""
    _logger.warning(
        "several nodes are named %s%s: a second robot or gateway in this domain? Give it"
        " another ROS_DOMAIN_ID or a namespace, a gateway another ros.node_prefix",
        ", ".join(names[:MAX_NAMED]),
        more,
    )
