# SPDX-License-Identifier: Apache-2.0
"""The command line with a rclpy that lacks what came after ROS 2 Humble, as far as we know it.

It stands in for a Humble robot only here: the middleware below is the installed one.
"""

import sys

import rclpy.event_handler
import rclpy.node
from rclpy.topic_endpoint_info import TopicEndpointInfo

from gateway.cli.main import main


def _no_hash(_: TopicEndpointInfo) -> None:
    raise AttributeError("topic_type_hash came with Iron")


class _Nothing:
    """In the place of a service that nodes have since Iron."""

    def __init__(self, *_: object) -> None:
        """Take what the service would take."""

    def destroy(self) -> None:
        """End nothing."""


if __name__ == "__main__":
    # rclpy itself has imported all of it
    sys.modules["rclpy.qos_event"] = sys.modules["rclpy.event_handler"]  # its name before Iron
    sys.modules["rclpy.event_handler"] = None  # type: ignore[assignment]
    sys.modules["rclpy.experimental.events_executor"] = None  # type: ignore[assignment]
    del rclpy.event_handler
    rclpy.node.TypeDescriptionService = _Nothing
    TopicEndpointInfo.topic_type_hash = property(_no_hash, lambda *_: None)
    sys.exit(main())
