# SPDX-License-Identifier: Apache-2.0
"""An uplink of a gateway over the fake ROS, and relays: sources of Zenoh behind a real router."""

import contextlib
from collections.abc import AsyncIterator
from dataclasses import dataclass, field
from typing import Any

import pytest

from gateway.access.permissions import Policy
from gateway.config.access import AccessConfig
from gateway.config.control import ControlConfig
from gateway.config.model import Config
from gateway.config.zenoh import UplinkConfig
from gateway.sources.options import RosOptions
from gateway.sources.zenoh.port import ZenohSource
from gateway.uplink.uplink import Uplink, uplinked
from tests.client import eventually
from tests.core.conftest import Bench, bench  # noqa: F401  # a fixture
from tests.sources.test_contract import Received
from tests.sources.zenoh.conftest import open_source_on
from tests.sources.zenoh.outside import Router, free_port


@dataclass
class Fleet:
    """A robot that is offered as r1, its router, and the relays behind that."""

    bench: Bench
    stack: contextlib.AsyncExitStack
    router: Router = field(default_factory=Router)

    async def uplink(self, *, topics: tuple[str, ...] = ("/cmd_vel",), **settings: Any) -> Uplink:
        """Begin an uplink."""
        config = Config(
            control=ControlConfig(topics=topics),
            uplink=UplinkConfig(
                **{"endpoint": self.router.address, "robot_name": "r1", **settings}
            ),
        )
        opening = uplinked(self.bench.router, self.bench.types, config, Policy(AccessConfig()))
        return await self.stack.enter_async_context(opening)

    async def offered(self, **settings: Any) -> Uplink:
        """Begin an uplink, and wait until it works."""
        uplink = await self.uplink(**settings)
        await eventually(lambda: uplink.link is not None and not uplink.faults())
        return uplink

    def relay(self, prefix: str = "relay") -> ZenohSource:
        """Open the source of a relay."""
        options = RosOptions(domain_id=0, node_prefix=prefix)
        return self.stack.enter_context(
            open_source_on(self.router.address, options, namespace="gw/r1")
        )

    async def restart_router(self) -> None:
        """Let the router end, and another one begin at its address."""
        port = int(self.router.address.rpartition(":")[2])
        self.router.close()
        self.router = Router(port)


def watched(source: ZenohSource, topic: str, type_name: str) -> tuple[Received, Any]:
    """Subscribe as a relay does for a viewer."""
    from gateway.sources.source import Qos

    received = Received()
    return received, source.subscribe(
        topic, type_name, Qos(), received.on_samples, received.on_event
    )


@pytest.fixture
async def fleet(bench: Bench) -> AsyncIterator[Fleet]:  # noqa: F811
    async with contextlib.AsyncExitStack() as stack:
        made = Fleet(bench, stack)
        stack.callback(lambda: made.router.close())
        yield made


__all__ = ["Fleet", "free_port", "watched"]
