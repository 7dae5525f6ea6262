# SPDX-License-Identifier: Apache-2.0
"""Actions of the rest of the robot, by rclpy's own clients and servers."""

import asyncio
import threading
from collections.abc import Callable
from typing import Any

from rclpy.action.client import ActionClient
from rclpy.action.server import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.serialization import deserialize_message, serialize_message
from rclpy.task import Future

from gateway.sources.actions import (
    ABORTED,
    CANCELED,
    SUCCEEDED,
    GoalOutcome,
    GoalRequest,
    GoalResult,
)
from gateway.sources.rclpy.interfaces import action_class
from tests.sources.outside_services import arrived, until_known

ACTION_SERVICES = ("send_goal", "get_result", "cancel_goal")


class LockedActionClient(ActionClient):
    """rclpy's client, for another thread than the executor's.

    rclpy 7.1 sends a request, and then notes that it waits for the response. On a busy machine the
    executor may take a response in between, and throws it away. Of services it locks both.
    """

    def __init__(self, *args: Any, **options: Any) -> None:
        self._noting = threading.Lock()
        super().__init__(*args, **options)

    def send_goal_async(self, *args: Any, **options: Any) -> Any:
        with self._noting:
            return super().send_goal_async(*args, **options)

    def _cancel_goal_async(self, *args: Any) -> Any:
        with self._noting:
            return super()._cancel_goal_async(*args)

    def _get_result_async(self, *args: Any) -> Any:
        with self._noting:
            return super()._get_result_async(*args)

    def take_data(self) -> Any:
        with self._noting:
            return super().take_data()


class OutsideGoalRequest:
    """A goal that the executor's thread executes by waiting for its end."""

    def __init__(self, server: "OutsideActionServer", handle: Any) -> None:
        self.cdr = serialize_message(handle.request)
        self.ended: Any = Future()
        self._server = server
        self._handle = handle

    def feedback(self, cdr: bytes) -> None:
        self._handle.publish_feedback(deserialize_message(cdr, self._server.action.Feedback))

    def finish(self, status: GoalOutcome, result: bytes) -> None:
        self.ended.set_result((status, deserialize_message(result, self._server.action.Result)))
        self._server.wake()


class OutsideActionServer:
    def __init__(
        self,
        node: Node,
        wake: Callable[[], None],
        name: str,
        type_name: str,
        on_goal: Callable[[GoalRequest], None],
        on_cancel: Callable[[GoalRequest], None],
        accepts: Callable[[bytes], bool],
    ) -> None:
        self._node = node
        self._services = [f"{name}/_action/{one}" for one in ACTION_SERVICES]
        self.wake = wake
        self.action = action_class(type_name)
        self._loop = asyncio.get_running_loop()
        self._on_goal = on_goal
        self._on_cancel = on_cancel
        self._accepts = accepts
        self._requests: dict[bytes, OutsideGoalRequest] = {}
        self._server: Any = ActionServer(
            node,
            self.action,
            name,
            execute_callback=self._execute,
            goal_callback=self._decide,
            cancel_callback=self._cancel,
            callback_group=ReentrantCallbackGroup(),
        )

    def close(self) -> None:
        """Let it vanish, with its goals unfinished."""
        if self._server is not None:
            self._server.destroy()
            self._server = None
            self.wake()  # entities that the executor waits for are not destroyed yet

    def _decide(self, goal: Any) -> GoalResponse:
        until_known(self._node, *self._services)
        is_accepted = self._accepts(serialize_message(goal))
        return GoalResponse.ACCEPT if is_accepted else GoalResponse.REJECT

    def _cancel(self, handle: Any) -> CancelResponse:
        request = self._requests[bytes(handle.goal_id.uuid)]
        self._loop.call_soon_threadsafe(self._on_cancel, request)
        return CancelResponse.ACCEPT

    async def _execute(self, handle: Any) -> Any:
        request = self._requests[bytes(handle.goal_id.uuid)] = OutsideGoalRequest(self, handle)
        self._loop.call_soon_threadsafe(self._on_goal, request)
        status, result = await request.ended
        {SUCCEEDED: handle.succeed, CANCELED: handle.canceled, ABORTED: handle.abort}[status]()
        return result


class OutsideGoal:
    def __init__(self, handle: Any) -> None:
        self._handle = handle

    async def result(self) -> GoalResult:
        response = await arrived(self._handle.get_result_async())
        return GoalResult(response.status, serialize_message(response.result))

    def cancel(self) -> None:
        self._handle.cancel_goal_async()


class OutsideActionClient:
    def __init__(self, node: Node, name: str, type_name: str, is_known: Callable[[], bool]) -> None:
        self._node = node
        self._name = name
        self._is_known = is_known
        self._action = action_class(type_name)
        self._client: Any = LockedActionClient(node, self._action, name)

    async def send_goal(
        self, goal: bytes, on_feedback: Callable[[bytes], None]
    ) -> OutsideGoal | None:
        loop = asyncio.get_running_loop()
        try:
            while not (self._client.server_is_ready() and self._is_known()):  # noqa: ASYNC110
                await asyncio.sleep(0.01)
        except asyncio.CancelledError as error:
            error.add_note(f"the server knows the client: {self._is_known()}; {self._seen()}")
            raise

        def hear(message: Any) -> None:
            loop.call_soon_threadsafe(on_feedback, serialize_message(message.feedback))

        message = deserialize_message(goal, self._action.Goal)
        handle = await arrived(self._client.send_goal_async(message, hear))
        return OutsideGoal(handle) if handle.accepted else None

    def _seen(self) -> str:
        """Say what rcl looks at before it calls a server ready."""
        services = [f"{self._name}/_action/{one}" for one in ACTION_SERVICES]
        topics = [f"{self._name}/_action/{one}" for one in ("feedback", "status")]
        parts = [
            *(f"{one} {self._ends(one)}" for one in services),
            *(f"{one} has {self._node.count_publishers(one)}" for one in topics),
        ]
        return ", ".join(parts)

    def _ends(self, service: str) -> str:
        readers = self._node.get_subscriptions_info_by_topic(f"rq{service}Request", no_mangle=True)
        writers = self._node.get_publishers_info_by_topic(f"rr{service}Reply", no_mangle=True)
        ends = [[f"{e.node_namespace}{e.node_name}" for e in end] for end in (readers, writers)]
        return f"read by {ends[0]} and answered by {ends[1]}"

    def close(self) -> None:
        if self._client is not None:
            self._client.destroy()
            self._client = None
