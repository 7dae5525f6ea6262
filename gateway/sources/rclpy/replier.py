# SPDX-License-Identifier: Apache-2.0
"""Servers of services whose messages the event loop itself takes and sends.

See `gateway.sources.rclpy.requester` for the reason.
"""

import logging
from collections import deque
from collections.abc import Callable
from typing import Any, Final

from gateway.config.limits import MAX_QUEUE_DEPTH
from gateway.sources.rclpy.creating import group_of_one
from gateway.sources.rclpy.errors import creation, losses, remapped
from gateway.sources.rclpy.rclpy_private.handles import RequestId, request_taker, response_sender
from gateway.sources.rclpy.ready_events import SERVICE_PROFILE, Endpoints

# rmw waits 0.1 s, and blocks the event loop, for a client whose reader DDS has not matched yet, as
# on a bad network. Then the response is lost. It is sent once more after this time.
SEND_AGAIN_S: Final = 1.0
# A client whose reader never matches, such as one that requests transient_local, costs these waits
# each time. A request does not show which client sent it: after this many waits the service sends
# no responses for a while, which leaves the loop 94 % of its time.
MAX_STALLS: Final = 3
STALLED_S: Final = 10.0

_logger = logging.getLogger(__name__)

# Sends the response, unless the server is closed. A response to a client that has gone is lost.
Reply = Callable[[Any], None]
OnRequest = Callable[[Any, Reply], None]


class Replier:
    """A server of rclpy."""

    def __init__(
        self,
        endpoints: Endpoints,
        service_class: Any,
        name: str,
        on_request: OnRequest,
        *,
        subject: str,
    ) -> None:
        """Create it. The text of its errors begins with *subject*, such as ``service /reset``.

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
        self._stalls: deque[float] = deque(maxlen=MAX_STALLS)  # the times of the last ones
        self._silent_until = self._loop.time()
        with creation(subject):
            self._source = endpoints.ready_events.open(
                "service",
                lambda: node.create_service(
                    service_class,
                    name,
                    _never_called,
                    qos_profile=SERVICE_PROFILE,
                    callback_group=group_of_one(),
                ),
                node.destroy_service,
                self._take,
            )
        service = self._source.entity
        self._take_request = request_taker(service)
        self._send_response = response_sender(service)
        given = service.service_name
        if given != name:
            self._source.close()
            raise remapped(subject, given)

    def drain(self) -> None:
        """Pass all that has arrived to *on_request*. Called from within that, do nothing."""
        if self._is_draining:
            return
        self._is_draining = True
        try:
            for _ in range(MAX_QUEUE_DEPTH):
                if self._is_closed or not self._take_one():
                    break
        finally:
            self._is_draining = False

    def close(self) -> None:
        """Pass what has arrived to *on_request*, which must reply within the call. Destroy it.

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
        """Take one request. Return whether there may be more."""
        request, info = self._take_request(self._request_class)
        if not self._source.count_take() and info is None:
            return False
        # One request a turn. Before the callback: what that raises must not delay other requests.
        self._source.notify_again()
        if info is not None:  # it could be read
            self._on_request(request, lambda response: self._reply(response, info.request_id))
        return True

    def _reply(self, response: Any, request_id: RequestId) -> None:
        if self._is_closed or self._loop.time() < self._silent_until:
            return
        self.has_replied = True
        if not self._send(response, request_id):
            self._loop.call_later(SEND_AGAIN_S, self._send_again, response, request_id)
            self._stall()

    def _send_again(self, response: Any, request_id: RequestId) -> None:
        # also while the service is silent: these are as few as the waits before
        if not self._is_closed and not self._send(response, request_id):
            _logger.warning("%s: a client's QoS does not let it get responses", self._subject)

    def _send(self, response: Any, request_id: RequestId) -> bool:
        """Send a response. Return whether rmw found the client in time."""
        with losses(self._subject) as waits:
            self._send_response(response, request_id)
        return not waits

    def _stall(self) -> None:
        now = self._loop.time()
        self._stalls.append(now)
        if len(self._stalls) == MAX_STALLS and now - self._stalls[0] < STALLED_S:
            self._stalls.clear()
            self._silent_until = now + STALLED_S
            _logger.warning(
                "%s: no responses for %g s, as its clients do not get them: see their QoS",
                *(self._subject, STALLED_S),
            )


def _never_called(*_: object) -> None:
    """Serve as the callback that rclpy requires. Nothing calls it."""
