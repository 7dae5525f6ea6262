# SPDX-License-Identifier: Apache-2.0
"""What clients ask about the gateway itself: clocks, limits, types, the graph."""

import time

from gateway.config.limits import Limits
from gateway.ports import Graph, Ros
from gateway.protocol import messages
from gateway.protocol.errors import ProtocolError
from gateway.protocol.operations.gateway import Describe, GraphRequest, Hello, Ping
from gateway.protocol.session import Session
from gateway.router.interface_types import InterfaceTypes
from gateway.router.introspection import graph_frames
from gateway.router.topic_types import TopicTypes
from gateway.router.topics.subscriptions import Subscriptions
from schemas.definition import Definition
from schemas.interface import Interface

SERVER_NAME = "ros2-json-gateway"
PROTOCOL = "rosbridge 2.0"


class Introspection:
    """Answers them, and tells the watchers of the graph what changes."""

    def __init__(
        self,
        ros: Ros,
        topic_types: TopicTypes,
        interface_types: InterfaceTypes,
        subscriptions: Subscriptions,
        *,
        limits: Limits,
        version: str,
    ) -> None:
        self._ros = ros
        self._topic_types = topic_types
        self._interface_types = interface_types
        self._subscriptions = subscriptions
        self._limits = limits
        self._version = version
        self._watching: dict[Session, str | int | None] = {}
        self._seen: Graph | None = None  # what the watchers know

    def ping(self, session: Session, request: Ping) -> None:
        """Tell the clocks."""
        session.answer(
            "pong",
            request.id,
            value=request.value,
            ros_time=messages.time(self._ros.now_ns()),
            gateway_time=messages.time(time.time_ns()),
        )

    def hello(self, session: Session, request: Hello) -> None:
        """Tell who this is and what it allows."""
        session.answer(
            "hello",
            request.id,
            server=SERVER_NAME,
            version=self._version,
            protocol=PROTOCOL,
            ros_distro=self._ros.distro,
            role="operator",
            limits=self._limits.for_hello(),
        )

    def describe(self, session: Session, request: Describe) -> None:
        """Tell all about a type.

        Raises:
            ProtocolError: it is no type, or none that is installed here.
        """
        try:
            message_type = self._topic_types.named(request.type)
        except ProtocolError:
            found = self._interface_types.described(request.type)
            if found is None:
                raise
            members: dict[str, object] = {"type": found.name, **_words(found.definition)}
            session.answer("describe", request.id, **members, schema=found.json_schema())
        else:
            members = {
                "type": message_type.name,
                "number": self._topic_types.number(message_type.name),
                **_words(message_type.definition),
            }
            session.answer("describe", request.id, **members, schema=message_type.json_schema())

    def graph(self, session: Session, request: GraphRequest) -> None:
        """Tell what is there, and from now on or no longer what changes."""
        now = self._ros.graph()
        if request.watch is False:
            self._watching.pop(session, None)
        elif request.watch:
            if not self._watching:
                self._seen = now
            self._watching[session] = request.id
        rates_hz = self._subscriptions.rates_hz(time.monotonic_ns())
        session.answer("graph", request.id, **graph_frames.picture(now, rates_hz))

    def on_graph_change(self) -> None:
        """Tell the watchers."""
        if not self._watching or self._seen is None:
            return
        before, self._seen = self._seen, self._ros.graph()
        changes = graph_frames.changes(before, self._seen)
        if changes:
            for session, request_id in self._watching.items():
                session.answer("graph", request_id, changes=changes)

    def leave(self, session: Session) -> None:
        """Tell a client nothing any more."""
        self._watching.pop(session, None)


def _words(definition: Definition | Interface) -> dict[str, str | None]:
    return {"type_hash": definition.type_hash, "definition": definition.text}
