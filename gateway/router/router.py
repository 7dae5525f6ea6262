# SPDX-License-Identifier: Apache-2.0
"""Carries out what clients ask for."""

import time
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import asdict
from typing import assert_never

from gateway.codec.json import dumps
from gateway.codec.picture import picture_renderer
from gateway.codec.types import Types
from gateway.codec.words import cut
from gateway.ports import Graph, Ros, RosError
from gateway.protocol import frames
from gateway.protocol.errors import ProtocolError
from gateway.protocol.limits import Limits
from gateway.protocol.operations import (
    Advertise,
    Auth,
    ClientOperation,
    Describe,
    GraphRequest,
    Hello,
    Ping,
    Publish,
    SetLevel,
    Subscribe,
    Unadvertise,
    Unsubscribe,
)
from gateway.protocol.session import Session
from gateway.router import graph
from gateway.router.feed import Feed
from gateway.router.publications import Publications
from gateway.router.rendition import PictureRendition, Rendition, RenditionKey
from gateway.router.subscriptions import Subscriptions
from gateway.router.topic_types import TopicTypes
from schemas.table import Table

SERVER_NAME = "ros2-json-gateway"
PROTOCOL = "rosbridge 2.0"


class Router:
    """One ROS subscription for many sessions, and every operation answered.

    Lives on the event loop's thread. Give it what each client sends, in order; `leave` ends
    all that a client had.
    """

    def __init__(
        self,
        ros: Ros,
        types: Types,
        table: Table,
        *,
        limits: Limits,
        workers: Executor,
        version: str,
    ) -> None:
        self._ros = ros
        self._limits = limits
        self._workers = workers
        self._version = version
        self._topic_types = TopicTypes(ros, types, table)
        self._subscriptions = Subscriptions(ros, self._topic_types, self._rendition)
        self._publications = Publications(ros, self._topic_types)
        self._sessions: set[Session] = set()
        self._watching: dict[Session, str | int | None] = {}
        self._seen: Graph | None = None  # what the watchers know
        self._watch = ros.watch_graph(self._on_graph_change)

    def enter(self, wake: Callable[[], None]) -> Session:
        """Open a session; *wake* is called whenever its outbox has something to send."""
        session = Session(self._limits, time.monotonic_ns(), wake)
        self._sessions.add(session)
        return session

    def receive(self, session: Session, data: bytes) -> None:
        """Carry out one message of a client; whatever is wrong with it is answered."""
        operation = session.receive(data, time.monotonic_ns())
        if operation is None:
            return
        try:
            self._carry_out(session, operation)
        except ProtocolError as error:
            session.refuse(error, operation.op, operation.id)
        except RosError as error:
            refusal = ProtocolError(error.code, cut(str(error)))
            session.refuse(refusal, operation.op, operation.id)

    def leave(self, session: Session) -> None:
        """Close every ROS entity that was open for a client, and forget it."""
        self._sessions.discard(session)
        self._watching.pop(session, None)
        self._subscriptions.leave(session)
        self._publications.leave(session)

    def close(self) -> None:
        """End all sessions and stop following the graph."""
        self._watch.close()
        for session in list(self._sessions):
            self.leave(session)

    def counts(self) -> dict[str, int]:
        """Count what is open, for health reports."""
        return {
            "clients": len(self._sessions),
            "subscriptions": self._subscriptions.feeds,
            "publishers": self._publications.publishers,
        }

    def _carry_out(self, session: Session, operation: ClientOperation) -> None:
        match operation:
            case Publish():
                self._publications.publish(session, operation)
            case Subscribe():
                self._subscriptions.subscribe(session, operation)
            case Unsubscribe():
                self._subscriptions.unsubscribe(session, operation)
            case Advertise():
                self._publications.advertise(session, operation)
            case Unadvertise():
                self._publications.unadvertise(session, operation)
            case Ping():
                self._ping(session, operation)
            case Hello():
                self._hello(session, operation)
            case Describe():
                self._describe(session, operation)
            case GraphRequest():
                self._graph(session, operation)
            case SetLevel():
                session.set_level(operation.level)
            case Auth():
                pass  # nobody is asked for a password, so every one is right
            case _:
                assert_never(operation)

    def _ping(self, session: Session, request: Ping) -> None:
        session.answer(
            "pong",
            request.id,
            value=request.value,
            ros_time=frames.time(self._ros.now_ns()),
            gateway_time=frames.time(time.time_ns()),
        )

    def _hello(self, session: Session, request: Hello) -> None:
        session.answer(
            "hello",
            request.id,
            server=SERVER_NAME,
            version=self._version,
            protocol=PROTOCOL,
            ros_distro=self._ros.distro,
            role="operator",
            limits=asdict(self._limits),
        )

    def _describe(self, session: Session, request: Describe) -> None:
        message_type = self._topic_types.named(request.type)
        session.answer(
            "describe",
            request.id,
            type=message_type.name,
            number=self._topic_types.number(message_type.name),
            type_hash=message_type.definition.type_hash,
            definition=message_type.definition.text,
            schema=message_type.json_schema(),
        )

    def _graph(self, session: Session, request: GraphRequest) -> None:
        now = self._ros.graph()
        if request.watch is False:
            self._watching.pop(session, None)
        elif request.watch:
            if not self._watching:
                self._seen = now
            self._watching[session] = request.id
        rates_hz = self._subscriptions.rates_hz(time.monotonic_ns())
        session.answer("graph", request.id, **graph.picture(now, rates_hz))

    def _on_graph_change(self) -> None:
        self._subscriptions.refresh()
        if not self._watching or self._seen is None:
            return
        before, self._seen = self._seen, self._ros.graph()
        changes = graph.changes(before, self._seen)
        if changes:
            for session, request_id in self._watching.items():
                session.answer("graph", request_id, changes=changes)

    def _rendition(self, feed: Feed, key: RenditionKey) -> Rendition:
        message_type = self._topic_types.get(feed.key.type_name)
        if key.image is None:
            decode = message_type.decoder(key.fields)
            return Rendition(key, lambda cdr: dumps(decode(cdr)), feed.on_codec_error)
        return PictureRendition(
            key,
            picture_renderer(message_type, key.image),
            feed.on_codec_error,
            workers=self._workers,
            on_ready=feed.wake_all,
        )
