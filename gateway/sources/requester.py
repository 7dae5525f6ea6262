# SPDX-License-Identifier: Apache-2.0
"""Clients of services, with any number of requests under way, whatever carries them."""

import asyncio
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection
from typing import Any, Final, NamedTuple

from gateway.sources.source import RosError

# How soon a new server gets the requests that wait for it: the graph shows a server before DDS has
# matched both its topics, and nothing reports that match.
LOOK_S: Final = 0.02
# A server keeps 10 requests that it has not taken, the default of ROS, and DDS drops any more
# without an error. So this many are in flight at most. While no answer comes, one more is sent each
# second: a server that answers late, or never, has most likely taken the oldest by then.
MAX_IN_FLIGHT: Final = 10
PACING_S: Final = 1.0

# Servers by the ids that the source gives them.
FindConflict = Callable[[frozenset[bytes]], RosError | None]


class _UnderWay(NamedTuple):
    response: asyncio.Future[Any]
    servers: frozenset[bytes]  # that may have the request


class Requester(ABC):
    """A client of a service. A subclass carries its requests."""

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        *,
        subject: str,
        is_ready: Callable[[], bool] = lambda: True,
        is_paced: Callable[[], bool] = lambda: True,
        find_conflict: FindConflict = lambda _: None,
    ) -> None:
        """Prepare it. The text of its errors begins with *subject*, such as ``service /reset``.

        Requests wait while *is_ready* returns false, even if there is a server. While *is_paced*
        returns true, requests beyond `MAX_IN_FLIGHT` wait as well. *find_conflict* gets the servers
        that there are, and may return the error with which requests fail.
        """
        self._loop = loop
        self._subject = subject
        self._is_other_ready = is_ready
        self._is_paced = is_paced
        self._find_conflict = find_conflict
        self._waiting: dict[asyncio.Future[Any], Any] = {}
        self._under_way: dict[int, _UnderWay] = {}
        self._in_flight: dict[int, None] = {}  # those of them that count as not taken, oldest first
        self._pacing: asyncio.TimerHandle | None = None
        self._next_look: asyncio.TimerHandle | None = None
        self._is_closed = False

    @abstractmethod
    def _has_server(self) -> bool:
        """Return whether there is a server to send to."""

    @abstractmethod
    def _find_servers(self) -> frozenset[bytes]:
        """Identify the servers. Empty if nobody can tell them apart."""

    @abstractmethod
    def _transmit(self, request: Any) -> int:
        """Send a request, and return its number.

        Raises:
            RosError: it cannot be sent.
        """

    @abstractmethod
    def _take(self) -> None:
        """Settle the requests whose responses have arrived."""

    @abstractmethod
    def _destroy(self) -> None:
        """Destroy what carries the requests."""

    @property
    def is_ready(self) -> bool:
        """True while there is a server to send to."""
        return self._has_server() and self._is_other_ready()

    def send(self, request: Any, *, waits: bool = True) -> "asyncio.Future[Any]":
        """Send a request and return its future response.

        While there is no server the request waits, or fails unless it *waits*. Cancelling the
        future forgets the request. It fails with a `RosError`, ``not_found``, when the server has
        gone since it got the request, or this is closed.
        """
        response = self._loop.create_future()
        if self._is_closed:
            self._fail(response, self._closed())
        elif not waits and not self.is_ready:
            if self._find_servers():  # half of another one has come: see `_find_lost`
                self._send(request, response)
            else:
                self._fail(response, self._gone())
        else:
            self._waiting[response] = request
            response.add_done_callback(self._forget)
            self._send_waiting()
        return response

    def is_waiting(self, response: "asyncio.Future[Any]") -> bool:
        """Return whether a request has not been sent yet."""
        return response in self._waiting

    def follow_graph(self) -> None:
        """Send to servers that have come, and fail the requests of those that have gone."""
        lost = self._find_lost()
        if lost:
            self._take()  # a response that has arrived already counts
        for response in lost:
            self._fail(response, self._gone())
        self._send_waiting()

    def flush(self) -> None:
        """Send at once the requests that wait only because of pacing."""
        self._send_waiting(is_flush=True)

    def close(self) -> None:
        """Destroy it and fail what is under way. Closing twice is harmless."""
        if self._is_closed:
            return
        self._is_closed = True
        if self._next_look is not None:
            self._next_look.cancel()
        self._destroy()
        self.fail_all()

    def fail_all(self, *, but: Collection["asyncio.Future[Any]"] = ()) -> None:
        """Fail the requests that wait or are under way, as `close` does, except for *but*."""
        responses = [each.response for each in self._under_way.values()]
        for response in [*responses, *self._waiting]:
            if response not in but:
                self._fail(response, self._closed())

    def _find_lost(self) -> "list[asyncio.Future[Any]]":
        if not self._under_way:
            return []
        # Not whether it is ready. Another server may have replaced one that died without notice. If
        # DDS has found half of a server, the service is not ready, although another one answers.
        servers = self._find_servers()
        is_unready = not self.is_ready  # counts for those whose servers nobody could tell
        return [
            each.response
            for each in self._under_way.values()
            if (each.servers.isdisjoint(servers) if each.servers else is_unready)
        ]

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
        # Looked up each time: a change of the graph is reported later than a server is ready.
        servers = self._find_servers()
        conflict = self._find_conflict(servers)
        if conflict is not None:
            self._fail(response, conflict)
            return
        try:
            number = self._transmit(request)
        except RosError as error:
            self._fail(response, error)
            return
        self._under_way[number] = _UnderWay(response, servers)
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
        """Count the oldest as taken once no place has become free for `PACING_S`."""
        if self._pacing is not None:
            self._pacing.cancel()
            self._pacing = None
        if self._in_flight and not self._is_closed:
            self._pacing = self._loop.call_later(
                PACING_S, self._make_room, next(iter(self._in_flight))
            )

    def _settle(self, number: int, response: Any) -> None:
        """Give a response to the request of a number, unless that has ended."""
        request = self._under_way.get(number)
        if request is not None and not request.response.done():
            request.response.set_result(response)

    def _forget(self, response: "asyncio.Future[Any]") -> None:
        self._waiting.pop(response, None)

    def _gone(self) -> RosError:
        return RosError("not_found", f"{self._subject} has gone")

    def _closed(self) -> RosError:
        return RosError("not_found", f"the client of {self._subject} is closed")

    def _fail(self, response: "asyncio.Future[Any]", error: RosError) -> None:
        if not response.done():
            response.set_exception(error)
            response.exception()  # marks it as retrieved: nobody has to await it
