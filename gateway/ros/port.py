# SPDX-License-Identifier: Apache-2.0
"""The gateway's three nodes, and the port on top of them."""

import asyncio
import contextlib
import os
from collections.abc import Callable, Sequence
from typing import assert_never

from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter

from gateway.domain import MAX_DOMAIN_ID
from gateway.ports import Graph, LogLevel, Qos, RosError, Sample
from gateway.ros.errors import REFUSALS, refused
from gateway.ros.executor import ExecutorThread
from gateway.ros.graph import GraphChanges, read_graph, read_types
from gateway.ros.options import RosOptions, Taking
from gateway.ros.publishers import Publishers, RclpyPublisher
from gateway.ros.samples import EventfdSamples, ExecutorSamples, Samples, UnsupportedError
from gateway.ros.subscriptions import RclpySubscription, Subscriptions
from gateway.ros.watches import GraphWatch, GraphWatches


class RclpyRos:
    """ROS 2 as `gateway.ports.Ros` describes it, on the running event loop.

    The nodes are ``PREFIX_subscriptions`` and ``PREFIX_publishers``, which nothing spins, and
    ``PREFIX_debug``, which has the parameters, the clock and ``/rosout``. Their context is their
    own and installs no signal handlers: rclpy's would end it before the gateway said goodbye.
    """

    def __init__(self, options: RosOptions) -> None:
        """Start.

        Raises:
            RosError: ROS refuses the options.
        """
        loop = asyncio.get_running_loop()
        self._max_entities = options.max_entities
        with contextlib.ExitStack() as undo:
            try:
                context = _open_context(options, undo)
                subscribing = _open_node(context, options, "subscriptions", undo)
                publishing = _open_node(context, options, "publishers", undo)
                self._debug = _open_node(context, options, "debug", undo)
            except REFUSALS as error:
                raise refused("starting ROS", error) from error
            executor = ExecutorThread(context)
            undo.callback(executor.close)
            executor.add_node(self._debug)
            self._own_nodes = frozenset(
                node.get_fully_qualified_name() for node in (subscribing, publishing, self._debug)
            )
            samples = _open_samples(options.taking, subscribing, loop, undo)
            self._subscriptions = Subscriptions(subscribing, samples, loop)
            undo.callback(self._subscriptions.close)
            self._publishers = Publishers(publishing)
            undo.callback(self._publishers.close)
            self._watches = GraphWatches(loop)
            undo.callback(self._watches.close)
            changes = GraphChanges(self._debug, loop, self._graph_changed)
            undo.callback(changes.close)
            self._undo = undo.pop_all()
        self._is_closed = False
        self._graph: Graph | None = None
        self._types: dict[str, tuple[str, ...]] = {}

    def close(self) -> None:
        """End everything that is open, then the nodes; no callback comes after."""
        self._is_closed = True
        self._undo.close()

    @property
    def distro(self) -> str:
        """The ROS distribution, such as ``jazzy``."""
        return os.environ.get("ROS_DISTRO", "jazzy")

    def now_ns(self) -> int:
        """ROS time in nanoseconds."""
        return int(self._debug.get_clock().now().nanoseconds)

    def subscribe(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        on_samples: Callable[[Sequence[Sample]], None],
        on_incompatible: Callable[[str], None],
    ) -> RclpySubscription:
        """Subscribe to a fully resolved topic name; see the port."""
        self._check_new(topic, type_name)
        return self._subscriptions.subscribe(topic, type_name, qos, on_samples, on_incompatible)

    def advertise(self, topic: str, type_name: str, qos: Qos) -> RclpyPublisher:
        """Create a publisher on a fully resolved topic name; see the port."""
        self._check_new(topic, type_name)
        return self._publishers.advertise(topic, type_name, qos)

    def topic_types(self, topic: str) -> tuple[str, ...]:
        """Return the types of a topic; see the port. Kept until the graph changes."""
        known = self._types.get(topic)
        if known is None:
            known = read_types(self._debug, topic, self._own_nodes)
            if known:  # clients may name any number of topics that do not exist
                self._types[topic] = known
        return known

    def graph(self) -> Graph:
        """Return the graph as it is known now; kept until it changes."""
        if self._graph is None:
            self._graph = read_graph(self._debug)
        return self._graph

    def watch_graph(self, on_change: Callable[[], None]) -> GraphWatch:
        """Call *on_change* soon after the graph has changed."""
        return self._watches.add(on_change)

    def log(self, level: LogLevel, text: str) -> None:
        """Write to the debug node's logger, and so to ``/rosout``; after `close` nowhere."""
        if self._is_closed:  # rcl's logging would fall back to the terminal
            return
        logger = self._debug.get_logger()
        # A line for each: rclpy refuses a second severity from the same line of code.
        match level:
            case "debug":
                logger.debug(text)
            case "info":
                logger.info(text)
            case "warning":
                logger.warning(text)
            case "error":
                logger.error(text)
            case _:
                assert_never(level)

    def entity_count(self) -> int:
        """Count the subscriptions and publishers open through this port."""
        return len(self._subscriptions) + len(self._publishers)

    def _check_new(self, topic: str, type_name: str) -> None:
        if self.entity_count() >= self._max_entities:
            raise RosError("limit_exceeded", f"at most {self._max_entities} ROS entities")
        # One DDS participant cannot have both, and rcl loses rmw's reason for saying so.
        known = self._subscriptions.type_of(topic) or self._publishers.type_of(topic)
        if known not in {None, type_name}:
            raise RosError("bad_type", f"topic {topic} is open here as {known}, not {type_name}")
        self._types.pop(topic, None)  # the new endpoint is not waited for

    def _graph_changed(self) -> None:
        self._graph = None
        self._types.clear()
        self._subscriptions.follow_publishers()
        self._watches.notify()


def _open_context(options: RosOptions, undo: contextlib.ExitStack) -> Context:
    # Not rclpy.init(): that would install signal handlers, and take our own command line.
    context = Context()
    # Who logs through the port writes to the terminal, or to files, by other ways.
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


def _open_node(
    context: Context, options: RosOptions, purpose: str, undo: contextlib.ExitStack
) -> Node:
    is_spun = purpose == "debug"
    node = Node(
        f"{options.node_prefix}_{purpose}",
        context=context,
        namespace=options.namespace,
        enable_rosout=is_spun,
        # Nobody would answer their services on a node that is not spun.
        start_parameter_services=is_spun,
        parameter_overrides=[
            Parameter("use_sim_time", value=is_spun and options.use_sim_time),
            Parameter("start_type_description_service", value=is_spun),
        ],
    )
    undo.callback(node.destroy_node)
    return node


def _open_samples(
    taking: Taking, node: Node, loop: asyncio.AbstractEventLoop, undo: contextlib.ExitStack
) -> Samples:
    if taking != "executor":
        try:
            return EventfdSamples(node, loop)
        except UnsupportedError:
            if taking == "eventfd":
                raise
    # The standard one: the EventsExecutor of rclpy 7.1 fails to hand over a message's info.
    executor = ExecutorThread(node.context, standard=True)
    undo.callback(executor.close)
    executor.add_node(node)
    return ExecutorSamples(node, loop)
