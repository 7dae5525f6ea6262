# SPDX-License-Identifier: Apache-2.0
"""The part of the core that moves robots, as the router needs it."""

from collections.abc import Callable, Hashable, Iterator
from typing import Protocol

from gateway.core.commands.relayed_counts import RelayedCounts
from gateway.core.names import TopicName
from gateway.core.requests import (
    AcquireControl,
    Advertise,
    Control,
    Publish,
    ReleaseControl,
    Stop,
    Unadvertise,
)
from gateway.core.session import Session
from gateway.core.topic_types import TopicTypes
from gateway.metrics.state import ClientPublication, ControlState


class CommandTopics(Protocol):
    """Carries out every operation on a command topic, here or at another gateway.

    An operation may raise ProtocolError or RosError, and is answered later or at once.
    """

    relayed: RelayedCounts

    def __contains__(self, topic: TopicName) -> bool:
        """Return whether a topic moves a robot."""

    @property
    def publishers(self) -> int:
        """The number of open ROS publishers."""

    def control_state(self) -> ControlState:
        """Return the state of each topic, and of the guard."""

    def client_publications(self) -> Iterator[ClientPublication]:
        """Yield the number of commands of each client, on each topic."""

    def is_driven_by(self, session: Session) -> bool:
        """Return whether a client has control of a topic."""

    def holder(self, topic: str) -> Hashable | None:
        """Return what has control of a topic."""

    def type_name(self, topic: str) -> str | None:
        """Return the type of a topic's commands, once it is known."""

    def advertise(self, session: Session, name: TopicName, request: Advertise) -> None:
        """Open a command topic for a client."""

    def unadvertise(self, session: Session, name: TopicName, request: Unadvertise) -> None:
        """Withdraw one advertisement, or without an id all of the client's."""

    def publish(self, session: Session, name: TopicName, request: Publish) -> None:
        """Take one command."""

    def stop(self, session: Session, request: Stop) -> None:
        """Stop one command topic, or all. Never refused for its rate."""

    def acquire(self, session: Session, request: AcquireControl) -> None:
        """Give a client control of a topic."""

    def release(self, session: Session, request: ReleaseControl) -> None:
        """Take control of a topic back from a client."""

    def control(self, session: Session, request: Control) -> None:
        """Answer with the state of a topic, and begin or end to send its changes."""

    def on_graph_change(self) -> None:
        """Follow the nodes that are there."""

    def revoke(self, session: Session) -> None:
        """Stop what a client moves, because it lost the permission."""

    def leave(self, session: Session) -> None:
        """Stop what a client moves, and forget it."""

    def shut_down(self) -> None:
        """Stop every robot. From now on nothing moves."""

    def close(self) -> None:
        """Release everything."""


OpenCommands = Callable[[TopicTypes], CommandTopics]
