# SPDX-License-Identifier: Apache-2.0
"""Publishers over Zenoh, as rmw_zenoh has them."""

import itertools
import time
from collections import deque
from collections.abc import Callable, Container, Sequence
from functools import partial
from typing import Any, Final

import zenoh
from zenoh import ext

from gateway.sources.qos import Endpoint, complete_offer, unmatched_subscribers
from gateway.sources.source import Qos, RosError, TopicEvent
from gateway.sources.zenoh.attachment import Attachment
from gateway.sources.zenoh.events import other_versions
from gateway.sources.zenoh.keys import NO_TYPE_HASH, DataKey
from gateway.sources.zenoh.outgoing import Outgoing
from gateway.sources.zenoh.session import ZenohSession
from gateway.sources.zenoh.token_graph import TokenGraph
from gateway.sources.zenoh.tokens import gid_of

# A message of this size goes out in one part, with its key and attachment: Zenoh's batches have 64
# KiB. Larger ones may block for 50 ms.
MAX_ONE_PART_BYTES: Final = 60 * 1024
# Not express: each message would be a batch, and a router has room for two of this priority. Of a
# burst, as of a link that was black, it would pass on the first commands and drop the zeros.
URGENT: Final = zenoh.Priority.REAL_TIME
LATE_S: Final = 3.0  # for the way of a subscription, which may come after its token
HEARTBEAT_S: Final = 0.5  # by which a subscriber finds out that it missed the last message

OnEvent = Callable[[TopicEvent], None]


def declare_publisher(session: Any, key: str, qos: Qos, *, is_urgent: bool, blocks: bool) -> Any:
    """Declare a publisher of Zenoh as rmw_zenoh does for a complete profile."""
    is_reliable = qos.reliability == "reliable"
    control = zenoh.CongestionControl
    options: dict[str, Any] = {
        "congestion_control": control.BLOCK if blocks else control.DROP,
        "reliability": zenoh.Reliability.RELIABLE if is_reliable else zenoh.Reliability.BEST_EFFORT,
    }
    if is_urgent:
        options["priority"] = URGENT  # it overtakes pictures
    if qos.durability == "transient_local":
        options |= {"cache": ext.CacheConfig(qos.depth or 1), "publisher_detection": True}
        if is_reliable:
            options["sample_miss_detection"] = ext.MissDetectionConfig(
                heartbeat=None, sporadic_heartbeat=HEARTBEAT_S
            )
    return ext.declare_advanced_publisher(session, key, **options)


class ZenohPublishers:
    """The publishers of one node.

    *hash_of* returns the hash of the definition of a type here. Topics in *urgent* move a robot.
    """

    def __init__(
        self,
        session: ZenohSession,
        node: str,
        graph: TokenGraph,
        outgoing: Outgoing,
        hash_of: Callable[[str], str],
        urgent: Container[str] = (),
    ) -> None:
        self.session, self.node, self.graph, self.outgoing = session, node, graph, outgoing
        self.hash_of, self.urgent = hash_of, urgent
        self.remedy: str | None = None  # if messages are refused that reach no subscription
        self.open: dict[ZenohPublisher, None] = {}

    def advertise(
        self, topic: str, type_name: str, qos: Qos, on_event: OnEvent
    ) -> "ZenohPublisher":
        """Open a publisher. The caller has checked its name, and that the type is free."""
        own_hash = self.hash_of(type_name)
        type_hash = self.graph.hash_for("MS", topic, type_name, own_hash)
        key = self.session.data_key(topic, type_name, type_hash)
        return ZenohPublisher(self, key, own_hash, qos, on_event)

    def refuse_unheard(self, remedy: str) -> None:
        """Refuse messages that the router keeps from subscriptions that it lists."""
        self.remedy = remedy

    def type_of(self, topic: str) -> str | None:
        """Return the type of an open publisher on a topic, if there is one."""
        return next((each.key.type_name for each in self.open if each.key.name == topic), None)

    def follow_subscribers(self) -> None:
        """Let every publisher count and report the subscriptions that there are now."""
        for each in list(self.open):
            each.follow()

    def close(self) -> None:
        """Close every publisher that is still open."""
        for each in list(self.open):
            each.close()


class ZenohPublisher:
    """Implements `gateway.sources.source.Publisher`."""

    def __init__(
        self,
        all_of_them: ZenohPublishers,
        key: DataKey,
        own_hash: str,
        asked: Qos,
        on_event: OnEvent,
    ) -> None:
        self._all, self._own_hash, self._on_event = all_of_them, own_hash, on_event
        self._qos = qos = complete_offer(asked)
        self._is_urgent = key.name in all_of_them.urgent
        keeps_all = asked.history == "keep_all" and qos.reliability == "reliable"
        # A message that blocks at this priority would hold up all other commands, and zeros.
        self._blocks = keeps_all and not self._is_urgent
        self._subject = f"topic {key.name}"
        self._sending = 0  # messages that the thread has to send
        is_latched = qos.durability == "transient_local"
        self._kept: deque[bytes] = deque(maxlen=(qos.depth or 1) if is_latched else 0)
        self._open(key)
        self._found: frozenset[bytes] = frozenset()
        self._new_matches = 0
        self._reported: Sequence[TopicEvent] = ()
        self._trial: Any = None
        self._tried_s = 0.0
        self._has_matched = False
        all_of_them.open[self] = None
        self._count()

    def publish(self, cdr: bytes) -> None:
        """Publish one sample, encapsulation header included.

        Raises:
            RosError: ``forbidden``: the router keeps it from subscriptions that it lists.
                ``limit_exceeded``: too much waits.
        """
        self._check_reach()
        self._put(cdr)
        self._kept.append(cdr)

    def _put(self, cdr: bytes) -> None:
        attachment = Attachment(next(self._numbers), time.time_ns(), self._gid).packed
        put = partial(self._publisher.put, cdr, attachment=attachment)
        if len(cdr) <= MAX_ONE_PART_BYTES and not self._must_wait():
            put()
            return
        self._sending += 1

        def send() -> None:
            try:
                put()
            finally:
                self._sending -= 1

        try:
            self._all.outgoing.send(self._subject, len(cdr), send)
        except BaseException:
            self._sending -= 1
            raise

    def _check_reach(self) -> None:
        remedy = self._all.remedy
        if remedy is None or self._has_matched or not self._found:
            return
        if self._trial is None:  # an advanced publisher does not know whether it is matched
            self._trial = self._all.session.zenoh.declare_publisher(self.key.text)
            self._tried_s = time.monotonic()
        self._has_matched = bool(self._trial.matching_status.matching)
        if self._has_matched:
            self._end_trial()
        elif time.monotonic() - self._tried_s > LATE_S:
            raise RosError("forbidden", f"{self._subject}: the robot gets no message: {remedy}")

    def _end_trial(self) -> None:
        if self._trial is not None:
            self._trial.undeclare()
            self._trial = None

    @property
    def has_subscribers(self) -> bool:
        """True while subscriptions are listed that can read it."""
        return bool(self._found)

    def new_matches(self) -> int:
        """Return how many subscriptions have been found since the last call."""
        found, self._new_matches = self._new_matches, 0
        return found

    def follow(self) -> None:
        """Count and report the subscriptions that there are now."""
        self._change_key()
        self._count()
        known = self._reported
        self._reported = self._unmatched()
        for event in self._reported:
            if event not in known and self in self._all.open:  # a callback may close it
                self._on_event(event)

    def close(self) -> None:
        """Withdraw it, once what waits is sent. Closing twice is harmless."""
        if self not in self._all.open:
            return
        del self._all.open[self]
        self._withdraw()

    def _open(self, key: DataKey) -> None:
        self.key, session = key, self._all.session
        self._publisher = declare_publisher(
            session.zenoh, key.text, self._qos, is_urgent=self._is_urgent, blocks=self._blocks
        )
        self._token = session.add_endpoint(self._all.node, "MP", key, self._qos)
        self._all.graph.add(self._token)
        self._gid, self._numbers = gid_of(self._token), itertools.count(1)

    def _change_key(self) -> None:
        """Open again for subscriptions that show another hash than those before."""
        key = self.key
        type_hash = self._all.graph.hash_for(
            "MS", key.name, key.type_name, self._own_hash, key.type_hash
        )
        if type_hash == key.type_hash or self not in self._all.open:
            return
        self._withdraw()
        self._open(key._replace(type_hash=type_hash))
        for each in self._kept:
            self._put(each)

    def _withdraw(self) -> None:
        self._end_trial()
        self._all.graph.remove(self._token)
        self._all.session.remove(self._token)
        if self._sending:
            self._all.outgoing.finish(self._publisher.undeclare)
        else:
            self._publisher.undeclare()

    def _must_wait(self) -> bool:
        """Return whether a small message has to wait in a thread.

        While that waits for the router, any other of the same priority blocks its sender as well.
        """
        is_held_up = not self._is_urgent and self._all.outgoing.is_busy
        return bool(self._sending) or self._blocks or is_held_up

    def _count(self) -> None:
        matching = frozenset(
            each.gid
            for each in self._all.graph.endpoints("MS", self.key.name)
            if each.key == self.key
        )
        self._new_matches += len(matching - self._found)
        if not self._found:
            self._has_matched = False
        self._found = matching

    def _unmatched(self) -> list[TopicEvent]:
        """Describe the subscriptions of others that get nothing. QoS keeps none apart here."""
        topic, type_name = self.key.name, self.key.type_name
        others = [
            each
            for each in self._all.graph.requests(topic)
            if each.node not in self._all.session.nodes
        ]
        unmatched = unmatched_subscribers(topic, type_name, Qos(), others)
        of_type = [event for event in unmatched if event.code == "type_conflict"]
        return [*of_type, *self._other_versions(others)]

    def _other_versions(self, others: Sequence[Endpoint]) -> list[TopicEvent]:
        own_hash = None if self.key.type_hash == NO_TYPE_HASH else self.key.type_hash
        topic, type_name = self.key.name, self.key.type_name
        found = (
            each for each in others if each.type_name == type_name and each.type_hash != own_hash
        )
        return other_versions(topic, type_name, found, "it gets no messages")
