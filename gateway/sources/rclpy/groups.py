# SPDX-License-Identifier: Apache-2.0
"""A callback group for each entity: rclpy 7.1 keeps those of the default group forever."""

from rclpy.callback_groups import CallbackGroup, ReentrantCallbackGroup


def group_of_one() -> CallbackGroup:
    """Return a group for one entity, which ends with it.

    A group never forgets the entities that it had, and a node's default group lives as long as
    the node, while clients open and close entities all day.
    """
    return ReentrantCallbackGroup()
