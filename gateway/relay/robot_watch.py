# SPDX-License-Identifier: Apache-2.0
"""The robots behind a Zenoh router: each has a liveliness token while its uplink is connected."""

import asyncio
import re
from collections.abc import Callable, Sequence
from typing import Any, Final

import zenoh

from gateway.config.zenoh import ROBOT_NAME
from gateway.faults import Fault
from gateway.sources.zenoh.session import close_session

PREFIX: Final = "gw"
ALIVE: Final = "alive"
_TOKEN: Final = re.compile(rf"{PREFIX}/([^/]+)/{ALIVE}")


def namespace_of(robot: str) -> str:
    """Return what comes before all keys of a robot."""
    return f"{PREFIX}/{robot}"


class RobotWatch:
    """Reports each robot that comes or goes, and ignores names that no robot may have."""

    def __init__(self, session: Any, on_robot: Callable[[str, bool], None]) -> None:
        """Watch on a session of Zenoh, which this closes."""
        loop = asyncio.get_running_loop()
        self._session = session

        def arrive(sample: Any) -> None:
            found = _TOKEN.fullmatch(str(sample.key_expr))
            if found is not None and re.fullmatch(ROBOT_NAME, found[1]):
                is_alive = sample.kind == zenoh.SampleKind.PUT
                loop.call_soon_threadsafe(on_robot, found[1], is_alive)

        liveliness = session.liveliness()
        self._watching = liveliness.declare_subscriber(f"{PREFIX}/*/{ALIVE}", arrive, history=True)

    @property
    def is_connected(self) -> bool:
        """True while the router answers."""
        return bool(self._session.info.routers_zid())

    def faults(self) -> Sequence[Fault]:
        """Return what is wrong."""
        if self.is_connected:
            return ()
        text = "the Zenoh router does not answer: start it, or check the network"
        return (Fault("not ready", text),)

    def close(self) -> None:
        """End the session."""
        close_session(self._session)
