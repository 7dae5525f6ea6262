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
from gateway.protocol.stream import Stream
from gateway.router.rendition import Frame, MetaFrame, Rendition, RenditionKey

_RATE_BATCHES = 16  # enough to tell 30 Hz from 25, few enough to follow a change within a second


class FeedKey(NamedTuple):
    """Streams with the same key share one ROS subscription."""

    topic: str  # resolved
    type_name: str
    qos: Qos


class Member:
    """A stream of some session, in its rendition."""

    __slots__ = ("release", "rendition", "session", "stream")

    def __init__(self, session: Session, stream: Stream, rendition: Rendition) -> None:
        self.session = session
        self.stream = stream
        self.rendition = rendition
        self.release: asyncio.TimerHandle | None = None  # at the end of a throttle interval


class Feed:
    """Hands every sample to its streams: one frame per rendition, however many clients.

    Runs on the event loop's thread. *make_rendition* builds a rendition when the first
    stream asks for it; *ros_now_ns* stamps frames with meta.
    """

    def __init__(
        self,
        key: FeedKey,
        make_rendition: Callable[["Feed", RenditionKey], Rendition],
        ros_now_ns: Callable[[], int],
    ) -> None:
        self.key = key
        self.subscription: Subscription | None = None  # set by the opener, before any sample
        self._make_rendition = make_rendition
        self._ros_now_ns = ros_now_ns
        self._members: dict[Rendition, list[Member]] = {}
        self._seq = 0
        self._arrivals: deque[tuple[int, int]] = deque(maxlen=_RATE_BATCHES)
        self._latched: deque[Sample] = deque(maxlen=key.qos.depth or 1)
        self._complaints: dict[str, ProtocolError] = {}

    @property
    def is_idle(self) -> bool:
        """Whether nobody is fed any more."""
        return not self._members

    @property
    def received(self) -> int:
        """How many samples came from ROS."""
        return self._seq

    def join(self, session: Session, stream: Stream, key: RenditionKey, *, replay: bool) -> Member:
        """Feed a stream from now on; *replay* begins with what transient-local topics keep."""
        rendition = next((known for known in self._members if known.key == key), None)
        if rendition is None:
            rendition = self._make_rendition(self, key)
        member = Member(session, stream, rendition)
        self._members.setdefault(rendition, []).append(member)
        for complaint in self._complaints.values():
            session.warn(complaint, "subscribe", None)
        if replay and self._latched:
            now_ns = time.monotonic_ns()
            first = self._seq - len(self._latched)
            for seq, sample in enumerate(self._latched, start=first + 1):
                self._offer(member, Frame(rendition, sample, seq), now_ns)
            session.wake()
        return member

    def leave(self, member: Member) -> None:
        """Feed a stream no longer; what it already has it keeps, held back or waiting."""
        members = self._members[member.rendition]
        members.remove(member)
        if not members:
            del self._members[member.rendition]
        if member.release is not None:
            # nobody will come at the end of this interval: it ends now
            member.release.cancel()
            self._release(member)

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
        if self.subscription is not None and self.subscription.qos.durability == "transient_local":
            self._latched.extend(samples[-(self._latched.maxlen or 1) :])
        for rendition, members in self._members.items():
            for seq, sample in enumerate(samples, start=before + 1):
                frame = Frame(rendition, sample, seq)
                for member in members:
                    self._offer(member, frame, now_ns)
        self.wake_all()

    def wake_all(self, rendition: Rendition | None = None) -> None:
        """Have the sessions of all streams, or of one rendition's, send what they can."""
        groups = self._members.values() if rendition is None else [self._members.get(rendition, [])]
        for members in list(groups):
            for member in list(members):
                member.session.wake()

    def complain(self, error: ProtocolError) -> None:
        """Tell every client concerned, now or later, what is wrong with this topic; once."""
        if str(error) in self._complaints or len(self._complaints) >= _MAX_COMPLAINTS:
            return
        self._complaints[str(error)] = error
        for members in self._members.values():
            for member in members:
                member.session.warn(error, "subscribe", None)

    def on_codec_error(self, error: CodecError) -> None:
        """Tell the clients that a message of this topic cannot be rendered."""
        self.complain(ProtocolError("invalid_value", f"{self.key.topic}: {error}"))

    def rate_hz(self, now_ns: int) -> float:
        """Return how often samples arrive; 0 once they have ceased."""
        if len(self._arrivals) < 2:  # one arrival has no rate
            return 0.0
        (first_ns, first), (last_ns, last) = self._arrivals[0], self._arrivals[-1]
        period_ns = (last_ns - first_ns) / (last - first)
        return 0.0 if now_ns - last_ns > max(3 * period_ns, 1e9) else 1e9 / max(period_ns, 1.0)

    def _offer(self, member: Member, frame: Frame, now_ns: int) -> None:
        stream = member.stream
        entry: Entry = frame
        if stream.wish.meta:
            entry = MetaFrame(frame, stream, self._ros_now_ns())
        due_ns = stream.offer(entry, now_ns)
        if due_ns is not None:
            delay_s = (due_ns - now_ns) / 1e9
            loop = asyncio.get_running_loop()
            member.release = loop.call_later(delay_s, self._release, member)

    def _release(self, member: Member) -> None:
        member.release = None
        member.stream.release(time.monotonic_ns())
        member.session.wake()


_MAX_COMPLAINTS = 16  # a publisher that sends ever new nonsense fills no memory and no log
