# SPDX-License-Identifier: Apache-2.0
"""Subscribe to ``/t`` by the gateway's port, best effort, and print what is heard and told of it.

Run it as a program: if you stop the process for a moment, DDS loses messages on any machine.
"""

import asyncio
from collections.abc import Sequence

from gateway.sources.rclpy import open_ros
from gateway.sources.source import Qos, Sample, TopicEvent

LOSSY = Qos("best_effort", depth=1)


async def main() -> None:
    """Print ``heard`` for each batch and the text of each event, until killed."""

    def hear(_: Sequence[Sample]) -> None:
        print("heard", flush=True)  # noqa: T201

    def tell(event: TopicEvent) -> None:
        print(event.code, event.text, flush=True)  # noqa: T201

    async with open_ros() as ros:
        ros.subscribe("/t", "std_msgs/msg/String", LOSSY, hear, tell)
        await asyncio.Event().wait()


if __name__ == "__main__":
    asyncio.run(main())
