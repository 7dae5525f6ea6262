# SPDX-License-Identifier: Apache-2.0
"""A WebSocket server that only writes to its clients after their handshake."""

import asyncio
from typing import cast

from websockets.http11 import Request
from websockets.server import ServerProtocol


class Audience:
    """Shakes hands with the library's sans-I/O protocol, and then only writes."""

    def __init__(self) -> None:
        self._clients: list[asyncio.Transport] = []

    async def listen(self) -> str:
        """Start to accept clients. Return the URL."""
        loop = asyncio.get_running_loop()
        server = await loop.create_server(lambda: _Client(self._clients), "127.0.0.1", 0)
        return f"ws://127.0.0.1:{server.sockets[0].getsockname()[1]}"

    def write(self, frame: bytes) -> None:
        """Write a prepared frame to every client."""
        for client in self._clients:
            client.write(frame)


class _Client(asyncio.Protocol):
    def __init__(self, clients: list[asyncio.Transport]) -> None:
        self._clients = clients
        self._protocol: ServerProtocol | None = ServerProtocol()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self._transport = cast("asyncio.Transport", transport)  # uvloop's is one by duck typing

    def data_received(self, data: bytes) -> None:
        protocol = self._protocol
        if protocol is None:
            return
        protocol.receive_data(data)
        for event in protocol.events_received():
            if isinstance(event, Request):
                protocol.send_response(protocol.accept(event))
                self._clients.append(self._transport)
                self._protocol = None
        for chunk in protocol.data_to_send():
            self._transport.write(chunk)

    def connection_lost(self, exc: Exception | None) -> None:
        if self._transport in self._clients:
            self._clients.remove(self._transport)
