# SPDX-License-Identifier: Apache-2.0
"""A WebSocket connection that costs its process little: for benchmarks only."""

import contextlib
import json
import socket
import threading
from collections.abc import Iterator, Sequence
from typing import Any, Final

from typing_extensions import Self
from websockets.client import ClientProtocol
from websockets.http11 import Response
from websockets.typing import Subprotocol
from websockets.uri import parse_uri

from benchmarks.actors.frames import CLOSE, PING, PONG, TEXT, FrameWalker, client_frame

_HANDSHAKE_S: Final = 10.0
_HEAD_END: Final = b"\r\n\r\n"


class RawConnection:
    """Connected on return. Operations go out, payloads come in."""

    def __init__(
        self,
        url: str,
        room: int = 1 << 20,
        *,
        handshake_s: float = _HANDSHAKE_S,
        receive_buffer_bytes: int | None = None,
        subprotocols: Sequence[Subprotocol] | None = None,
    ) -> None:
        """*room* is what is read at once. The kernel doubles the bytes of its buffer."""
        uri = parse_uri(url)
        self._writing = threading.Lock()
        self._walker = FrameWalker(room)
        self.is_over = False  # by `stop`
        self._socket = socket.create_connection((uri.host, uri.port), timeout=handshake_s)
        try:
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            if receive_buffer_bytes is not None:
                self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer_bytes)
            self._shake_hands(ClientProtocol(uri, subprotocols=subprotocols))
        except BaseException:
            self._socket.close()
            raise
        self._socket.settimeout(None)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.close()

    def fileno(self) -> int:
        """Return the file descriptor, for a selector."""
        return self._socket.fileno()

    def limit(self, timeout_s: float) -> None:
        """Bound every send and receive, which raise TimeoutError after that."""
        self._socket.settimeout(timeout_s)

    def send(self, operation: dict[str, Any]) -> None:
        """Send an operation."""
        self.send_text(json.dumps(operation).encode())

    def send_text(self, text: bytes) -> None:
        """Send a text that is JSON already."""
        self._write(client_frame(TEXT, text))

    def receive(self) -> Iterator[memoryview]:
        """Wait for bytes once, and yield each complete payload, which is valid until the next.

        Raises:
            ConnectionError: the server has closed, or `stop` was called.
        """
        room = self._walker.room()
        size = self._socket.recv_into(room)
        if size == 0 or self.is_over:
            raise ConnectionError("the server has closed the connection")
        return self._payloads(size)

    def discard(self) -> int:
        """Wait for bytes once, and have the kernel drop them: see MSG_TRUNC in tcp(7).

        Raises:
            ConnectionError: the server has closed.
        """
        size = self._socket.recv_into(self._walker.room(), 0, socket.MSG_TRUNC)
        if size == 0:
            raise ConnectionError("the server has closed the connection")
        return size

    def answer_pings(self) -> None:
        """Keep reading in a thread: a server cuts off clients that do not answer its pings."""
        threading.Thread(target=self._ignore, daemon=True).start()

    def stop(self) -> None:
        """Have `receive` raise, from another thread."""
        self.is_over = True
        self._socket.shutdown(socket.SHUT_RD)

    def _ignore(self) -> None:
        with contextlib.suppress(OSError):
            while True:
                for _ in self.receive():
                    pass

    def _write(self, frame: bytes) -> None:
        with self._writing:  # a pong must not split a frame
            self._socket.sendall(frame)

    def _payloads(self, size: int) -> Iterator[memoryview]:
        for opcode, payload in self._walker.received(size):
            if opcode == PING:
                self._write(client_frame(PONG, bytes(payload)))
            elif opcode == CLOSE:
                reason = bytes(payload[2:]).decode(errors="replace")
                raise ConnectionError(f"the server has closed the connection: {reason}")
            elif opcode != PONG:
                yield payload

    def _shake_hands(self, protocol: ClientProtocol) -> None:
        protocol.send_request(protocol.connect())
        for chunk in protocol.data_to_send():
            self._socket.sendall(chunk)
        head = bytearray()
        while not head.endswith(_HEAD_END):
            byte = self._socket.recv(1)  # no more: the walker reads the bytes that follow
            if not byte:
                raise ConnectionError("the server has closed during the handshake")
            head += byte
        protocol.receive_data(bytes(head))
        for event in protocol.events_received():
            if isinstance(event, Response) and protocol.handshake_exc is None:
                return
        status = bytes(head).splitlines()[0].decode(errors="replace")
        raise ConnectionError(f"the handshake has failed: {protocol.handshake_exc or status}")
