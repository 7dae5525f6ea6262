# SPDX-License-Identifier: Apache-2.0
"""Requests about the gateway itself: clocks, limits, types, the graph."""

import time

from gateway.codec.types import Types
from gateway.config.limits import Limits
from gateway.core.introspection import graph_frames
from gateway.core.introspection.assets import Assets
from gateway.core.introspection.client_code import ClientCode
from gateway.core.introspection.descriptions import Descriptions
from gateway.core.introspection.kept_log import ROSOUT, KeptLog
from gateway.core.permission_checks import check_subscribe
from gateway.core.requests import Describe, GraphRequest, Hello, Ping, Request
from gateway.core.ros_time import stamp
from gateway.core.session import Session
from gateway.core.topics.subscriptions import Subscriptions
from gateway.core.visible_graph import visible
from gateway.sources.graph import Graph
from gateway.sources.source import Ros

SERVER_NAME = "ros2-json-gateway"
PROTOCOL = "rosbridge 2.0"


class Introspection:
    """Answers these requests, and sends changes of the graph to its watchers."""

    def __init__(
        self,
        ros: Ros,
        descriptions: Descriptions,
        subscriptions: Subscriptions,
        *,
        limits: Limits,
        version: str,
    ) -> None:
        self._ros = ros
        self._client_code = ClientCode(descriptions.definitions)
        self.generate = self._client_code.generate
        self._assets = Assets()
        self.fetch = self._assets.fetch
        self._descriptions = descriptions
        self._subscriptions = subscriptions
        self._limits = limits
        self._version = version
        self._watching: dict[Session, str | int | None] = {}
        self._seen: Graph | None = None  # the last snapshot that the watchers got
        self._log: KeptLog | None = None

    def keep_log(self, types: Types) -> None:
        """Keep the last lines of ``/rosout`` from now on."""
        self._log = KeptLog(self._ros, types)

    @property
    def own_entities(self) -> int:
        """The ROS entities that no client has asked for."""
        return 0 if self._log is None else self._log.entities

    def close(self) -> None:
        """End the threads, with what they are doing."""
        if self._log is not None:
            self._log.close()
        self._client_code.close()
        self._assets.close()

    def ping(self, session: Session, request: Ping) -> None:
        """Answer `ping` with ROS time and gateway time."""
        if request.clock_offset_ms is not None:
            session.set_clock(request.clock_offset_ms)
        session.answer(
            "pong",
            request.id,
            value=request.value,
            ros_time=stamp(self._ros.now_ns()),
            gateway_time=stamp(time.time_ns()),
        )

    def hello(self, session: Session, request: Hello) -> None:
        """Answer `hello` with the gateway's version and limits."""
        session.answer(
            "hello",
            request.id,
            server=SERVER_NAME,
            version=self._version,
            protocol=PROTOCOL,
            ros_distro=self._ros.distro,
            **self._ros.network,
            role=session.identity.role if session.identity else None,
            limits=self._limits.for_hello(),
        )

    def describe(self, session: Session, request: Describe) -> None:
        """Answer `describe` with a type's schema, definition and hash, and a frame to paste.

        Raises:
            ProtocolError: the name is not that of an installed type, or of something that has one.
        """
        graph = seen_by(session, self._ros.graph())
        example, members = self._descriptions.describe(session, request.type, graph)
        session.describe(request.id, example, members)

    def log(self, session: Session, request: Request) -> None:
        """Answer `log` with the lines of ``/rosout`` that are kept.

        Raises:
            ProtocolError: this client may not subscribe to it.
        """
        check_subscribe(session, ROSOUT)
        session.answer("log", request.id, lines=self._log.lines if self._log else [])

    def graph(self, session: Session, request: GraphRequest) -> None:
        """Answer `graph` with a snapshot, and start or stop watching for changes."""
        now = self._ros.graph()
        if request.watch is False:
            self._watching.pop(session, None)
        elif request.watch:
            if not self._watching:
                self._seen = now
            self._watching[session] = request.id
        rates_hz = self._subscriptions.rates_hz(time.monotonic_ns())
        session.answer("graph", request.id, **graph_frames.picture(seen_by(session, now), rates_hz))

    def on_graph_change(self) -> None:
        """Send the changes to the watchers."""
        if not self._watching or self._seen is None:
            return
        before, now = self._seen, self._ros.graph()
        self._seen = now
        all_changes = graph_frames.changes(before, now)
        for session, request_id in self._watching.items() if all_changes else ():
            changes = all_changes
            if session.is_restricted:
                changes = graph_frames.changes(seen_by(session, before), seen_by(session, now))
            if changes:
                session.answer("graph", request_id, changes=changes)

    def leave(self, session: Session) -> None:
        """Send nothing more to a client."""
        self._watching.pop(session, None)


def seen_by(session: Session, graph: Graph) -> Graph:
    """Return a graph without the names that are hidden from a client."""
    return visible(graph, session.sees) if session.is_restricted else graph
