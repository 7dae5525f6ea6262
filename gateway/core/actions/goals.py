# SPDX-License-Identifier: Apache-2.0
"""Goals that clients send to action servers."""

import asyncio
from dataclasses import dataclass, field
from functools import partial
from typing import Final

from gateway.codec.error_text import CodecError
from gateway.codec.types import ActionType
from gateway.core.deadline import Deadline
from gateway.core.entries import NOTHING, Frame
from gateway.core.errors import NothingThereError, ProtocolError, over_limit
from gateway.core.interface_types import InterfaceTypes
from gateway.core.names import ActionName, resolve_action
from gateway.core.queue import Queue
from gateway.core.raw_values import RawValues
from gateway.core.requests import CancelActionGoal, SendActionGoal
from gateway.core.service_clients import encode_values
from gateway.core.session import Session
from gateway.core.tasks import Metered, answered
from gateway.sources.actions import ActionClient, Goal
from gateway.sources.client_cache import ClientCache
from gateway.sources.source import Ros

# An action server accepts or rejects a goal at once. The goal itself may take hours.
ACCEPT_S: Final = 5.0
# Only the newest feedback matters: a slow reader gets that.
FEEDBACK_QUEUE: Final = (16, 256 * 1024)  # messages, bytes


@dataclass(slots=True, eq=False)
class SentGoal:
    """One goal, from the client's request to the result."""

    session: Session
    request: SendActionGoal
    action: ActionName
    type: ActionType
    queue: Queue  # for its feedback
    goal: Goal | None = None  # once a server has accepted it
    is_cancelled: bool = False
    is_abandoned: bool = False  # its client has left
    task: "asyncio.Task[None] | None" = field(default=None, repr=False)

    def cancel(self) -> None:
        """Ask the server to cancel, now or as soon as it has accepted."""
        self.is_cancelled = True
        if self.goal is not None:
            self.goal.cancel()

    def flush_feedback(self) -> None:
        """Send waiting feedback before the result, which would overtake it."""
        while (frame := self.queue.next()) is not None:
            self.session.outbox.put_control(bytes(frame))

    def on_feedback(self, cdr: bytes) -> None:
        """Pass the server's feedback on, if the client wants it and is still connected."""
        if self.request.feedback and not self.is_abandoned:
            self.queue.put(_Feedback(self, cdr))
            self.session.wake()


class Goals:
    """Carries out `send_action_goal` and `cancel_action_goal`, several at once per client."""

    def __init__(self, ros: Ros, types: InterfaceTypes) -> None:
        self._ros = ros
        self._types = types
        self._clients: ClientCache[ActionClient] = ClientCache()
        self._sent: dict[Session, set[SentGoal]] = {}

    @property
    def clients(self) -> int:
        """The number of open ROS action clients."""
        return len(self._clients)

    @property
    def under_way(self) -> int:
        """The number of goals without a result yet."""
        return sum(map(len, self._sent.values()))

    def count(self, session: Session) -> int:
        """Count the goals of a client. Each may need a client of another action."""
        return len(self._sent.get(session, ()))

    def send(self, session: Session, request: SendActionGoal) -> None:
        """Send a goal. Feedback and the result, or an error, are sent later.

        Raises:
            ProtocolError: no server provides the action with that type, the goal does not fit the
                type, or the client has too many goals.
        """
        action = resolve_action(request.action, session.limits.max_name_characters)
        action_type = self._types.of_action(action, request.action_type, session.sees)
        own = self._sent.get(session, set())
        if len(own) >= session.limits.max_goals:
            limit = session.limits.max_goals
            raise over_limit(limit, "unfinished goals per client", "max_goals")
        session.check_share()
        if request.id is not None and any(other.request.id == request.id for other in own):
            raise ProtocolError(
                "bad_request", f"id: {request.id!r} is already in use by an unfinished goal"
            )
        args = request.args
        if isinstance(args, RawValues):
            goal = args.cdr
        else:
            goal = encode_values(action_type.goal, args, self._ros.now_ns, "args")
        queue = session.outbox.open_queue(*FEEDBACK_QUEUE)
        sent = SentGoal(session, request, action, action_type, queue)
        self._sent.setdefault(session, own).add(sent)
        work = partial(self._follow, sent, goal)
        loop = asyncio.get_running_loop()
        sent.task = loop.create_task(Metered(answered(session, request, work), session))
        sent.task.add_done_callback(lambda _: self._forget(sent))

    def cancel(self, session: Session, request: CancelActionGoal) -> None:
        """Ask the server to cancel a goal. Its result reports whether it was cancelled.

        Raises:
            ProtocolError: the client has no active goal with this id.
        """
        action = resolve_action(request.action, session.limits.max_name_characters)
        for sent in self._sent.get(session, set()):
            if sent.request.id == request.id and sent.action == action:
                sent.cancel()
                return
        text = f"no goal of {action} with id {request.id!r} is under way"
        raise NothingThereError(text)

    def leave(self, session: Session) -> None:
        """Cancel a client's goals, except for those that it wants to keep."""
        for sent in list(self._sent.get(session, ())):
            sent.is_abandoned = True
            if not sent.request.keep:
                sent.cancel()
            elif sent.goal is None:
                continue  # its task ends as soon as the server has accepted
            if sent.task is not None:
                sent.task.cancel()  # this withdraws a goal that the server has not accepted yet

    def close(self) -> None:
        """Forget every goal and close every action client."""
        for own in list(self._sent.values()):
            for sent in own:
                if sent.task is not None:
                    sent.task.cancel()
        self._clients.close()

    async def _follow(self, sent: SentGoal, goal_cdr: bytes) -> None:
        action, type_name = sent.action, sent.type.name
        opened = self._clients.use(
            (action, type_name), lambda: self._ros.actions.action_client(action, type_name)
        )
        with opened as client:
            deadline = Deadline.within(ACCEPT_S)
            async with deadline.limit(f"action {action} has not answered the goal"):
                goal = await client.send_goal(goal_cdr, sent.on_feedback)
            if goal is None:
                raise ProtocolError("bad_request", f"action {action} has rejected the goal")
            sent.goal = goal
            if sent.is_cancelled:
                goal.cancel()
            if sent.is_abandoned:
                return
            status, cdr = await goal.result()
        if isinstance(sent.request.args, RawValues):
            sent.flush_feedback()
            sent.session.finish_raw(sent.request, cdr, status)
            return
        try:
            values = sent.type.result.decode(cdr)
        except CodecError as error:
            raise ProtocolError("internal", f"result of {action}: {error}") from error
        sent.flush_feedback()
        sent.session.finish(sent.request, values, status)

    def _forget(self, sent: SentGoal) -> None:
        sent.session.outbox.close_queue(sent.queue)
        own = self._sent[sent.session]
        own.discard(sent)
        if not own:
            del self._sent[sent.session]


class _Feedback:
    """One feedback in a client's outbox, decoded when it is sent."""

    __slots__ = ("_cdr", "_goal", "size")

    is_being_encoded = False
    arrived_ns = 0

    def __init__(self, sent: SentGoal, cdr: bytes) -> None:
        self._goal = sent
        self._cdr = cdr
        self.size = len(cdr)

    def frame(self) -> Frame:
        """Return the frame, or `NOTHING` if the feedback cannot be decoded."""
        sent = self._goal
        if isinstance(sent.request.args, RawValues):
            return sent.session.feedback_raw(sent.request, self._cdr)
        try:
            values = sent.type.feedback.decode(self._cdr)
        except CodecError:
            return NOTHING
        return sent.session.feedback_frame(sent.request, values)
