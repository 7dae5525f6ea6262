# SPDX-License-Identifier: Apache-2.0
"""A router over the fake ROS, and clients without sockets."""

import asyncio
import contextlib
import json
from collections.abc import AsyncIterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any

import pytest

from gateway.access.permissions import UNLIMITED, Identity
from gateway.codec.types import Types
from gateway.config.limits import Limits
from gateway.core.errors import Level, ProtocolError
from gateway.core.peer import ClientTurns, Peer
from gateway.core.requests import Request
from gateway.core.router import Router
from gateway.core.session import Session
from gateway.fronts.rosbridge.front import RosbridgeFront
from gateway.fronts.rosbridge.session import RosbridgeSession
from gateway.sources.guard import Guard
from gateway.sources.source import Qos
from schemas.folders import SHIPPED
from schemas.installed import InstalledDefinitions
from schemas.table import Table
from tests.client import Frame, eventually
from tests.sources.fake import FakeRos
from tests.wire import unpacked

FIBONACCI = "test_msgs/action/Fibonacci"
GRID = "nav_msgs/msg/OccupancyGrid"
IMAGE = "sensor_msgs/msg/Image"
ODOMETRY = "nav_msgs/msg/Odometry"
SCAN = "sensor_msgs/msg/LaserScan"
SET_BOOL = "std_srvs/srv/SetBool"
STRING = "std_msgs/msg/String"
TRIGGER = "std_srvs/srv/Trigger"
TWIST = "geometry_msgs/msg/Twist"
LIMITS = Limits(max_subscriptions=4, max_advertisements=3)


@dataclass(frozen=True)
class LoneCore:
    """The part of the router that a session needs, for one that is alone."""

    limits: Limits = field(default_factory=Limits)
    image_format: str = "jpeg"

    def check_share(self, session: Session) -> None:
        pass

    def is_driven_by(self, session: Session) -> bool:
        return False

    def record_forbidden(self, session: Session, error: ProtocolError, request: Request) -> None:
        pass


def lone_session(limits: Limits | None = None, **of_peer: Any) -> RosbridgeSession:
    """Return a session without a router."""
    peer = Peer(wake=lambda: None, **of_peer)
    return RosbridgeSession(LoneCore(limits or Limits()), peer)


class Socketless:
    """A client whose frames are taken from its outbox as soon as it is woken."""

    def __init__(
        self,
        front: RosbridgeFront,
        address: str,
        identity: Identity | None = UNLIMITED,
        level: Level | None = "warning",
        **of_peer: Any,
    ) -> None:
        self.front = front
        self.router = front.core
        self.frames: list[Frame] = []
        self.wires: list[bytes] = []
        self.is_paused = False
        self.is_flushing = False
        self.turns: Any = ClientTurns()  # a test replaces what it asks for
        self.session: RosbridgeSession = front.open(
            Peer(
                wake=self.flush,
                address=address,
                identity=identity,
                level=level,  # None: it is a client of rosbridge
                turns=self.turns,
                **of_peer,
            )
        )

    def flush(self) -> None:
        if self.is_flushing:  # as a connection does: rendering may report an error
            return
        self.is_flushing = True
        outbox = self.session.outbox
        while not self.is_paused and ((batch := outbox.take(1 << 20)) or outbox.has_control):
            self.wires += batch
            self.frames += unpacked(b"".join(batch))  # a large frame comes in pieces
        self.is_flushing = False

    def resume(self) -> None:
        self.is_paused = False
        self.flush()

    def send(self, **operation: Any) -> None:
        self.send_raw(json.dumps(operation).encode())

    def send_raw(self, data: bytes) -> None:
        self.front.receive(self.session, data)

    def of(self, op: str) -> list[Frame]:
        return [frame for frame in self.frames if frame["op"] == op]

    @property
    def messages(self) -> list[Any]:
        return [frame["msg"] for frame in self.of("publish")]

    @property
    def statuses(self) -> list[tuple[str, str]]:
        return [(frame["code"], frame["msg"]) for frame in self.of("status")]

    async def sees(self, count: int, op: str = "publish") -> list[Frame]:
        await eventually(lambda: len(self.of(op)) >= count)
        return self.of(op)

    async def sees_id(self, request_id: str | int) -> None:
        """Wait for the answer to a request."""
        await eventually(lambda: any(frame.get("id") == request_id for frame in self.frames))


class Bench:
    """The router under test, the ROS below it, clients above."""

    def __init__(self, ros: FakeRos, router: Router, types: Types) -> None:
        self.ros = ros
        self.router = router
        self.front = RosbridgeFront(router)
        self.types = types

    def client(
        self,
        address: str = "127.0.0.1",
        *,
        identity: Identity | None = UNLIMITED,
        level: Level | None = "warning",
        **of_peer: Any,
    ) -> Socketless:
        return Socketless(self.front, address, identity, level, **of_peer)

    def sender(self, **operation: Any) -> Socketless:
        """Return a client that begins with an operation."""
        client = self.client()
        client.send(**operation)
        return client

    def listener(
        self,
        topic: str,
        type_name: str,
        qos: Qos | None = None,
        **options: Any,
    ) -> Socketless:
        """Return a client that has subscribed to a topic which a node publishes."""
        self.ros.add_publisher(topic, type_name, qos or Qos())
        return self.sender(op="subscribe", topic=topic, **options)

    def say(self, topic: str, *texts: str) -> None:
        """Let a node publish strings."""
        for text in texts:
            self.ros.publish(topic, self.cdr("std_msgs/msg/String", data=text))

    def cdr(self, type_name: str, **values: Any) -> bytes:
        message_type = self.types.get(type_name)
        return message_type.encode(values, now_ns=0)

    async def settle(self) -> None:
        """Let everything that the fake has scheduled happen."""
        for _ in range(20):
            await asyncio.sleep(0)


@contextlib.asynccontextmanager
async def open_bench(guard: Guard | None = None, **settings: Any) -> AsyncIterator[Bench]:
    """Open one, with more arguments for the router."""
    types = Types(InstalledDefinitions(folders=[SHIPPED]))
    ros = FakeRos(types=types, guard=guard)
    with ThreadPoolExecutor(2) as workers:
        table, shared = Table.load(), {"workers": workers, "version": "test"}
        router = Router(ros, types, table, limits=LIMITS, **shared, **settings)
        yield Bench(ros, router, types)
        router.close()
        ros.told.close()
        assert ros.entity_count() == 0


@pytest.fixture
async def bench() -> AsyncIterator[Bench]:
    async with open_bench() as bench:
        yield bench


@pytest.fixture
async def empty() -> AsyncIterator[Bench]:
    """Yield another one, to compare with."""
    async with open_bench() as bench:
        yield bench
