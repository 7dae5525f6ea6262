# SPDX-License-Identifier: Apache-2.0
"""ROS in memory: the port without DDS, and the outside world to drive it with.

Messages that go in come out within a few turns of the event loop. `test_contract.py` holds it to
what the real one does.
"""

import asyncio
from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, Self

from gateway.codec.types import Types
from gateway.faults import Fault
from gateway.sources.actions import GoalRequest
from gateway.sources.graph import Graph, ServerInfo, TopicInfo
from gateway.sources.guard import Guard
from gateway.sources.name_checks import (
    TypeKind,
    check_action,
    check_service,
    check_topic,
    split_type,
)
from gateway.sources.node_definitions import NodeDefinitions, TypeHolder
from gateway.sources.options import RosOptions, check_room
from gateway.sources.qos import (
    Endpoint,
    adopt,
    complete_offer,
    gone,
    is_latched,
    is_same_request,
    offered,
    unmatched_publishers,
    unmatched_subscribers,
)
from gateway.sources.services import ServiceRequest
from gateway.sources.source import (
    MAX_TAKES_PER_TURN,
    LogLevel,
    Origin,
    Qos,
    RosError,
    Sample,
    TopicEvent,
)
from schemas.definition import Definition
from schemas.definition_text import parse_definition
from schemas.folders import SHIPPED
from schemas.installed import InstalledDefinitions, UnknownTypeError
from schemas.type_hash import type_description, type_hash
from tests.sources.fake_actions import FakeActionClient, FakeActionServer
from tests.sources.fake_guard import FakeGuard
from tests.sources.fake_services import FakeClient, FakeService

_MAX_RETAINED: Final = 1024
_NOUNS: Final = {"msg": "topic", "srv": "service", "action": "action"}


@dataclass(eq=False)
class FakePublisher:
    """A publisher on the fake's topics, outside or the gateway's own."""

    ros: "FakeRos"
    topic: str
    type_name: str
    qos: Qos
    node: str
    retained: deque[Sample] = field(default_factory=deque)
    on_event: Callable[[TopicEvent], None] = lambda _: None
    reported: list[TopicEvent] = field(default_factory=list)
    met: set[str] = field(default_factory=set)

    def new_matches(self) -> int:
        known = len(self.met)
        own = [each for each in self.ros.subscriptions if each.takes_from(self)]
        self.met |= {each.id for each in own}
        return len(self.met) - known

    def publish(self, cdr: bytes) -> None:
        assert self in self.ros.publishers, "published after close"
        self.ros.published += 1  # no two samples are published at the same time
        sample = Sample(cdr, self.ros.now, self.ros.published, publisher=b"%d" % id(self))
        if self.qos.durability == "transient_local":
            self.retained.append(sample)
        self.ros.arrive(self, sample)

    def close(self) -> None:
        if self in self.ros.publishers:
            self.ros.publishers.remove(self)
            self.ros.changed()

    @property
    def offer(self) -> Endpoint:
        return _endpoint(self.node, self.type_name, self.qos)

    def follow(self) -> None:
        subscribers = [
            _endpoint(each.node, each.type_name, each.qos)
            for each in self.ros.subscriptions
            if each.topic == self.topic and not self.ros.is_own(each.node)
        ]
        known = self.reported
        self.reported = unmatched_subscribers(self.topic, self.type_name, self.qos, subscribers)
        for reason in self.reported:
            if reason not in known and self in self.ros.publishers:
                self.on_event(reason)


@dataclass(eq=False)
class FakeSubscription:
    """A subscription to the fake's topics, outside or the gateway's own."""

    ros: "FakeRos"
    topic: str
    type_name: str
    asked: Qos
    on_samples: Callable[[Sequence[Sample]], None]
    on_event: Callable[[TopicEvent], None]
    node: str
    id: str = field(init=False)
    qos: Qos = field(init=False)
    matched: list[Endpoint] = field(init=False)
    waiting: deque[Sample] = field(default_factory=deque)
    reported: list[TopicEvent] = field(default_factory=list)
    is_scheduled: bool = False
    lost: int = 0
    origins: set[Origin] = field(default_factory=set)  # of what has come

    def __post_init__(self) -> None:
        self.ros.subscribed += 1
        self.id = f"{self.ros.subscribed:032x}"
        self.matched = self.matching()
        self.qos = adopt(self.asked, self.matched)

    @property
    def publishers(self) -> int:
        return sum(map(self.takes_from, self.ros.publishers))

    def join_late(self, on_samples: Callable[[Sequence[Sample]], None]) -> "FakeSubscription":
        return self.ros.open_subscription(
            self.topic, self.type_name, self.qos, on_samples, lambda _: None, self.node
        )

    @property
    def incompatible(self) -> tuple[TopicEvent, ...]:
        return tuple(self.reported)

    def close(self) -> None:
        if self in self.ros.subscriptions:
            self.ros.subscriptions.remove(self)
            self.ros.changed()

    @property
    def offers(self) -> list[Qos]:
        return offered(self.matching())

    def matching(self) -> list[Endpoint]:
        return [o for o in self.ros.offers(self.topic) if o.type_name == self.type_name]

    def takes_from(self, publisher: FakePublisher) -> bool:
        return publisher.topic == self.topic and not unmatched_publishers(
            self.topic, self.type_name, self.qos, [publisher.offer]
        )

    def follow(self) -> None:
        offers = self.matching()
        before, self.matched = self.matched, offers
        for event in gone(self.topic, before, offers):
            if self in self.ros.subscriptions:
                self.on_event(event)
        qos = adopt(self.asked, offers, self.qos)
        if not is_same_request(qos, self.qos):
            self.qos = qos
            self.take_retained()
        known = self.reported
        self.reported = unmatched_publishers(
            self.topic, self.type_name, self.qos, self.ros.offers(self.topic)
        )
        for reason in self.reported:
            if reason not in known and self in self.ros.subscriptions:
                self.on_event(reason)

    def take_retained(self) -> None:
        if self.qos.durability == "transient_local":
            for publisher in self.ros.publishers:
                if self.takes_from(publisher):
                    for sample in publisher.retained:
                        self.put(sample)

    def put(self, sample: Sample) -> None:
        if sample.origin in self.origins:
            return
        self.origins.add(sample.origin)
        self.waiting.append(sample)
        if self.qos.history == "keep_last" and len(self.waiting) > (self.qos.depth or 1):
            self.waiting.popleft()
            self.lost += self.publishers == 1
        self._schedule()

    def _schedule(self) -> None:
        if not self.is_scheduled:
            self.is_scheduled = True
            self.ros.loop.call_soon(self._deliver)

    def _deliver(self) -> None:
        self.is_scheduled = False
        if self not in self.ros.subscriptions:
            return
        waiting = self.waiting
        samples = [waiting.popleft() for _ in range(min(len(waiting), MAX_TAKES_PER_TURN))]
        if waiting:
            self._schedule()
        if samples:
            self.on_samples(samples)


TopicEndpoint = FakePublisher | FakeSubscription
Caller = FakeClient | FakeActionClient
Server = FakeService | FakeActionServer


class FakeWatch:
    """A watch of something in the fake, one of *watches*."""

    def __init__(
        self, ros: "FakeRos", on_change: Callable[[], None], watches: "list[FakeWatch]"
    ) -> None:
        self.ros = ros
        self.on_change = on_change
        self.watches = watches
        watches.append(self)

    def close(self) -> None:
        if self in self.watches:
            self.watches.remove(self)


class FakeRos:
    """The port. Further public members are for tests to look at and to drive."""

    def __init__(
        self,
        *,
        prefix: str = "ros2_gateway",
        options: RosOptions | None = None,
        types: Types | None = None,
        guard: Guard | None = None,
    ) -> None:
        self.guard = guard or FakeGuard()
        self.loop = asyncio.get_running_loop()
        self.prefix = prefix
        self.options = options or RosOptions()
        self.now = 1_700_000_000_000_000_000
        self.published = 0
        self.subscribed = 0
        self.publishers: list[FakePublisher] = []
        self.subscriptions: list[FakeSubscription] = []
        self.clients: list[FakeClient] = []
        self.service_servers: list[FakeService] = []
        self.action_clients: list[FakeActionClient] = []
        self.action_servers: list[FakeActionServer] = []
        self.watches: list[FakeWatch] = []
        self.jump_watches: list[FakeWatch] = []
        self.logged: list[tuple[LogLevel, str]] = []
        self.found: list[Fault] = []
        self.shared: tuple[str, ...] = ()
        self.hashes: dict[str, str] = {}  # of types that are not installed
        self._types = types or Types(InstalledDefinitions(folders=[SHIPPED]))
        self._is_changing = False
        self.told = NodeDefinitions(
            self,
            self._types.definitions,
            self.changed,
            holders=self.type_holders,
            make_types=_nothing,
        )

    # The port

    @property
    def publishing(self) -> Self:
        return self

    services = actions = diagnosis = publishing

    refusal = None

    @property
    def distro(self) -> str:
        return "jazzy"

    @property
    def network(self) -> Mapping[str, str | int]:
        return {"domain_id": 0, "rmw": "rmw_fastrtps_cpp", "discovery": "SUBNET"}

    def faults(self) -> Sequence[Fault]:
        return self.found

    def shared_names(self) -> Sequence[str]:
        return self.shared

    def now_ns(self) -> int:
        return self.now

    def subscribe(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        on_samples: Callable[[Sequence[Sample]], None],
        on_event: Callable[[TopicEvent], None],
    ) -> FakeSubscription:
        self._check_topic(topic, type_name)
        return self.open_subscription(
            topic, type_name, qos, on_samples, on_event, f"/{self.prefix}_subscriptions"
        )

    def advertise(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        on_event: Callable[[TopicEvent], None],
    ) -> FakePublisher:
        self._check_topic(topic, type_name, is_reserved=topic in self.options.reserved_topics)
        publisher = self.add_publisher(topic, type_name, qos, f"/{self.prefix}_publishers")
        publisher.on_event = on_event
        return publisher

    def advertise_own(self, topic: str, type_name: str, qos: Qos) -> FakePublisher:
        self._check_topic(topic, type_name)
        return self.add_publisher(topic, type_name, qos, f"/{self.prefix}_debug")

    def client(self, service: str, type_name: str) -> FakeClient:
        check_service(service)
        self._check_new(service, type_name, "srv", [*self.clients, *self.service_servers])
        return self.add_client(service, type_name, f"/{self.prefix}_services")

    def serve(
        self, service: str, type_name: str, on_request: Callable[[ServiceRequest], None]
    ) -> FakeService:
        check_service(service)
        self._check_new(service, type_name, "srv", [*self.clients, *self.service_servers])
        if any(each.name == service for each in self.service_servers if self.is_own(each.node)):
            raise RosError("limit_exceeded", f"service {service} is provided here already")
        return self.add_service(service, type_name, on_request, f"/{self.prefix}_services")

    def action_client(self, action: str, type_name: str) -> FakeActionClient:
        check_action(action)
        self._check_new(action, type_name, "action", [*self.action_clients, *self.action_servers])
        return self.add_action_client(action, type_name, f"/{self.prefix}_services")

    def serve_action(
        self,
        action: str,
        type_name: str,
        on_goal: Callable[[GoalRequest], None],
        on_cancel: Callable[[GoalRequest], None],
    ) -> FakeActionServer:
        check_action(action)
        self._check_new(action, type_name, "action", [*self.action_clients, *self.action_servers])
        if any(each.name == action for each in self.action_servers if self.is_own(each.node)):
            raise RosError("limit_exceeded", f"action {action} is provided here already")
        node = f"/{self.prefix}_services"
        return self.add_action_server(action, type_name, on_goal, on_cancel, node=node)

    async def definitions(self, type_name: str) -> Mapping[str, Definition] | None:
        return await self.told.of(type_name)

    def topics(self) -> dict[str, tuple[str, ...]]:
        endpoints: list[TopicEndpoint] = [*self.publishers, *self.subscriptions]
        return {each.topic: self.topic_types(each.topic) for each in endpoints}

    def type_holders(self, topic: str, type_name: str) -> tuple[TypeHolder, ...]:
        endpoints: list[TopicEndpoint] = [*self.publishers, *self.subscriptions]
        nodes = dict.fromkeys(
            each.node
            for each in endpoints
            if (each.topic, each.type_name) == (topic, type_name) and not self.is_own(each.node)
        )
        return tuple(TypeHolder(node, self._hash(type_name)) for node in nodes)

    def readers(self, topic: str) -> frozenset[str]:
        others = [each for each in self.subscriptions if not self.is_own(each.node)]
        return frozenset(each.id for each in others if each.topic == topic)

    def topic_types(self, topic: str) -> tuple[str, ...]:
        publishers = [p for p in self.publishers if p.topic == topic]
        subscriptions = [s for s in self.subscriptions if s.topic == topic]
        others = [s for s in subscriptions if not self.is_own(s.node)]
        return tuple(sorted({e.type_name for e in publishers or others or subscriptions}))

    def service_types(self, service: str) -> tuple[str, ...]:
        return tuple(sorted({s.type_name for s in self.service_servers if s.name == service}))

    def action_types(self, action: str) -> tuple[str, ...]:
        return tuple(sorted({s.type_name for s in self.action_servers if s.name == action}))

    def graph(self) -> Graph:
        endpoints: list[TopicEndpoint] = [*self.publishers, *self.subscriptions]
        topics = (
            TopicInfo(
                name,
                tuple(sorted({e.type_name for e in endpoints if e.topic == name})),
                tuple(sorted(p.node for p in self.publishers if p.topic == name)),
                tuple(sorted(s.node for s in self.subscriptions if s.topic == name)),
                is_latched([p.qos for p in self.publishers if p.topic == name]),
            )
            for name in sorted({endpoint.topic for endpoint in endpoints})
        )
        purposes = ("subscriptions", "publishers", "services", "debug")
        nodes = {f"/{self.prefix}_{each}" for each in purposes}
        nodes |= {each.node for each in [*endpoints, *self._calling()]}
        return Graph(
            tuple(topics),
            tuple(sorted(nodes)),
            _provided(self.service_servers),
            _provided(self.action_servers),
        )

    def watch_graph(self, on_change: Callable[[], None]) -> FakeWatch:
        return FakeWatch(self, on_change, self.watches)

    def watch_jumps_back(self, on_jump: Callable[[], None]) -> FakeWatch:
        return FakeWatch(self, on_jump, self.jump_watches)

    def log(self, level: LogLevel, text: str) -> None:
        self.logged.append((level, text))

    def entity_count(self) -> int:
        topics: list[TopicEndpoint] = [*self.publishers, *self.subscriptions]
        own = [each.node for each in [*topics, *self._calling()] if self.is_own(each.node)]
        return sum(node != f"/{self.prefix}_debug" for node in own)

    # The world outside

    def set_time(self, now_ns: int) -> None:
        """Set simulated time."""
        is_back, self.now = now_ns < self.now, now_ns
        if is_back:
            for watch in list(self.jump_watches):
                self.loop.call_soon(watch.on_change)

    def publish(self, topic: str, cdr: bytes) -> None:
        """Publish from the outside publisher that was added to a topic first."""
        next(p for p in self.publishers if p.topic == topic and not self.is_own(p.node)).publish(
            cdr
        )

    def add_publisher(
        self, topic: str, type_name: str, qos: Qos | None = None, node: str = "/outside"
    ) -> FakePublisher:
        """Add a publisher. Members that *qos* leaves open get the defaults of ROS."""
        offered = complete_offer(qos or Qos())
        publisher = FakePublisher(
            self, topic, type_name, offered, node, deque(maxlen=offered.depth or _MAX_RETAINED)
        )
        self.publishers.append(publisher)
        self.changed()
        return publisher

    def add_described_publisher(self, topic: str, type_name: str, text: str) -> None:
        """Publish a type that no other process has a file of. Its node has the definition."""
        told = {type_name: parse_definition(type_name, text)}
        definitions = self._types.definitions.with_told(told)
        self.hashes[type_name] = type_hash(told[type_name], definitions)
        service_type = self._types.service("type_description_interfaces/srv/GetTypeDescription")
        described = type_description(told[type_name], definitions)
        answer = {"successful": True, "type_description": described}
        response = service_type.response.encode(answer, 0)
        name = "/outside/get_type_description"
        self.add_service(name, service_type.name, lambda request: request.answer(response))
        self.add_publisher(topic, type_name)

    def remove_publisher(self, publisher: FakePublisher) -> None:
        """Let a publisher vanish."""
        publisher.close()

    def add_subscription(
        self,
        topic: str,
        type_name: str,
        on_samples: Callable[[Sequence[Sample]], None],
        qos: Qos | None = None,
        node: str = "/outside",
    ) -> FakeSubscription:
        """Add a subscription that sees what is published, by the gateway too."""
        return self.open_subscription(
            topic, type_name, qos or Qos(), on_samples, lambda _: None, node
        )

    def remove_subscription(self, subscription: FakeSubscription) -> None:
        """Let a subscription vanish."""
        subscription.close()

    def add_client(self, name: str, type_name: str, node: str = "/outside") -> FakeClient:
        """Add a client of a service."""
        client = FakeClient(self, name, type_name, node)
        self.clients.append(client)
        self.changed()
        return client

    def add_service(
        self,
        name: str,
        type_name: str,
        on_request: Callable[[ServiceRequest], None],
        node: str = "/outside",
    ) -> FakeService:
        """Add a server of a service. Closing it lets it vanish."""
        service = FakeService(self, name, type_name, on_request, node)
        self.service_servers.append(service)
        self.changed()
        return service

    def add_action_client(
        self, name: str, type_name: str, node: str = "/outside"
    ) -> FakeActionClient:
        """Add a client of an action."""
        client = FakeActionClient(self, name, type_name, node)
        self.action_clients.append(client)
        self.changed()
        return client

    def add_action_server(
        self,
        name: str,
        type_name: str,
        on_goal: Callable[[GoalRequest], None],
        on_cancel: Callable[[GoalRequest], None],
        accepts: Callable[[bytes], bool] = lambda goal: True,
        node: str = "/outside",
    ) -> FakeActionServer:
        """Add a server of an action. Closing it lets it vanish, with its goals unfinished."""
        server = FakeActionServer(self, name, type_name, on_goal, on_cancel, node, accepts)
        self.action_servers.append(server)
        self.changed()
        return server

    # For its parts

    def is_own(self, node: str) -> bool:
        return node.startswith(f"/{self.prefix}_")

    def empty(self, type_name: str) -> bytes:
        message_type = self._types.get(type_name)
        return message_type.encode({}, now_ns=0)

    def offers(self, topic: str) -> list[Endpoint]:
        return [p.offer for p in self.publishers if p.topic == topic]

    def arrive(self, publisher: FakePublisher, sample: Sample) -> None:
        for subscription in self.subscriptions:
            if subscription.takes_from(publisher):
                subscription.put(sample)

    def changed(self) -> None:
        if not self._is_changing:
            self._is_changing = True
            self.loop.call_soon(self._tell)

    def _calling(self) -> "list[Caller | Server]":
        calling: list[Caller | Server] = [*self.clients, *self.service_servers]
        return [*calling, *self.action_clients, *self.action_servers]

    def _tell(self) -> None:
        self._is_changing = False
        for subscription in list(self.subscriptions):
            subscription.follow()
        for publisher in list(self.publishers):
            publisher.follow()
        for client in list(self.clients):
            client.follow()
        for action_client in list(self.action_clients):
            action_client.follow()
        self.told.on_graph_change()
        for watch in list(self.watches):
            if watch in self.watches:
                watch.on_change()

    def open_subscription(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        on_samples: Callable[[Sequence[Sample]], None],
        on_event: Callable[[TopicEvent], None],
        node: str,
    ) -> FakeSubscription:
        subscription = FakeSubscription(self, topic, type_name, qos, on_samples, on_event, node)
        self.subscriptions.append(subscription)
        subscription.take_retained()
        self.changed()
        return subscription

    def _hash(self, type_name: str) -> str:
        if type_name in self.hashes:
            return self.hashes[type_name]
        definitions = self._types.definitions
        return type_hash(definitions.get(type_name), definitions)

    def _check_topic(self, topic: str, type_name: str, *, is_reserved: bool = False) -> None:
        check_topic(topic)
        others = [*self.publishers, *self.subscriptions]
        self._check_new(topic, type_name, "msg", others, is_reserved=is_reserved)

    def _check_new(
        self,
        name: str,
        type_name: str,
        kind: TypeKind,
        others: Iterable[TopicEndpoint | Caller | Server],
        *,
        is_reserved: bool = False,
    ) -> None:
        check_room(self.entity_count(), self.options, is_reserved=is_reserved)
        split_type(type_name, kind)
        try:
            if kind == "msg":
                self._types.get(type_name)
            else:
                self._types.definitions.interface(type_name)
        except UnknownTypeError as error:
            raise RosError("bad_type", str(error)) from error
        for other in others:
            known = other.type_name
            if self.is_own(other.node) and _name(other) == name and known != type_name:
                subject = f"{_NOUNS[kind]} {name}"
                text = f"{subject} is open here as {known}, not {type_name}"
                raise RosError("type_conflict", text)


async def _nothing() -> None:
    """Any type can be used here."""


def _name(each: TopicEndpoint | Caller | Server) -> str:
    return each.topic if isinstance(each, FakePublisher | FakeSubscription) else each.name


def _provided(servers: Sequence[Server]) -> tuple[ServerInfo, ...]:
    return tuple(
        ServerInfo(
            name,
            tuple(sorted({s.type_name for s in servers if s.name == name})),
            tuple(sorted(s.node for s in servers if s.name == name)),
        )
        for name in sorted({server.name for server in servers})
    )


def _endpoint(node: str, type_name: str, qos: Qos) -> Endpoint:
    assert qos.reliability is not None
    assert qos.durability is not None
    return Endpoint(
        node,
        type_name,
        qos.reliability,
        qos.durability,
        deadline_ns=qos.deadline_ns,
        lifespan_ns=qos.lifespan_ns,
    )
