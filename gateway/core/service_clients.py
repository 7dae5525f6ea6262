# SPDX-License-Identifier: Apache-2.0
"""Calls of ROS services with values: validated, encoded, timed, decoded."""

from gateway.codec.error_text import CodecError
from gateway.codec.types import MessageType, ServiceType
from gateway.core.deadline import Deadline
from gateway.core.errors import ProtocolError
from gateway.sources.client_cache import ClientCache
from gateway.sources.services import ServiceClient
from gateway.sources.source import Ros
from schemas.json_forms import Clock


class ServiceClients:
    """Calls any service, and keeps its ROS client open for the next call."""

    def __init__(self, ros: Ros) -> None:
        self._ros = ros
        self._clients: ClientCache[ServiceClient] = ClientCache()

    @property
    def clients(self) -> int:
        """The number of ROS clients that are open."""
        return len(self._clients)

    async def call(
        self, service: str, service_type: ServiceType, values: object, deadline: Deadline
    ) -> dict[str, object]:
        """Call a service by its resolved name and return its response, decoded.

        *values* are for the fields of the request, by name or in order. ``None`` leaves all of
        them out. The deadline includes the time of waiting for a server.

        Raises:
            ProtocolError: the values do not fit the type, or nobody answers.
            RosError: ROS refuses it, or the server has gone.
        """
        request = encode_values(service_type.request, values, self._ros.now_ns, "args")
        response = await self.call_raw(service, service_type.name, request, deadline)
        try:
            return service_type.response.decode(response)
        except CodecError as error:
            raise ProtocolError("internal", f"response of {service}: {error}") from error

    async def call_raw(
        self, service: str, type_name: str, request: bytes, deadline: Deadline
    ) -> bytes:
        """Call a service with CDR of its type. See `call`."""
        key = service, type_name
        with self._clients.use(key, lambda: self._ros.services.client(*key)) as client:
            async with deadline.limit(f"service {service} has not answered"):
                return await client.call(request)

    def close(self) -> None:
        """Close every client. Calls under way fail."""
        self._clients.close()


def encode_values(message_type: MessageType, values: object, now_ns: Clock, root: str) -> bytes:
    """Turn the values of a request, a goal or the like into CDR.

    They are an object, or as rosbridge allows an array with the values of the fields in order, or
    missing. *now_ns* and *root* are as for `MessageType.encode`.

    Raises:
        ProtocolError: ``invalid_value``, with the path.
    """
    try:
        if values is None:
            values = {}
        elif isinstance(values, list):
            values = message_type.named(values, root)
        return message_type.encode(values, now_ns, root)
    except CodecError as error:
        raise ProtocolError("invalid_value", str(error)) from error
