# SPDX-License-Identifier: Apache-2.0
"""Actions that the gateway provides: three services and two topics each, by ROS 2's design.

https://design.ros2.org/articles/actions.html
"""

import asyncio
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence
from typing import Any, Final, Protocol

from gateway.sources.actions import ABORTED, CANCELED, GoalOutcome, GoalRequest

# Sends the response, unless the server is closed.
Reply = Callable[[Any], None]

# A person with a headset supervises a few. More, as of a client that floods, are rejected.
MAX_GOALS: Final = 64
# As rclpy's servers do: some clients ask for the result only when a person wants to see it.
RESULT_KEPT_S: Final = 900.0
# of results: at 1 MB each, 64 MB for one action at worst
MAX_RESULTS_KEPT: Final = 64
# for one goal's result: its client, and tools that watch
MAX_WAITING: Final = 16

# action_msgs/msg/GoalStatus
_UNKNOWN: Final = 0
_EXECUTING: Final = 2
_CANCELING: Final = 3

# action_msgs/srv/CancelGoal
_NONE: Final = 0
_UNKNOWN_GOAL_ID: Final = 2
_GOAL_TERMINATED: Final = 3

_NO_ID: Final = bytes(16)


class AnswerForm(Protocol):
    """An action type, as the responses of a source carry it."""

    type_name: str

    def read_goal_request(self, request: Any) -> tuple[bytes, bytes]:
        """Return the goal's id, shorter than 16 bytes if it is malformed, and the goal."""

    def to_goal_response(self, accepted_ns: int | None) -> Any:
        """Return the response to a goal that was accepted at a time, or was rejected."""

    def read_result_request(self, request: Any) -> bytes:
        """Return the id of the goal whose result is asked for."""

    def to_result_response(self, status: int, result: bytes | None = None) -> Any:
        """Return the response with a result, or with an empty one."""


class Drainable(Protocol):
    """A server of one of the services."""

    @property
    def has_replied(self) -> bool:
        """True once a response has been sent."""

    def drain(self) -> None:
        """Pass all that has arrived to the action."""


class HeldGoal:
    """A goal that a client has sent, and what the server knows of it."""

    def __init__(
        self, server: "ServedAction", goal_id: bytes, accepted_ns: int, cdr: bytes
    ) -> None:
        self.cdr = cdr
        self.goal_id = goal_id
        self.accepted_ns = accepted_ns
        self.status = _EXECUTING
        self.response: Any = None  # once it has ended
        self.waiting: list[Reply] = []
        self.expiry: asyncio.TimerHandle | None = None
        self._server = server

    @property
    def is_open(self) -> bool:
        """True until the goal has ended."""
        return self.response is None

    def feedback(self, cdr: bytes) -> None:
        """Publish the action's Feedback."""
        if self.is_open:
            self._server.publish_feedback(self.goal_id, cdr)

    def finish(self, status: GoalOutcome, result: bytes) -> None:
        """End the goal. See the port."""
        if self.is_open:
            is_possible = status != CANCELED or self.status == _CANCELING
            self._server.finish(self, status if is_possible else ABORTED, result)

    def answer_waiting(self) -> None:
        """Send the result to those who wait for it."""
        for reply in self.waiting:
            reply(self.response)
        self.waiting.clear()


class ServedAction(ABC):
    """An action that the gateway provides. A subclass opens its parts.

    A goal is executing from its acceptance on. It may come to be canceling. It ends as succeeded,
    canceled or aborted, and is then kept for those who ask for its result late.
    """

    _repliers: Sequence[Drainable]

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        now_ns: Callable[[], int],
        name: str,
        form: AnswerForm,
        on_goal: Callable[[GoalRequest], None],
        on_cancel: Callable[[GoalRequest], None],
        on_close: Callable[[Any], None],
    ) -> None:
        self.name = name
        self.type_name = form.type_name
        self._loop = loop
        self._now_ns = now_ns
        self._on_goal = on_goal
        self._on_cancel = on_cancel
        self._on_close = on_close
        self._subject = f"action {name}"
        self._is_closing = False
        self._goals: dict[bytes, HeldGoal] = {}
        self._ended: dict[bytes, HeldGoal] = {}  # those of them, the oldest first
        self._form = form

    @abstractmethod
    def publish_feedback(self, goal_id: bytes, cdr: bytes) -> None:
        """Publish the Feedback of a goal."""

    @abstractmethod
    def _publish_statuses(self, goals: Iterable[HeldGoal]) -> None:
        """Publish the statuses of all goals."""

    @abstractmethod
    def _read_cancel(self, message: Any) -> tuple[bytes, int]:
        """Return the goal's id in a request to cancel, and the time that it names."""

    @abstractmethod
    def _to_cancel_response(self, code: int, goals: Iterable[HeldGoal]) -> Any:
        """Return the response to a request to cancel."""

    @abstractmethod
    def _destroy_parts(self) -> None:
        """Destroy the services and the publishers."""

    def _to_result_response(self, status: int, result: bytes | None = None) -> Any:
        return self._form.to_result_response(status, result)

    def finish(self, goal: HeldGoal, status: int, result: bytes) -> None:
        """End a goal that has not ended."""
        response = self._to_result_response(status, result)
        self._settle(goal, status, response)
        self._publish_status()
        goal.answer_waiting()

    def close(self) -> None:
        """Abort what has not ended and withdraw the action. Closing twice is harmless."""
        if self._is_closing:
            return
        self._is_closing = True
        try:
            unfinished = [goal for goal in self._goals.values() if goal.is_open]
            for goal in unfinished:
                self._settle(goal, ABORTED, self._to_result_response(ABORTED))
            if unfinished:
                self._publish_status()  # once: it holds all goals
            for goal in unfinished:
                goal.answer_waiting()
            for replier in self._repliers:
                replier.drain()  # goals that have just arrived are rejected, the rest answered
        finally:
            self._on_close(self)

    @property
    def has_answered(self) -> bool:
        """True once a response has been sent."""
        return any(replier.has_replied for replier in self._repliers)

    def destroy(self) -> None:
        """Destroy it, at the latest once its last response has been delivered."""
        for goal in self._ended.values():
            if goal.expiry is not None:
                goal.expiry.cancel()
        self._destroy_parts()

    def _accept(self, message: Any, reply: Reply) -> None:
        goal_id, cdr = self._form.read_goal_request(message)
        is_malformed = len(goal_id) != len(_NO_ID)
        running = len(self._goals) - len(self._ended)
        if self._is_closing or is_malformed or goal_id in self._goals or running >= MAX_GOALS:
            reply(self._form.to_goal_response(None))
            return
        now_ns = self._now_ns()
        reply(self._form.to_goal_response(now_ns))
        goal = HeldGoal(self, goal_id, now_ns, cdr)
        self._goals[goal_id] = goal
        self._publish_status()
        self._on_goal(goal)

    def _cancel(self, message: Any, reply: Reply) -> None:
        goal_id, until_ns = self._read_cancel(message)
        wanted = self._to_cancel(goal_id, until_ns)
        code = _NONE
        if goal_id != _NO_ID and not until_ns and not wanted:
            code = _GOAL_TERMINATED if goal_id in self._goals else _UNKNOWN_GOAL_ID
        reply(self._to_cancel_response(code, wanted))
        for goal in wanted:
            goal.status = _CANCELING
        if wanted:
            self._publish_status()
        for goal in wanted:
            if goal.is_open:  # an earlier callback may have ended it, or closed the action
                self._on_cancel(goal)

    def _to_cancel(self, goal_id: bytes, until_ns: int) -> list[HeldGoal]:
        """Return the goals that a request of action_msgs/srv/CancelGoal selects.

        That is a goal by its id, those accepted until a stamp, both, or with neither all of them.
        Never those that are canceling already.
        """
        wants_all = goal_id == _NO_ID and not until_ns
        return [
            goal
            for goal in self._goals.values()
            if goal.is_open
            and goal.status == _EXECUTING
            and (
                wants_all
                or goal.goal_id == goal_id
                or (until_ns > 0 and goal.accepted_ns <= until_ns)
            )
        ]

    def _answer_result(self, message: Any, reply: Reply) -> None:
        goal = self._goals.get(self._form.read_result_request(message))
        if goal is None:
            reply(self._form.to_result_response(_UNKNOWN))
        elif not goal.is_open:
            reply(goal.response)
        elif len(goal.waiting) < MAX_WAITING:
            goal.waiting.append(reply)
        else:  # those who have waited longer keep their places
            reply(self._form.to_result_response(_UNKNOWN))

    def _settle(self, goal: HeldGoal, status: int, response: Any) -> None:
        goal.status = status
        goal.response = response
        self._ended[goal.goal_id] = goal
        goal.expiry = self._loop.call_later(RESULT_KEPT_S, self._forget, goal)
        if len(self._ended) > MAX_RESULTS_KEPT:
            self._forget(next(iter(self._ended.values())))

    def _forget(self, goal: HeldGoal) -> None:
        if goal.expiry is not None:
            goal.expiry.cancel()
        del self._goals[goal.goal_id], self._ended[goal.goal_id]

    def _publish_status(self) -> None:
        self._publish_statuses(self._goals.values())
