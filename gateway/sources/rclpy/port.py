# SPDX-License-Identifier: Apache-2.0
"""The gateway's nodes, and the port on top of them."""

import asyncio
import contextlib
import os
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Final

from rclpy.node import Node
from rclpy.utilities import get_rmw_implementation_identifier
from typing_extensions import Self, assert_never

from gateway.faults import Fault
from gateway.guard.supervisor import GuardProcess
from gateway.sources.graph_watches import GraphWatch, GraphWatches
from gateway.sources.node_definitions import NodeDefinitions
from gateway.sources.options import RosOptions, check_room
from gateway.sources.rclpy.deferred_destruction import DeferredDestruction
from gateway.sources.rclpy.distro import distro
from gateway.sources.rclpy.errors import REFUSALS, refused
from gateway.sources.rclpy.executor import ExecutorThread
from gateway.sources.rclpy.graph import (
    GraphChanges,
    read_holders,
    read_nodes,
    read_readers,
)
from gateway.sources.rclpy.jump_watch import JumpWatch
from gateway.sources.rclpy.known_graph import KnownGraph
from gateway.sources.rclpy.message_classes import MessageClasses
from gateway.sources.rclpy.network import NetworkAtStart
from gateway.sources.rclpy.nodes import Nodes
from gateway.sources.rclpy.publishers import Publishers, RclpyPublisher
from gateway.sources.rclpy.qos_events import QosEvents
from gateway.sources.rclpy.raw_subscriptions import RawSubscription, RawSubscriptions
from gateway.sources.rclpy.rclpy_private.handles import clock_reader
from gateway.sources.rclpy.ready_events import Endpoints, ReadyEvents
from gateway.sources.rclpy.samples import Samples
from gateway.sources.rclpy.servers import RclpyActions, RclpyServices
from gateway.sources.same_names import SameNames
from gateway.sources.source import (
    LogLevel,
    Qos,
    RosError,
    Sample,
    TopicEvent,
)
from schemas.definition import Definition

_DISTRO: Final = distro()  # which reads a file


class RclpyRos:
    """ROS 2 as `gateway.sources.source.Ros` describes it, on the running event loop.

    The nodes are ``PREFIX_subscriptions``, ``PREFIX_publishers`` and ``PREFIX_services``, which
    nothing spins, and ``PREFIX_debug``, which has the parameters, the clock and ``/rosout``. With
    Fast DDS, ``_PREFIX_commands`` publishes on the command topics: see `Nodes`. Their
    contexts are their own and install no signal handlers: rclpy's would end them before the gateway
    has closed its connections.
    """

    def __init__(
        self,
        options: RosOptions,
        classes: MessageClasses | None = None,
        guard: GuardProcess | None = None,
    ) -> None:
        """Start.

        Raises:
            RosError: ROS refuses the options.
        """
        loop = asyncio.get_running_loop()
        self._options, self.guard, self._network = options, guard, NetworkAtStart(os.environ)
        self._classes = classes or MessageClasses()
        with contextlib.ExitStack() as undo:
            try:
                self._nodes = nodes = Nodes(options, undo)
            except REFUSALS as error:
                raise refused("starting ROS", error) from error
            self._debug = nodes.debug
            # ROS time in nanoseconds
            self.now_ns: Callable[[], int] = clock_reader(self._debug.get_clock())
            ready_events = ReadyEvents(loop)
            ready_events.check(nodes.subscribing)
            self._executor = ExecutorThread(nodes.debug.context)
            undo.callback(self._executor.close)
            self._executor.add_node(self._debug)
            samples = Samples(nodes.subscribing, ready_events)
            undo.callback(samples.close)
            self._deferred = DeferredDestruction(loop)
            # The parts are opened below, and tell the graph of their changes.
            self._known = KnownGraph(
                nodes,
                options,
                self._deferred,
                lambda: self.services.provided(),
                lambda: self.actions.provided(),
            )
            known = self._known
            self.graph, self.topic_types = known.whole, known.topic_types
            self.service_types, self.action_types = known.service_types, known.action_types
            events = QosEvents(loop)
            self._subscriptions = RawSubscriptions(
                nodes.subscribing, samples, events, loop, self._known.topics_changed, self._classes
            )
            undo.callback(self._subscriptions.close)
            undo.callback(self._deferred.close)
            open_publishers = partial(self._open_publishers, events, undo)
            self._publishers = open_publishers(nodes.publishing, nodes.publishing_on)
            self._own_publishers = open_publishers(self._debug, lambda _: self._debug)
            endpoints = Endpoints(nodes.serving, ready_events, loop)
            shared = (self._classes, self._check_new)
            self.services = RclpyServices(
                endpoints, self._deferred, self._known.services_changed, *shared
            )
            undo.callback(self.services.close)
            self.actions = RclpyActions(
                endpoints,
                self._deferred,
                self._known.actions_changed,
                *shared,
                samples=samples,
                now_ns=self.now_ns,
            )
            undo.callback(self.actions.close)
            self._watches = self._open_watches(loop, undo)
            self._told = self._open_definitions(undo)
            self._changes = self._open_changes(loop, undo)
            self._undo = undo.pop_all()
        self._is_closed = False

    def close(self) -> None:
        """End everything that is open, then the nodes. No callback comes after."""
        self._is_closed = True
        self._undo.close()

    @property
    def publishing(self) -> Self:
        """The part that publishes. See the port."""
        return self

    diagnosis = publishing

    @property
    def refusal(self) -> None:
        """Nothing is missing."""

    @property
    def distro(self) -> str:
        """The ROS distribution, such as ``jazzy``."""
        return _DISTRO

    @property
    def network(self) -> Mapping[str, str | int]:
        """Its place among the nodes. See the port."""
        domain_id = self._debug.context.get_domain_id()
        rmw = get_rmw_implementation_identifier()
        return {"domain_id": domain_id, "rmw": rmw, "discovery": self._network.reach}

    def subscribe(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        on_samples: Callable[[Sequence[Sample]], None],
        on_event: Callable[[TopicEvent], None],
    ) -> RawSubscription:
        """Subscribe to a fully resolved topic name. See the port."""
        self._check_topic(topic, type_name)
        return self._subscriptions.subscribe(topic, type_name, qos, on_samples, on_event)

    def advertise(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        on_event: Callable[[TopicEvent], None],
    ) -> RclpyPublisher:
        """Create a publisher on a fully resolved topic name. See the port."""
        self._check_topic(topic, type_name, is_reserved=topic in self._options.reserved_topics)
        return self._publishers.advertise(topic, type_name, qos, on_event)

    def advertise_own(self, topic: str, type_name: str, qos: Qos) -> RclpyPublisher:
        """Create a publisher on the debug node. See the port."""
        self._check_type(f"topic {topic}", type_name, self._type_of_topic(topic))
        return self._own_publishers.advertise(topic, type_name, qos, lambda _: None)

    async def definitions(self, type_name: str) -> Mapping[str, Definition] | None:
        """Ask nodes for the definition of a type. See the port."""
        return None if self._told is None else await self._told.of(type_name)

    def topics(self) -> dict[str, list[str]]:
        """Return the types of all topics. See the port."""
        return dict(self._debug.get_topic_names_and_types())

    def readers(self, topic: str) -> frozenset[str]:
        """Return the ids of other nodes' subscriptions, as they are known now. See the port."""
        nodes = self._nodes
        return read_readers(nodes.publishing_on(topic), topic, nodes.own, nodes.own_participants)

    def watch_graph(self, on_change: Callable[[], None]) -> GraphWatch:
        """Call *on_change* soon after the graph has changed."""
        return self._watches.add(on_change)

    def watch_jumps_back(self, on_jump: Callable[[], None]) -> JumpWatch:
        """Call *on_jump* when simulated time has jumped back."""
        return JumpWatch(self._debug.get_clock(), on_jump)

    def log(self, level: LogLevel, text: str) -> None:
        """Write to the debug node's logger, and so to ``/rosout``. Do nothing after `close`."""
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

    def faults(self) -> Sequence[Fault]:
        """Return what is wrong with ROS itself. See the port."""
        if self._is_closed or not self._debug.context.ok():
            return (Fault("dead", "ROS has shut down below the gateway: it must be restarted"),)
        guarding = () if self.guard is None else self.guard.faults()
        faults = [*self._executor.faults(), *self._network.faults(), *guarding]
        if not all(each.is_alive for each in self._changes):
            faults.append(Fault("dead", "the thread that follows the ROS graph has ended"))
        return faults

    def shared_names(self) -> Sequence[str]:
        """Return the names that several nodes have. See the port."""
        return self._same_names.known

    def entity_count(self) -> int:
        """Count the handles of all kinds that are open through this port."""
        parts = (self._subscriptions, self._publishers, self.services, self.actions)
        return sum(len(part) for part in parts)

    def _open_publishers(
        self,
        events: QosEvents,
        undo: contextlib.ExitStack,
        node: Node,
        node_for: Callable[[str], Node],
    ) -> Publishers:
        publishers = Publishers(
            node,
            node_for,
            self._deferred,
            self._known.topics_changed,
            self._nodes.own,
            events,
            self._classes,
        )
        undo.callback(publishers.close)
        return publishers

    def _open_watches(
        self, loop: asyncio.AbstractEventLoop, undo: contextlib.ExitStack
    ) -> GraphWatches:
        watches = GraphWatches(loop)
        undo.callback(watches.close)
        self._same_names = SameNames(loop, lambda: read_nodes(self._debug), self._nodes.own)
        undo.callback(self._same_names.close)
        watches.add(self._same_names.look)
        return watches

    def _open_changes(
        self, loop: asyncio.AbstractEventLoop, undo: contextlib.ExitStack
    ) -> list[GraphChanges]:
        followed = [(self._debug, self._graph_changed)]
        if self._nodes.commanding is not self._nodes.publishing:
            followed.append((self._nodes.commanding, self._command_topics_changed))
        changes = [GraphChanges(node, loop, on_change) for node, on_change in followed]
        for each in changes:
            undo.callback(each.close)
        return changes

    def _open_definitions(self, undo: contextlib.ExitStack) -> NodeDefinitions | None:
        known = self._classes.definitions
        if known is None or not self._options.asks_nodes:
            return None
        told = NodeDefinitions(
            self,
            known,
            self._watches.notify,
            holders=partial(
                read_holders, self._debug, own_nodes=self._nodes.own | {self._options.guard_node}
            ),
            make_types=self._classes.make_types,
        )
        undo.callback(told.close)
        return told

    def _check_topic(self, topic: str, type_name: str, *, is_reserved: bool = False) -> None:
        known = self._type_of_topic(topic)
        self._check_new(f"topic {topic}", type_name, known, is_reserved=is_reserved)

    def _type_of_topic(self, topic: str) -> str | None:
        parts = (self._subscriptions, self._publishers, self._own_publishers)
        return next(filter(None, (part.type_of(topic) for part in parts)), None)

    def _check_new(
        self, subject: str, type_name: str, known: str | None, *, is_reserved: bool = False
    ) -> None:
        check_room(self.entity_count(), self._options, is_reserved=is_reserved)
        self._check_type(subject, type_name, known)

    def _check_type(self, subject: str, type_name: str, known: str | None) -> None:
        # One DDS participant cannot have both types, and rcl's error leaves rmw's reason out.
        if known not in {None, type_name}:
            raise RosError("type_conflict", f"{subject} is open here as {known}, not {type_name}")
        self._deferred.destroy_now(subject, except_type=type_name)

    def _command_topics_changed(self) -> None:
        self._known.topics_changed()
        self._watches.notify()

    def _graph_changed(self) -> None:
        self._known.topics_changed()
        self._known.actions_changed()
        self._subscriptions.follow_publishers()
        self._publishers.follow_subscribers()
        self.services.follow_graph()
        self.actions.follow_graph()
        if self._told is not None:
            self._told.on_graph_change()
        self._watches.notify()
