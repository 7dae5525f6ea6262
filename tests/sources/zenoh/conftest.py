# SPDX-License-Identifier: Apache-2.0
"""A robot that speaks Zenoh, and the gateway's source next to it."""

import contextlib
from collections.abc import Iterator

from gateway.sources.options import RosOptions
from gateway.sources.zenoh.options import ZenohOptions
from gateway.sources.zenoh.port import ZenohSource
from gateway.sources.zenoh.session import open_session
from schemas.installed import InstalledDefinitions
from tests.sources.zenoh.outside import DOMAIN, Router
from tests.sources.zenoh.world_actions import ZenohRobot

OPTIONS = RosOptions(domain_id=DOMAIN)


@contextlib.contextmanager
def open_source_on(
    router: str, options: RosOptions = OPTIONS, namespace: str = ""
) -> Iterator[ZenohSource]:
    """Open the source on a router that runs."""
    session = open_session(ZenohOptions(router, namespace=namespace))
    with contextlib.closing(ZenohSource(session, options, InstalledDefinitions())) as source:
        yield source


@contextlib.contextmanager
def open_robot(options: RosOptions = OPTIONS) -> Iterator[tuple[ZenohSource, ZenohRobot]]:
    """Open a router, a node, and the source."""
    with contextlib.ExitStack() as stack:
        router = stack.enter_context(contextlib.closing(Router()))
        world = stack.enter_context(contextlib.closing(ZenohRobot(router.address)))
        yield stack.enter_context(open_source_on(router.address, options)), world
