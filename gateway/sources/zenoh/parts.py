# SPDX-License-Identifier: Apache-2.0
"""The parts of the Zenoh source that speak: publishers, services, and its own log."""

import asyncio
import contextlib
import time
from collections.abc import Callable, Mapping
from typing import Final

from gateway.codec.types import Types
from gateway.guard.supervisor import GuardProcess
from gateway.sources.name_checks import check_topic
from gateway.sources.options import RosOptions
from gateway.sources.source import LogLevel, Qos, TopicEvent
from gateway.sources.zenoh.actions import Read, ZenohActions
from gateway.sources.zenoh.events import nobody
from gateway.sources.zenoh.keys import NO_TYPE_HASH
from gateway.sources.zenoh.outgoing import Mailbox, Outgoing
from gateway.sources.zenoh.publishing import ZenohPublisher, ZenohPublishers
from gateway.sources.zenoh.requester import ZenohEndpoints
from gateway.sources.zenoh.service_forms import service_wire
from gateway.sources.zenoh.services import ZenohServices
from gateway.sources.zenoh.session import ZenohSession
from gateway.sources.zenoh.token_graph import TokenGraph
from schemas.installed import InstalledDefinitions

ROSOUT: Final = "/rosout"
LOG: Final = "rcl_interfaces/msg/Log"
# as rclpy has it
ROSOUT_QOS: Final = Qos(
    "reliable", "transient_local", "keep_last", 1000, lifespan_ns=10_000_000_000
)
LEVELS: Final[Mapping[LogLevel, int]] = {"debug": 10, "info": 20, "warning": 30, "error": 40}

# Checks that one more may be opened: subject, type, the type that is open here, and whether room
# is kept for it.
CheckNew = Callable[..., None]


class ZenohParts:
    """Implements `gateway.sources.source.Publishing`, and has the services."""

    def __init__(  # noqa: PLR0913  # what the source has
        self,
        session: ZenohSession,
        nodes: Mapping[str, str],
        graph: TokenGraph,
        options: RosOptions,
        definitions: InstalledDefinitions,
        *,
        hash_of: Callable[[str], str | None],
        check_new: CheckNew,
        type_of_subscription: Callable[[str], str | None],
        read: Read,
        now_ns: Callable[[], int],
        on_change: Callable[[], None],
        guard: GuardProcess | None = None,
    ) -> None:
        self.guard = guard
        loop = asyncio.get_running_loop()
        self._graph, self._options, self._hash_of = graph, options, hash_of
        self._check_new, self._on_change = check_new, on_change
        self._type_of_subscription = type_of_subscription
        self._types = Types(definitions)
        self._outgoing, self._mailbox = Outgoing(), Mailbox(loop)
        self._publishers, self._own = (
            ZenohPublishers(
                session,
                nodes[node],
                graph,
                self._outgoing,
                self._own_hash,
                options.reserved_topics,
            )
            for node in ("publishers", "debug")
        )
        self._serving = serving = ZenohEndpoints(
            session, nodes["services"], graph, self._mailbox, self._outgoing, loop
        )
        self.services = ZenohServices(
            serving, lambda name: service_wire(self._types, name), check_new, on_change
        )
        self._of_actions = ZenohPublishers(
            session, nodes["services"], graph, self._outgoing, self._own_hash
        )
        self.actions = ZenohActions(
            serving, self._types, self._of_actions, read, check_new, on_change, now_ns
        )
        self._debug_node = nodes["debug"]
        self._rosout: ZenohPublisher | None = self._own.advertise(ROSOUT, LOG, ROSOUT_QOS, nobody)

    @property
    def publishers(self) -> Mapping[ZenohPublisher, None]:
        """The publishers that clients have opened."""
        return self._publishers.open

    def refuse_unheard(self, remedy: str) -> None:
        """Refuse messages of clients that the router keeps from subscriptions that it lists."""
        self._publishers.refuse_unheard(remedy)

    def count(self) -> int:
        """Count what clients have opened."""
        return len(self._publishers.open) + len(self.services) + len(self.actions)

    def close(self) -> None:
        """Close what is open, and send what waits."""
        self._rosout = None
        with contextlib.ExitStack() as undo:  # one that fails keeps none of the others open
            undo.callback(self._mailbox.close)
            undo.callback(self._outgoing.close)
            parts = (self._own, self._of_actions, self._publishers, self.services, self.actions)
            for part in parts:
                undo.callback(part.close)

    def follow_graph(self) -> None:
        """Follow subscriptions and servers that have come or gone."""
        self._publishers.follow_subscribers()
        self._of_actions.follow_subscribers()
        self.services.follow_graph()
        self.actions.follow_graph()
        for follow in list(self._serving.servers):
            follow()

    def type_of(self, topic: str) -> str | None:
        """Return the type with which a topic is open here."""
        return (
            self._type_of_subscription(topic)
            or self._publishers.type_of(topic)
            or self._own.type_of(topic)
        )

    def readers(self, topic: str) -> frozenset[str]:
        """Return the ids of the subscriptions that other nodes have to a topic."""
        return self._graph.readers(topic)

    def advertise(
        self, topic: str, type_name: str, qos: Qos, on_event: Callable[[TopicEvent], None]
    ) -> ZenohPublisher:
        """Create a publisher on a fully resolved topic name. See the port."""
        check_topic(topic)
        is_reserved = topic in self._options.reserved_topics
        self._check_new(f"topic {topic}", type_name, self.type_of(topic), is_reserved=is_reserved)
        publisher = self._publishers.advertise(topic, type_name, qos, on_event)
        # Not from within this call: the caller does not hold the publisher yet.
        asyncio.get_running_loop().call_soon(self._follow_new, publisher)
        self._on_change()
        return publisher

    def advertise_own(self, topic: str, type_name: str, qos: Qos) -> ZenohPublisher:
        """Create a publisher of the gateway itself. See the port."""
        check_topic(topic)
        known = self.type_of(topic)
        self._check_new(f"topic {topic}", type_name, known, is_own=True)
        publisher = self._own.advertise(topic, type_name, qos, nobody)
        self._on_change()
        return publisher

    def log(self, level: LogLevel, text: str) -> None:
        """Publish on ``/rosout``, as the debug node."""
        if self._rosout is None:
            return
        message = {
            "stamp": "now",
            "level": LEVELS[level],
            "name": self._debug_node.strip("/").replace("/", "."),
            "msg": text,
        }
        encode = self._types.get(LOG).encode
        self._rosout.publish(encode(message, time.time_ns))

    def _follow_new(self, publisher: ZenohPublisher) -> None:
        if publisher in self._publishers.open:
            publisher.follow()

    def _own_hash(self, type_name: str) -> str:
        return self._hash_of(type_name) or NO_TYPE_HASH
