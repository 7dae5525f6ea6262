# SPDX-License-Identifier: Apache-2.0
"""One client's wish for one topic, and the pace at which it gets it."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final, TypeVar, get_args

from gateway.protocol.limits import DEFAULT_QUEUE_BYTES, DEFAULT_QUEUE_LENGTH
from gateway.protocol.operations.topics import ImageRequest, QosRequest, Subscribe
from gateway.protocol.outbox import Entry, Outbox, Queue
from gateway.protocol.publish_frames import Compression

T = TypeVar("T")

_COMPRESSIONS: Final[tuple[Compression, ...]] = get_args(Compression)  # later ones win


@dataclass(frozen=True, slots=True)
class Wish:
    """What a client's subscriptions to one topic amount to.

    A `publish` frame does not say which subscription it is for, so several subscriptions
    of one client to one topic share one stream, as in rosbridge: the shortest throttle and
    queue, the strongest compression, the smallest fragments, all the fields that any of them
    asked for, the newest word on type, QoS and image.
    """

    type: str | int | None
    qos: QosRequest
    fields: tuple[str, ...] | None
    image: ImageRequest
    meta: bool
    throttle_ns: int
    queue_length: int | None
    compression: Compression
    fragment_size: int | None

    @classmethod
    def merge(cls, requests: Iterable[Subscribe]) -> "Wish":
        """Merge subscriptions, oldest first; there must be one at least."""
        wanted = list(requests)
        image = _newest(request.image for request in wanted) or ImageRequest()
        throttle_ms = min(request.throttle_rate or 0 for request in wanted)
        if image.max_fps is not None:
            throttle_ms = max(throttle_ms, 1000 / image.max_fps)
        fields: tuple[str, ...] | None = None
        if all(request.fields is not None for request in wanted):
            fields = tuple(sorted({field for request in wanted for field in request.fields or ()}))
        types = [request.type for request in wanted if request.type is not None]
        lengths = [request.queue_length for request in wanted if request.queue_length]
        sizes = [known for request in wanted if (known := request.fragment_size) is not None]
        return cls(
            type=types[-1] if types else None,
            qos=_newest(request.qos for request in wanted) or QosRequest(),
            fields=fields,
            image=image,
            meta=any(request.meta for request in wanted),
            throttle_ns=round(throttle_ms * 1e6),
            queue_length=min(lengths, default=None),
            compression=max((compression(request) for request in wanted), key=_COMPRESSIONS.index),
            fragment_size=min(sizes, default=None),
        )


def compression(request: Subscribe) -> Compression:
    """Return what a subscription asks for; what is unknown counts as ``none``, as in rosbridge."""
    return next((known for known in _COMPRESSIONS if known == request.compression), "none")


def _newest(values: Iterable[T | None]) -> T | None:
    newest: T | None = None
    for value in values:
        newest = newest if value is None else value
    return newest


class Stream:
    """A topic on its way to one client.

    Without a throttle every sample goes to the queue. With one, at most one sample per
    interval does: the first at once, then the newest at the end of each interval, the last
    one included.
    """

    __slots__ = ("_held", "_next_ns", "coalesced", "queue", "topic", "wish")

    def __init__(self, topic: str, wish: Wish, outbox: Outbox) -> None:
        self.topic = topic  # as the client spells it
        self.wish = wish
        self.queue: Queue = outbox.open_queue(*_bounds(wish))
        self.coalesced = 0
        self._held: Entry | None = None
        self._next_ns = 0

    def change(self, wish: Wish) -> None:
        """Go on with another wish; what already waits is still delivered.

        Another throttle begins at once: the sample that was held back for the former one passes,
        and no `release` is due any more.
        """
        if wish.throttle_ns != self.wish.throttle_ns:
            self._next_ns = 0
            held, self._held = self._held, None
            if held is not None:
                self.queue.put(held)
        self.wish = wish
        self.queue.depth, self.queue.max_bytes = _bounds(wish)

    def offer(self, entry: Entry, now_ns: int, *, more: bool = False) -> int | None:
        """Take a new sample; return when to call `release`, if this sample has to wait.

        *more* says that others follow at once; see `Queue.put`.
        """
        if not self.wish.throttle_ns:
            self.queue.put(entry, more=more)
            return None
        if self._held is not None:
            self.coalesced += 1
            self._held = entry
            return None  # `release` is already due
        if now_ns >= self._next_ns:
            self._pass(entry, now_ns)
            return None
        self._held = entry
        return self._next_ns

    def release(self, now_ns: int) -> None:
        """Pass on the sample that was held back, at the end of its interval."""
        held, self._held = self._held, None
        if held is not None:
            self._pass(held, now_ns)

    def withdraw(self) -> None:
        """Forget what waits or is held."""
        self._held = None
        self.queue.clear()

    def _pass(self, entry: Entry, now_ns: int) -> None:
        # Keep the beat while samples come in time; start a new one after a pause.
        throttle_ns = self.wish.throttle_ns
        late_ns = now_ns - self._next_ns
        self._next_ns = (self._next_ns if late_ns < throttle_ns else now_ns) + throttle_ns
        self.queue.put(entry)


def _bounds(wish: Wish) -> tuple[int, int | None]:
    """Return depth and bytes of a queue: what was asked for, else a second or a quarter MiB."""
    if wish.queue_length is None:
        return DEFAULT_QUEUE_LENGTH, DEFAULT_QUEUE_BYTES
    return wish.queue_length, None
