# SPDX-License-Identifier: Apache-2.0
"""The options of one client's subscription to one topic."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import reduce
from typing import Final, TypeVar

from gateway.codec.cloud import CloudOptions
from gateway.config.limits import MAX_QUEUE_DEPTH
from gateway.core.frames import Framing
from gateway.core.requests import ImageRequest, Subscribe
from gateway.core.topics.throttle import Pace
from gateway.sources.source import Qos

# As many as DDS keeps of small messages: a burst is complete, and a hiccup of WiFi ridden out. On a
# link that is too slow the outbox keeps what is fresh.
DEFAULT_QUEUE_LENGTH: Final = MAX_QUEUE_DEPTH
DEFAULT_QUEUE_BYTES: Final = 512 * 1024  # 700 of odometry, the newest few of big messages

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class SubscriptionOptions:
    """The sum of a client's `subscribe` requests for one topic.

    A `publish` frame does not say which request it is for. So several requests of one client for
    one topic are one subscription, as in rosbridge. It has the shortest throttle, queue, and
    silence, all the fields that any request names, and the newest type, QoS, image, and cloud
    options. The front merges the framings.
    """

    type: str | int | None
    qos: Qos
    fields: tuple[str, ...] | None
    image: ImageRequest
    cloud: CloudOptions | None
    meta: bool
    pace: Pace
    stale_after_ns: int | None
    queue_length: int | None
    framing: Framing

    @classmethod
    def merge(cls, requests: Iterable[Subscribe]) -> "SubscriptionOptions":
        """Merge requests, oldest first. There must be one at least."""
        asked = list(requests)
        image = _newest(request.image for request in asked) or ImageRequest()
        lengths = [request.queue_length for request in asked if request.queue_length]
        throttle_ms = min(request.throttle_ms for request in asked)
        throttle_length = min(lengths, default=1)
        if image.max_fps is not None and 1000 / image.max_fps > throttle_ms:
            throttle_ms, throttle_length = 1000 / image.max_fps, 1  # pictures are to be fresh
        fields: tuple[str, ...] | None = None
        if all(request.fields is not None for request in asked):
            fields = tuple(sorted({field for request in asked for field in request.fields or ()}))
        types = [request.type for request in asked if request.type is not None]
        silences = [known for request in asked if (known := request.stale_after_ms) is not None]
        return cls(
            type=types[-1] if types else None,
            qos=_newest(request.qos for request in asked) or Qos(),
            fields=fields,
            image=image,
            cloud=_newest(request.cloud for request in asked),
            meta=any(request.meta for request in asked),
            pace=Pace(round(throttle_ms * 1e6), throttle_length),
            stale_after_ns=round(min(silences) * 1e6) if silences else None,
            queue_length=min(lengths, default=None),
            framing=reduce(lambda older, one: one.after(older), (each.framing for each in asked)),
        )

    @property
    def needs_own_frames(self) -> bool:
        """True if no frame can be shared with other subscriptions."""
        return self.meta or self.framing.needs_own_frames

    @property
    def queue_bounds(self) -> tuple[int, int | None]:
        """Length and bytes of the queue: as requested, else as many as DDS keeps, or half a MiB.

        Of clouds to be thinned the newest waits.
        """
        if self.queue_length is None and self.cloud is not None:
            return 1, None
        if self.queue_length is None:
            return DEFAULT_QUEUE_LENGTH, DEFAULT_QUEUE_BYTES
        return self.queue_length, None


def _newest(values: Iterable[T | None]) -> T | None:
    newest: T | None = None
    for value in values:
        newest = newest if value is None else value
    return newest
