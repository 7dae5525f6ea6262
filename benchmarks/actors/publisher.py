# SPDX-License-Identifier: Apache-2.0
"""A process that publishes stamped samples as ordered, in turn to each of its topics.

``SAMPLE TOPICS PART/PARTS WHEN`` as arguments. PARTS processes may share a topic, as one call takes
about 20 us in Python. WHEN is ``now``, or ``late`` for publishers created with the first sample. In
addition to the orders of `runs`, ``matched`` answers with the number of subscriptions of the topic
that has fewest.
"""

import itertools
import os
import sys
import time
from pathlib import Path
from typing import Any, Final

import gateway_sim
from benchmarks.actors.pace import Stamps
from benchmarks.actors.runs import do_runs

# big samples need more than the 512 KB that Fast DDS shares by default
os.environ.setdefault(
    "FASTRTPS_DEFAULT_PROFILES_FILE", str(Path(gateway_sim.__path__[0]) / "fastdds_profile.xml")
)

# A writer that keeps ten samples drops those that a reader has not acknowledged after 10 ms at
# 1 kHz: that would measure how the system schedules processes. It keeps the last thousand instead,
# fewer of large samples, but at least ROS' ten.
_KEPT_BYTES: Final = 16 * 1024**2
_KEPT: Final = (10, 1000)


def main(name: str, topics: int, share: str, *, late: bool) -> None:
    """Publish as ordered until the end of stdin."""
    import rclpy
    from rclpy.signals import SignalHandlerOptions

    from benchmarks.samples import SAMPLES, topic

    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("publisher_of" + topic(name).replace("/", "_"))
    sample = SAMPLES[name]
    cdr = sample.cdr()
    message_class = type(sample.make())
    depth = max(_KEPT[0], min(_KEPT_BYTES // len(cdr), _KEPT[1]))
    part, parts = map(int, share.split("/"))
    stamps = Stamps(part, parts)
    write = sample.clockwork.write
    publishers: list[Any] = []
    turns = itertools.cycle(publishers)

    def create() -> None:
        publishers.extend(
            node.create_publisher(message_class, topic(name, number), depth)
            for number in range(topics)
        )

    def send() -> None:
        if not publishers:
            create()
        write(cdr, stamps.next(time.time_ns()))
        next(turns).publish(bytes(cdr))

    def matched() -> int:
        return min((one.get_subscription_count() for one in publishers), default=0)

    if not late:
        create()
    do_runs(send, {"matched": matched})
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), sys.argv[3], late=sys.argv[4] == "late")
