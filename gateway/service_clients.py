# SPDX-License-Identifier: Apache-2.0
"""Calls of ROS services with values: validated, encoded, timed, decoded."""

import asyncio

from gateway.client_cache import ClientCache
from gateway.codec.error_text import truncate
from gateway.codec.errors import CodecError
from gateway.codec.types import MessageType, ServiceType, Types
from gateway.ports import Client, Ros
from gateway.protocol.errors import ProtocolError
from schemas.definition import DefinitionError
from schemas.installed import UnknownTypeError
from schemas.message import Clock


class ServiceClients:
    """Calls any service; its ROS client stays open for the next call."""

    def __init__(self, ros: Ros, types: Types) -> None:
        self._ros = ros
        self._types = types
        self._clients: ClientCache[Client] = ClientCache()

    @property
    def clients(self) -> int:
        """How many ROS clients are open."""
        return len(self._clients)

    async def call(
        self, service: str, type_name: str, values: object, timeout_s: float
    ) -> dict[str, object]:
        """Call a service by its resolved name and return its response, decoded.

        *values* are what the fields of the request get, by name or in order; ``None`` is none.
        *timeout_s* covers waiting for a server, too.

        Raises:
            ProtocolError: the type is none, the values do not fit it, or nobody answers.
            RosError: ROS refuses it, or the server has gone.
        """
        service_type = self._type(type_name)
        request = encode_values(service_type.request, values, self._ros.now_ns, "args")
        client = self._clients.use(
            (service, type_name), lambda: self._ros.client(service, type_name)
        )
        with client as open_client:
            try:
                async with asyncio.timeout(timeout_s):
                    response = await open_client.call(request)
            except TimeoutError:
                text = f"service {service} has not answered within {timeout_s:g} s"
                raise ProtocolError("timeout", text) from None
        try:
            return service_type.response.decode(response)
        except CodecError as error:
            raise ProtocolError("internal", f"response of {service}: {error}") from error

    def close(self) -> None:
        """Close every client; calls under way fail."""
        self._clients.close()

    def _type(self, type_name: str) -> ServiceType:
        try:
            return self._types.service(type_name)
        except (UnknownTypeError, DefinitionError) as error:
            raise ProtocolError("bad_type", f"type: {truncate(str(error))}") from error


def encode_values(message_type: MessageType, values: object, now_ns: Clock, root: str) -> bytes:
    """Turn what a client wrote for a request, goal or the like into CDR.

    That is an object, or as rosbridge allows an array with the values of the fields in order, or
    nothing at all. *now_ns* and *root* are as for `MessageType.validate`.

    Raises:
        ProtocolError: ``invalid_value``, with the path.
    """
    try:
        if values is None:
            values = {}
        elif isinstance(values, list):
            values = message_type.named(values, root)
        return message_type.encode(message_type.validate(values, now_ns, root))
    except CodecError as error:
        raise ProtocolError("invalid_value", str(error)) from error
