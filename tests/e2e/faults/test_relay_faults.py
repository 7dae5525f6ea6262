# SPDX-License-Identifier: Apache-2.0
"""A robot that is driven through a relay stops in time, whatever dies, hangs or is cut off.

Viewer, relay, router and robot have a network each. All is measured at the robot.
"""

import asyncio
import contextlib
import signal
import time
from asyncio.subprocess import Process
from collections.abc import AsyncIterator, Callable, Iterator
from dataclasses import dataclass, field

import pytest
import pytest_asyncio

pytest.importorskip("zenoh")

from tests.e2e.faults import networks, scene
from tests.e2e.faults.conftest import REPEAT
from tests.e2e.faults.networks import Machines
from tests.e2e.faults.scene import Base, Gateway, until_it_moves
from tests.e2e.faults.test_faults import DEADLINE_S, injected, stopped

NO_NETWORKS = networks.reason_against()
pytestmark = [
    pytest.mark.asyncio(loop_scope="module"),
    pytest.mark.timeout(3600),
    pytest.mark.long,
    pytest.mark.skipif(NO_NETWORKS is not None, reason=NO_NETWORKS or ""),
]

REPETITIONS = range(REPEAT)
LINKS = [("viewer", "relay"), ("relay", "router"), ("router", "robot")]
STALLS_S = (0.3, 0.8, 1.5, 4.0)
QUIET_S = 1.0
OPEN = ("--host", "0.0.0.0", "--no-auth", "--anyone-may-drive", "--set", "discoverable=false")  # noqa: S104


@dataclass
class Chain:
    """The programs between the viewer and the robot."""

    machines: Machines
    base: Base
    robot: Gateway
    parts: dict[str, Process] = field(default_factory=dict)

    @property
    def router_address(self) -> str:
        return f"tcp/{self.machines.address('router', 'relay')}:7447"

    @contextlib.asynccontextmanager
    async def router(self) -> AsyncIterator[None]:
        enter = self.machines.enter["router"]
        command = ("tests.e2e.faults.zenoh_router", "tcp/0.0.0.0:7447")
        async with scene.process(*command, before=enter) as process:
            assert await scene.line(process) == "ready\n"
            self.parts["router"] = process
            yield

    @contextlib.asynccontextmanager
    async def relay(self) -> AsyncIterator[int]:
        """Run a relay, and yield its port."""
        enter = self.machines.enter["relay"]
        arguments = (self.router_address, *OPEN, "--set", "relay.drain_s=0")
        async with scene.gateway(*arguments, before=enter, command="relay") as relay:
            self.parts["relay"] = relay.process
            yield relay.port

    @contextlib.asynccontextmanager
    async def viewer(self, port: int) -> AsyncIterator[None]:
        url = f"ws://{self.machines.address('relay', 'viewer')}:{port}/r1/"
        async with scene.operator(url, self.machines.enter["viewer"]) as process:
            self.parts["viewer"] = process
            await until_it_moves(self.base, process)
            yield


@pytest.fixture(scope="module")
def machines() -> Iterator[Machines]:
    with networks.machines() as machines:
        yield machines


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def chain(machines: Machines) -> AsyncIterator[Chain]:
    enter = machines.enter["robot"]
    router = f"tcp/{machines.address('router', 'robot')}:7447"
    uplink = ("--uplink", router, "--robot-name", "r1")
    async with scene.base(enter) as base, scene.gateway(*uplink, before=enter) as robot:
        yield Chain(machines, base, robot)


@contextlib.asynccontextmanager
async def driven(chain: Chain) -> AsyncIterator[Chain]:
    async with chain.router(), chain.relay() as port, chain.viewer(port):
        yield chain


@pytest.mark.parametrize("part", ["viewer", "relay", "router"])
async def test_a_part_that_is_killed_stops_the_robot(chain, measured, part):
    async with contextlib.AsyncExitStack() as kept:
        if part == "viewer":  # then the others go on
            await kept.enter_async_context(chain.router())
            port = await kept.enter_async_context(chain.relay())
        for _ in REPETITIONS:
            async with chain.viewer(port) if part == "viewer" else driven(chain):
                base, killed = chain.base, chain.parts[part]
                at_ns = await injected(base, chain.parts["viewer"], killed.kill)
                zero_ns = await stopped(base, at_ns)
                took_s = (zero_ns - at_ns) / 1e9
                measured(f"relay: {part} killed", took_s, after_s=DEADLINE_S, allowed_s=0.1)
                await asyncio.sleep(QUIET_S)
                assert base.moved_after(zero_ns) == []


@pytest.mark.parametrize("part", ["viewer", "relay", "router"])
async def test_a_part_that_is_frozen_stops_the_robot(chain, measured, part):
    async with driven(chain):
        frozen = chain.parts[part]
        for _ in REPETITIONS:
            await judge_silence(
                chain,
                measured,
                f"{part} frozen",
                lambda: frozen.send_signal(signal.SIGSTOP),
                lambda: frozen.send_signal(signal.SIGCONT),
            )


@pytest.mark.parametrize("link", LINKS, ids="-".join)
async def test_a_link_that_goes_black_stops_the_robot(chain, measured, link):
    async with driven(chain):
        cable = chain.machines.cables[link]
        for _ in REPETITIONS:
            await judge_silence(
                chain,
                measured,
                f"link {'-'.join(link)} black",
                lambda: cable.cut(is_cut=True),
                lambda: cable.cut(is_cut=False),
            )


async def judge_silence(
    chain: Chain, measured, name: str, begin: Callable[[], None], end: Callable[[], None]
) -> None:
    """Check that the robot stops in time, stays, and can be driven on at the end."""
    base, viewer = chain.base, chain.parts["viewer"]
    try:
        at_ns = await injected(base, viewer, begin)
        zero_ns = await stopped(base, at_ns)
    finally:
        end()
    took_s = (zero_ns - at_ns) / 1e9
    measured(f"relay: {name}", took_s, after_s=DEADLINE_S, allowed_s=0.1)
    await asyncio.sleep(QUIET_S)  # the operator pushes all the time
    assert base.moved_after(zero_ns) == []
    viewer.send_signal(signal.SIGUSR1)
    await until_it_moves(base, viewer, since_ns=time.monotonic_ns())


@pytest.mark.parametrize("stall_s", STALLS_S)
@pytest.mark.parametrize("link", LINKS, ids="-".join)
async def test_nothing_that_a_link_held_back_moves_the_robot(chain, measured, link, stall_s):
    async with driven(chain) as driven_:
        base, viewer = driven_.base, driven_.parts["viewer"]
        cable = driven_.machines.cables[link]
        for _ in REPETITIONS:
            try:
                at_ns = await injected(base, viewer, lambda c=cable: c.cut(is_cut=True))
                await asyncio.sleep(stall_s)
            finally:
                cable.cut(is_cut=False)
            await judge_stall(base, viewer, measured, f"link {'-'.join(link)}", at_ns, stall_s)


@pytest.mark.parametrize("stall_s", STALLS_S)
@pytest.mark.parametrize("part", ["viewer", "relay", "router"])
async def test_nothing_that_a_frozen_part_held_back_moves_the_robot(chain, measured, part, stall_s):
    async with driven(chain) as driven_:
        base, viewer, frozen = driven_.base, driven_.parts["viewer"], driven_.parts[part]
        for _ in REPETITIONS:
            at_ns = await injected(base, viewer, lambda f=frozen: f.send_signal(signal.SIGSTOP))
            await asyncio.sleep(stall_s)
            frozen.send_signal(signal.SIGCONT)
            await judge_stall(base, viewer, measured, part, at_ns, stall_s)


async def judge_stall(
    base: Base, viewer: Process, measured, name: str, at_ns: int, stall_s: float
) -> None:
    """Check that the robot stopped in time, and has not moved since.

    A stall that is shorter than the command timeout need not stop it.
    """
    await asyncio.sleep(QUIET_S)  # the operator pushes all the time
    zero_ns = base.zero_after(at_ns)
    if stall_s > DEADLINE_S or zero_ns is not None:
        assert zero_ns is not None
        took_s = (zero_ns - at_ns) / 1e9
        fault = f"relay: {name} stalls for {stall_s:g} s"
        measured(fault, took_s, after_s=DEADLINE_S, allowed_s=0.1)
        if stall_s > DEADLINE_S:  # a shorter one, on a machine that pauses, may look like two
            assert base.moved_after(zero_ns) == []
    viewer.send_signal(signal.SIGUSR1)
    await until_it_moves(base, viewer, since_ns=time.monotonic_ns())
