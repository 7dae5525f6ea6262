# SPDX-License-Identifier: Apache-2.0
"""The control of what clients hear: a bare rclpy subscriber to the topics of the load.

Orders: ``report``.
"""

import importlib
import struct
import time
from collections.abc import Callable
from typing import Any, Final

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future

from benchmarks.actors.orders import obey, reply
from tests.soak.load import NUMBERS, NUMBERS_DEPTH, TOPICS, Topic
from tests.soak.sequence import Sequence
from tests.soak.silences import Silences

_DEPTH: Final = 10
_SPIN_S: Final = 1e6
_ENCAPSULATION: Final = 4  # bytes before the first field of every CDR message


def main() -> None:
    """Listen until the end of stdin."""
    silences = {topic.name: Silences() for topic in TOPICS}
    sequence = Sequence()
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("soak_control")

    def hearing(topic: Topic) -> Callable[[bytes], None]:
        def hear(cdr: bytes) -> None:
            silences[topic.name].hear(time.monotonic())
            if topic is NUMBERS:
                sequence.add(struct.unpack_from("<Q", cdr, _ENCAPSULATION)[0])

        return hear

    for topic in TOPICS:
        depth = NUMBERS_DEPTH if topic is NUMBERS else _DEPTH
        kind = message_class(topic.type_name)
        node.create_subscription(kind, topic.name, hearing(topic), depth, raw=True)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    over: Any = Future()

    def end() -> None:
        over.set_result(None)
        executor.wake()

    def report() -> dict[str, Any]:
        return {
            "heard": {name: one.count for name, one in silences.items()},
            "gaps": {name: one.so_far() for name, one in silences.items()},
            "sequence": sequence.as_json(),
        }

    obey({"report": report}, end)
    reply("ready")
    executor.spin_until_future_complete(over, _SPIN_S)
    rclpy.shutdown()


def message_class(name: str) -> Any:
    """Return a message class by the ROS name of its type."""
    package, _, message = name.split("/")
    return getattr(importlib.import_module(f"{package}.msg"), message)


if __name__ == "__main__":
    main()
