# SPDX-License-Identifier: Apache-2.0
"""The gateway's nodes, and the port on top of them."""

import asyncio
import contextlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Final, Self, assert_never

from rclpy.node import Node

from gateway.faults import Fault
from gateway.guard.supervisor import GuardProcess
from gateway.sources.actions import GoalRequest
from gateway.sources.rclpy import rclpy_private
from gateway.sources.rclpy.action_client import RclpyActionClient
from gateway.sources.rclpy.action_entities import RclpyActions
from gateway.sources.rclpy.action_server import RclpyActionServer
from gateway.sources.rclpy.deferred_destruction import DeferredDestruction
from gateway.sources.rclpy.distro import distro
from gateway.sources.rclpy.endpoints import Endpoints
from gateway.sources.rclpy.errors import REFUSALS, refused
from gateway.sources.rclpy.executor import ExecutorThread
from gateway.sources.rclpy.graph import (
    GraphChanges,
    read_actions,
    read_all_services,
    read_graph,
    read_holders,
    read_nodes,
    read_readers,
    read_types,
)
from gateway.sources.rclpy.message_classes import MessageClasses
from gateway.sources.rclpy.node_definitions import NodeDefinitions, TypeHolder
from gateway.sources.rclpy.nodes import Nodes
from gateway.sources.rclpy.options import RosOptions, check_room
from gateway.sources.rclpy.publishers import Publishers, RclpyPublisher
from gateway.sources.rclpy.qos_events import QosEvents
from gateway.sources.rclpy.raw_subscriptions import RawSubscription, RawSubscriptions
from gateway.sources.rclpy.same_names import SameNames
from gateway.sources.rclpy.samples import Samples
from gateway.sources.rclpy.service_entities import RclpyClient, RclpyService, RclpyServices
from gateway.sources.rclpy.time_jumps import JumpWatch
from gateway.sources.rclpy.wait_set_events import WaitSetReadyEvents, open_ready_events
from gateway.sources.rclpy.watches import GraphWatch, GraphWatches
from gateway.sources.services import ServiceRequest
from gateway.sources.source import (
    Graph,
    LogLevel,
    Qos,
    RosError,
    Sample,
    ServerInfo,
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
        self._options, self.guard = options, guard
        self._classes = classes or MessageClasses()
        # read from the graph, kept until it changes
        self._graph: Graph | None = None
        self._types: dict[str, tuple[str, ...]] = {}
        self._service_types: dict[str, tuple[str, ...]] | None = None
        self._action_types: dict[str, tuple[str, ...]] | None = None
        with contextlib.ExitStack() as undo:
            try:
                self._nodes = nodes = Nodes(options, undo)
            except REFUSALS as error:
                raise refused("starting ROS", error) from error
            self._debug = nodes.debug
            # ROS time in nanoseconds
            self.now_ns: Callable[[], int] = rclpy_private.clock_reader(self._debug.get_clock())
            self._ready_events = open_ready_events(options.taking, nodes.subscribing, loop, undo)
            self._executor = ExecutorThread(
                # the other one needs the same of the middleware as the eventfd
                nodes.debug.context,
                standard=isinstance(self._ready_events, WaitSetReadyEvents),
            )
            undo.callback(self._executor.close)
            self._executor.add_node(self._debug)
            samples = undo.enter_context(
                contextlib.closing(Samples(nodes.subscribing, self._ready_events))
            )
            events = QosEvents(loop)
            self._subscriptions = RawSubscriptions(
                nodes.subscribing, samples, events, loop, self._topics_changed, self._classes
            )
            undo.callback(self._subscriptions.close)
            self._deferred = DeferredDestruction(loop)
            undo.callback(self._deferred.close)
            open_publishers = partial(self._open_publishers, events, undo)
            self._publishers = open_publishers(nodes.publishing, nodes.publishing_on)
            self._own_publishers = open_publishers(self._debug, lambda _: self._debug)
            endpoints = Endpoints(nodes.serving, self._ready_events, loop)
            self._services = RclpyServices(
                endpoints, self._deferred, self._services_changed, self._classes
            )
            undo.callback(self._services.close)
            self._actions = RclpyActions(
                endpoints,
                samples,
                self._deferred,
                self.now_ns,
                self._actions_changed,
                self._classes,
            )
            undo.callback(self._actions.close)
            self._watches = self._open_watches(loop, undo)
            self._told = self._open_definitions(undo)
            self._changes = [
                undo.enter_context(contextlib.closing(GraphChanges(node, loop, on_change)))
                for node, on_change in (
                    (nodes.debug, self._graph_changed),
                    (nodes.commanding, self._command_topics_changed),
                )
                if node is not nodes.publishing
            ]
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

    services = actions = diagnosis = publishing

    @property
    def distro(self) -> str:
        """The ROS distribution, such as ``jazzy``."""
        return _DISTRO

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

    def client(self, service: str, type_name: str) -> RclpyClient:
        """Create a client of a service by its fully resolved name. See the port."""
        self._check_service(service, type_name)
        return self._services.client(service, type_name)

    def serve(
        self, service: str, type_name: str, on_request: Callable[[ServiceRequest], None]
    ) -> RclpyService:
        """Provide a service by its fully resolved name. See the port."""
        self._check_service(service, type_name)
        return self._services.serve(service, type_name, on_request)

    def action_client(self, action: str, type_name: str) -> RclpyActionClient:
        """Create a client of an action by its fully resolved name. See the port."""
        self._check_action(action, type_name)
        return self._actions.client(action, type_name)

    def serve_action(
        self,
        action: str,
        type_name: str,
        on_goal: Callable[[GoalRequest], None],
        on_cancel: Callable[[GoalRequest], None],
    ) -> RclpyActionServer:
        """Provide an action by its fully resolved name. See the port."""
        self._check_action(action, type_name)
        return self._actions.serve(action, type_name, on_goal, on_cancel)

    async def definitions(self, type_name: str) -> Mapping[str, Definition] | None:
        """Ask nodes for the definition of a type. See the port."""
        return None if self._told is None else await self._told.of(type_name)

    async def make_types(self) -> None:
        """Find out whether types can be made here. See `AskedRos`."""
        await self._classes.make_types()

    def topics(self) -> dict[str, list[str]]:
        """Return the types of all topics. See the port."""
        return dict(self._debug.get_topic_names_and_types())

    def type_holders(self, topic: str, type_name: str) -> tuple[TypeHolder, ...]:
        """Return the nodes that have a type. See `AskedRos`."""
        own = self._nodes.own | {self._options.guard_node}
        return read_holders(self._debug, topic, type_name, own)

    def readers(self, topic: str) -> frozenset[str]:
        """Return the ids of other nodes' subscriptions, as they are known now. See the port."""
        nodes = self._nodes
        return read_readers(nodes.publishing_on(topic), topic, nodes.own, nodes.own_participants)

    def topic_types(self, topic: str) -> tuple[str, ...]:
        """Return the types of a topic. See the port. Kept until the graph changes."""
        known = self._types.get(topic)
        if known is None:
            nodes, guard = self._nodes, self._options.guard_node
            publishing = nodes.publishing_on(topic)
            known = read_types(nodes.debug, topic, nodes.own, guard, publishing)
            if known:  # clients may name any number of topics that do not exist
                self._types[topic] = known
        return known

    def service_types(self, service: str) -> tuple[str, ...]:
        """Return the types of a service. See the port. Kept until the graph changes."""
        # A change is reported a little after it happens: a name that is not known may be new.
        if self._service_types is None or service not in self._service_types:
            found = self._services_here(read_all_services(self._debug))
            self._service_types = {each.name: each.types for each in found}
        return self._service_types.get(service, ())

    def action_types(self, action: str) -> tuple[str, ...]:
        """Return the types of an action. See `service_types`."""
        if self._action_types is None or action not in self._action_types:
            found = self._actions_here(read_actions(self._debug))
            self._action_types = {each.name: each.types for each in found}
        return self._action_types.get(action, ())

    def graph(self) -> Graph:
        """Return the graph as it is known now. Kept until it changes."""
        if self._graph is None:
            graph = read_graph(self._debug, self._options.hidden_nodes)
            self._graph = replace(
                graph,
                services=self._services_here(graph.services),
                actions=self._actions_here(graph.actions),
            )
        return self._graph

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
        faults = [*self._executor.faults(), *self._ready_events.faults(), *guarding]
        if not all(each.is_alive for each in self._changes):
            faults.append(Fault("dead", "the thread that follows the ROS graph has ended"))
        return faults

    def shared_names(self) -> Sequence[str]:
        """Return the names that several nodes have. See the port."""
        return self._same_names.known

    def entity_count(self) -> int:
        """Count the handles of all kinds that are open through this port."""
        parts = (self._subscriptions, self._publishers, self._services, self._actions)
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
            self._topics_changed,
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

    def _open_definitions(self, undo: contextlib.ExitStack) -> NodeDefinitions | None:
        known = self._classes.definitions
        if known is None or not self._options.asks_nodes:
            return None
        told = NodeDefinitions(self, known, self._watches.notify)
        undo.callback(told.close)
        return told

    def _check_topic(self, topic: str, type_name: str, *, is_reserved: bool = False) -> None:
        known = self._type_of_topic(topic)
        self._check_new(f"topic {topic}", type_name, known, is_reserved=is_reserved)

    def _type_of_topic(self, topic: str) -> str | None:
        parts = (self._subscriptions, self._publishers, self._own_publishers)
        return next(filter(None, (part.type_of(topic) for part in parts)), None)

    def _check_service(self, service: str, type_name: str) -> None:
        self._check_new(f"service {service}", type_name, self._services.type_of(service))

    def _check_action(self, action: str, type_name: str) -> None:
        self._check_new(f"action {action}", type_name, self._actions.type_of(action))

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

    # Entities of this port change the graph at once, without waiting for a report.

    def _services_here(self, found: Iterable[ServerInfo]) -> tuple[ServerInfo, ...]:
        return self._as_here("service", found, self._services.provided())

    def _actions_here(self, found: Iterable[ServerInfo]) -> tuple[ServerInfo, ...]:
        return self._as_here("action", found, self._actions.provided())

    def _as_here(
        self, kind: str, found: Iterable[ServerInfo], provided: Iterable[ServerInfo]
    ) -> tuple[ServerInfo, ...]:
        """Add what DDS has to find yet. Leave out what awaits its deferred destruction."""
        known = {each.name: each for each in (*provided, *found)}
        return tuple(
            known[name]
            for name in sorted(known)
            if not (set(known[name].nodes) <= self._nodes.own)
            or not self._deferred.is_deferred(f"{kind} {name}")
        )

    def _topics_changed(self) -> None:
        self._graph = None
        self._types.clear()

    def _services_changed(self) -> None:
        self._graph = None
        self._service_types = None

    def _actions_changed(self) -> None:
        self._services_changed()
        self._action_types = None

    def _command_topics_changed(self) -> None:
        self._types.clear()
        self._watches.notify()

    def _graph_changed(self) -> None:
        self._topics_changed()
        self._actions_changed()
        self._subscriptions.follow_publishers()
        self._publishers.follow_subscribers()
        self._services.follow_graph()
        self._actions.follow_graph()
        if self._told is not None:
            self._told.on_graph_change()
        self._watches.notify()
