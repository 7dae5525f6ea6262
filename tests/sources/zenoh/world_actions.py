# SPDX-License-Identifier: Apache-2.0
"""Actions of the rest of the robot over Zenoh, of services and topics of `world`."""

import asyncio
import struct
import uuid
from collections.abc import Callable
from typing import Any

from gateway.codec.types import Types
from gateway.sources.actions import GoalOutcome, GoalRequest, GoalResult
from gateway.sources.services import ServiceRequest
from gateway.sources.source import Qos
from tests.sources.zenoh.outside import DEFINITIONS
from tests.sources.zenoh.world import ZenohWorld

TYPES = Types(DEFINITIONS)
CANCEL = "action_msgs/srv/CancelGoal"
HEADER = b"\0\1\0\0"


class ZenohGoalRequest:
    def __init__(self, server: "ZenohGoalServer", goal_id: bytes, cdr: bytes) -> None:
        self.goal_id, self.cdr, self._server = goal_id, cdr, server
        self.answer: bytes | None = None
        self.waiting: list[ServiceRequest] = []

    def feedback(self, cdr: bytes) -> None:
        self._server.feedback.publish(HEADER + self.goal_id + cdr[4:])

    def finish(self, status: GoalOutcome, result: bytes) -> None:
        # the result of Fibonacci is aligned to four bytes
        self.answer = HEADER + bytes([status, 0, 0, 0]) + result[4:]
        for each in self.waiting:
            each.answer(self.answer)


class ZenohGoalServer:
    def __init__(
        self,
        world: ZenohWorld,
        name: str,
        type_name: str,
        on_goal: Callable[[GoalRequest], None],
        on_cancel: Callable[[GoalRequest], None],
        accepts: Callable[[bytes], bool],
    ) -> None:
        self._on_goal, self._on_cancel, self._accepts = on_goal, on_cancel, accepts
        self._goals: dict[bytes, ZenohGoalRequest] = {}
        before = f"{name}/_action"
        self.feedback = world.add_publisher(f"{before}/feedback", f"{type_name}_FeedbackMessage")
        self._opened = [
            world.add_service(f"{before}/get_result", f"{type_name}_GetResult", self._result),
            world.add_service(f"{before}/cancel_goal", CANCEL, self._cancel),
            world.add_service(f"{before}/send_goal", f"{type_name}_SendGoal", self._send),
        ]

    def close(self) -> None:
        for each in self._opened:
            each.close()
        self.feedback.close()

    def _send(self, request: ServiceRequest) -> None:
        goal = ZenohGoalRequest(self, request.cdr[4:20], HEADER + request.cdr[20:])
        is_accepted = self._accepts(goal.cdr)
        request.answer(HEADER + struct.pack("<?3xiI", is_accepted, 0, 0))
        if is_accepted:
            self._goals[goal.goal_id] = goal
            self._on_goal(goal)

    def _result(self, request: ServiceRequest) -> None:
        goal = self._goals[request.cdr[4:20]]
        if goal.answer is None:
            goal.waiting.append(request)
        else:
            request.answer(goal.answer)

    def _cancel(self, request: ServiceRequest) -> None:
        goal = self._goals[request.cdr[4:20]]
        info = {"goal_id": {"uuid": list(goal.goal_id)}}
        request.answer(TYPES.get(f"{CANCEL}_Response").encode({"goals_canceling": [info]}, 0))
        self._on_cancel(goal)


class ZenohGoal:
    def __init__(self, client: "ZenohGoalClient", goal_id: bytes) -> None:
        self._client, self._goal_id = client, goal_id
        self._cancels: list[Any] = []

    async def result(self) -> GoalResult:
        answer = await self._client.results.call(HEADER + self._goal_id)
        status: Any = answer[4]
        return GoalResult(status, HEADER + answer[8:])

    def cancel(self) -> None:
        request = HEADER + self._goal_id + bytes(8)
        self._cancels.append(asyncio.ensure_future(self._client.cancels.call(request)))


class ZenohGoalClient:
    def __init__(self, world: ZenohWorld, name: str, type_name: str) -> None:
        self._heard: dict[bytes, Callable[[bytes], None]] = {}
        before = f"{name}/_action"
        world.add_subscription(
            f"{before}/feedback", f"{type_name}_FeedbackMessage", self._hear, Qos(depth=100)
        )
        self._goals = world.add_client(f"{before}/send_goal", f"{type_name}_SendGoal")
        self.results = world.add_client(f"{before}/get_result", f"{type_name}_GetResult")
        self.cancels = world.add_client(f"{before}/cancel_goal", CANCEL)

    async def send_goal(
        self, goal: bytes, on_feedback: Callable[[bytes], None]
    ) -> ZenohGoal | None:
        goal_id = uuid.uuid4().bytes
        self._heard[goal_id] = on_feedback
        answer = await self._goals.call(HEADER + goal_id + goal[4:])
        return ZenohGoal(self, goal_id) if answer[4] else None

    def close(self) -> None:
        for each in (self._goals, self.results, self.cancels):
            each.close()

    def _hear(self, samples: Any) -> None:
        for sample in samples:
            self._heard.get(sample.cdr[4:20], lambda _: None)(HEADER + sample.cdr[20:])


class ZenohRobot(ZenohWorld):
    """The node, with actions as well."""

    def add_action_client(self, name: str, type_name: str) -> ZenohGoalClient:
        return ZenohGoalClient(self, name, type_name)

    def add_action_server(
        self,
        name: str,
        type_name: str,
        on_goal: Callable[[GoalRequest], None],
        on_cancel: Callable[[GoalRequest], None],
        accepts: Callable[[bytes], bool] = lambda goal: True,
    ) -> ZenohGoalServer:
        return ZenohGoalServer(self, name, type_name, on_goal, on_cancel, accepts)
