# SPDX-License-Identifier: Apache-2.0
"""Actions that the gateway uses: three services and a topic each, by ROS 2's design.

https://design.ros2.org/articles/actions.html
"""

import asyncio
import contextlib
import uuid
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Any, Final, Protocol

from gateway.backports import timeout
from gateway.sources.actions import ABORTED, CANCELED, SUCCEEDED, GoalResult
from gateway.sources.goal_ids import goal_id_of, without_goal_id
from gateway.sources.requester import Requester
from gateway.sources.source import RosError, Sample

# How long to wait for the answer to an abandoned goal, to cancel it if it is accepted. A closed
# client waits as long for the answers to its cancels. Clients of the gateway give up
# after 5 s. A server that loads a map before it accepts needs longer. An abandoned goal costs a few
# hundred bytes, a client that waits four entities of DDS.
_ABANDONED_S: Final = 30.0

OnFeedback = Callable[[bytes], None]


class GoalForm(Protocol):
    """An action type, as the requests of a source carry it."""

    type_name: str

    def to_goal_request(self, goal_id: bytes, goal: bytes) -> Any:
        """Return the request that sends a goal.

        Raises:
            RosError: ``internal``: the goal is not CDR of the type.
        """

    def is_accepted(self, response: Any) -> bool:
        """Return the server's answer to a goal."""

    def to_result_request(self, goal_id: bytes) -> Any:
        """Return the request for the result of a goal."""

    def to_cancel_request(self, goal_id: bytes) -> Any:
        """Return the request that cancels a goal."""

    def read_result_response(self, response: Any) -> tuple[int, bytes]:
        """Return the status and the result.

        Raises:
            RosError: ``internal``: the response is not CDR of the type.
        """


class GoalClient(ABC):
    """A client of an action. A subclass opens its parts."""

    _results: Requester
    _cancels: Requester
    _goals: Requester

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        name: str,
        form: GoalForm,
        on_close: Callable[["GoalClient"], None],
    ) -> None:
        self.name = name
        self.type_name = form.type_name
        self._on_close = on_close
        self._loop = loop
        self._subject = f"action {name}"
        self._feedback_callbacks: dict[bytes, OnFeedback] = {}
        self._abandoned: dict[asyncio.Future[Any], asyncio.Task[None]] = {}  # by their answers
        self._canceling: dict[bytes, asyncio.Future[Any]] = {}
        self._destroy_timer: asyncio.TimerHandle | None = None
        self._is_closed = False
        self._feedback_topic = f"{name}/_action/feedback"
        self._form = form

    def _to_request(self, goal_id: bytes, goal: bytes) -> Any:
        return self._form.to_goal_request(goal_id, goal)

    @abstractmethod
    def _flush_feedback(self) -> None:
        """Deliver the feedback that has arrived."""

    @abstractmethod
    def _has_feedback(self) -> bool:
        """Return whether a server publishes feedback."""

    @abstractmethod
    def _destroy_parts(self) -> None:
        """Destroy the requesters, and what reads the feedback."""

    async def send_goal(self, goal: bytes, on_feedback: OnFeedback) -> "AcceptedGoal | None":
        """Wait for a server and send it a goal. See the port."""
        if self._is_closed:
            raise RosError("not_found", f"the client of {self._subject} is closed")
        goal_id = uuid.uuid4().bytes
        request = self._to_request(goal_id, goal)
        self._feedback_callbacks[goal_id] = on_feedback  # feedback may come before the answer
        answer = self._goals.send(request)
        is_accepted = False
        try:
            is_accepted = self._form.is_accepted(await asyncio.shield(answer))
        except asyncio.CancelledError:
            self._abandon(goal_id, answer)
            raise
        finally:
            if not is_accepted:
                self._feedback_callbacks.pop(goal_id, None)
        return AcceptedGoal(self, goal_id, self._ask_result(goal_id)) if is_accepted else None

    def cancel_goal(self, goal_id: bytes) -> None:
        """Ask the server to cancel a goal, unless it has been asked and has not answered."""
        if goal_id in self._canceling:
            return
        answer = self._cancels.send(self._form.to_cancel_request(goal_id), waits=False)
        self._canceling[goal_id] = answer

        def answered(_: object) -> None:
            del self._canceling[goal_id]
            self._destroy_if_done()

        answer.add_done_callback(answered)

    def to_result(self, response: Any) -> GoalResult:
        """Convert the response to a request for the result of a goal.

        Raises:
            RosError: ``not_found``: the server does not know the goal. ``internal``: the response
                cannot be read.
        """
        status, result = self._form.read_result_response(response)
        for known in (SUCCEEDED, CANCELED, ABORTED):
            if status == known:
                return GoalResult(known, result)
        text = f"{self._subject} does not know the goal: it has forgotten it, or was started again"
        raise RosError("not_found", text)

    def follow_graph(self) -> None:
        """Follow servers that have come or gone."""
        for requester in (self._goals, self._results, self._cancels):
            requester.follow_graph()

    def close(self) -> None:
        """Destroy it, once abandoned goals are answered and cancelled. See the port."""
        if self._is_closed:
            return
        self._is_closed = True
        self._destroy_timer = self._loop.call_later(_ABANDONED_S, self.destroy)
        self._feedback_callbacks.clear()
        self._results.fail_all()
        self._goals.fail_all(but=self._abandoned)
        self._destroy_if_done()

    def withdraw(self) -> None:
        """Send all cancels now, so that it can be destroyed. Withdrawing twice is harmless."""
        self._is_closed = True
        if self._destroy_timer is not None:
            self._destroy_timer.cancel()
        self._on_close(self)
        self._cancels.flush()  # more at once than a server may keep, but unsent all are lost

    def destroy(self) -> None:
        """Withdraw and destroy it. Destroying twice is harmless."""
        self.withdraw()
        self._destroy_parts()

    def _is_rest_ready(self) -> bool:
        # Without this the first feedback of a goal, or its result, would be lost.
        return self._results.is_ready and self._cancels.is_ready and self._has_feedback()

    def _ask_result(self, goal_id: bytes) -> "asyncio.Future[Any]":
        result = self._results.send(self._form.to_result_request(goal_id), waits=False)
        result.add_done_callback(lambda _: self._end(goal_id, result))
        return result

    def _end(self, goal_id: bytes, result: "asyncio.Future[Any]") -> None:
        self._flush_feedback()  # samples from before the result
        self._feedback_callbacks.pop(goal_id, None)
        if goal_id in self._canceling and result.exception() is None:
            self._canceling[goal_id].cancel()  # there is nothing left to cancel

    def _destroy_if_done(self) -> None:
        if self._is_closed and not self._abandoned and not self._canceling:
            self.destroy()

    def _abandon(self, goal_id: bytes, answer: "asyncio.Future[Any]") -> None:
        if self._goals.is_waiting(answer):
            answer.cancel()
            return

        def decided(_: object) -> None:
            del self._abandoned[answer]
            self._destroy_if_done()

        deciding = self._loop.create_task(self._cancel_if_accepted(goal_id, answer))
        self._abandoned[answer] = deciding
        deciding.add_done_callback(decided)

    async def _cancel_if_accepted(self, goal_id: bytes, answer: "asyncio.Future[Any]") -> None:
        with contextlib.suppress(TimeoutError, RosError):  # errors of the server. Nobody waits
            async with timeout(_ABANDONED_S):
                if self._form.is_accepted(await answer):  # it would be executed for nobody
                    self.cancel_goal(goal_id)

    def _deliver_feedback(self, samples: Sequence[Sample]) -> None:
        for sample in samples:
            cdr = bytes(sample.cdr)
            on_feedback = self._feedback_callbacks.get(goal_id_of(cdr))
            if on_feedback is not None:
                on_feedback(without_goal_id(cdr))


class AcceptedGoal:
    """A goal that a server has accepted."""

    def __init__(self, client: GoalClient, goal_id: bytes, response: "asyncio.Future[Any]") -> None:
        self._client = client
        self._goal_id = goal_id
        self._response = response

    async def result(self) -> GoalResult:
        """Wait for the end of the goal. See the port."""
        return self._client.to_result(await asyncio.shield(self._response))

    def cancel(self) -> None:
        """Ask the server to cancel. Returns at once."""
        self._client.cancel_goal(self._goal_id)
