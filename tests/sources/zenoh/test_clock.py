# SPDX-License-Identifier: Apache-2.0
"""The time of a simulated robot over Zenoh."""

import time
from dataclasses import replace

from gateway.codec.types import Types
from gateway.sources.zenoh.clock import CLOCK_TOPIC, CLOCK_TYPE
from tests.client import eventually
from tests.sources.zenoh.conftest import OPTIONS, open_robot
from tests.sources.zenoh.outside import DEFINITIONS


async def test_the_time_is_that_of_the_clock_and_its_jumps_back_are_told():
    encode = Types(DEFINITIONS).get(CLOCK_TYPE).encode
    with open_robot(replace(OPTIONS, use_sim_time=True)) as (source, world):
        assert abs(source.now_ns() - time.time_ns()) < 60e9  # until it is heard
        jumps: list[int] = []
        watch = source.watch_jumps_back(lambda: jumps.append(source.now_ns()))
        clock = world.add_publisher(CLOCK_TOPIC, CLOCK_TYPE)

        def is_at(seconds: int) -> bool:
            clock.publish(encode({"clock": {"sec": seconds, "nanosec": 5}}, 0))
            return bool(source.now_ns() == seconds * 10**9 + 5)

        await eventually(lambda: is_at(70))
        await eventually(lambda: is_at(80))
        assert jumps == []
        await eventually(lambda: is_at(3))
        assert jumps == [3 * 10**9 + 5]
        watch.close()
