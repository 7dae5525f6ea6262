# SPDX-License-Identifier: Apache-2.0
"""The topics of an uplink. Each flows while a viewer wants it, once for any number of them."""

import asyncio
import contextlib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final

from gateway.codec.cloud import CLOUD, MAX_CLOUD_POINTS, CloudOptions
from gateway.codec.picture import COMPRESSED_IMAGE
from gateway.config.zenoh import UplinkConfig
from gateway.core.frames import PlainFraming
from gateway.core.requests import ImageRequest, Subscribe, Unsubscribe
from gateway.core.topics.picture_adaptation import MAX_HOLD_S
from gateway.core.topics.subscription import Subscription
from gateway.sources.source import Qos, RosError
from gateway.sources.zenoh.attachment import Attachment
from gateway.sources.zenoh.outgoing import Outgoing
from gateway.sources.zenoh.publishing import declare_publisher
from gateway.uplink.offer import JPEG_TOPIC, OfferedTopic
from gateway.uplink.session import Stamp

if TYPE_CHECKING:
    from gateway.uplink.link import UplinkLink

# Publishers of one latched topic whose messages are kept apart, as of `/tf_static`.
MAX_KEPT_PUBLISHERS: Final = 64


class Sender:
    """A publisher of Zenoh, which a thread opens, uses and closes."""

    def __init__(self, outgoing: Outgoing, session: Any, key: str, qos: Qos, gid: bytes) -> None:
        self._outgoing, self._key, self._gid = outgoing, key, gid
        self._opened: list[Any] = []  # of the thread
        outgoing.finish(
            lambda: self._opened.append(
                declare_publisher(session, key, qos, is_urgent=False, blocks=False)
            )
        )

    def send(self, cdr: bytes, number: int, source_ns: int) -> None:
        """Send a sample.

        Raises:
            RosError: ``limit_exceeded``: too much waits.
        """
        attachment = Attachment(number, source_ns, self._gid).packed
        self._outgoing.send(self._key, len(cdr), lambda: self._put(cdr, attachment))

    def close(self) -> None:
        """Withdraw it, after what waits."""
        self._outgoing.finish(self._withdraw)

    def _put(self, cdr: bytes, attachment: bytes) -> None:
        for publisher in self._opened:
            publisher.put(cdr, attachment=attachment)

    def _withdraw(self) -> None:
        while self._opened:
            self._opened.pop().undeclare()


class _Flow:
    """A topic that viewers want."""

    def __init__(self, offered: OfferedTopic, gids: tuple[bytes, ...]) -> None:
        self.offered = offered
        self.gids = gids  # of the publishers that are shown
        self.is_fitted = False  # JPEGs of the robot, compressed again because the link is slow
        self.senders: dict[bytes | None, Sender] = {}  # by publisher, of a latched topic


class UplinkTopics:
    """Subscribes to the topics that viewers want, and sends what comes."""

    def __init__(self, link: "UplinkLink", config: UplinkConfig) -> None:
        self._link, self._config = link, config
        self._plain, self._pictures = PlainFraming(), PlainFraming.of_pictures(link.types)
        self._clouds = PlainFraming.of_clouds(link.types)
        self._flows: dict[str, _Flow] = {}  # by the robot's name of the topic

    @property
    def flowing(self) -> frozenset[str]:
        """The topics of the robot that viewers want."""
        return frozenset(self._flows)

    def follow(self, topics: Mapping[str, OfferedTopic]) -> None:
        """Begin and end flows, as others want the topics that are offered."""
        wanted = {
            each.source: (each, self._link.mirror.gids(name))
            for name, each in topics.items()
            if self._link.graph.readers(name)
        }
        for source, flow in list(self._flows.items()):
            if (flow.offered, flow.gids) != wanted.get(source):
                self._end(source)
        for source, (offered, gids) in wanted.items():
            if source not in self._flows and gids:
                self._flows[source] = _Flow(offered, gids)
                self._link.core.carry_out(self._link.session, self._subscribe(offered))

    def send(self, subscription: Subscription, cdr: bytes, stamp: Stamp) -> None:
        """Send a sample whose turn has come."""
        flow = self._flows.get(subscription.topic_name)
        if flow is None:
            return
        publisher = stamp.publisher if flow.offered.is_latched else None
        sender = flow.senders.get(publisher)
        if sender is None:
            if len(flow.senders) >= MAX_KEPT_PUBLISHERS:
                flow.senders.pop(next(iter(flow.senders))).close()
            sender = flow.senders[publisher] = self._sender(flow, subscription)
        with contextlib.suppress(RosError):  # too much waits: its number is missing
            sender.send(cdr, stamp.number, stamp.source_ns)
        self._link.pace.sent(len(cdr))
        bytes_per_s = self._link.session.outbox.bytes_per_s
        if bytes_per_s is not None and len(cdr) > bytes_per_s * MAX_HOLD_S:
            self._fit(flow)

    def _fit(self, flow: _Flow) -> None:
        """Let JPEGs that the robot has compressed fit the link from now on."""
        offered = flow.offered
        is_jpeg = offered.key.type_name == COMPRESSED_IMAGE and offered.source.endswith(JPEG_TOPIC)
        if is_jpeg and not flow.is_fitted:
            flow.is_fitted = True
            # not now: the queues are being gone through
            asyncio.get_running_loop().call_soon(self._subscribe_again, flow)

    def _subscribe_again(self, flow: _Flow) -> None:
        if self._flows.get(flow.offered.source) is flow:
            request = self._subscribe_to_images(flow.offered)
            self._link.core.carry_out(self._link.session, request)

    def close(self) -> None:
        """End all of them."""
        for source in list(self._flows):
            self._end(source)

    def _sender(self, flow: _Flow, subscription: Subscription) -> Sender:
        key, feed = flow.offered.key, subscription.source
        gid = flow.gids[len(flow.senders) % len(flow.gids)]
        depths = (
            [] if feed is None else [each.depth or 1 for each in self._link.core.offers(feed.topic)]
        )
        latched = Qos("reliable", "transient_local", "keep_last", max(depths, default=1))
        qos = latched if flow.offered.is_latched else Qos("reliable", "volatile")
        return Sender(self._link.outgoing, self._link.opened.zenoh, key.text, qos, gid)

    def _subscribe(self, offered: OfferedTopic) -> Subscribe:
        if offered.is_picture:
            return self._subscribe_to_images(offered)
        if offered.key.type_name == CLOUD:
            return self._subscribe_to_cloud(offered)
        return Subscribe(topic=offered.source, framing=self._plain)

    def _subscribe_to_images(self, offered: OfferedTopic) -> Subscribe:
        image = ImageRequest(
            format="jpeg", asks_for_picture=True, max_fps=self._config.max_image_hz
        )
        # only the newest one counts
        return Subscribe(topic=offered.source, framing=self._pictures, image=image, queue_length=1)

    def _subscribe_to_cloud(self, offered: OfferedTopic) -> Subscribe:
        config = self._config
        throttle_ms = 0 if config.max_cloud_hz is None else 1000 / config.max_cloud_hz
        if config.max_cloud_points is None and config.cloud_voxel_m is None:
            return Subscribe(topic=offered.source, framing=self._plain, throttle_ms=throttle_ms)
        most = config.max_cloud_points or MAX_CLOUD_POINTS
        cloud = CloudOptions(most, config.cloud_voxel_m, stays_cloud=True)
        return Subscribe(
            topic=offered.source, framing=self._clouds, throttle_ms=throttle_ms, cloud=cloud
        )

    def _end(self, source: str) -> None:
        flow = self._flows.pop(source)
        self._link.core.carry_out(self._link.session, Unsubscribe(topic=source))
        for sender in flow.senders.values():
            sender.close()
        self._link.session.problems.pop(source, None)
