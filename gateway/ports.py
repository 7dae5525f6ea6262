# SPDX-License-Identifier: Apache-2.0
"""What the router needs from ROS, as Protocols.

`gateway.ros` is the real thing; the tests' fake passes the same contract suite. Everything
here is called on the event loop's thread, returns without blocking, and every callback comes
back on that thread.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple, Protocol

# action_msgs/msg/GoalStatus: how a goal ended
GoalOutcome = Literal[4, 5, 6]
SUCCEEDED: GoalOutcome = 4
CANCELED: GoalOutcome = 5
ABORTED: GoalOutcome = 6

Reliability = Literal["reliable", "best_effort"]
Durability = Literal["volatile", "transient_local"]
History = Literal["keep_last", "keep_all"]
LogLevel = Literal["debug", "info", "warning", "error"]


class RosError(Exception):
    """ROS refuses what was asked for; ``code`` is the protocol's word for the reason."""

    def __init__(
        self,
        code: Literal[
            "bad_name", "bad_type", "type_conflict", "not_found", "limit_exceeded", "internal"
        ],
        reason: str,
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
class TopicInfo:
    """A topic of the graph: its types (more than one is a conflict) and who is on it."""

    name: str
    types: tuple[str, ...]  # pkg/msg/Name
    publishers: tuple[str, ...]  # full node names, one entry per endpoint, sorted
    subscribers: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ServerInfo:
    """A service or an action of the graph: its types, and the nodes that provide it."""

    name: str
    types: tuple[str, ...]  # pkg/srv/Name or pkg/action/Name
    nodes: tuple[str, ...]  # full names, sorted


@dataclass(frozen=True, slots=True)
class Graph:
    """One picture of the ROS graph, sorted by name."""

    topics: tuple[TopicInfo, ...]
    nodes: tuple[str, ...]  # full names
    services: tuple[ServerInfo, ...] = ()  # those behind actions are not listed
    actions: tuple[ServerInfo, ...] = ()


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


class Client(Protocol):
    """A client of a ROS service; its requests and responses are CDR."""

    async def call(self, request: bytes) -> bytes:
        """Wait for a server, send the request, wait for the response; cancelling forgets it.

        Any number of calls may be under way. There is no time limit: that is the caller's.

        Raises:
            RosError: ``not_found``: the server has gone while it had the request, or the
                client was closed.
        """

    def close(self) -> None:
        """Destroy it; what is under way fails. Closing twice is harmless."""


class Request(Protocol):
    """A request to a service that the gateway provides."""

    @property
    def cdr(self) -> bytes:
        """The request, encapsulation header included."""

    def answer(self, response: bytes) -> None:
        """Respond. At most once; nothing happens once the service is closed or who asked has gone.

        Raises:
            RosError: ``internal``: *response* is no CDR of the type; the request is still open.
        """


class Service(Protocol):
    """A ROS service that the gateway provides."""

    def close(self) -> None:
        """Withdraw it. Closing twice is harmless.

        *on_request* gets what has arrived, and what callers send before they have heard of the
        end; what it answers within its call is sent.
        """


class GoalResult(NamedTuple):
    """How a goal ended."""

    status: GoalOutcome
    cdr: bytes  # the action's Result, with its 4-byte encapsulation header


class Goal(Protocol):
    """A goal that an action server has accepted."""

    async def result(self) -> GoalResult:
        """Wait for the end of the goal.

        Raises:
            RosError: ``not_found``: the server has gone or forgotten the goal, or the action
                client was closed.
        """

    def cancel(self) -> None:
        """Ask the server to cancel; whether it does, `result` tells. Returns at once."""


class ActionClient(Protocol):
    """A client of a ROS action; goals, feedback and results are CDR."""

    async def send_goal(self, goal: bytes, on_feedback: Callable[[bytes], None]) -> Goal | None:
        """Wait for a server and send it a goal; ``None``: it rejects the goal.

        *on_feedback* gets CDR of the action's Feedback until the result is there. Any number of
        goals may be under way. There is no time limit: that is the caller's. Cancelling this gives
        the goal up: it is cancelled should the server accept it yet.

        Raises:
            RosError: ``not_found``, as for `Client.call`.
        """

    def close(self) -> None:
        """Destroy it; accepted goals go on without us. Closing twice is harmless.

        What waits for it fails and no callback comes after, but while the server may still accept
        a goal that was given up, or has not answered to a cancel, that is waited for, some time at
        most, and counts as open.
        """


class GoalRequest(Protocol):
    """A goal that a ROS client has sent to an action that the gateway provides.

    It counts as accepted and being executed. Nothing happens once the action is closed, the goal
    has finished, or who sent it has gone.
    """

    @property
    def cdr(self) -> bytes:
        """The action's Goal, encapsulation header included."""

    def feedback(self, cdr: bytes) -> None:
        """Publish the action's Feedback.

        Raises:
            RosError: ``internal``: ROS does not publish it.
        """

    def finish(self, status: GoalOutcome, result: bytes) -> None:
        """End the goal; *result* is CDR of the action's Result.

        A goal can end as canceled only while it is being canceled; else it counts as aborted.

        Raises:
            RosError: ``internal``: *result* is no CDR of the type; the goal goes on.
        """


class ActionServer(Protocol):
    """A ROS action that the gateway provides."""

    def close(self) -> None:
        """Withdraw it; unfinished goals are aborted, and no callback comes after.

        What callers send before they have heard of the end is answered, goals by a rejection.
        Closing twice is harmless.
        """


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

    def client(self, service: str, type_name: str) -> Client:
        """Create a client of a service by its fully resolved name.

        Raises:
            RosError: as for `subscribe`; *type_name* is ``pkg/srv/Name``.
        """

    def serve(self, service: str, type_name: str, on_request: Callable[[Request], None]) -> Service:
        """Provide a service by its fully resolved name.

        Raises:
            RosError: as for `client`; also ``limit_exceeded`` where the gateway provides it
                already.
        """

    def action_client(self, action: str, type_name: str) -> ActionClient:
        """Create a client of an action by its fully resolved name.

        Raises:
            RosError: as for `subscribe`; *type_name* is ``pkg/action/Name``.
        """

    def serve_action(
        self,
        action: str,
        type_name: str,
        on_goal: Callable[[GoalRequest], None],
        on_cancel: Callable[[GoalRequest], None],
    ) -> ActionServer:
        """Provide an action by its fully resolved name.

        *on_cancel* is called once for a goal of *on_goal*'s that a client wants cancelled; the
        goal goes on until it is finished.

        Raises:
            RosError: as for `action_client`; also ``limit_exceeded`` where the gateway provides
                it already.
        """

    def topic_types(self, topic: str) -> tuple[str, ...]:
        """Return the types of a topic, sorted, empty where the graph does not know it.

        These are what its publishers publish; without any, what its subscribers expect, the
        gateway's own counting only where they are alone.
        """

    def service_types(self, service: str) -> tuple[str, ...]:
        """Return the types of a service, also of one behind an action, sorted.

        Empty where the graph knows no server.
        """

    def action_types(self, action: str) -> tuple[str, ...]:
        """Return the types of an action, sorted, empty where the graph knows no server."""

    def graph(self) -> Graph:
        """Return the graph as it is known now."""

    def watch_graph(self, on_change: Callable[[], None]) -> Watch:
        """Call *on_change* soon after topics, types, endpoints or nodes have changed.

        Changes close together are reported once. Cheap while nothing changes.
        """

    def log(self, level: LogLevel, text: str) -> None:
        """Write to the debug node's logger, and so to ``/rosout``."""

    def entity_count(self) -> int:
        """Count what is open through this port, of whatever kind."""


MAX_TAKES_PER_TURN = 32  # 4 ms of 4 kHz Odometry; then other sockets and topics get their turn
