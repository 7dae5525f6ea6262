# SPDX-License-Identifier: Apache-2.0
"""Actions in memory: for the fake's port and for the world outside it alike."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from gateway.sources.actions import ABORTED, CANCELED, GoalOutcome, GoalRequest, GoalResult
from gateway.sources.source import RosError

if TYPE_CHECKING:
    from tests.sources.fake import FakeRos


@dataclass(eq=False)
class FakeActionServer:
    """A server of one of the fake's actions, outside or the gateway's own."""

    ros: "FakeRos"
    name: str
    type_name: str
    on_goal: Callable[[GoalRequest], None]
    on_cancel: Callable[[GoalRequest], None]
    node: str
    accepts: Callable[[bytes], bool] = lambda goal: True
    goals: list["FakeGoalRequest"] = field(default_factory=list)

    def close(self) -> None:
        """End it. The gateway's own aborts its goals, one outside just vanishes."""
        if self not in self.ros.action_servers:
            return
        if self.ros.is_own(self.node):
            for request in list(self.goals):
                request.finish(ABORTED, self.ros.empty(f"{self.type_name}_Result"))
        self.ros.action_servers.remove(self)
        self.ros.changed()

    def arrive(self, goal: "FakeGoal") -> None:
        if self not in self.ros.action_servers:
            return
        if not self.accepts(goal.cdr):
            goal.decide(False)
            return
        goal.request = FakeGoalRequest(self, goal)
        self.goals.append(goal.request)
        self.ros.loop.call_soon(goal.decide, True)
        self.on_goal(goal.request)


@dataclass(eq=False)
class FakeGoalRequest:
    """A goal at its server."""

    server: FakeActionServer
    goal: "FakeGoal"
    is_canceling: bool = False

    @property
    def cdr(self) -> bytes:
        return self.goal.cdr

    def feedback(self, cdr: bytes) -> None:
        if self.is_open:
            self.server.ros.loop.call_soon(self.goal.hear, cdr)

    def finish(self, status: GoalOutcome, result: bytes) -> None:
        if self.is_open:
            self.server.goals.remove(self)
            if status == CANCELED and not self.is_canceling:
                status = ABORTED
            self.server.ros.loop.call_soon(self.goal.end, GoalResult(status, result))

    def cancel(self) -> None:
        if self.is_open and not self.is_canceling:
            self.is_canceling = True
            self.server.on_cancel(self)

    @property
    def is_open(self) -> bool:
        return self.server in self.server.ros.action_servers and self in self.server.goals


@dataclass(eq=False)
class FakeGoal:
    """A goal at its client."""

    client: "FakeActionClient"
    cdr: bytes
    on_feedback: Callable[[bytes], None]
    decision: asyncio.Future[bool]
    outcome: asyncio.Future[GoalResult]
    server: FakeActionServer | None = None
    request: FakeGoalRequest | None = None

    @property
    def is_accepted(self) -> bool:
        decision = self.decision
        is_decided = decision.done() and not decision.cancelled() and not decision.exception()
        return is_decided and decision.result()

    async def result(self) -> GoalResult:
        return await asyncio.shield(self.outcome)

    def cancel(self) -> None:
        if self.request is not None:
            self.client.ros.loop.call_soon(self.request.cancel)

    def decide(self, accepted: bool) -> None:
        if not self.decision.done():
            self.decision.set_result(accepted)
        elif self.decision.cancelled():  # nobody will ever ask for this goal
            self.cancel()

    def hear(self, cdr: bytes) -> None:
        if self in self.client.goals:
            self.on_feedback(cdr)

    def end(self, result: GoalResult) -> None:
        if not self.outcome.done():
            self.client.goals.remove(self)
            self.outcome.set_result(result)

    def fail(self, reason: str) -> None:
        if self in self.client.goals:
            self.client.goals.remove(self)
        for future in (self.decision, self.outcome):
            if not future.done():
                future.set_exception(RosError("not_found", reason))
                future.exception()  # nobody may be waiting for it


@dataclass(eq=False)
class FakeActionClient:
    """A client of one of the fake's actions, outside or the gateway's own."""

    ros: "FakeRos"
    name: str
    type_name: str
    node: str
    goals: list[FakeGoal] = field(default_factory=list)

    async def send_goal(self, goal: bytes, on_feedback: Callable[[bytes], None]) -> FakeGoal | None:
        loop = self.ros.loop
        sent = FakeGoal(self, goal, on_feedback, loop.create_future(), loop.create_future())
        self.goals.append(sent)
        self.follow()
        try:
            accepted = await sent.decision
        except asyncio.CancelledError:
            if sent.is_accepted:  # in this very turn of the loop
                sent.cancel()
            sent.fail("nobody is waiting")
            raise
        if not accepted:
            sent.fail("rejected")
        return sent if accepted else None

    def close(self) -> None:
        if self in self.ros.action_clients:
            self.ros.action_clients.remove(self)
            self.follow()

    def follow(self) -> None:
        """Send what waits for a server. Fail what has lost it, or this client."""
        servers = [
            server
            for server in self.ros.action_servers
            if (server.name, server.type_name) == (self.name, self.type_name)
        ]
        for goal in list(self.goals):
            if self not in self.ros.action_clients:
                goal.fail(f"the client of action {self.name} is closed")
            elif goal.server is None and servers:
                goal.server = servers[0]
                self.ros.loop.call_soon(goal.server.arrive, goal)
            elif goal.server is not None and goal.server not in self.ros.action_servers:
                # in a separate turn: a result that was given before is on its way
                self.ros.loop.call_soon(goal.fail, f"action {self.name} has gone")
