# SPDX-License-Identifier: Apache-2.0
"""The robot stops in time, whatever dies, hangs or is cut off. Measured at the robot."""

import asyncio
import contextlib
import os
import signal
import ssl
import time
from collections.abc import AsyncIterator, Callable
from functools import partial
from pathlib import Path

import pytest
import pytest_asyncio
from websockets.asyncio.client import connect

from gateway.cli.main import main
from gateway.drive.freshness import MAX_AGE_NS
from tests.e2e.faults import scene
from tests.e2e.faults.conftest import IS_EXACT, REPEAT
from tests.e2e.faults.processes import guard_of, is_running
from tests.e2e.faults.scene import Base, Gateway, until, until_it_moves

pytestmark = [pytest.mark.asyncio(loop_scope="module"), pytest.mark.timeout(3600)]

DEADLINE_S = 0.5
ZEROS_S = 0.2  # from the first of a stop to the last
REPETITIONS = range(REPEAT)
QUIET_S = 1.0  # a backlog of 20 s takes milliseconds
# the last one outlives the connection, which is ended after ten seconds of silence
BLACKOUTS_S = (0.5, 1.5, 4.0, 20.0) if IS_EXACT else (0.5, 1.5, 4.0)


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def robot() -> AsyncIterator[Base]:
    async with scene.base() as robot:
        yield robot


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def gateway() -> AsyncIterator[Gateway]:
    async with scene.gateway() as gateway:
        yield gateway


async def stopped(robot: Base, since_ns: int) -> int:
    """Wait for the first zero after a time, and return when it came."""
    await until(lambda: robot.zero_after(since_ns) is not None)
    at_ns = robot.zero_after(since_ns)
    assert at_ns is not None
    return at_ns


async def injected(robot: Base, driver, inject: Callable[[], None]) -> int:
    """Inject a fault into a robot that moves, and return when. Try again if it has stopped."""
    while True:
        await until_it_moves(robot, driver)
        before_ns = time.monotonic_ns()
        if robot.zero_after(before_ns - 200_000_000) is None:
            inject()
            return before_ns


# Client


@pytest.mark.brief
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT], ids=["killed", "closed"])
async def test_a_client_that_ends_stops_the_robot(robot, gateway, measured, number):
    for _ in REPETITIONS:
        async with scene.operator(gateway.url) as driver:
            at_ns = await injected(robot, driver, lambda d=driver: d.send_signal(number))
            took_s = (await stopped(robot, at_ns) - at_ns) / 1e9
            name = "killed" if number is signal.SIGKILL else "closed"
            measured(f"client {name}", took_s, allowed_s=0.1)


@pytest.mark.brief
async def test_a_client_that_is_frozen_stops_the_robot(robot, gateway, measured):
    for _ in REPETITIONS:
        async with scene.operator(gateway.url) as driver:
            at_ns = await injected(robot, driver, lambda d=driver: d.send_signal(signal.SIGSTOP))
            took_s = (await stopped(robot, at_ns) - at_ns) / 1e9
            measured("client frozen", took_s, after_s=DEADLINE_S, allowed_s=0.1)


@pytest.mark.brief
async def test_a_link_that_goes_black_stops_the_robot(robot, gateway, measured):
    for _ in REPETITIONS:
        async with (
            scene.link(gateway.port) as (cable, url),
            scene.operator(url) as driver,
        ):
            at_ns = await injected(robot, driver, lambda c=cable: c.send_signal(signal.SIGSTOP))
            took_s = (await stopped(robot, at_ns) - at_ns) / 1e9
            measured("link black", took_s, after_s=DEADLINE_S, allowed_s=0.1)


@pytest.mark.parametrize("dark_s", BLACKOUTS_S)
async def test_after_a_blackout_nothing_moves_until_the_stick_is_let_go(
    robot, gateway, measured, dark_s
):
    for _ in REPETITIONS:
        async with (
            scene.link(gateway.port) as (cable, url),
            scene.operator(url) as driver,
        ):
            at_ns = await injected(robot, driver, lambda c=cable: c.send_signal(signal.SIGSTOP))
            zero_ns = await stopped(robot, at_ns)
            measured(
                f"blackout of {dark_s:g} s: stop",
                (zero_ns - at_ns) / 1e9,
                after_s=DEADLINE_S,
                allowed_s=0.1,
            )
            await asyncio.sleep(max(dark_s - (time.monotonic_ns() - at_ns) / 1e9, 0.1))
            cable.send_signal(signal.SIGCONT)
            # the operator pushes all the time, and nothing of it may come, old or new
            await asyncio.sleep(QUIET_S + (1 if dark_s > 10 else 0))
            assert robot.moved_after(zero_ns) == []
            driver.send_signal(signal.SIGUSR1)
            await until_it_moves(robot, driver)


@pytest.mark.brief
async def test_a_stop_whose_zeros_do_not_go_out_is_the_guards(robot, measured):
    async with scene.gateway() as own:

        async def has(words: str) -> None:
            while await scene.line(own.process) != f"{words}\n":
                pass

        for _ in REPETITIONS:
            async with scene.operator(own.url) as driver:
                await injected(robot, driver, lambda: own.process.send_signal(signal.SIGRTMIN))
                await has("zeros are kept back")
                at_ns = time.monotonic_ns()
                driver.kill()
                took_s = (await stopped(robot, at_ns) - at_ns) / 1e9
                measured("zeros kept back", took_s, after_s=DEADLINE_S + ZEROS_S, allowed_s=0.15)
                assert took_s > DEADLINE_S
            own.process.send_signal(signal.SIGRTMIN)
            await has("zeros go out")


@pytest.fixture(scope="module")
def certificate(tmp_path_factory) -> Path:
    """Return the folder of a certificate of this machine and its key."""
    pytest.importorskip("cryptography")
    folder = tmp_path_factory.mktemp("certificate")
    assert main(["cert", "--folder", str(folder)]) == 0
    return folder


async def test_commands_that_waited_behind_other_input_do_not_move_the_robot(
    robot, gateway, measured
):
    await judge_late_input(robot, measured, partial(connect, gateway.url, max_queue=None))


async def test_commands_that_waited_behind_other_input_do_not_move_the_robot_over_tls(
    robot, certificate, measured
):
    cert, key = certificate / "cert.pem", certificate / "key.pem"
    trusting = ssl.create_default_context(cafile=cert)
    async with scene.gateway("--tls-cert", str(cert), "--tls-key", str(key)) as own:
        url = own.url.replace("ws:", "wss:")
        await judge_late_input(robot, measured, partial(connect, url, max_queue=None, ssl=trusting))


async def judge_late_input(robot: Base, measured, operator: Callable[[], connect]) -> None:
    drive = (
        '{"op":"publish","topic":"/cmd_vel","type":"geometry_msgs/Twist","msg":{"linear":{"x":%s}}}'
    )
    costly = '{"op":"subscribe","topic":"/odm","id":"x"}'  # a search for what was meant
    for _ in REPETITIONS:
        async with operator() as driver:
            while not robot.is_moving:
                await driver.send(drive % 0)
                await asyncio.sleep(0.4)
                for _ in range(20):
                    await driver.send(drive % 0.05)
                    await asyncio.sleep(0.05)
            begin_ns = time.monotonic_ns()
            while time.monotonic_ns() - begin_ns < 3e9:
                await driver.send(drive % 0.05)
                for _ in range(150):  # ten times what a client has time for
                    await driver.send(costly)
                await asyncio.sleep(0.05)
            silent_ns = time.monotonic_ns()
            await asyncio.sleep(1)  # longer than any gap in a backlog
            await until(lambda: time.monotonic_ns() - robot.last_moved_ns > 2e9)
            took_s = max(0.0, (robot.last_moved_ns - silent_ns) / 1e9)
            after_s = DEADLINE_S + MAX_AGE_NS / 1e9
            measured("client silent, its input late", took_s, after_s=after_s, allowed_s=0.1)


# Gateway: each needs a separate one


@contextlib.asynccontextmanager
async def driven(robot: Base) -> AsyncIterator[tuple[Gateway, asyncio.subprocess.Process]]:
    async with scene.gateway() as own, scene.operator(own.url) as driver:
        await until_it_moves(robot, driver)
        yield own, driver


@pytest.mark.brief
@pytest.mark.parametrize(
    ("number", "name", "allowed_s"),
    [(signal.SIGTERM, "SIGTERM", 0.1), (signal.SIGKILL, "SIGKILL", 0.2)],
)
async def test_a_gateway_that_is_ended_stops_the_robot(robot, measured, number, name, allowed_s):
    for _ in REPETITIONS:
        async with driven(robot) as (own, driver):
            guard = guard_of(own)
            at_ns = await injected(robot, driver, lambda o=own: o.process.send_signal(number))
            zero_ns = await stopped(robot, at_ns)
            measured(f"gateway {name}", (zero_ns - at_ns) / 1e9, allowed_s=allowed_s)
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
    robot, measured, number, name
):
    async with driven(robot) as (own, driver):
        for _ in REPETITIONS:
            at_ns = await injected(robot, driver, lambda o=own: o.process.send_signal(number))
            zero_ns = await stopped(robot, at_ns)
            measured(name, (zero_ns - at_ns) / 1e9, after_s=DEADLINE_S, allowed_s=0.15)
            await asyncio.sleep(1)
            own.process.send_signal(signal.SIGCONT)
            await asyncio.sleep(2)
            assert robot.moved_after(zero_ns) == []
            driver.send_signal(signal.SIGUSR1)


# The guard


async def test_a_guard_that_is_killed_stops_the_robot_until_another_one_is_there(robot, measured):
    for _ in REPETITIONS:  # each with a separate gateway: the second restart is a later one
        async with driven(robot) as (own, driver):
            guard = guard_of(own)
            at_ns = await injected(robot, driver, lambda g=guard: os.kill(g, signal.SIGKILL))
            zero_ns = await stopped(robot, at_ns)
            measured("guard killed", (zero_ns - at_ns) / 1e9, allowed_s=0.1)
            driver.send_signal(signal.SIGUSR1)
            await until_it_moves(robot, driver)
            assert guard_of(own) != guard


async def test_nothing_is_left_of_a_gateway_that_has_ended(robot):
    async with driven(robot) as (own, _):
        guard = guard_of(own)
        os.kill(guard, signal.SIGINT)  # as Ctrl-C does to all of a terminal
        own.process.send_signal(signal.SIGINT)
        assert await own.process.wait() == 0
        assert not is_running(guard)
