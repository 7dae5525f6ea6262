# SPDX-License-Identifier: Apache-2.0
"""Try whether this ROS takes made types: exit code 0 if it does.

A sample goes from a real publisher to a made subscription. Another one goes from a made publisher
to a real subscription. Both are of std_msgs/msg/Header within this process. Services are called
likewise (`gateway.sources.rclpy.made_services_check`). A fault is one line on stdout. A crash says
nothing. `gateway.sources.rclpy.message_classes` runs it, before it makes any types.
"""

import resource
import sys
import time
from typing import Final

import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import Header

from gateway.sources.rclpy import rclpy_private
from gateway.sources.rclpy.errors import REFUSALS, refused
from gateway.sources.rclpy.made_services_check import Calls, open_calls
from gateway.sources.rclpy.made_types import MadeTypes, check_middleware
from gateway.sources.source import RosError
from schemas.installed import InstalledDefinitions
from schemas.type_hash import type_hash

_HEADER: Final = "std_msgs/msg/Header"
_WITHIN_S: Final = 50
_STEP_S: Final = 0.005
_TO_MADE: Final = "/_to_made"
_FROM_MADE: Final = "/_from_made"


def main() -> int:
    """Try it."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    try:
        check_middleware()
        wrong = _exchange()
    except RosError as error:
        wrong = str(error)
    except REFUSALS as error:
        wrong = str(refused("made types", error)).partition("\n")[0]
    if wrong:
        print(wrong)  # noqa: T201
    return 1 if wrong else 0


def _exchange() -> str:
    """Try everything at once, and return the first fault in words."""
    context = Context()
    rclpy.init(context=context, args=[])
    # nothing spins it: samples, requests and responses are taken here
    node = Node("_made_types_check", context=context, start_parameter_services=False)
    definitions, made_types = InstalledDefinitions(), MadeTypes()
    calls = open_calls(node, made_types, definitions)
    parts: list[_Topics | Calls] = [_Topics(node, made_types, definitions), *calls]
    end_s = time.monotonic() + _WITHIN_S
    while not all(part.is_over for part in parts) and time.monotonic() < end_s:
        for part in parts:
            part.step()
        time.sleep(_STEP_S)
    return next((part.fault for part in parts if part.fault), "")


class _Topics:
    """A sample in either direction, sent until it arrives."""

    def __init__(
        self, node: Node, made_types: MadeTypes, definitions: InstalledDefinitions
    ) -> None:
        header = definitions.get(_HEADER)
        self._hash = type_hash(header, definitions)
        made = made_types.get(header, definitions)
        self._node = node
        self._publishers = [
            node.create_publisher(Header, _TO_MADE, 10),
            node.create_publisher(made, _FROM_MADE, 10),
        ]
        subscriptions = [
            node.create_subscription(made, _TO_MADE, _never_called, 10, raw=True),
            node.create_subscription(Header, _FROM_MADE, _never_called, 10, raw=True),
        ]
        self._takers = list(map(rclpy_private.message_taker, subscriptions))
        self._classes = [made, Header]
        self._heard: list[bytes | None] = [None, None]
        self._message = Header(frame_id="made")

    @property
    def is_over(self) -> bool:
        """True once both have arrived."""
        return None not in self._heard

    @property
    def fault(self) -> str:
        """The words for what is wrong. Empty if nothing is."""
        heard = [cdr for cdr in self._heard if cdr is not None]
        if len(heard) < len(self._heard):
            return "no messages pass between made types and real ones here"
        if any(deserialize_message(cdr, Header) != self._message for cdr in heard):
            return "messages of made types arrive as others here"
        found = self._node.get_publishers_info_by_topic(_FROM_MADE)
        if {str(each.topic_type_hash) for each in found} != {self._hash}:
            return "made types have no hash here"
        return ""

    def step(self) -> None:
        """Send and take."""
        if self.is_over:
            return
        for publisher in self._publishers:
            publisher.publish(serialize_message(self._message))
        for index, take in enumerate(self._takers):
            taken = take(self._classes[index], True)  # raw
            if taken is not None:
                self._heard[index] = taken[0]


def _never_called(*_: object) -> None:
    """Serve as the callback that rclpy requires. Nothing calls it."""


if __name__ == "__main__":
    sys.exit(main())
