# SPDX-License-Identifier: Apache-2.0
"""Services in the interface of the core to a robot. See `gateway.sources.source`."""

from collections.abc import Callable
from typing import Protocol


class ServiceClient(Protocol):
    """A client of a ROS service. Its requests and responses are CDR."""

    async def call(self, request: bytes) -> bytes:
        """Wait for a server, send the request, wait for the response. Cancelling forgets it.

        Any number of calls may be pending. The caller sets the time limit.

        Raises:
            RosError: ``not_found``: the server disappeared before it responded, or the client was
                closed.
        """

    def close(self) -> None:
        """Destroy it. Pending calls fail. Closing twice is harmless."""


class ServiceRequest(Protocol):
    """A request to a service that the gateway provides."""

    @property
    def cdr(self) -> bytes:
        """The request, encapsulation header included."""

    def answer(self, response: bytes) -> None:
        """Respond, at most once. It does nothing if the service is closed or the caller is gone.

        Raises:
            RosError: ``internal``: *response* is not CDR of the type. The request is still open.
        """


class Service(Protocol):
    """A ROS service that the gateway provides."""

    def close(self) -> None:
        """Withdraw it. Closing twice is harmless.

        *on_request* still gets requests that have arrived, and those sent by callers that have not
        yet discovered the end. Answers that it gives before it returns are sent.
        """


class Services(Protocol):
    """The part of a source that calls and provides services."""

    def client(self, service: str, type_name: str) -> ServiceClient:
        """Create a client of a service by its fully resolved name.

        Raises:
            RosError: as for `subscribe`. *type_name* is ``pkg/srv/Name``.
        """

    def serve(
        self, service: str, type_name: str, on_request: Callable[[ServiceRequest], None]
    ) -> Service:
        """Provide a service by its fully resolved name.

        Raises:
            RosError: as for `client`. Also ``limit_exceeded`` if the gateway provides it already.
        """
