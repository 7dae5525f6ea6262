# SPDX-License-Identifier: Apache-2.0
"""The contexts of rclpy and the nodes that the gateway opens."""

import contextlib

from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.utilities import get_rmw_implementation_identifier

from gateway.config.domain_id import MAX_DOMAIN_ID
from gateway.sources.options import RosOptions
from gateway.sources.rclpy import fast_dds
from gateway.sources.rclpy.errors import REFUSALS
from gateway.sources.rclpy.graph import read_participants
from gateway.sources.rclpy.shared_memory import without_shared_memory
from gateway.sources.source import RosError


class Nodes:
    """The gateway's nodes, until *undo* ends them.

    The command topics have a separate context without shared memory. A gateway that is killed may
    keep the mutex of the robot's port there, or of the gateway's. The robot, which acknowledges
    commands, would wait for that, and hear the guard a second later.
    """

    def __init__(self, options: RosOptions, undo: contextlib.ExitStack) -> None:
        self._command_topics = frozenset(options.reserved_topics)
        # before others take part, which need to write to shared memory
        commanding = _open_command_node(options, undo) if self._command_topics else None
        with fast_dds.profile():
            context = open_context(options, undo)
            self.subscribing, self.publishing, self.serving, self.debug = (
                open_node(context, options, purpose, undo)
                for purpose in ("subscriptions", "publishers", "services", "debug")
            )
        self.commanding = commanding or self.publishing
        nodes = (self.subscribing, self.publishing, self.serving, self.debug, self.commanding)
        self.own = frozenset(node.get_fully_qualified_name() for node in nodes)
        self.own_participants = read_participants(self.debug, self.own)

    def publishing_on(self, topic: str) -> Node:
        """Return the node that publishes on a topic, and so knows who gets that."""
        return self.commanding if topic in self._command_topics else self.publishing


def open_context(options: RosOptions, undo: contextlib.ExitStack) -> Context:
    """Open the context, until *undo* ends it.

    Raises:
        RosError: Fast DDS has no such domain.
    """
    # Not rclpy.init(): that would install signal handlers, and take our own command line.
    context = Context()
    # The gateway writes its log to the terminal, or to files, by other ways.
    quiet = ("--disable-stdout-logs", "--disable-external-lib-logs")
    arguments = ["--ros-args", *quiet, "--", *options.arguments]
    context.init(args=arguments, domain_id=options.domain_id)
    undo.callback(_close_context, context)
    domain_id = context.get_domain_id()
    if domain_id > MAX_DOMAIN_ID:  # Fast DDS would end the process
        raise RosError("internal", f"domain id {domain_id}, at most {MAX_DOMAIN_ID}")
    return context


def _close_context(context: Context) -> None:
    context.try_shutdown()
    context.destroy()


def open_node(
    context: Context, options: RosOptions, purpose: str, undo: contextlib.ExitStack
) -> Node:
    """Open the node of a purpose, until *undo* ends it. ``debug`` is the one that is spun."""
    is_spun = purpose == "debug"
    hidden = "_" if purpose == "commands" else ""  # as ROS hides names
    node = Node(
        f"{hidden}{options.node_prefix}_{purpose}",
        context=context,
        namespace=options.namespace,
        enable_rosout=is_spun,
        # On a node that is not spun nothing would answer these services.
        start_parameter_services=is_spun,
        parameter_overrides=[
            Parameter("use_sim_time", value=is_spun and options.use_sim_time),
            Parameter("start_type_description_service", value=is_spun),
        ],
    )
    undo.callback(node.destroy_node)
    return node


def _open_command_node(options: RosOptions, undo: contextlib.ExitStack) -> Node | None:
    if not get_rmw_implementation_identifier().startswith("rmw_fastrtps"):
        return None
    context = open_context(options, undo)
    with without_shared_memory(), fast_dds.profile():
        try:
            return open_node(context, options, "commands", undo)
        except REFUSALS:  # all nodes are refused, or those without shared memory
            return None
