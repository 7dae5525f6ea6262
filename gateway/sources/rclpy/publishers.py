# SPDX-License-Identifier: Apache-2.0
"""Raw publishers: all who advertise the same share one of rclpy's, unless it is latched."""

import asyncio
import itertools
from collections import defaultdict
from collections.abc import Callable, Container, Iterable
from dataclasses import dataclass
from functools import partial
from typing import Any

from rclpy.node import Node

from gateway.sources.name_checks import check_topic
from gateway.sources.qos import Endpoint, complete_offer, retains, unmatched_subscribers
from gateway.sources.rclpy.creating import create_publisher
from gateway.sources.rclpy.deferred_destruction import Deferred, DeferredDestruction
from gateway.sources.rclpy.errors import REFUSALS, refused
from gateway.sources.rclpy.graph import read_requests
from gateway.sources.rclpy.message_classes import MessageClasses
from gateway.sources.rclpy.profile import to_profile
from gateway.sources.rclpy.qos_events import QosEvents, QosWatch
from gateway.sources.rclpy.rclpy_private.handles import new_matches, raw_publisher
from gateway.sources.rclpy.versions import other_versions
from gateway.sources.source import Qos, TopicEvent


@dataclass(frozen=True, slots=True)
class _Key:
    topic: str
    type_name: str
    type_hash: str | None
    qos: Qos
    owner: int | None = None


@dataclass(slots=True)
class _Shared:
    publisher: Any
    watch: QosWatch | None
    users: int = 0
    has_published: bool = False
    matches: tuple[Callable[[], int], Callable[[], None]] | None = None  # once asked for
    deferred: Deferred | None = None  # while nobody uses it


class Publishers:
    """The publishers of a node. Subscriptions of *own_nodes* need no explanations.

    *node_for* returns the node that publishes on a topic. It is another one for command topics.
    """

    def __init__(
        self,
        node: Node,
        node_for: Callable[[str], Node],
        deferred: DeferredDestruction,
        on_change: Callable[[], None],
        own_nodes: Container[str],
        events: QosEvents,
        classes: MessageClasses,
    ) -> None:
        self._node = node
        self._node_for = node_for
        self._classes = classes
        self._own_nodes = own_nodes
        self._events = events
        self._loop = asyncio.get_running_loop()
        self._deferred = deferred
        self._on_change = on_change
        self._shared: dict[_Key, _Shared] = {}
        self._handles: set[RclpyPublisher] = set()
        self._unfollowed: set[str] = set()  # topics with handles that were opened in this turn
        self._owners = itertools.count()

    def __len__(self) -> int:
        """Count the open handles."""
        return len(self._handles)

    def type_of(self, topic: str) -> str | None:
        """Return the type of an open publisher on a topic, if there is one."""
        open_here = (key for key, shared in self._shared.items() if shared.users)
        return next((key.type_name for key in open_here if key.topic == topic), None)

    def advertise(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        on_event: Callable[[TopicEvent], None],
    ) -> "RclpyPublisher":
        """Open a publisher. See `gateway.sources.source.Publishing.advertise`."""
        check_topic(topic)
        offer = complete_offer(qos)
        # Late subscribers get the last samples of each publisher, so latched ones are not shared.
        owner = next(self._owners) if retains(offer) else None
        key = _Key(topic, type_name, self._classes.hash_of(type_name), offer, owner)
        shared = self._shared.get(key)
        if shared is None:
            created = self._create(key)
            told = partial(self._tell, key)
            watch = self._events.of_publisher(created, topic, offer, told)
            shared = self._shared[key] = _Shared(created, watch)
        elif shared.deferred is not None:
            self._deferred.cancel(shared.deferred)
            shared.deferred = None
        shared.users += 1
        publish_raw = raw_publisher(shared.publisher)
        handle = RclpyPublisher(self, key, publish_raw, on_event)
        self._handles.add(handle)
        if not self._unfollowed:
            # Not from within this call: the caller does not hold the publisher yet.
            self._loop.call_soon(self._follow_new)
        self._unfollowed.add(topic)
        return handle

    def follow_subscribers(self) -> None:
        """Let every publisher report the subscriptions that get nothing from it now."""
        self._report_on(None)

    def _follow_new(self) -> None:
        topics, self._unfollowed = self._unfollowed, set()
        self._report_on(topics)

    def _report_on(self, topics: Container[str] | None) -> None:
        """Let the publishers on some topics, or on all, report. Each topic is looked at once."""
        handles_on: dict[str, list[RclpyPublisher]] = defaultdict(list)
        for handle in self._handles:
            if topics is None or handle.key.topic in topics:
                handles_on[handle.key.topic].append(handle)
        for topic, handles in handles_on.items():
            found = read_requests(self._node, topic)
            subscribers = [each for each in found if each.node not in self._own_nodes]
            for handle in handles:
                handle.report(subscribers)

    def is_open(self, handle: "RclpyPublisher") -> bool:
        """Return whether a handle is not released yet."""
        return handle in self._handles

    def new_matches(self, key: _Key) -> int:
        """Return how many subscriptions have been found since the last call."""
        shared = self._shared[key]
        if shared.matches is None:
            shared.matches = new_matches(shared.publisher)
        take, _ = shared.matches
        return take()

    def release(self, handle: "RclpyPublisher", key: _Key) -> None:
        """Release a handle, and the publisher with the last one. Releasing twice is harmless."""
        if handle not in self._handles:
            return
        self._handles.remove(handle)
        shared = self._shared[key]
        shared.users -= 1
        shared.has_published |= handle.has_published
        if shared.users:
            return

        def destroy() -> None:
            if shared.watch is not None:
                shared.watch.close()
            if shared.matches is not None:
                shared.matches[1]()
            del self._shared[key]
            self._node_for(key.topic).destroy_publisher(shared.publisher)
            self._on_change()

        if shared.has_published:
            shared.deferred = self._deferred.defer(f"topic {key.topic}", key.type_name, destroy)
        else:
            destroy()

    def _tell(self, key: _Key, event: TopicEvent) -> None:
        for handle in [each for each in self._handles if each.key == key]:
            handle.on_event(event)

    def close(self) -> None:
        """Close every handle that is still open."""
        for handle in list(self._handles):
            handle.close()

    def _create(self, key: _Key) -> Any:
        found = self._classes.get(key.type_name)
        node = self._node_for(key.topic)
        profile = to_profile(key.qos)
        publisher = create_publisher(node, f"topic {key.topic}", key.topic, found, profile)
        self._on_change()
        return publisher


class RclpyPublisher:
    """One handle on a publisher that others may share."""

    def __init__(
        self,
        publishers: Publishers,
        key: _Key,
        publish_raw: Callable[[bytes], None],
        on_event: Callable[[TopicEvent], None],
    ) -> None:
        self._publishers = publishers
        self.key = key
        self._publish_raw = publish_raw
        self.on_event = on_event
        self._reported: list[TopicEvent] = []
        self.has_published = False

    def report(self, subscribers: Iterable[Endpoint]) -> None:
        """Report each subscription that gets nothing, once for as long as that lasts."""
        key = self.key
        known = self._reported
        unmatched = unmatched_subscribers(key.topic, key.type_name, key.qos, subscribers)
        others = other_versions(key.topic, key.type_name, key.type_hash, subscribers)
        self._reported = [*unmatched, *others]
        for reason in self._reported:
            if reason not in known and self._publishers.is_open(self):  # a callback may close it
                self.on_event(reason)

    def publish(self, cdr: bytes) -> None:
        """Publish one sample, encapsulation header included. Not after `close`."""
        self.has_published = True
        try:
            self._publish_raw(cdr)
        except REFUSALS as error:
            raise refused(f"topic {self.key.topic}", error) from error

    def new_matches(self) -> int:
        """Return how many subscriptions have been found since the last call. See the port."""
        return self._publishers.new_matches(self.key)

    def close(self) -> None:
        """Release it. Closing twice is harmless."""
        self._publishers.release(self, self.key)
