# SPDX-License-Identifier: Apache-2.0
"""Actions that clients provide: goals from ROS go to a client, its results go back."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from gateway.codec.error_text import CodecError
from gateway.codec.types import ActionType
from gateway.core.errors import NothingThereError, ProtocolError, over_limit
from gateway.core.interface_types import InterfaceTypes
from gateway.core.names import ActionName, resolve_action
from gateway.core.provided import check_takeover, failure, nodes_of, warn_of_others
from gateway.core.requests import (
    ActionFeedback,
    ActionResult,
    AdvertiseAction,
    UnadvertiseAction,
)
from gateway.core.service_clients import encode_values
from gateway.core.session import Session
from gateway.sources.actions import (
    ABORTED,
    CANCELED,
    SUCCEEDED,
    ActionServer,
    GoalOutcome,
    GoalRequest,
)
from gateway.sources.source import Ros, RosError

_OUTCOMES: dict[int, GoalOutcome] = {4: SUCCEEDED, 5: CANCELED, 6: ABORTED}


@dataclass(slots=True)
class ClientAction:
    """One action of one client."""

    session: Session
    requested_name: str
    requested_type: str
    type: ActionType
    server: ActionServer
    goals: dict[str, GoalRequest] = field(default_factory=dict)
    canceling: set[str] = field(default_factory=set)  # goals that a ROS client wants to cancel


class ClientActions:
    """Opens and closes ROS action servers as clients come and go."""

    def __init__(self, ros: Ros, types: InterfaceTypes) -> None:
        self._ros = ros
        self._types = types
        self._provided: dict[ActionName, ClientAction] = {}

    @property
    def servers(self) -> int:
        """The number of open ROS action servers."""
        return len(self._provided)

    @property
    def pending(self) -> int:
        """The number of goals that wait for a client to end them."""
        return sum(len(provided.goals) for provided in self._provided.values())

    def count(self, session: Session) -> int:
        """Count the actions of a client."""
        return sum(provided.session is session for provided in self._provided.values())

    def advertise(self, session: Session, request: AdvertiseAction) -> None:
        """Open an action server. As with services, the newest provider wins.

        Raises:
            ProtocolError: the name or the type is wrong.
            RosError: ROS refuses it.
        """
        action = resolve_action(request.action, session.limits.max_name_characters)
        action_type = self._types.action(request.type)
        former = self._provided.get(action)
        if former is None and self.count(session) >= session.limits.max_advertisements:
            limit = session.limits.max_advertisements
            raise over_limit(limit, "actions provided per client", "max_advertisements")
        if former is None or former.session is not session:
            session.check_share()
        if former is not None:
            check_takeover(session, former.session, action, action_type.name, former.type.name)
            self._close(action, former)
        others = () if former else self._others(action)
        try:
            self._open(session, action, request.action, request.type, action_type)
        except RosError:
            if former is not None:
                names = former.requested_name, former.requested_type
                self._open(former.session, action, *names, former.type)
            raise
        if former is not None and former.session is not session:
            text = f"action {action} is provided by another client now"
            former.session.warn(ProtocolError("not_found", text), replace(request, id=None))
        warn_of_others(session, f"action {action}", others, request)
        session.inform(f"providing {action} ({action_type.name})", request)

    def unadvertise(self, session: Session, request: UnadvertiseAction) -> None:
        """Close an action server. Its goals are aborted.

        Raises:
            ProtocolError: this client does not provide it.
        """
        action = resolve_action(request.action, session.limits.max_name_characters)
        self._close(action, self._own(session, action))

    def feedback(self, session: Session, request: ActionFeedback) -> None:
        """Publish a client's feedback on a goal.

        Raises:
            ProtocolError: the goal is unknown, or the values do not fit the type.
        """
        provided, goal_id = self._find(session, request)
        cdr = encode_values(provided.type.feedback, request.values, self._ros.now_ns, "values")
        provided.goals[goal_id].feedback(cdr)

    def finish(self, session: Session, request: ActionResult) -> None:
        """End a goal with a client's status and result.

        Raises:
            ProtocolError: the goal is unknown, the status does not end a goal, or the values do
                not fit the type. In this last case the goal is aborted.
        """
        provided, goal_id = self._find(session, request)
        # roslib 1 leaves the status out: then only success or failure is known
        status = _OUTCOMES.get(SUCCEEDED if request.status is None else request.status)
        if not request.result:
            status = ABORTED
        if status is None:
            expected = "4 (succeeded), 5 (canceled) or 6 (aborted)"
            raise ProtocolError("bad_request", f"status: expected {expected}, got {request.status}")
        result_type = provided.type.result
        goal = provided.goals.pop(goal_id)
        is_canceling = goal_id in provided.canceling
        provided.canceling.discard(goal_id)
        if request.status == CANCELED and (status == ABORTED or not is_canceling):
            why = "nobody asked to cancel the goal" if not is_canceling else "result is false"
            text = f"status: {why}, so it ends as aborted (6), not canceled (5)"
            session.warn(ProtocolError("bad_request", text), request)
        if status == ABORTED and isinstance(request.values, str | None):
            reason = request.values if isinstance(request.values, str) else "action failed"
            goal.finish(ABORTED, failure(result_type, reason))
            return
        try:
            cdr = encode_values(result_type, request.values, self._ros.now_ns, "values")
        except ProtocolError:
            reason = "the action's client sent an invalid result"
            goal.finish(ABORTED, failure(result_type, reason))
            raise
        goal.finish(status, cdr)

    def leave(self, session: Session) -> None:
        """Close all actions of a client. Their goals are aborted."""
        for action, provided in list(self._provided.items()):
            if provided.session is session:
                self._close(action, provided)

    def _others(self, action: ActionName) -> Sequence[str]:
        """Return the ROS nodes that provide it."""
        if not self._ros.action_types(action):  # which the graph is read for
            return ()
        return nodes_of(action, self._ros.graph().actions)

    def _own(self, session: Session, action: ActionName) -> ClientAction:
        provided = self._provided.get(action)
        if provided is None or provided.session is not session:
            raise NothingThereError(f"action {action} is not provided by this client")
        return provided

    def _find(
        self, session: Session, request: ActionFeedback | ActionResult
    ) -> tuple[ClientAction, str]:
        action = resolve_action(request.action, session.limits.max_name_characters)
        provided = self._own(session, action)
        goal_id = str(request.id)
        if goal_id not in provided.goals:
            raise NothingThereError(f"no goal of {action} with id {request.id!r}")
        return provided, goal_id

    def _open(
        self,
        session: Session,
        action: ActionName,
        requested_name: str,
        requested_type: str,
        action_type: ActionType,
    ) -> None:
        provided: ClientAction

        def on_goal(goal: GoalRequest) -> None:
            self._pass_on(action, provided, goal)

        def on_cancel(goal: GoalRequest) -> None:
            _pass_on_cancel(provided, goal)

        server = self._ros.actions.serve_action(action, action_type.name, on_goal, on_cancel)
        provided = ClientAction(session, requested_name, requested_type, action_type, server)
        self._provided[action] = provided

    def _pass_on(self, action: ActionName, provided: ClientAction, goal: GoalRequest) -> None:
        try:
            args = provided.type.goal.decode(goal.cdr)
        except CodecError as error:
            goal.finish(ABORTED, failure(provided.type.result, f"goal cannot be read: {error}"))
            return
        name, type_name = provided.requested_name, provided.requested_type
        provided.goals[provided.session.pass_goal(action, name, type_name, args)] = goal

    def _close(self, action: ActionName, provided: ClientAction) -> None:
        del self._provided[action]
        provided.goals.clear()
        provided.canceling.clear()
        provided.server.close()


def _pass_on_cancel(provided: ClientAction, goal: GoalRequest) -> None:
    for goal_id, known in provided.goals.items():
        if known is goal:
            provided.canceling.add(goal_id)
            provided.session.pass_cancel(provided.requested_name, goal_id)
