# SPDX-License-Identifier: Apache-2.0
"""The example of adding-a-front.md: a protocol of lines with three operations.

A client with the subprotocol ``lines`` sends ``watch TOPIC``, ``unwatch TOPIC`` and ``stop``. It
gets ``TOPIC MESSAGE``, with the message in JSON, ``ok TEXT`` and ``error TEXT``.
"""

from typing import Any

from gateway.codec.chunks import Chunks
from gateway.codec.json import dumps
from gateway.core.errors import ProtocolError, StatusCode
from gateway.core.frames import Framing, PerClient, PublishFrames
from gateway.core.peer import Peer
from gateway.core.requests import (
    Request,
    RequestId,
    Stop,
    Subscribe,
    Unsubscribe,
)
from gateway.core.router import Router
from gateway.transport.front import ClientSession
from gateway.transport.websocket_frames import TEXT, header, payload, text_frame


class LineFrames:
    """Makes the lines of one topic."""

    def __init__(self, topic: str) -> None:
        self._prefix = f"{topic} ".encode()

    def shared(self, message: bytes) -> bytes:
        return text_frame(self._prefix + message)

    def message(self, shared: bytes) -> bytes:
        return payload(shared)[len(self._prefix) :]

    def per_client(self, message: bytes, _: PerClient) -> bytes:
        return self.shared(message)

    def shared_chunks(self, message: Chunks) -> Chunks:
        return message.within(header(TEXT, len(self._prefix) + len(message)) + self._prefix, b"")

    def per_client_chunks(self, message: Chunks, _: PerClient) -> Chunks:
        return self.shared_chunks(message)


class LineFraming(Framing):
    def frames(self, topic: str) -> PublishFrames:
        return LineFrames(topic)


class LineSession(ClientSession):
    """Says everything in lines. Its clients provide nothing, and call nothing."""

    NOT_AUTHENTICATED = "connect with the header `Authorization: Bearer TOKEN`"

    def say(self, text: str) -> None:
        self.outbox.put_control(text_frame(text.encode()))
        self.wake()

    def is_stop(self, data: bytes) -> bool:
        return data.strip() == b"stop"

    def send_refusal(self, error: ProtocolError, request: Request | None) -> None:
        self.say(f"error {error}")

    def warn(self, error: ProtocolError, request: Request) -> None:
        self.say(f"error {error}")

    def inform(self, text: str, request: Request) -> None:
        self.say(f"ok {text}")

    def alert(self, code: StatusCode, text: str, request: Request) -> None:
        self.say(f"{code} {text}")

    def answer(self, kind: str, request_id: RequestId, **members: Any) -> None:
        self.say(f"ok {kind} {dumps(members).decode()}")


class LineFront:
    """Reads lines, and has the core carry them out."""

    subprotocols = ("lines",)

    def __init__(self, core: Router) -> None:
        self._core = core

    def open(self, peer: Peer) -> LineSession:
        session = LineSession(self._core, peer)
        self._core.enter(session)
        return session

    def rejection(self, code: StatusCode, reason: str) -> bytes:
        return f"error {reason}".encode()

    def receive(self, session: ClientSession, data: bytes) -> None:
        session.received += 1
        match data.decode().split():
            case ["watch", topic]:
                self._core.carry_out(session, Subscribe(topic=topic, framing=LineFraming()))
            case ["unwatch", topic]:
                self._core.carry_out(session, Unsubscribe(topic=topic))
            case ["stop"]:
                self._core.carry_out(session, Stop())
            case _:
                text = "expected watch TOPIC, unwatch TOPIC, or stop"
                session.refuse(ProtocolError("bad_request", text))
