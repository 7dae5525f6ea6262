# SPDX-License-Identifier: Apache-2.0
"""Actions of the robot that relays use: goals come as requests, and the core sends them on."""

import asyncio
import contextlib
import itertools
import logging
import time
from collections.abc import Mapping
from typing import TYPE_CHECKING, Final, cast

from gateway.core.errors import ProtocolError
from gateway.core.raw_values import RawValues
from gateway.core.requests import CancelActionGoal, SendActionGoal
from gateway.sources.action_server import ServedAction
from gateway.sources.actions import ABORTED, GoalOutcome, GoalRequest
from gateway.sources.source import Qos, RosError
from gateway.sources.zenoh.action_wire import action_wire
from gateway.sources.zenoh.actions import ActionParts, ZenohActionServer
from gateway.sources.zenoh.keys import DataKey
from gateway.sources.zenoh.replier import OnRequest
from gateway.sources.zenoh.service_forms import ServiceWire, check
from gateway.uplink.offer import DOMAIN
from gateway.uplink.topics import Sender

if TYPE_CHECKING:
    from gateway.uplink.calls import RemoteQuery
    from gateway.uplink.link import UplinkLink

BEHIND_ACTION: Final = "/_action/"

_logger = logging.getLogger(__name__)


class _ActionSender:
    """The publisher of an action's feedback, or of its statuses."""

    def __init__(self, link: "UplinkLink", key: DataKey, qos: Qos) -> None:
        self._link = link
        gid = next(iter(link.mirror.gids(key.name)), bytes(16))
        self._sender = Sender(link.outgoing, link.opened.zenoh, key.text, qos, gid)
        self._numbers = itertools.count(1)

    def publish(self, cdr: bytes) -> None:
        with contextlib.suppress(RosError):  # too much waits: its number is missing
            self._sender.send(cdr, next(self._numbers), time.time_ns())
        self._link.pace.sent(len(cdr))

    def close(self) -> None:
        self._sender.close()


class _Route:
    """A service of an action, to which the requests of relays are passed on."""

    has_replied = False

    def __init__(self, wire: ServiceWire, on_request: OnRequest, subject: str) -> None:
        self.wire, self.on_request, self.subject = wire, on_request, subject

    def drain(self) -> None:
        """Keep nothing that waits."""

    def close(self) -> None:
        """Have nothing to withdraw: the queryable of the uplink stays."""


class UplinkActions:
    """Serves an action from the first request on."""

    def __init__(self, link: "UplinkLink") -> None:
        self._link = link
        self._served: dict[str, ZenohActionServer] = {}
        self._routes: dict[str, _Route] = {}  # by service
        self._ids = itertools.count(1)
        self._sent: dict[GoalRequest, str] = {}  # the id of each goal that has not ended

    def take(self, remote: "RemoteQuery", cdr: bytes) -> None:
        """Pass a request on to the action that it is for."""
        key = remote.key
        action = key.name.partition(BEHIND_ACTION)[0]
        type_name = self._link.offer.actions.get(action)
        if type_name is None:
            remote.drop()
            return
        if action not in self._served:
            self._serve(action, type_name)
        route = self._routes.get(key.name)
        if route is None or key[2:] != (route.wire.type_name, route.wire.type_hash):
            text = f"the robot has another definition of {type_name} than the relay"
            remote.refuse(f"action {action}: {text}: give both the same packages")
            return
        try:
            check(route.subject, route.wire.read_request, cdr)
            route.on_request(cdr, remote.reply)
        except RosError as error:
            remote.refuse(str(error))

    def follow(self, actions: Mapping[str, str]) -> None:
        """Withdraw what the robot does not offer any more."""
        for name, server in list(self._served.items()):
            if actions.get(name) != server.type_name:
                server.close()

    def close(self) -> None:
        """Abort all goals of relays."""
        for server in list(self._served.values()):
            server.close()

    def _serve(self, action: str, type_name: str) -> None:
        link = self._link
        empty_result = link.types.action(type_name).result.encode({}, 0)

        def on_goal(goal: GoalRequest) -> None:
            goal_id = self._sent[goal] = str(next(self._ids))
            request = SendActionGoal(
                id=goal_id,
                action=action,
                action_type=type_name,
                args=RawValues(goal.cdr),
                feedback=True,
                form=_RemoteGoal(self, empty_result, goal),
            )
            link.core.carry_out(link.session, request)

        def on_cancel(goal: GoalRequest) -> None:
            request = CancelActionGoal(id=self._sent[goal], action=action)
            link.core.carry_out(link.session, request)

        self._served[action] = ZenohActionServer(
            ActionParts(
                asyncio.get_running_loop(),
                link.types,
                link.core.ros.now_ns,
                self._publisher,
                self._replier,
            ),
            *(action, action_wire(link.types, type_name), (on_goal, on_cancel), self._forget),
        )

    def has_ended(self, goal: GoalRequest) -> None:
        """Forget a goal."""
        self._sent.pop(goal, None)

    def _publisher(self, topic: str, type_name: str, qos: Qos) -> _ActionSender:
        type_hash = self._link.offering.hash_of(type_name) or ""
        return _ActionSender(self._link, DataKey(DOMAIN, topic, type_name, type_hash), qos)

    def _replier(self, wire: ServiceWire, name: str, answer: OnRequest, subject: str) -> _Route:
        route = self._routes[name] = _Route(wire, answer, subject)
        return route

    def _forget(self, server: ServedAction) -> None:
        del self._served[server.name]
        before = f"{server.name}{BEHIND_ACTION}"
        self._routes = {
            name: route for name, route in self._routes.items() if not name.startswith(before)
        }
        server.destroy()


class _RemoteGoal:
    """A goal that the core sends on. See `gateway.uplink.session.RemoteRequest`."""

    def __init__(self, actions: UplinkActions, empty_result: bytes, goal: GoalRequest) -> None:
        self._actions, self._empty_result, self._goal = actions, empty_result, goal

    def take(self, cdr: bytes, status: int) -> None:
        self._actions.has_ended(self._goal)
        self._goal.finish(cast("GoalOutcome", status), cdr)

    def feed(self, cdr: bytes) -> None:
        self._goal.feedback(cdr)

    def refuse(self, error: ProtocolError) -> None:
        _logger.warning("a goal of a relay has failed: %s", error)
        self._actions.has_ended(self._goal)
        self._goal.finish(ABORTED, self._empty_result)
