# SPDX-License-Identifier: Apache-2.0
"""Actions over Zenoh, used and provided: three services and two topics each."""

import asyncio
import contextlib
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Final, Protocol

from gateway.codec.types import Types
from gateway.sources.action_client import GoalClient
from gateway.sources.action_server import Drainable, HeldGoal, ServedAction
from gateway.sources.actions import GoalRequest
from gateway.sources.goal_ids import with_goal_id
from gateway.sources.name_checks import check_action
from gateway.sources.source import Qos, RosError, Sample
from gateway.sources.zenoh.action_wire import CANCEL, ActionWire, action_wire
from gateway.sources.zenoh.events import nobody
from gateway.sources.zenoh.publishing import ZenohPublishers
from gateway.sources.zenoh.replier import OnRequest, ZenohReplier
from gateway.sources.zenoh.requester import ZenohEndpoints, ZenohRequester
from gateway.sources.zenoh.service_forms import ServiceWire, check

# A query for a result lasts as long as its goal. The robot may be on its way for days.
RESULT_QUERY_S: Final = 30 * 24 * 3600.0
STATUSES: Final = "action_msgs/msg/GoalStatusArray"
FEEDBACK_QOS: Final = Qos("reliable", "volatile", "keep_last", 10)  # of rcl_action
STATUS_QOS: Final = Qos("reliable", "transient_local", "keep_last", 1)
_NS_PER_S: Final = 1_000_000_000


class FeedbackReader(Protocol):
    """A subscription that nobody sees."""

    def flush(self) -> None:
        """Deliver what has arrived."""

    def close(self) -> None:
        """End it."""


# Subscribes to a topic of a type.
Read = Callable[[str, str, Callable[[Sequence[Sample]], None]], FeedbackReader]
CheckNew = Callable[[str, str, str | None], None]


class ActionPublisher(Protocol):
    """A publisher of the feedback, or of the statuses of all goals."""

    def publish(self, cdr: bytes) -> None:
        """Publish one message."""

    def close(self) -> None:
        """Withdraw it."""


class ActionReplier(Drainable, Protocol):
    """A server of one of the services."""

    def close(self) -> None:
        """Withdraw it."""


@dataclass(frozen=True, slots=True)
class ActionParts:
    """The ways to open what a served action consists of."""

    loop: asyncio.AbstractEventLoop
    types: Types
    now_ns: Callable[[], int]
    publisher: Callable[[str, str, Qos], ActionPublisher]  # topic, type
    # the form of the service, its name, and the subject of errors
    replier: Callable[[ServiceWire, str, OnRequest, str], ActionReplier]


class ZenohActions:
    """Implements `gateway.sources.actions.Actions`."""

    def __init__(
        self,
        endpoints: ZenohEndpoints,
        types: Types,
        publishers: ZenohPublishers,
        read: Read,
        check_new: CheckNew,
        on_change: Callable[[], None],
        now_ns: Callable[[], int],
    ) -> None:
        self.endpoints, self.types, self.publishers = endpoints, types, publishers
        self.read, self.now_ns = read, now_ns
        self._check_new, self._on_change = check_new, on_change
        self._clients: dict[GoalClient, None] = {}
        self._provided: dict[str, ServedAction] = {}

    def __len__(self) -> int:
        """Count what is open."""
        return len(self._clients) + len(self._provided)

    def action_client(self, action: str, type_name: str) -> "ZenohActionClient":
        """Create a client of an action by its fully resolved name. See the port."""
        wire = self._checked(action, type_name)
        client = ZenohActionClient(
            self, action, wire, self._forget_client, lambda: action not in self._provided
        )
        self._clients[client] = None
        return client

    def serve_action(
        self,
        action: str,
        type_name: str,
        on_goal: Callable[[GoalRequest], None],
        on_cancel: Callable[[GoalRequest], None],
    ) -> "ZenohActionServer":
        """Provide an action by its fully resolved name. See the port."""
        wire = self._checked(action, type_name)
        if action in self._provided:
            raise RosError("limit_exceeded", f"action {action} is provided here already")
        server = ZenohActionServer(
            ActionParts(
                self.endpoints.loop, self.types, self.now_ns, self._publisher, self._replier
            ),
            *(action, wire, (on_goal, on_cancel), self._forget_server),
        )
        self._provided[action] = server
        self._on_change()
        return server

    def follow_graph(self) -> None:
        """Let every client follow servers that have come or gone."""
        for client in list(self._clients):
            client.follow_graph()

    def close(self) -> None:
        """Close what is still open without waiting for answers."""
        for client in list(self._clients):
            client.destroy()
        for server in list(self._provided.values()):
            server.close()

    def _publisher(self, topic: str, type_name: str, qos: Qos) -> ActionPublisher:
        return self.publishers.advertise(topic, type_name, qos, nobody)

    def _replier(
        self, part: ServiceWire, name: str, on_request: OnRequest, subject: str
    ) -> ActionReplier:
        return ZenohReplier(self.endpoints, part, name, on_request, subject=subject)

    def _forget_client(self, client: GoalClient) -> None:
        self._clients.pop(client, None)

    def _forget_server(self, server: ServedAction) -> None:
        del self._provided[server.name]
        server.destroy()
        self._on_change()

    def _checked(self, action: str, type_name: str) -> ActionWire:
        known = {each.name: each.type_name for each in self._clients}
        known |= {each.name: each.type_name for each in self._provided.values()}
        self._check_new(f"action {action}", type_name, known.get(action))
        check_action(action)
        return action_wire(self.types, type_name)


class ZenohActionClient(GoalClient):
    """A client of an action."""

    def __init__(
        self,
        actions: ZenohActions,
        name: str,
        wire: ActionWire,
        on_close: Callable[[GoalClient], None],
        is_paced: Callable[[], bool],
    ) -> None:
        endpoints = actions.endpoints
        super().__init__(endpoints.loop, name, wire.cdr, on_close)
        self._wire, self._graph = wire, endpoints.graph
        # First: by the time that a server accepts a goal, it knows who reads its feedback.
        self._feedback = actions.read(
            self._feedback_topic, wire.feedback_type, self._deliver_feedback
        )

        def requester(part: ServiceWire, service: str, **options: Any) -> ZenohRequester:
            full_name = f"{name}/_action/{service}"
            return ZenohRequester(endpoints, part, full_name, subject=self._subject, **options)

        # Not paced: these are under way as long as their goals, and sent as those are accepted.
        self._results = requester(
            wire.get_result, "get_result", is_paced=lambda: False, query_s=RESULT_QUERY_S
        )
        self._cancels = requester(wire.cancel, "cancel_goal", is_paced=is_paced)
        self._goals = requester(
            wire.send_goal, "send_goal", is_ready=self._is_rest_ready, is_paced=is_paced
        )

    def _to_request(self, goal_id: bytes, goal: bytes) -> bytes:
        request = self._wire.cdr.to_goal_request(goal_id, goal)
        check(self._subject, self._wire.send_goal.read_request, request)
        return request

    def _flush_feedback(self) -> None:
        self._feedback.flush()

    def _has_feedback(self) -> bool:
        return bool(self._graph.endpoints("MP", self._feedback_topic))

    def _destroy_parts(self) -> None:
        for part in (self._feedback, self._goals, self._results, self._cancels):
            part.close()


class ZenohActionServer(ServedAction):
    """An action that the gateway provides."""

    def __init__(
        self,
        parts: "ActionParts",
        name: str,
        wire: ActionWire,
        callbacks: tuple[Callable[[GoalRequest], None], Callable[[GoalRequest], None]],
        on_close: Callable[[ServedAction], None],
    ) -> None:
        types = parts.types
        super().__init__(parts.loop, parts.now_ns, name, wire.cdr, *callbacks, on_close)
        self._wire = wire
        self._read_cancel_request = types.get(f"{CANCEL}_Request").decode
        self._encode_cancel = types.get(f"{CANCEL}_Response").encode
        self._encode_statuses = types.get(STATUSES).encode
        before = f"{name}/_action"
        self._feedback = parts.publisher(f"{before}/feedback", wire.feedback_type, FEEDBACK_QOS)
        self._statuses = parts.publisher(f"{before}/status", STATUSES, STATUS_QOS)
        # The service that clients use first comes last: a client that sees it finds the rest.
        services: list[tuple[str, ServiceWire, OnRequest]] = [
            ("get_result", wire.get_result, self._answer_result),
            ("cancel_goal", wire.cancel, self._cancel),
            ("send_goal", wire.send_goal, self._accept),
        ]
        self._repliers: list[ActionReplier] = [
            parts.replier(part, f"{before}/{service}", answer, self._subject)
            for service, part, answer in services
        ]

    def publish_feedback(self, goal_id: bytes, cdr: bytes) -> None:
        """Publish the Feedback of a goal."""
        message = with_goal_id(goal_id, cdr)
        check(self._subject, self._wire.read_feedback, message)
        self._feedback.publish(message)

    def _to_result_response(self, status: int, result: bytes | None = None) -> bytes:
        response = self._wire.cdr.to_result_response(status, result)
        check(self._subject, self._wire.get_result.read_response, response)
        return response

    def _read_cancel(self, message: bytes) -> tuple[bytes, int]:
        request: Any = self._read_cancel_request(message)
        stamp = request["goal_info"]["stamp"]
        goal_id = self._wire.cdr.read_result_request(message)  # it comes first here as well
        return goal_id, stamp["sec"] * _NS_PER_S + stamp["nanosec"]

    def _to_cancel_response(self, code: int, goals: Iterable[HeldGoal]) -> bytes:
        canceling = [_info_of(goal) for goal in goals]
        return self._encode_cancel({"return_code": code, "goals_canceling": canceling}, 0)

    def _publish_statuses(self, goals: Iterable[HeldGoal]) -> None:
        statuses = [{"goal_info": _info_of(goal), "status": goal.status} for goal in goals]
        self._statuses.publish(self._encode_statuses({"status_list": statuses}, 0))

    def _destroy_parts(self) -> None:
        with contextlib.ExitStack() as undo:
            undo.callback(self._feedback.close)
            undo.callback(self._statuses.close)
            for replier in self._repliers:
                undo.callback(replier.close)


def _info_of(goal: HeldGoal) -> dict[str, object]:
    seconds, nanoseconds = divmod(goal.accepted_ns, _NS_PER_S)
    stamp = {"sec": seconds, "nanosec": nanoseconds}
    return {"goal_id": {"uuid": list(goal.goal_id)}, "stamp": stamp}
