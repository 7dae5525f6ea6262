# SPDX-License-Identifier: Apache-2.0
"""A process that publishes topics of the robot, each at its own rate: ``TOPIC ...`` as arguments.

Latched ones are published at the start. The order ``run SECONDS`` publishes the others for so long,
and answers with the number of messages of each, and the time that it took.
"""

import os
import queue
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import serialize_message
from rclpy.signals import SignalHandlerOptions

import gateway_sim
from benchmarks.actors.orders import obey, reply
from benchmarks.actors.pace import merged
from benchmarks.robot import AGED, LATCHED, ROBOT
from benchmarks.samples import HEADER, topic

_DEPTH: Final = 10  # the default of ROS
_PROFILE: Final = str(Path(gateway_sim.__path__[0]) / "fastdds_profile.xml")  # for pictures


def main(*names: str) -> None:
    """Publish as ordered until the end of stdin."""
    os.environ.setdefault("FASTRTPS_DEFAULT_PROFILES_FILE", _PROFILE)
    runs: queue.SimpleQueue[float | None] = queue.SimpleQueue()
    obey({"run": lambda seconds: runs.put(float(seconds))}, lambda: runs.put(None))
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node(
        f"benchmark_{names[0].replace('/', '_')}"
    )  # two of one name are warned of
    sends = {name: _sender(node, name) for name in names}
    for name in names:
        if ROBOT[name].rate_hz == LATCHED:
            sends.pop(name)()
    reply("ready")
    while (seconds := runs.get()) is not None:
        _run(sends, seconds)
    node.destroy_node()
    rclpy.shutdown()


def _run(sends: dict[str, Callable[[], object]], seconds: float) -> None:
    names = list(sends)
    sent = dict.fromkeys(names, 0)
    started_s = time.monotonic()
    for due_s, number in merged([ROBOT[name].rate_hz for name in names]):
        if due_s >= seconds:
            break
        time.sleep(max(0.0, started_s + due_s - time.monotonic()))
        name = names[number]
        sends[name]()
        sent[name] += 1
    reply({"sent": sent, "seconds": max(seconds, time.monotonic() - started_s)})


def _sender(node: Node, name: str) -> Callable[[], object]:
    """Return the function that publishes a topic's message once more."""
    one = ROBOT[name]
    message = one.make()
    qos = QoSProfile(depth=_DEPTH)
    if one.rate_hz == LATCHED:
        qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    publisher = node.create_publisher(type(message), topic(name), qos)
    cdr = bytearray(serialize_message(message))

    def send() -> None:
        if name in AGED:
            HEADER.write(cdr, time.time_ns())
        publisher.publish(bytes(cdr))

    return send


if __name__ == "__main__":
    main(*sys.argv[1:])
