# SPDX-License-Identifier: Apache-2.0
"""Nodes of the tests' own process, in which the gateway under test may also run."""

from typing import Any

from rclpy.context import Context
from rclpy.node import Node

from gateway.sources.rclpy import fast_dds


def open_node(name: str, context: Context, **options: Any) -> Node:
    """Create a node as on a robot, where the rest is in other processes than the gateway.

    The first node of a process decides for all that follow. Left to itself, Fast DDS 2.14 has
    participants of one process call each other directly. On a busy machine, one of them then may
    never hear of another's readers: a service or an action never becomes ready.
    """
    with fast_dds.profile():
        return Node(name, context=context, **options)
