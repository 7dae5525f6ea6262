# SPDX-License-Identifier: Apache-2.0
"""A robot by plain rclpy: what the clients talk to, with nothing of the gateway's in between."""

import asyncio
from collections.abc import Awaitable, Callable
from typing import Any

from rclpy.action.client import ActionClient
from rclpy.action.server import ActionServer, CancelResponse, GoalResponse, ServerGoalHandle
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.task import Future
from test_msgs.action import Fibonacci

from tests.client import TIMEOUT_S, eventually
from tests.sources.outside import Outside
from tests.sources.outside_actions import LockedActionClient

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
POLL_S = 0.05  # well below the operations that a client may send
ENDLESS = 1000  # an order from which on a goal runs until it is cancelled


class Robot:
    """Makes things on the node ``/robot``, and destroys them when closed."""

    def __init__(self, outside: Outside) -> None:
        self.node = outside.node
        self._wake = outside._guard.trigger
        self._ends: list[Callable[[], object]] = []

    def publish(self, topic: str, *messages: Any) -> None:
        """Publish on a separate topic. The last message also reaches late subscribers."""
        publisher = self.node.create_publisher(type(messages[0]), topic, LATCHED)
        self._ends.append(lambda: self.node.destroy_publisher(publisher))
        for message in messages:
            publisher.publish(message)

    def hear(self, message_class: type, topic: str, qos: QoSProfile | int = 10) -> list[Any]:
        """Subscribe, and return the list that the messages will stand in."""
        heard: list[Any] = []
        subscription = self.node.create_subscription(message_class, topic, heard.append, qos)
        self._ends.append(lambda: self.node.destroy_subscription(subscription))
        return heard

    def serve(self, service_class: type, name: str, handle: Callable[[Any, Any], Any]) -> None:
        """Provide a service. *handle* may be a coroutine function, and then wait."""
        service = self.node.create_service(
            service_class,
            name,
            handle,
            # ROS keeps 10 by default, and drops the rest of a burst
            qos_profile=QoSProfile(depth=100),
            callback_group=ReentrantCallbackGroup(),
        )
        self._ends.append(lambda: self.node.destroy_service(service))

    def release(self, future: Future) -> None:
        """Let a handler go on that waits for this."""
        future.set_result(None)
        self._wake()

    async def call(self, service_class: Any, name: str, **request: Any) -> Any:
        """Call a service once it is there, and return its response."""
        return await result(await self.start_call(service_class, name, **request))

    async def start_call(self, service_class: Any, name: str, **request: Any) -> Future:
        """Call a service once it is there."""
        client = self.node.create_client(service_class, name)
        self._ends.append(lambda: self.node.destroy_client(client))
        await eventually(client.service_is_ready)
        return client.call_async(service_class.Request(**request))

    def provide_fibonacci(self, name: str) -> list[int]:
        """Provide an action, and return the list that the status of each ended goal will stand in.

        It rejects order 0, aborts a negative one, and runs until cancelled from `ENDLESS` on.
        """
        server = _Fibonacci(self.node, name)
        self._ends.append(server.destroy)
        return server.ended

    async def action_client(self, name: str) -> ActionClient:
        """Return a client of another node's Fibonacci once that is there."""
        client = LockedActionClient(self.node, Fibonacci, name)
        self._ends.append(client.destroy)
        await eventually(client.server_is_ready)
        return client

    def knows_topic(self, topic: str) -> bool:
        """Tell whether the graph has a topic, as far as this node has heard."""
        return topic in dict(self.node.get_topic_names_and_types())

    def knows_service(self, service: str) -> bool:
        """Tell whether the graph has a service, as far as this node has heard."""
        return service in dict(self.node.get_service_names_and_types())

    def close(self) -> None:
        """Destroy what was made."""
        while self._ends:
            self._ends.pop()()


async def until(holds: Callable[[], Awaitable[bool]]) -> None:
    """Ask until the answer is yes: what is in the graph gets about in its own time."""
    async with asyncio.timeout(TIMEOUT_S):
        while not await holds():  # noqa: ASYNC110  # nobody tells
            await asyncio.sleep(POLL_S)


async def result(future: Future) -> Any:
    """Wait for something of rclpy's."""
    await eventually(future.done)
    return future.result()


class _Fibonacci:
    """A server of the action of that name."""

    def __init__(self, node: Node, name: str) -> None:
        self.ended: list[int] = []
        self._cancelled: dict[bytes, Future] = {}
        self._server = ActionServer(
            node,
            Fibonacci,
            name,
            execute_callback=self._execute,
            goal_callback=lambda goal: GoalResponse.ACCEPT if goal.order else GoalResponse.REJECT,
            cancel_callback=self._cancel,
            callback_group=ReentrantCallbackGroup(),
        )
        self.destroy = self._server.destroy

    def _cancel(self, goal: ServerGoalHandle) -> CancelResponse:
        self._cancelled[bytes(goal.goal_id.uuid)].set_result(None)
        return CancelResponse.ACCEPT

    async def _execute(self, goal: ServerGoalHandle) -> Fibonacci.Result:
        cancelled = self._cancelled[bytes(goal.goal_id.uuid)] = Future()
        sequence = [0, 1]
        order = goal.request.order
        goal.publish_feedback(Fibonacci.Feedback(sequence=sequence))
        for _ in range(order - 1 if order < ENDLESS else 0):
            sequence.append(sequence[-1] + sequence[-2])
            goal.publish_feedback(Fibonacci.Feedback(sequence=sequence))
        if order >= ENDLESS:
            await cancelled
            goal.canceled()
        elif order < 0:
            goal.abort()
        else:
            goal.succeed()
        self.ended.append(goal.status)
        return Fibonacci.Result(sequence=sequence)
