# SPDX-License-Identifier: Apache-2.0
"""Callback groups, without what rclpy 7.1 keeps in the default one for ever."""

from rclpy.callback_groups import CallbackGroup, ReentrantCallbackGroup


def group_of_one() -> CallbackGroup:
    """Return a group for one entity, to go with it.

    A group never forgets the entities that it had, and a node's default group lives as long as
    the node, while clients open and close entities all day.
    """
    return ReentrantCallbackGroup()
