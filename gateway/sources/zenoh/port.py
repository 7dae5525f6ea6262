# SPDX-License-Identifier: Apache-2.0
"""A robot whose nodes speak rmw_zenoh, as the gateway serves it without ROS."""

import asyncio
import contextlib
import logging
import os
from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from typing import Any, Final

from typing_extensions import Self

from gateway.config.limits import MAX_QUEUE_DEPTH
from gateway.config.model import Config
from gateway.drive.twist_cdr import TWIST, TWIST_STAMPED
from gateway.faults import Fault
from gateway.guard.supervisor import GuardProcess
from gateway.sources.graph import Graph
from gateway.sources.graph_watches import GraphWatch, GraphWatches
from gateway.sources.name_checks import check_topic
from gateway.sources.options import RosOptions, check_room
from gateway.sources.same_names import SameNames
from gateway.sources.source import Qos, RosError, TopicEvent
from gateway.sources.zenoh.clock import CLOCK_TOPIC, CLOCK_TYPE, RobotClock
from gateway.sources.zenoh.events import nobody
from gateway.sources.zenoh.inbox import Inbox
from gateway.sources.zenoh.options import ZenohOptions
from gateway.sources.zenoh.parts import ZenohParts
from gateway.sources.zenoh.refusals import Refusals
from gateway.sources.zenoh.robot_definitions import RobotDefinitions
from gateway.sources.zenoh.robot_faults import robot_faults
from gateway.sources.zenoh.session import ZenohSession, open_session
from gateway.sources.zenoh.subscriptions import (
    ForeignSamples,
    OnSamples,
    ZenohSubscription,
    ZenohSubscriptions,
)
from gateway.sources.zenoh.token_changes import TokenChanges
from gateway.sources.zenoh.token_graph import TokenGraph
from schemas.definition import DefinitionError
from schemas.installed import InstalledDefinitions, UnknownTypeError
from schemas.type_hash import type_hash

NODES: Final = ("debug", "subscriptions", "publishers", "services")

_logger = logging.getLogger(__name__)


class ZenohSource:
    """Implements `gateway.sources.source.Source` on the running event loop.

    It has the same nodes as the gateway has with rclpy.
    """

    actions = None
    refusal = None

    def __init__(
        self,
        session: Any,
        options: RosOptions,
        definitions: InstalledDefinitions,
        guard: GuardProcess | None = None,
        open_again: Callable[[], Any] | None = None,
    ) -> None:
        """Start on a session of Zenoh, which this closes. *open_again* opens one like it."""
        loop = asyncio.get_running_loop()
        self._options, self._definitions = options, definitions
        with contextlib.ExitStack() as undo:
            ros = self.session = ZenohSession(session, options.domain_id or 0)
            self.inbox = Inbox(loop)
            undo.callback(self.inbox.close)
            self.known = TokenGraph(self.session.id)
            self._changes = TokenChanges(loop, self._graph_changed)
            undo.callback(self._changes.close)
            undo.callback(self.session.close)  # before what its threads write to
            before = f"{options.namespace.rstrip('/')}/{options.node_prefix}"
            self.nodes = {each: f"{before}_{each}" for each in NODES}
            for node in self.nodes.values():
                self.known.add(self.session.add_node(node).text)
            self._watches = GraphWatches(loop)
            undo.callback(self._watches.close)
            self._same_names = SameNames(loop, self.known.nodes, self.nodes.values())
            undo.callback(self._same_names.close)
            self._watches.add(self._same_names.look)
            self._foreign = ForeignSamples(_log_foreign)
            rest = (self.known, self.inbox, self._foreign)
            self._subscriptions = ZenohSubscriptions(ros, self.nodes["subscriptions"], *rest)
            undo.callback(self._subscriptions.close)
            self._of_actions = ZenohSubscriptions(ros, self.nodes["services"], *rest, in_order=True)
            undo.callback(self._of_actions.close)
            self.publishing = parts = ZenohParts(
                self.session,
                self.nodes,
                self.known,
                options,
                definitions,
                hash_of=self.hash_of,
                check_new=self.check_new,
                type_of_subscription=self._subscriptions.type_of,
                read=self._read,
                now_ns=lambda: self.now_ns(),
                on_change=self._watches.notify,
                guard=guard,
            )
            undo.callback(parts.close)
            self.services, self.actions, self.log = parts.services, parts.actions, parts.log
            self._told = RobotDefinitions(
                self, definitions, self._watches.notify, self.known, asks=options.asks_nodes
            )
            undo.callback(self._told.close)
            self.definitions = self._told.of
            self._refusals: Refusals | None = None
            if open_again is not None:
                self._refusals = Refusals(
                    loop,
                    self.session,
                    open_again,
                    self.known.has_node,
                    self._subscriptions.open,
                    parts.publishers,
                )
                undo.callback(self._refusals.close)
            self._clock = RobotClock()
            self.now_ns, self.watch_jumps_back = self._clock.now_ns, self._clock.watch
            if options.use_sim_time:
                self._open(CLOCK_TOPIC, CLOCK_TYPE, Qos(depth=1), self._clock.hear, nobody)
            self._changes.watch(self.session.watch_tokens)
            self._undo = undo.pop_all()

    def close(self) -> None:
        """End everything that is open, then the session. No callback follows."""
        self._undo.close()

    @property
    def diagnosis(self) -> Self:
        """The part that reports on the source itself."""
        return self

    def shared_names(self) -> Sequence[str]:
        """Return the names that several nodes have."""
        return self._same_names.known

    # The graph

    @property
    def distro(self) -> str:
        """The ROS distribution of the robot, as far as its tokens show it."""
        return "humble" if self.known.is_humble else "zenoh"

    @property
    def network(self) -> Mapping[str, str | int]:
        """The reach of its discovery: the router of Zenoh knows all nodes."""
        domain_id = self._options.domain_id or 0
        return {"domain_id": domain_id, "rmw": "rmw_zenoh_cpp", "discovery": "ROUTER"}

    def topics(self) -> Mapping[str, Sequence[str]]:
        """Return the types of all topics."""
        return self.known.topics()

    def topic_types(self, topic: str) -> tuple[str, ...]:
        """Return the types of a topic."""
        return self.known.topic_types(topic)

    def service_types(self, service: str) -> tuple[str, ...]:
        """Return the types of a service."""
        return self.known.service_types(service)

    def action_types(self, action: str) -> tuple[str, ...]:
        """Return the types of an action."""
        return self.known.action_types(action)

    def graph(self) -> Graph:
        """Return the graph that is known now."""
        return self.known.whole()

    def watch_graph(self, on_change: Callable[[], None]) -> GraphWatch:
        """Call *on_change* soon after the graph has changed."""
        return self._watches.add(on_change)

    # Topics

    def subscribe(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        on_samples: OnSamples,
        on_event: Callable[[TopicEvent], None],
    ) -> ZenohSubscription:
        """Subscribe to a fully resolved topic name."""
        check_topic(topic)
        self.check_new(f"topic {topic}", type_name, self.publishing.type_of(topic))
        return self._open(topic, type_name, qos, on_samples, on_event)

    def check_new(
        self,
        subject: str,
        type_name: str,
        known: str | None,
        *,
        is_reserved: bool = False,
        is_own: bool = False,
    ) -> None:
        """Check that one more entity may be opened.

        Raises:
            RosError: there are too many, or it is open with another type.
        """
        if not is_own:
            check_room(self.entity_count(), self._options, is_reserved=is_reserved)
        if known not in {None, type_name}:
            raise RosError("type_conflict", f"{subject} is open here as {known}, not {type_name}")

    def hash_of(self, type_name: str) -> str | None:
        """Return the hash of the definition here.

        Raises:
            RosError: ``bad_type``: there is no definition.
        """
        try:
            definition = self._definitions.get(type_name)
        except (UnknownTypeError, DefinitionError) as error:
            raise RosError("bad_type", str(error)) from error
        try:
            return type_hash(definition, self._definitions)
        except (UnknownTypeError, DefinitionError):
            return None

    def entity_count(self) -> int:
        """Count the open entities of this source."""
        return len(self._subscriptions.open) + self.publishing.count()

    # Faults

    def faults(self) -> Sequence[Fault]:
        """Return what is wrong with the robot's graph. Ask every few seconds."""
        guard = self.publishing.guard
        faults = [] if guard is None else list(guard.faults())
        unlisted = self._subscriptions.unlisted
        if self._refusals is not None:
            faults += self._refusals.faults()
        return [*faults, *robot_faults(self.session, self._changes, self.known, unlisted)]

    def _open(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        on_samples: OnSamples,
        on_event: Callable[[TopicEvent], None],
    ) -> ZenohSubscription:
        stream = (topic, type_name)
        subscription = ZenohSubscription(
            self._subscriptions, stream, self.hash_of(type_name), qos, on_samples, on_event
        )
        # Not from within this call: the caller does not hold the subscription yet.
        asyncio.get_running_loop().call_soon(subscription.report)
        self._watches.notify()
        return subscription

    def _read(self, topic: str, type_name: str, on_samples: OnSamples) -> ZenohSubscription:
        """Subscribe to the feedback of an action. It does not count as an entity."""
        return ZenohSubscription(
            self._of_actions,
            (topic, type_name),
            self.hash_of(type_name),
            Qos("reliable", "volatile", "keep_last", MAX_QUEUE_DEPTH),
            on_samples,
            nobody,
        )

    def _graph_changed(self, changes: Mapping[str, bool]) -> None:
        self.known.apply(changes)
        self._subscriptions.follow_publishers()
        self.publishing.follow_graph()
        self._told.on_graph_change()
        self._watches.notify()


@contextlib.asynccontextmanager
async def open_source(
    zenoh_options: ZenohOptions, config: Config, definitions: InstalledDefinitions
) -> AsyncIterator[ZenohSource]:
    """Take part in the robot's ROS on the running loop, until the context ends.

    Raises:
        RosStartError: the router cannot be reached.
    """
    options = RosOptions(
        node_prefix=config.ros.node_prefix,
        namespace=config.ros.namespace,
        domain_id=domain_id(config),
        use_sim_time=config.ros.use_sim_time,
        max_entities=config.limits.max_ros_entities,
        reserved_topics=config.control.topics,
        reserved_entities=config.limits.reserved_ros_entities,
        asks_nodes=config.types.ask_nodes,
    )
    session = await asyncio.to_thread(open_session, zenoh_options)
    guard = guard_of(zenoh_options, options, definitions, config.control.deadline_s)
    async with contextlib.AsyncExitStack() as undo:
        source = ZenohSource(
            session, options, definitions, guard, lambda: open_session(zenoh_options)
        )
        undo.callback(source.close)
        await undo.enter_async_context(guard)
        yield source


def guard_of(
    zenoh_options: ZenohOptions,
    options: RosOptions,
    definitions: InstalledDefinitions,
    deadline_s: float,
) -> GuardProcess:
    """Return the guard, which is still to be started. It has a separate session."""
    hashes = {}
    for type_name in (TWIST, TWIST_STAMPED):
        with contextlib.suppress(UnknownTypeError, DefinitionError):
            hashes[type_name] = type_hash(definitions.get(type_name), definitions)
    namespace, _, name = options.guard_node.rpartition("/")
    node = {
        "name": name,
        "namespace": namespace or "/",
        "domain_id": options.domain_id or 0,
        "router": zenoh_options.router,
        "commander": f"{options.namespace.rstrip('/')}/{options.node_prefix}_publishers",
        "hashes": hashes,
    }
    node_class = "gateway.sources.zenoh.guard_node:ZenohGuardNode"
    return GuardProcess(node_class, node, deadline_s=deadline_s)


def domain_id(config: Config) -> int:
    """Return the ROS domain: as configured, or that of the environment, or 0."""
    if config.ros.domain_id is not None:
        return config.ros.domain_id
    text = os.environ.get("ROS_DOMAIN_ID", "")
    return int(text) if text.isdecimal() else 0


def _log_foreign(why: str) -> None:
    _logger.warning("samples that no node of ROS has published are left out: %s", why)
