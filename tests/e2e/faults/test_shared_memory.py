# SPDX-License-Identifier: Apache-2.0
"""The shared memory of a gateway that is killed."""

import asyncio
import mmap
import os
import signal
import struct
import time

from tests.e2e.faults import scene
from tests.e2e.faults.conftest import IS_MEASURED, REPEAT
from tests.e2e.faults.processes import (
    SHARED_MEMORY,
    guard_of,
    is_old,
    is_running,
    ports_of,
    segments_of,
)
from tests.e2e.faults.scene import until
from tests.e2e.faults.test_joining import STOPPED_S, driving

# pthread_mutex_t of glibc: lock, count, owner, users, kind (128: shared by processes), and no more
MUTEX = struct.Struct("<5i20x")
FREE = MUTEX.pack(0, 0, 0, 0, 128)


async def test_a_robot_is_stopped_whatever_the_killed_gateway_has_locked(measured):
    for _ in range(REPEAT if IS_MEASURED else 1):
        async with (
            scene.gateway() as gateway,
            driving(gateway.url) as driver,
            scene.base() as robot,
        ):
            await driver.push_until(robot, 0)
            pid, heard, guard = gateway.process.pid, len(robot.heard), guard_of(gateway)
            while len(robot.heard) == heard:  # noqa: ASYNC110  # at once, as the robot answers
                await asyncio.sleep(0)
            os.kill(pid, signal.SIGSTOP)  # before the robot has acknowledged the command
            assert sum(lock_all(port, pid) for port in ports_of(pid))
            at_ns = time.monotonic_ns()
            gateway.process.kill()
            await until(lambda at_ns=at_ns: robot.zero_after(at_ns) is not None)
            took_s = (robot.zero_after(at_ns) - at_ns) / 1e9
            measured("gateway SIGKILL with its locks", took_s, allowed_s=STOPPED_S)
            await until(lambda guard=guard: not is_running(guard))


def lock_all(port: str, owner: int) -> int:
    """Lock what is free of the mutexes in a port, as if a process did that. Return their number."""
    with (SHARED_MEMORY / port).open("r+b") as file, mmap.mmap(file.fileno(), 0) as memory:
        places = [at for at in range(0, len(memory), 8) if memory[at : at + len(FREE)] == FREE]
        for at in places:
            memory[at : at + len(FREE)] = MUTEX.pack(1, 0, owner, 1, 128)
    return len(places)


async def test_the_rest_of_a_killed_gateway_is_gone_once_the_next_one_runs():
    async with scene.gateway() as gateway:
        remains = segments_of(gateway.process.pid)
        assert remains
        await until(lambda: all(map(is_old, remains)))
        gateway.process.kill()
        await gateway.process.wait()
    async with scene.gateway():
        assert [name for name in remains if (SHARED_MEMORY / name).exists()] == []
