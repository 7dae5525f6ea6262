# SPDX-License-Identifier: Apache-2.0
"""Try whether this ROS takes made types: exit code 0 if it does.

A sample goes from a real publisher to a made subscription, and one from a made publisher to a real
subscription, both of std_msgs/msg/Header within this process. What is wrong is one line on stdout;
a crash says nothing. `gateway.ros.message_classes` runs it, before it makes any types.
"""

import resource
import sys
import time
from typing import Final

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.serialization import serialize_message
from std_msgs.msg import Header

from gateway.ports import RosError
from gateway.ros.made_types import MadeTypes, check_middleware
from schemas.installed import InstalledDefinitions
from schemas.type_hash import type_hash

_HEADER: Final = "std_msgs/msg/Header"
_WITHIN_S: Final = 50
_TOPICS: Final = ("/_to_made", "/_from_made")


def main() -> int:
    """Try it."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    try:
        check_middleware()
        wrong = _exchange()
    except RosError as error:
        wrong = str(error)
    if wrong:
        print(wrong)  # noqa: T201
    return 1 if wrong else 0


def _exchange() -> str:
    context = Context()
    rclpy.init(context=context, args=[])
    node = Node("_made_types_check", context=context, start_parameter_services=False)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    definitions = InstalledDefinitions()
    header = definitions.get(_HEADER)
    made = MadeTypes().get(header, definitions)
    to_made, from_made = _TOPICS
    raw: list[bytes] = []
    heard: list[Header] = []
    node.create_subscription(made, to_made, raw.append, 10, raw=True)
    node.create_subscription(Header, from_made, heard.append, 10)
    real_publisher = node.create_publisher(Header, to_made, 10)
    made_publisher = node.create_publisher(made, from_made, 10)
    message = Header(frame_id="made")
    end_s = time.monotonic() + _WITHIN_S
    while not (raw and heard) and time.monotonic() < end_s:
        real_publisher.publish(message)
        made_publisher.publish(serialize_message(message))
        executor.spin_once(timeout_sec=0.05)
    if not (raw and heard):
        return "no messages pass between made types and real ones here"
    if raw[0].rstrip(b"\0") != serialize_message(message).rstrip(b"\0") or heard[0] != message:
        return "messages of made types arrive as others here"
    hashes = {str(each.topic_type_hash) for each in node.get_publishers_info_by_topic(from_made)}
    if hashes != {type_hash(header, definitions)}:
        return "made types have no hash here"
    return ""


if __name__ == "__main__":
    sys.exit(main())
