# SPDX-License-Identifier: Apache-2.0
"""The interface of the core to a robot, as Protocols: a source.

Every source has topics, a graph, and a clock. The other parts are ``None`` if it has none.
`gateway.sources.rclpy` implements all of them. The tests' fake passes the same contract suite.
Everything here is called on the event loop's thread and returns without blocking. Callbacks run on
that thread.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal, NamedTuple, Protocol

from gateway.codec.cdr import Cdr
from gateway.faults import Fault
from gateway.sources.actions import Actions
from gateway.sources.graph import Graph
from gateway.sources.guard import Guard
from gateway.sources.services import Services
from schemas.definition import Definition

Reliability = Literal["reliable", "best_effort"]
Durability = Literal["volatile", "transient_local"]
History = Literal["keep_last", "keep_all"]
LogLevel = Literal["debug", "info", "warning", "error"]


RosErrorCode = Literal[
    "bad_name", "bad_type", "type_conflict", "not_found", "forbidden", "limit_exceeded", "internal"
]


class RosError(Exception):
    """ROS refuses a request. ``code`` is the protocol's name of the reason."""

    def __init__(self, code: RosErrorCode, reason: str) -> None:
        super().__init__(reason)
        self.code = code


Origin = tuple[int, int | None]
"""The time at which a sample was published, and its number where the middleware has one."""


class Sample(NamedTuple):
    """One message as it came from DDS. Times are nanoseconds of the system clock."""

    cdr: Cdr
    received_ns: int  # when the middleware took it
    source_ns: int = 0  # when it was published, by the publisher's clock
    number: int | None = None  # of the publisher's samples, where the middleware has one
    publisher: bytes | None = None  # its id, where samples of a topic are told apart by it

    @property
    def origin(self) -> Origin:
        """The mark by which it is known in every reader of its topic."""
        return self.source_ns, self.number


@dataclass(frozen=True, slots=True)
class Qos:
    """A quality of service. ``None`` means: adopt the other side's offer.

    Durations are nanoseconds, where ``None`` means unlimited.
    """

    reliability: Reliability | None = None
    durability: Durability | None = None
    history: History | None = None
    depth: int | None = None
    deadline_ns: int | None = None
    lifespan_ns: int | None = None
    lease_ns: int | None = None  # of liveliness: for how long a publisher may give no sign
    is_manual: bool = False  # of an offer: the sign is a message or a call, MANUAL_BY_TOPIC


# If a transient-local publisher keeps messages for at most this time, late subscribers do not need
# them: they only bridge the time of discovery. A shorter time could lose the end of a burst,
# because Fast DDS repairs a loss within 3 s (the period of its heartbeats).
BRIEF_LIFESPAN_NS: Final = 4_000_000_000


class TopicEvent(NamedTuple):
    """Something that keeps messages from passing between publishers and subscriptions.

    It has its code in the protocol, and two parts of a sentence for people.
    """

    code: Literal[
        "type_conflict",
        "qos_incompatible",
        "deadline_missed",
        "liveliness_lost",
        "messages_lost",
        "publisher_gone",
    ]
    problem: str
    remedy: str = ""
    node: str = ""  # that the problem names, as in "topic /t: /node offers"

    @property
    def text(self) -> str:
        """Both parts."""
        return f"{self.problem}; {self.remedy}" if self.remedy else self.problem

    def for_who(self, sees: Callable[[str], bool]) -> "TopicEvent":
        """Return it without the name of its node for a client that may not see that."""
        if not self.node or sees(self.node):
            return self
        # no name has a blank in it, so this is the node
        return self._replace(problem=self.problem.replace(f" {self.node} ", " a node ", 1), node="")


class Watch(Protocol):
    """A registration of callbacks."""

    def close(self) -> None:
        """End it. No callback follows. Closing twice is harmless."""


class LateReader(Watch, Protocol):
    """A second ROS subscription, next to an older one."""

    @property
    def publishers(self) -> int:
        """The number of publishers that it is matched with."""


class RosSubscription(LateReader, Protocol):
    """A ROS subscription that delivers raw samples until closed."""

    @property
    def qos(self) -> Qos:
        """The profile in force, with nothing left to adopt. It may change with the publishers."""

    @property
    def offers(self) -> Sequence[Qos]:
        """The offers of the publishers of its type now, as far as they are known."""

    @property
    def lost(self) -> int:
        """The number of samples that were published and never came, as far as that is known."""

    def join_late(self, on_samples: Callable[[Sequence[Sample]], None]) -> LateReader:
        """Subscribe once more, with the profile in force, and get what late joiners get.

        Close it before this subscription.

        Raises:
            RosError: ROS refuses it.
        """

    @property
    def incompatible(self) -> tuple[TopicEvent, ...]:
        """The mismatches given to *on_event* that still apply."""


class Publisher(Protocol):
    """A ROS publisher of raw samples."""

    def publish(self, cdr: bytes) -> None:
        """Publish one sample, encapsulation header included. Do not call it after `close`."""

    def new_matches(self) -> int:
        """Return how many subscriptions were found since the last call, gone or not.

        0 forever if the middleware does not count them.
        """

    def close(self) -> None:
        """Destroy it. Closing twice is harmless."""


class Publishing(Protocol):
    """The part of a source that publishes."""

    @property
    def guard(self) -> Guard | None:
        """The part that stops a robot if this process cannot. Nobody drives without it."""

    def readers(self, topic: str) -> frozenset[str]:
        """Return the ids of the subscriptions that other nodes have to a topic.

        They are the same in all processes, and a subscription is among them before a publisher
        counts it by `Publisher.new_matches`.
        """

    def advertise(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        on_event: Callable[[TopicEvent], None],
    ) -> Publisher:
        """Create a publisher on a fully resolved topic name. Open QoS fields get defaults.

        *on_event* hears of each subscription that gets nothing, because of its type or of
        what it asks for, and of missed deadlines. The gateway's own subscriptions hear of it
        themselves.

        Raises:
            RosError: as for `subscribe`.
        """

    def advertise_own(self, topic: str, type_name: str, qos: Qos) -> Publisher:
        """Create a publisher of the gateway itself. `entity_count` leaves it out.

        Raises:
            RosError: as for `subscribe`.
        """


class Diagnosis(Protocol):
    """The part of a source that reports on the source itself."""

    def log(self, level: LogLevel, text: str) -> None:
        """Write to the debug node's logger, and so to ``/rosout``."""

    def faults(self) -> Sequence[Fault]:
        """Return what is wrong with ROS itself. Ask every few seconds, or a hang is not found."""

    def shared_names(self) -> Sequence[str]:
        """Return the full names that several nodes have had for a while, sorted."""

    def entity_count(self) -> int:
        """Count the open entities of this port, of all kinds."""


class RosGraph(Protocol):
    """The part of `Source` that only looks."""

    @property
    def distro(self) -> str:
        """The ROS distribution, such as ``jazzy``."""

    @property
    def network(self) -> Mapping[str, str | int]:
        """The reach of its discovery: ``domain_id``, ``rmw``, ``discovery``, if it has any."""

    def now_ns(self) -> int:
        """ROS time in nanoseconds (simulated time if ``use_sim_time`` is set)."""

    def service_types(self, service: str) -> tuple[str, ...]:
        """Return the types of a service, also of one behind an action, sorted.

        Return nothing if the graph knows no server.
        """

    def graph(self) -> Graph:
        """Return the graph that is known now."""


class Source(RosGraph, Protocol):
    """The robot, or its stand-in, that the gateway serves. An object may be its own parts."""

    @property
    def refusal(self) -> str | None:
        """The answer to requests for what it has not, if one sentence fits all of them."""

    @property
    def publishing(self) -> Publishing | None:
        """The part that publishes."""

    @property
    def services(self) -> Services | None:
        """The part that calls and provides services."""

    @property
    def actions(self) -> Actions | None:
        """The part that sends goals, and provides actions."""

    @property
    def diagnosis(self) -> Diagnosis | None:
        """The part that reports on the source itself."""

    def topics(self) -> Mapping[str, Sequence[str]]:
        """Return the types of all topics, which is far cheaper than `graph`."""

    async def definitions(self, type_name: str) -> Mapping[str, Definition] | None:
        """Return the definition of a message type, and those of the types that it nests.

        Return ``None`` if the source has no other than is known here. This is called for each
        type of a topic that is not installed, and again after each change of the graph.

        Raises:
            RosError: it cannot be had now. The text continues "no definition is installed, and".
        """

    def subscribe(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        on_samples: Callable[[Sequence[Sample]], None],
        on_event: Callable[[TopicEvent], None],
    ) -> RosSubscription:
        """Subscribe to a fully resolved topic name.

        *on_samples* gets the samples since its last call, oldest first, never empty, at most
        `MAX_TAKES_PER_TURN` at once. Open fields of *qos* are adopted from the publishers, and
        again when these change. Even then each sample comes once. *on_event* gets publishers whose
        type or offer does not match, publishers that are gone, and the counts of DDS.

        Raises:
            RosError: the name or the type is invalid, or the type's ROS package is not installed.
        """

    def topic_types(self, topic: str) -> tuple[str, ...]:
        """Return the types of a topic, sorted. The result is empty if the graph does not know it.

        They are the types of its publishers, or of its subscribers if it has no publishers. The
        gateway's own count only if there are no others.
        """

    def action_types(self, action: str) -> tuple[str, ...]:
        """Return the types of an action, sorted. The result is empty if there is no server."""

    def watch_graph(self, on_change: Callable[[], None]) -> Watch:
        """Call *on_change* soon after topics, types, endpoints or nodes have changed.

        Changes close together are reported once. Costs little while nothing changes.
        """

    def watch_jumps_back(self, on_jump: Callable[[], None]) -> Watch:
        """Call *on_jump* when simulated time has jumped back, however little."""


class Ros(Source, Protocol):
    """A source with all parts, as the core uses it. See `gateway.core.missing_parts`."""

    @property
    def publishing(self) -> Publishing:
        """The part that publishes."""

    @property
    def services(self) -> Services:
        """The part that calls and provides services."""

    @property
    def actions(self) -> Actions:
        """The part that sends goals, and provides actions."""

    @property
    def diagnosis(self) -> Diagnosis:
        """The part that reports on the source itself."""


MAX_TAKES_PER_TURN = 32  # 4 ms of Odometry at 4 kHz, then other sockets and topics follow
