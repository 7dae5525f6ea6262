# SPDX-License-Identifier: Apache-2.0
"""Services, called and provided, with requests and responses as CDR."""

from collections.abc import Callable
from typing import Any

from gateway.sources.rclpy.errors import refusals
from gateway.sources.rclpy.ready_events import Endpoints
from gateway.sources.rclpy.replier import Replier, Reply
from gateway.sources.rclpy.requester import RclpyRequester
from gateway.sources.rclpy.service_forms import ServiceForm
from gateway.sources.requester import FindConflict
from gateway.sources.services import ServiceRequest


class RclpyClient:
    """A client of a service."""

    def __init__(
        self,
        endpoints: Endpoints,
        name: str,
        form: ServiceForm,
        on_close: Callable[["RclpyClient"], None],
        *,
        is_paced: Callable[[], bool],
        find_conflict: FindConflict,
    ) -> None:
        self.name = name
        self.type_name = form.type_name
        self._on_close = on_close
        self._subject = f"service {name}"
        self._form = form
        self._requester = RclpyRequester(
            endpoints,
            form.service_class,
            name,
            subject=self._subject,
            is_paced=is_paced,
            find_conflict=find_conflict,
        )

    async def call(self, request: bytes) -> bytes:
        """Wait for a server, send the request, wait for the response. See the port."""
        with refusals(self._subject):
            message = self._form.to_request(request)
        return self._form.to_cdr(await self._requester.send(message))

    def follow_graph(self) -> None:
        """Follow servers that have come or gone."""
        self._requester.follow_graph()

    def close(self) -> None:
        """Destroy it and fail what is under way. Closing twice is harmless."""
        self._on_close(self)
        self._requester.close()


class RclpyRequest:
    """A request that waits for its response."""

    def __init__(self, subject: str, form: ServiceForm, message: Any, reply: Reply) -> None:
        self._subject = subject
        self._form = form
        self._reply: Reply | None = reply
        self.cdr = form.to_cdr(message)

    def answer(self, response: bytes) -> None:
        """Send the response, once. Do nothing if the service is closed."""
        with refusals(self._subject):
            message = self._form.to_response(response)
        reply, self._reply = self._reply, None
        if reply is not None:
            reply(message)


class RclpyService:
    """A service that the gateway provides. Requests are kept by their receiver, not here."""

    def __init__(
        self,
        endpoints: Endpoints,
        name: str,
        form: ServiceForm,
        on_request: Callable[[ServiceRequest], None],
        on_close: Callable[["RclpyService"], None],
    ) -> None:
        self.name = name
        self.type_name = form.type_name
        self._on_request = on_request
        self._on_close = on_close
        self._is_closed = False
        self._subject = f"service {name}"
        self._form = form
        self._replier = Replier(
            endpoints, form.service_class, name, self._arrive, subject=self._subject
        )

    @property
    def has_answered(self) -> bool:
        """True once a response has been sent."""
        return self._replier.has_replied

    def close(self) -> None:
        """Deliver what has arrived and withdraw the service. See the port."""
        if not self._is_closed:
            self._is_closed = True
            try:
                self._replier.drain()
            finally:
                self._on_close(self)

    def destroy(self) -> None:
        """Destroy it, at the latest once its last response has been delivered."""
        self._replier.close()

    def _arrive(self, message: Any, reply: Reply) -> None:
        self._on_request(RclpyRequest(self._subject, self._form, message, reply))
