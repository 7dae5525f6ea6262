# SPDX-License-Identifier: Apache-2.0
"""Requests and responses of rclpy's classes, taken and sent by the event loop itself.

Services are these, and so is most of an action. No executor is part of it: in rclpy 7.1 a service
whose answer comes later fails on the EventsExecutor, and actions lose results on it.
"""

import asyncio
import logging
from collections import deque
from collections.abc import Callable, Collection
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

from rclpy.node import Node
from rclpy.qos import QoSProfile

from gateway.ports import MAX_TAKES_PER_TURN, RosError
from gateway.ros import rclpy_private
from gateway.ros.errors import REFUSALS, losses, refusals, refused, remapped
from gateway.ros.groups import group_of_one
from gateway.ros.qos import MAX_DEPTH
from gateway.ros.ready_events import ReadyEvents

# How soon a server that appears gets what waits for it: the graph tells of a server before DDS
# has matched both its topics, and nothing tells of that.
LOOK_S: Final = 0.02
# Servers keep 10 requests that they have not taken, the default of ROS, and DDS drops what comes
# beyond without a word. So many are sent ahead of their answers. While nothing is answered, one
# more goes each second: what answers late, or never, has most likely taken the oldest by then.
MAX_IN_FLIGHT: Final = 10
PACING_S: Final = 1.0
# A client whose reader does not match, such as one that asks for transient_local, gets no response,
# but rmw waits for it for 0.1 s each time, and the event loop with it. Nothing tells beforehand
# whose request it is: after so many such waits the service responds to nobody for a while, which
# leaves the loop 97 % of its time.
MAX_STALLS: Final = 3
STALLED_S: Final = 10.0

_logger = logging.getLogger(__name__)

# sends the response, unless the server is closed; to a client that has gone it goes nowhere
Reply = Callable[[Any], None]
OnRequest = Callable[[Any, Reply], None]


@dataclass(frozen=True, slots=True)
class Endpoints:
    """Where clients and servers are created: on a node that nothing spins."""

    node: Node
    ready_events: ReadyEvents
    loop: asyncio.AbstractEventLoop


class _UnderWay(NamedTuple):
    response: asyncio.Future[Any]
    servers: frozenset[bytes]  # those that may have the request


class Requester:
    """One client of rclpy's, with any number of requests under way."""

    def __init__(
        self,
        endpoints: Endpoints,
        service_class: Any,
        name: str,
        *,
        subject: str,
        is_ready: Callable[[], bool] = lambda: True,
        is_paced: Callable[[], bool] = lambda: True,
    ) -> None:
        """Create it; *subject*, such as ``service /reset``, is what its errors are about.

        *is_ready* may hold requests back though the server is there. While *is_paced* those
        beyond `MAX_IN_FLIGHT` wait as well.

        Raises:
            RosError: ROS refuses it, or gives it another name.
        """
        node = endpoints.node
        self._node = node
        self._name = name
        self._loop = endpoints.loop
        self._subject = subject
        self._is_other_ready = is_ready
        self._is_paced = is_paced
        self._response_class = service_class.Response
        self._waiting: dict[asyncio.Future[Any], Any] = {}
        self._under_way: dict[int, _UnderWay] = {}
        self._in_flight: dict[int, None] = {}  # those of them that count as not taken, oldest first
        self._pacing: asyncio.TimerHandle | None = None
        self._next_look: asyncio.TimerHandle | None = None
        self._is_closed = False
        with refusals(subject):
            self._source = endpoints.ready_events.open(
                "client",
                lambda: node.create_client(
                    service_class, name, qos_profile=_profile(), callback_group=group_of_one()
                ),
                node.destroy_client,
                self._take,
            )
        self._client = self._source.entity
        self._send_request = rclpy_private.request_sender(self._client)
        self._take_response = rclpy_private.response_taker(self._client)
        given = self._client.service_name
        if given != name:
            self.close()
            raise remapped(subject, given)

    @property
    def is_ready(self) -> bool:
        """Whether a server is there to be sent to."""
        return bool(self._client.service_is_ready()) and self._is_other_ready()

    def send(self, request: Any, *, waits: bool = True) -> "asyncio.Future[Any]":
        """Return the response to come; if there is no server the request waits, or it fails.

        Cancelling it forgets the request. It fails with a `RosError`, ``not_found``, when the
        server has gone since it got the request, or this is closed.
        """
        response = self._loop.create_future()
        if self._is_closed:
            self._fail(response, self._closed())
        elif not waits and not self.is_ready:
            self._fail(response, self._gone())
        else:
            self._waiting[response] = request
            response.add_done_callback(self._forget)
            self._send_waiting()
        return response

    def is_waiting(self, response: "asyncio.Future[Any]") -> bool:
        """Whether a request has not been sent yet."""
        return response in self._waiting

    def follow_graph(self) -> None:
        """See whether servers have come or gone."""
        lost = self._find_lost()
        if lost:
            self._take()  # an answer that is there already counts
        for response in lost:
            self._fail(response, self._gone())
        self._send_waiting()

    def flush(self) -> None:
        """Send at once what waits for nothing but its turn."""
        self._send_waiting(is_flush=True)

    def close(self) -> None:
        """Destroy it; what is under way fails. Closing twice is harmless."""
        if self._is_closed:
            return
        self._is_closed = True
        if self._next_look is not None:
            self._next_look.cancel()
        self._source.close()
        self.fail_all()

    def fail_all(self, *, but: Collection["asyncio.Future[Any]"] = ()) -> None:
        """Fail what waits and what is under way, except for some, as `close` does."""
        responses = [each.response for each in self._under_way.values()]
        for response in [*responses, *self._waiting]:
            if response not in but:
                self._fail(response, self._closed())

    def _find_lost(self) -> "list[asyncio.Future[Any]]":
        under_way = self._under_way.values()
        if not under_way or not self.is_ready:
            return [each.response for each in under_way]
        # Another server may have come in place of one that died without a word.
        servers = self._find_servers()
        return [e.response for e in under_way if e.servers and e.servers.isdisjoint(servers)]

    def _find_servers(self) -> frozenset[bytes]:
        """Identify the servers by their DDS readers; 40 us.

        Empty where another rmw than those of Fast DDS and Cyclone DDS names its topics otherwise.
        """
        topic = f"rq{self._name}Request"
        readers = self._node.get_subscriptions_info_by_topic(topic, no_mangle=True)
        return frozenset(bytes(reader.endpoint_gid) for reader in readers)

    def _look_again(self) -> None:
        if self._next_look is None:
            self._next_look = self._loop.call_later(LOOK_S, self._look_now)

    def _look_now(self) -> None:
        self._next_look = None
        self._send_waiting()

    def _send_waiting(self, *, is_flush: bool = False) -> None:
        while self._waiting and (
            is_flush or len(self._in_flight) < MAX_IN_FLIGHT or not self._is_paced()
        ):
            if not self.is_ready:
                self._look_again()
                break
            response = next(iter(self._waiting))
            request = self._waiting.pop(response)
            if not response.done():
                self._send(request, response)

    def _send(self, request: Any, response: "asyncio.Future[Any]") -> None:
        try:
            number = self._send_request(request)
        except REFUSALS as error:
            self._fail(response, refused(self._subject, error))
            return
        # Looked up each time: word of a change of the graph comes later than the server.
        self._under_way[number] = _UnderWay(response, self._find_servers())
        self._in_flight[number] = None
        if self._pacing is None:
            self._restart_pacing()
        response.add_done_callback(lambda _: self._end(number))

    def _end(self, number: int) -> None:
        del self._under_way[number]
        if number in self._in_flight:
            self._make_room(number)

    def _make_room(self, number: int) -> None:
        del self._in_flight[number]
        self._restart_pacing()
        if not self._is_closed:
            self._send_waiting()

    def _restart_pacing(self) -> None:
        """Let the oldest give its place up once nothing has made room for `PACING_S`."""
        if self._pacing is not None:
            self._pacing.cancel()
            self._pacing = None
        if self._in_flight and not self._is_closed:
            self._pacing = self._loop.call_later(
                PACING_S, self._make_room, next(iter(self._in_flight))
            )

    def _take(self) -> None:
        for _ in range(MAX_TAKES_PER_TURN):
            info, message = self._take_response(self._response_class)
            is_pending = self._source.count_take()
            if info is None:
                if is_pending:
                    continue  # it could not be read
                return
            request = self._under_way.get(info.request_id.sequence_number)
            if request is not None and not request.response.done():
                request.response.set_result(message)
        self._source.notify_again()  # there may be more

    def _forget(self, response: "asyncio.Future[Any]") -> None:
        self._waiting.pop(response, None)

    def _gone(self) -> RosError:
        return RosError("not_found", f"{self._subject} has gone")

    def _closed(self) -> RosError:
        return RosError("not_found", f"the client of {self._subject} is closed")

    def _fail(self, response: "asyncio.Future[Any]", error: RosError) -> None:
        if not response.done():
            response.set_exception(error)
            response.exception()  # known: nobody needs to wait for it


class Replier:
    """One server of rclpy's."""

    def __init__(
        self,
        endpoints: Endpoints,
        service_class: Any,
        name: str,
        on_request: OnRequest,
        *,
        subject: str,
    ) -> None:
        """Create it; *subject*, such as ``service /reset``, is what its errors are about.

        Raises:
            RosError: ROS refuses it, or gives it another name.
        """
        node = endpoints.node
        self._subject = subject
        self._loop = endpoints.loop
        self._on_request = on_request
        self._request_class = service_class.Request
        self._is_draining = False
        self._is_closed = False
        self.has_replied = False
        self._stalls: deque[float] = deque(maxlen=MAX_STALLS)  # when the last ones were
        self._silent_until = self._loop.time()
        with refusals(subject):
            self._source = endpoints.ready_events.open(
                "service",
                lambda: node.create_service(
                    service_class,
                    name,
                    _never_called,
                    qos_profile=_profile(),
                    callback_group=group_of_one(),
                ),
                node.destroy_service,
                self._take,
            )
        service = self._source.entity
        self._take_request = rclpy_private.request_taker(service)
        self._send_response = rclpy_private.response_sender(service)
        given = service.service_name
        if given != name:
            self._source.close()
            raise remapped(subject, given)

    def drain(self) -> None:
        """Give *on_request* what has arrived. From within that, this does nothing."""
        if self._is_draining:
            return
        self._is_draining = True
        try:
            for _ in range(MAX_DEPTH):
                if self._is_closed or not self._take_one():
                    break
        finally:
            self._is_draining = False

    def close(self) -> None:
        """Destroy it, once *on_request* has got what has arrived, to reply to it within the call.

        No request comes after. Closing twice is harmless.
        """
        if self._is_closed:
            return
        try:
            self.drain()
        finally:
            self._is_closed = True
            self._source.close()

    def _take(self) -> None:
        if not self._is_draining:
            self._take_one()

    def _take_one(self) -> bool:
        """Take one request; tell whether there may be more."""
        request, info = self._take_request(self._request_class)
        if not self._source.count_take() and info is None:
            return False
        # One a turn, and before the callback: what that raises keeps no other waiting.
        self._source.notify_again()
        if info is not None:  # it could be read
            self._on_request(request, lambda response: self._reply(response, info.request_id))
        return True

    def _reply(self, response: Any, request_id: rclpy_private.RequestId) -> None:
        if self._is_closed or self._loop.time() < self._silent_until:
            return
        self.has_replied = True
        with losses(self._subject) as waits:
            self._send_response(response, request_id)
        if waits:
            self._stall()

    def _stall(self) -> None:
        now = self._loop.time()
        self._stalls.append(now)
        _logger.warning("%s: a client's QoS does not let it get responses", self._subject)
        if len(self._stalls) == MAX_STALLS and now - self._stalls[0] < STALLED_S:
            self._stalls.clear()
            self._silent_until = now + STALLED_S
            _logger.warning("%s: no responses for %g s", self._subject, STALLED_S)


def _profile() -> QoSProfile:
    # That of ROS is reliable and volatile, too, and keeps 10: the rest of a burst would be lost.
    return QoSProfile(depth=MAX_DEPTH)


def _never_called(*_: object) -> None:
    """Stand in where rclpy wants a callback and nothing calls it."""
