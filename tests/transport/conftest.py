# SPDX-License-Identifier: Apache-2.0
"""The server on a real socket, with ROS in memory below it."""

import asyncio
import contextlib
import ssl
from collections.abc import AsyncIterator, Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass
from typing import Any

import pytest
import uvloop
from blockbuster import blockbuster_ctx

from gateway.access.web_rules import WebRules
from gateway.codec.types import Types
from gateway.config.limits import Limits
from gateway.core.router import Router
from gateway.fronts.pictures.front import Pictures
from gateway.fronts.rosbridge.front import RosbridgeFront
from gateway.transport.front import Fronts
from gateway.transport.http import own_names
from gateway.transport.listening import ListenPort
from gateway.transport.server import Server
from schemas.folders import SHIPPED
from schemas.installed import InstalledDefinitions
from schemas.table import Table
from tests.sources.fake import FakeRos


@dataclass(frozen=True)
class Served:
    """A server, its port, and the parts below it."""

    server: Server
    ros: FakeRos
    types: Types
    port: int
    pictures: Pictures

    @property
    def url(self) -> str:
        return f"ws://127.0.0.1:{self.port}/"

    def cdr(self, type_name: str, **values: Any) -> bytes:
        message_type = self.types.get(type_name)
        return message_type.encode(values, now_ns=0)

    @property
    def clients(self) -> int:
        return self.server.health()["clients"]


TABLE = Table.load()

Serve = Callable[..., AbstractAsyncContextManager[Served]]


# the tests of sockets: transports of asyncio and uvloop differ
BOTH_LOOPS = ("batches", "end", "lan_discovery", "picture_streams", "server", "tls")


def pytest_asyncio_loop_factories(item: pytest.Item) -> dict[str, Callable[[], Any]]:
    """Run tests on the loop of the gateway, and those of sockets on asyncio's as well."""
    loops = {"uvloop": uvloop.new_event_loop}
    if item.path.stem.removeprefix("test_") in BOTH_LOOPS:
        loops["asyncio"] = asyncio.new_event_loop
    return loops


@pytest.fixture(autouse=True)
def no_blocking_calls() -> Iterator[None]:
    """Fail every test in which something on the loop waits for a disk or a socket."""
    with blockbuster_ctx("gateway") as calls:
        for call in calls.functions.values():
            # a definition is read when its type is first used (about 0.1 ms), and then kept
            call.can_block_in("schemas/installed.py", {"_read", "_installed_place"})
        yield


@pytest.fixture
def serve() -> Serve:
    """Return a function that opens a server with some limits or options changed."""

    @contextlib.asynccontextmanager
    async def open_server(
        limits: dict[str, Any] | None = None,
        allowed_origins: tuple[str, ...] = (),
        allows_local: bool = False,
        tls: ssl.SSLContext | None = None,
        **options: Any,
    ) -> AsyncIterator[Served]:
        ros = FakeRos()
        types = Types(InstalledDefinitions(folders=[SHIPPED]))
        rules = WebRules(own_names(), (), allowed_origins, allows_local=allows_local)
        all_limits = Limits(**{"max_clients": 8, "max_clients_per_address": 8, **(limits or {})})
        with ThreadPoolExecutor(2) as workers:
            router = Router(ros, types, TABLE, limits=all_limits, workers=workers, version="test")
            pictures = Pictures(router)
            server = Server(
                router,
                Fronts(RosbridgeFront(router)),
                pictures,
                limits=all_limits,
                web_rules=rules,
                **options,
            )
            async with server.listening(["127.0.0.1"], ListenPort(0, tls)) as (((_, port),),):
                yield Served(server, ros, types, port, pictures)
            assert server.health()["clients"] == 0
            router.close()
            assert ros.entity_count() == 0

    return open_server
