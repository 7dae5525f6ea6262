# SPDX-License-Identifier: Apache-2.0
"""Raw publishers: all who advertise the same share one of rclpy's, unless it is latched."""

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from rclpy.event_handler import PublisherEventCallbacks
from rclpy.node import Node

from gateway.ports import Qos
from gateway.ros import rclpy_private
from gateway.ros.deferred_destruction import Deferred, DeferredDestruction
from gateway.ros.errors import REFUSALS, refused, remapped
from gateway.ros.groups import group_of_one
from gateway.ros.interfaces import message_class
from gateway.ros.name_checks import check_topic
from gateway.ros.profile import to_profile
from gateway.ros.qos import complete_offer


@dataclass(frozen=True, slots=True)
class _Key:
    topic: str
    type_name: str
    qos: Qos
    owner: int | None = None


@dataclass(slots=True)
class _Shared:
    publisher: Any
    users: int = 0
    has_published: bool = False
    deferred: Deferred | None = None  # while nobody uses it


class Publishers:
    """The publishers of one node."""

    def __init__(
        self, node: Node, deferred: DeferredDestruction, on_change: Callable[[], None]
    ) -> None:
        self._node = node
        self._deferred = deferred
        self._on_change = on_change
        self._shared: dict[_Key, _Shared] = {}
        self._handles: set[RclpyPublisher] = set()
        self._owners = itertools.count()

    def __len__(self) -> int:
        """Count the open handles."""
        return len(self._handles)

    def type_of(self, topic: str) -> str | None:
        """Return the type of an open publisher on a topic, if there is one."""
        open_here = (key for key, shared in self._shared.items() if shared.users)
        return next((key.type_name for key in open_here if key.topic == topic), None)

    def advertise(self, topic: str, type_name: str, qos: Qos) -> "RclpyPublisher":
        """Open a publisher; see `gateway.ports.Ros.advertise`."""
        check_topic(topic)
        offer = complete_offer(qos)
        # Late subscribers get the last samples of each publisher, so latched ones are not shared.
        is_latched = offer.durability == "transient_local"
        key = _Key(topic, type_name, offer, next(self._owners) if is_latched else None)
        shared = self._shared.get(key)
        if shared is None:
            shared = self._shared[key] = _Shared(self._create(key))
        elif shared.deferred is not None:
            self._deferred.cancel(shared.deferred)
            shared.deferred = None
        shared.users += 1
        handle = RclpyPublisher(self, key, rclpy_private.raw_publisher(shared.publisher))
        self._handles.add(handle)
        return handle

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
            del self._shared[key]
            self._node.destroy_publisher(shared.publisher)
            self._on_change()

        if shared.has_published:
            shared.deferred = self._deferred.defer(f"topic {key.topic}", key.type_name, destroy)
        else:
            destroy()

    def close(self) -> None:
        """Close every handle that is still open."""
        for handle in list(self._handles):
            handle.close()

    def _create(self, key: _Key) -> Any:
        found = message_class(key.type_name)
        try:
            publisher = self._node.create_publisher(
                found,
                key.topic,
                to_profile(key.qos),
                callback_group=group_of_one(),
                event_callbacks=PublisherEventCallbacks(use_default_callbacks=False),
            )
        except REFUSALS as error:
            raise refused(f"topic {key.topic}", error) from error
        given = publisher.topic_name
        if given != key.topic:
            self._node.destroy_publisher(publisher)
            raise remapped(f"topic {key.topic}", given)
        self._on_change()
        return publisher


class RclpyPublisher:
    """One handle on a publisher that others may share."""

    def __init__(
        self, publishers: Publishers, key: _Key, publish_raw: Callable[[bytes], None]
    ) -> None:
        self._publishers = publishers
        self._key = key
        self._publish_raw = publish_raw
        self.has_published = False

    def publish(self, cdr: bytes) -> None:
        """Publish one sample, encapsulation header included. Not after `close`."""
        self.has_published = True
        try:
            self._publish_raw(cdr)
        except REFUSALS as error:
            raise refused(f"topic {self._key.topic}", error) from error

    def close(self) -> None:
        """Release it. Closing twice is harmless."""
        self._publishers.release(self, self._key)
