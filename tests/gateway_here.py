# SPDX-License-Identifier: Apache-2.0
"""The gateway with real ROS and sockets in this process, where a test can trace and replace."""

import contextlib
from collections.abc import AsyncIterator
from concurrent.futures import ThreadPoolExecutor

from gateway.codec.types import Types
from gateway.config.limits import Limits
from gateway.core.router import Router
from gateway.fronts.rosbridge.front import RosbridgeFront
from gateway.sources.rclpy import open_ros
from gateway.transport.front import Fronts
from gateway.transport.listening import ListenPort
from gateway.transport.server import Server
from schemas.installed import InstalledDefinitions
from schemas.table import Table


@contextlib.asynccontextmanager
async def gateway_here(limits: Limits) -> AsyncIterator[str]:
    """Serve, and yield the URL."""
    async with open_ros() as ros:
        with ThreadPoolExecutor(1) as workers:
            types = Types(InstalledDefinitions())
            router = Router(ros, types, Table.load(), limits=limits, workers=workers, version="t")
            server = Server(router, Fronts(RosbridgeFront(router)), limits=limits)
            async with server.listening(["127.0.0.1"], ListenPort(0)) as (((_, port),),):
                yield f"ws://127.0.0.1:{port}/"
            router.close()
