# SPDX-License-Identifier: Apache-2.0
"""The shared memory of a gateway that is killed while nobody else takes part in ROS.

If a process that has received from it still runs, Fast DDS removes it there.
"""

from tests.e2e.faults import scene
from tests.e2e.faults.processes import SHARED_MEMORY, is_old, segments_of
from tests.e2e.faults.scene import until


async def test_the_rest_of_a_killed_gateway_is_gone_once_the_next_one_runs():
    async with scene.gateway() as gateway:
        remains = segments_of(gateway.process.pid)
        assert remains
        await until(lambda: all(map(is_old, remains)))
        gateway.process.kill()
        await gateway.process.wait()
    async with scene.gateway():
        assert [name for name in remains if (SHARED_MEMORY / name).exists()] == []
