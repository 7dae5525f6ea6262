# SPDX-License-Identifier: Apache-2.0
"""The context of rclpy and the nodes that the gateway opens."""

import contextlib

from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter

from gateway.config.domain_id import MAX_DOMAIN_ID
from gateway.sources.rclpy.options import RosOptions
from gateway.sources.source import RosError


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
    node = Node(
        f"{options.node_prefix}_{purpose}",
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
