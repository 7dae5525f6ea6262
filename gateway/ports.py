# SPDX-License-Identifier: Apache-2.0
"""What the router needs from ROS, as Protocols.

`gateway.ros` is the real thing; the tests' fake passes the same contract suite. Everything
here is called on the event loop's thread, returns without blocking, and every callback comes
back on that thread.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple, Protocol

Reliability = Literal["reliable", "best_effort"]
Durability = Literal["volatile", "transient_local"]
History = Literal["keep_last", "keep_all"]
LogLevel = Literal["debug", "info", "warning", "error"]


class RosError(Exception):
    """ROS refuses what was asked for; ``code`` is the protocol's word for the reason."""

    def __init__(
        self, code: Literal["bad_name", "bad_type", "limit_exceeded", "internal"], reason: str
    ) -> None:
        super().__init__(reason)
        self.code = code


class Sample(NamedTuple):
    """One message as it came from DDS."""

    cdr: bytes  # with its 4-byte encapsulation header
    received_ns: int  # when the middleware took it, nanoseconds of the system clock


@dataclass(frozen=True, slots=True)
class Qos:
    """A quality of service; ``None`` means: adopt what the other side offers.

    Durations are nanoseconds, ``None`` being unlimited.
    """

    reliability: Reliability | None = None
    durability: Durability | None = None
    history: History | None = None
    depth: int | None = None
    deadline_ns: int | None = None
    lifespan_ns: int | None = None


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic of the graph: its types (more than one is a conflict) and who is on it."""

    name: str
    types: tuple[str, ...]  # pkg/msg/Name
    publishers: tuple[str, ...]  # full node names, one entry per endpoint, sorted
    subscribers: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Graph:
    """One picture of the ROS graph, sorted by name."""

    topics: tuple[Topic, ...]
    nodes: tuple[str, ...]  # full names


class Subscription(Protocol):
    """A ROS subscription that delivers raw samples until closed."""

    @property
    def qos(self) -> Qos:
        """The profile in force, with nothing left to adopt; it may change with the publishers."""

    @property
    def publishers(self) -> int:
        """How many publishers of its type the topic has, as far as discovery knows.

        Late clients of a transient-local topic get as many samples.
        """

    @property
    def incompatible(self) -> tuple[str, ...]:
        """What *on_incompatible* was told and still holds."""

    def close(self) -> None:
        """Destroy it; no callback comes after. Closing twice is harmless."""


class Publisher(Protocol):
    """A ROS publisher of raw samples."""

    def publish(self, cdr: bytes) -> None:
        """Publish one sample, encapsulation header included. Not after `close`."""

    def close(self) -> None:
        """Destroy it. Closing twice is harmless."""


class Watch(Protocol):
    """A standing request for callbacks."""

    def close(self) -> None:
        """End it; no callback comes after. Closing twice is harmless."""


class Ros(Protocol):
    """ROS 2 as the gateway uses it."""

    @property
    def distro(self) -> str:
        """The ROS distribution, such as ``jazzy``."""

    def now_ns(self) -> int:
        """ROS time in nanoseconds (simulated time where ``use_sim_time`` is set)."""

    def subscribe(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        on_samples: Callable[[Sequence[Sample]], None],
        on_incompatible: Callable[[str], None],
    ) -> Subscription:
        """Subscribe to a fully resolved topic name.

        *on_samples* gets what arrived since its last call, oldest first, never empty, at most
        `MAX_TAKES_PER_TURN` at once. What *qos* leaves open is adopted from the publishers and
        adopted anew when they change. *on_incompatible* gets a sentence for people whenever a
        publisher's offer cannot be matched.

        Raises:
            RosError: the name or the type is none, or the type has no ROS package here.
        """

    def advertise(self, topic: str, type_name: str, qos: Qos) -> Publisher:
        """Create a publisher on a fully resolved topic name; open QoS fields get defaults.

        Raises:
            RosError: as for `subscribe`.
        """

    def topic_types(self, topic: str) -> tuple[str, ...]:
        """Return the types of a topic, sorted, empty where the graph does not know it.

        These are what its publishers publish; without any, what its subscribers expect, the
        gateway's own counting only where they are alone.
        """

    def graph(self) -> Graph:
        """Return the graph as it is known now."""

    def watch_graph(self, on_change: Callable[[], None]) -> Watch:
        """Call *on_change* soon after topics, types, endpoints or nodes have changed.

        Changes close together are reported once. Cheap while nothing changes.
        """

    def log(self, level: LogLevel, text: str) -> None:
        """Write to the debug node's logger, and so to ``/rosout``."""

    def entity_count(self) -> int:
        """Count the subscriptions and publishers open through this port."""


MAX_TAKES_PER_TURN = 32  # 4 ms of 4 kHz Odometry; then other sockets and topics get their turn
