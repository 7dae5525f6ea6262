# SPDX-License-Identifier: Apache-2.0
"""Creation of entities of rclpy, whose events nobody spins."""

from typing import Any

from rclpy.callback_groups import CallbackGroup, ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.qos import QoSProfile

from gateway.sources.rclpy.errors import creation, remapped
from gateway.sources.rclpy.no_callbacks import NO_PUBLISHER_EVENTS


def group_of_one() -> CallbackGroup:
    """Return a group for one entity, which ends with it.

    In rclpy 7.1 a group never forgets the entities that it had. A node's default group lives as
    long as the node, while clients open and close entities all day.
    """
    return ReentrantCallbackGroup()


def create_publisher(
    node: Node, subject: str, topic: str, message_class: Any, profile: QoSProfile
) -> Any:
    """Create a publisher on a fully resolved name. The text of its errors begins with *subject*.

    Raises:
        RosError: ROS refuses it, or gives it another name.
    """
    with creation(subject):
        publisher = node.create_publisher(
            message_class,
            topic,
            profile,
            callback_group=group_of_one(),
            event_callbacks=NO_PUBLISHER_EVENTS,
        )
    given = publisher.topic_name
    if given != topic:
        node.destroy_publisher(publisher)
        raise remapped(subject, given)
    return publisher
