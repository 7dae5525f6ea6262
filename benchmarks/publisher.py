# SPDX-License-Identifier: Apache-2.0
"""A process that publishes stamped samples at a steady rate: ``TYPE RATE_HZ`` as arguments."""

import os
import sys
import time
from pathlib import Path

import gateway.sim

# big samples need more than the 512 KB that Fast DDS shares by default
os.environ.setdefault(
    "FASTRTPS_DEFAULT_PROFILES_FILE", str(Path(gateway.sim.__path__[0]) / "fastdds_profile.xml")
)


def main(name: str, rate_hz: float) -> None:
    """Publish until SIGINT."""
    import rclpy

    from benchmarks.samples import SAMPLES, topic

    rclpy.init(signal_handler_options=rclpy.SignalHandlerOptions.NO)
    node = rclpy.create_node("benchmark_publisher")
    sample = SAMPLES[name]
    cdr = sample.cdr()
    publisher = node.create_publisher(type(sample.make()), topic(name), 10)
    period_s = 1 / rate_hz
    due_s = time.monotonic()
    try:
        while True:
            sample.clockwork.write(cdr, time.time_ns())
            publisher.publish(bytes(cdr))
            due_s += period_s
            pause_s = due_s - time.monotonic()
            if pause_s > 0:
                time.sleep(pause_s)
    except KeyboardInterrupt:
        rclpy.shutdown()


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]))
