# SPDX-License-Identifier: Apache-2.0
"""A base in a separate process that speaks Zenoh: it prints what `robot` prints."""

import asyncio
import sys
import time
from collections.abc import Sequence

from gateway.codec.types import Types
from gateway.drive.twist_cdr import TWIST
from gateway.sources.source import Sample
from tests.sources.zenoh.outside import DEFINITIONS
from tests.sources.zenoh.world import ZenohWorld


async def main(router: str) -> None:
    decode = Types(DEFINITIONS).get(TWIST).decode

    def hear(samples: Sequence[Sample]) -> None:
        for sample in samples:
            twist = decode(bytes(sample.cdr))
            speed = abs(twist["linear"]["x"]) + abs(twist["angular"]["z"])
            sys.stdout.write(f"{time.monotonic_ns()} {speed}\n")
        sys.stdout.flush()

    world = ZenohWorld(router, "base")
    world.add_subscription("/cmd_vel", TWIST, hear)
    sys.stdout.write("ready\n")
    sys.stdout.flush()
    await asyncio.Event().wait()


if __name__ == "__main__":
    asyncio.run(main(sys.argv[1]))
