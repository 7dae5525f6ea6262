# SPDX-License-Identifier: Apache-2.0
"""One ROS subscription and the streams that it feeds."""

import asyncio
import time
from collections import deque
from collections.abc import Callable, Sequence
from typing import NamedTuple

from gateway.codec.errors import CodecError
from gateway.ports import Qos, Sample, Subscription
from gateway.protocol.errors import ProtocolError
from gateway.protocol.outbox import Entry
from gateway.protocol.session import Session
from gateway.protocol.subscription_options import Stream, Wish
from gateway.router.topics.encoding import Frame, Rendition, RenditionKey, TailoredFrame
from gateway.router.topics.latch import Latch, TransformLatch

_MAX_BROKEN = 16  # a publisher that sends ever new nonsense fills no memory and no log
_RATE_BATCHES = 16  # enough to tell 30 Hz from 25, few enough to follow a change within a second


class FeedKey(NamedTuple):
    """Streams with the same key share one ROS subscription."""

    topic: str  # resolved
    type_name: str
    qos: Qos


class Member:
    """A stream of some session on its way from feed to feed, with its timer.

    *ros_now_ns* stamps frames with meta.
    """

    __slots__ = ("_release", "_ros_now_ns", "rendition", "request_id", "session", "stream")

    def __init__(self, session: Session, stream: Stream, ros_now_ns: Callable[[], int]) -> None:
        self._ros_now_ns = ros_now_ns
        self.session = session
        self.stream = stream
        self.rendition: Rendition | None = None  # while it is fed
        self.request_id: str | int | None = None  # of the newest subscription, for warnings
        self._release: asyncio.TimerHandle | None = None  # at the end of a throttle interval

    def offer(self, frame: Frame, now_ns: int, *, more: bool) -> None:
        """Take a sample, now or at the end of the stream's interval; *more* follow at once."""
        stream, session = self.stream, self.session
        wish = stream.wish
        entry: Entry = frame
        if wish.meta or wish.fragment_size is not None or session.is_ros_sharp:
            entry = TailoredFrame(frame, stream, session, self._ros_now_ns() if wish.meta else 0)
        due_ns = stream.offer(entry, now_ns, more=more)
        if due_ns is not None:
            loop = asyncio.get_running_loop()
            self._release = loop.call_later((due_ns - now_ns) / 1e9, self._on_interval)

    def change(self, wish: Wish) -> None:
        """Go on with another wish."""
        if wish.throttle_ns != self.stream.wish.throttle_ns:
            self._cancel_release()
        self.stream.change(wish)

    def warn(self, error: ProtocolError) -> None:
        """Tell the client what is wrong with its subscription."""
        self.session.warn(error, "subscribe", self.request_id)

    def cancel(self) -> None:
        """Deliver nothing of what has come so far."""
        self._cancel_release()
        self.stream.withdraw()

    def _cancel_release(self) -> None:
        if self._release is not None:
            self._release.cancel()
            self._release = None

    def _on_interval(self) -> None:
        self._release = None
        self.stream.release(time.monotonic_ns())
        self.session.wake()


class Feed:
    """Hands every sample to its streams: one frame per rendition, however many clients.

    Runs on the event loop's thread. *make_rendition* builds a rendition when the first
    stream asks for it; *latch* keeps what late streams get.
    """

    def __init__(
        self,
        key: FeedKey,
        make_rendition: Callable[["Feed", RenditionKey], Rendition],
        latch: Latch | TransformLatch,
    ) -> None:
        self.key = key
        self.subscription: Subscription | None = None  # set by the opener, before any sample
        self._make_rendition = make_rendition
        self._members: dict[Rendition, list[Member]] = {}
        self._seq = 0
        self._arrivals: deque[tuple[int, int]] = deque(maxlen=_RATE_BATCHES)
        self._latch = latch
        self._has_kept = False
        self._broken: set[str] = set()  # what is wrong with samples, as far as it was told

    @property
    def is_idle(self) -> bool:
        """Whether nobody is fed any more."""
        return not self._members

    def join(self, member: Member, key: RenditionKey, *, replay: bool) -> None:
        """Feed a stream from now on; *replay* begins with what transient-local topics keep."""
        rendition = next((known for known in self._members if known.key == key), None)
        if rendition is None:
            rendition = self._make_rendition(self, key)
        latched = self._latch.newest(self._retained) if replay else []  # before it counts as fed
        member.rendition = rendition
        self._members.setdefault(rendition, []).append(member)
        if not replay:
            return
        for text in self.subscription.incompatible if self.subscription is not None else ():
            member.warn(ProtocolError("qos_incompatible", text))
        now_ns = time.monotonic_ns()
        for seq, sample in latched:
            member.offer(Frame(rendition, sample, seq), now_ns, more=True)

    def leave(self, member: Member, rendition: Rendition) -> None:
        """Feed a stream of some rendition no longer."""
        members = self._members[rendition]
        members.remove(member)
        if not members:
            del self._members[rendition]

    def close(self) -> None:
        """End the ROS subscription."""
        if self.subscription is not None:
            self.subscription.close()

    def on_samples(self, samples: Sequence[Sample]) -> None:
        """Pass on what arrived, oldest first."""
        now_ns = time.monotonic_ns()
        before = self._seq
        self._seq += len(samples)
        self._arrivals.append((now_ns, self._seq))
        retained = self._retained
        if retained:
            # twice what is replayed now: a new publisher's sample may come before its discovery
            self._latch.keep(samples, before + 1, 2 * retained)
            self._has_kept = True
        elif self._has_kept:
            self._latch.clear()  # its publishers have changed: what it kept may be long wrong
            self._has_kept = False
        more = len(samples) > 1
        for rendition, members in self._members.items():
            for seq, sample in enumerate(samples, start=before + 1):
                frame = Frame(rendition, sample, seq)
                for member in members:
                    member.offer(frame, now_ns, more=more)
        self.wake_all()

    def wake_all(self) -> None:
        """Have the sessions of all streams send what they can."""
        for members in self._members.values():
            for member in members:
                if member.session.outbox.size:
                    member.session.wake()

    def on_incompatible(self, text: str) -> None:
        """Tell the clients of a publisher that cannot be matched."""
        self._warn_all(ProtocolError("qos_incompatible", text))

    def on_codec_error(self, error: CodecError) -> None:
        """Tell the clients that a message of this topic cannot be rendered; once."""
        text = f"{self.key.topic}: {error}"
        if text not in self._broken and len(self._broken) < _MAX_BROKEN:
            self._broken.add(text)
            self._warn_all(ProtocolError("invalid_value", text))

    def _warn_all(self, error: ProtocolError) -> None:
        for members in list(self._members.values()):
            for member in list(members):
                member.warn(error)

    def rate_hz(self, now_ns: int) -> float:
        """Return how often samples arrive; 0 once they have ceased."""
        if len(self._arrivals) < 2:  # one arrival has no rate
            return 0.0
        (first_ns, first), (last_ns, last) = self._arrivals[0], self._arrivals[-1]
        period_ns = (last_ns - first_ns) / (last - first)
        return 0.0 if now_ns - last_ns > max(3 * period_ns, 1e9) else 1e9 / max(period_ns, 1.0)

    @property
    def _retained(self) -> int:
        """How many samples a late stream gets: what DDS would give a late subscription.

        That is `depth` samples of each publisher. Which publisher a sample came from rclpy does
        not tell, so it is the newest ones, as many as there are publishers. None of a volatile
        topic.
        """
        subscription = self.subscription
        if subscription is None or subscription.qos.durability != "transient_local":
            return 0
        return max(1, subscription.publishers) * (self.key.qos.depth or 1)
