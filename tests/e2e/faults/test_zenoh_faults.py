# SPDX-License-Identifier: Apache-2.0
"""The robot stops in time over Zenoh as over DDS, whatever dies, hangs or is cut off."""

import asyncio
import contextlib
import os
import signal
import time
from collections.abc import AsyncIterator, Iterator

import pytest
import pytest_asyncio

from tests.e2e.faults import scene
from tests.e2e.faults.conftest import REPEAT
from tests.e2e.faults.processes import guard_of, is_running
from tests.e2e.faults.scene import Base, Gateway, until, until_it_moves
from tests.e2e.faults.test_faults import DEADLINE_S, injected, stopped
from tests.sources.zenoh.outside import DOMAIN, Router

pytestmark = [
    pytest.mark.asyncio(loop_scope="module"),
    pytest.mark.timeout(3600),
    pytest.mark.long,
]

REPETITIONS = range(REPEAT)


@pytest.fixture(scope="module")
def router() -> Iterator[Router]:
    with contextlib.closing(Router()) as router:
        yield router


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def robot(router: Router) -> AsyncIterator[Base]:
    command = ("tests.e2e.faults.zenoh_robot", router.address)
    async with scene.base(command=command) as robot:
        yield robot


@contextlib.asynccontextmanager
async def driven(
    robot: Base, address: str
) -> AsyncIterator[tuple[Gateway, asyncio.subprocess.Process]]:
    arguments = ("--zenoh", address, "--domain-id", str(DOMAIN))
    async with scene.gateway(*arguments) as own, scene.operator(own.url) as driver:
        await until_it_moves(robot, driver)
        yield own, driver


@pytest.mark.parametrize(
    ("number", "name", "allowed_s"),
    [(signal.SIGTERM, "SIGTERM", 0.1), (signal.SIGKILL, "SIGKILL", 0.2)],
)
async def test_a_gateway_that_is_ended_stops_the_robot(
    robot, router, measured, number, name, allowed_s
):
    for _ in REPETITIONS:
        async with driven(robot, router.address) as (own, driver):
            guard = guard_of(own)
            at_ns = await injected(robot, driver, lambda o=own: o.process.send_signal(number))
            zero_ns = await stopped(robot, at_ns)
            measured(f"Zenoh: gateway {name}", (zero_ns - at_ns) / 1e9, allowed_s=allowed_s)
            await own.process.wait()
            await until(lambda g=guard: not is_running(g))
            assert robot.moved_after(zero_ns) == []


@pytest.mark.parametrize(
    ("number", "name"),
    [
        (signal.SIGSTOP, "gateway frozen"),
        (signal.SIGRTMIN + 1, "event loop blocked"),
        (signal.SIGRTMIN + 2, "GIL held"),
    ],
)
async def test_a_gateway_that_hangs_stops_the_robot_and_does_not_move_it_afterwards(
    robot, router, measured, number, name
):
    async with driven(robot, router.address) as (own, driver):
        for _ in REPETITIONS:
            at_ns = await injected(robot, driver, lambda o=own: o.process.send_signal(number))
            zero_ns = await stopped(robot, at_ns)
            took_s = (zero_ns - at_ns) / 1e9
            measured(f"Zenoh: {name}", took_s, after_s=DEADLINE_S, allowed_s=0.15)
            await asyncio.sleep(1)
            own.process.send_signal(signal.SIGCONT)
            await asyncio.sleep(2)
            assert robot.moved_after(zero_ns) == []
            driver.send_signal(signal.SIGUSR1)


async def test_a_guard_that_is_killed_stops_the_robot_until_another_one_is_there(
    robot, router, measured
):
    for _ in REPETITIONS:
        async with driven(robot, router.address) as (own, driver):
            guard = guard_of(own)
            at_ns = await injected(robot, driver, lambda g=guard: os.kill(g, signal.SIGKILL))
            zero_ns = await stopped(robot, at_ns)
            measured("Zenoh: guard killed", (zero_ns - at_ns) / 1e9, allowed_s=0.1)
            driver.send_signal(signal.SIGUSR1)
            await until_it_moves(robot, driver)
            assert guard_of(own) != guard


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP], ids=["killed", "frozen"])
async def test_a_client_that_ends_or_hangs_stops_the_robot(robot, router, measured, number):
    for _ in REPETITIONS:
        async with driven(robot, router.address) as (_, driver):
            at_ns = await injected(robot, driver, lambda d=driver: d.send_signal(number))
            took_s = (await stopped(robot, at_ns) - at_ns) / 1e9
            after_s = DEADLINE_S if number is signal.SIGSTOP else 0.0
            measured("Zenoh: client ends", took_s, after_s=after_s, allowed_s=0.1)


@pytest.mark.parametrize("dark_s", [1.0, 4.0])
async def test_commands_that_a_link_to_the_router_held_back_do_not_move_the_robot_later(
    robot, router, measured, dark_s
):
    """Nothing reaches the robot while the link is black: then only its own timeout stops it."""
    port = router.address.rpartition(":")[2]
    for _ in REPETITIONS:
        async with scene.process("tests.e2e.faults.link", "127.0.0.1", port) as cable:
            address = f"tcp/127.0.0.1:{int(await scene.line(cable))}"
            async with driven(robot, address) as (_, driver):
                at_ns = await injected(robot, driver, lambda c=cable: c.send_signal(signal.SIGSTOP))
                await asyncio.sleep(dark_s)
                back_ns = time.monotonic_ns()
                cable.send_signal(signal.SIGCONT)
                await asyncio.sleep(1.5)  # the operator pushes all the time
                late = robot.moved_after(back_ns)
                lasted_s = (max(late, default=back_ns) - back_ns) / 1e9
                measured(f"Zenoh: router black for {dark_s:g} s", lasted_s, allowed_s=0.2)
                assert not late or robot.zero_after(late[-1]) is not None
                driver.send_signal(signal.SIGUSR1)
                await until_it_moves(robot, driver, since_ns=at_ns)
