# SPDX-License-Identifier: Apache-2.0
"""The guard process of a robot behind a Zenoh router: a separate session, which publishes zeros.

It also listens to the commands of the gateway. If they do not come back from the router in time,
the link hangs, and what is sent into it would move the robot later. Then the guard ends itself, and
the gateway refuses commands until another guard has reached the router.
"""

import os
import threading
import time
from collections.abc import Mapping
from types import TracebackType
from typing import Any, Final

import zenoh
from typing_extensions import Self

from gateway.errors import RosStartError
from gateway.sources.name_checks import check_topic
from gateway.sources.source import Qos, RosError
from gateway.sources.zenoh.attachment import Attachment, read_attachment
from gateway.sources.zenoh.keys import NO_TYPE_HASH, DataKey, WireError
from gateway.sources.zenoh.options import ZenohOptions
from gateway.sources.zenoh.publishing import URGENT
from gateway.sources.zenoh.session import ZenohSession, open_session
from gateway.sources.zenoh.tokens import EndpointToken, NodeToken, gid_of, parse_token, tokens_of

# A command comes back from the router within some milliseconds. On a link with a delay of 100 ms
# it takes 200.
ECHO_S: Final = 0.3
# The command that was heard so lately is most likely the one that the gateway has just announced.
JUST_HEARD_S: Final = 0.1
CLOSE_S: Final = 0.3  # for what is still to be sent. A router that takes nothing keeps it longer
# Of one topic. The gateway names 100 subscriptions at most
MAX_ENDPOINTS: Final = 1024
_NEWEST: Final = Qos("reliable", "volatile", "keep_last", 1)


class ZenohGuardNode:
    """Implements `gateway.sources.guard.GuardNode`.

    *commander* is the node that publishes the gateway's commands, and *hashes* has those of the
    types that they may have.
    """

    def __init__(
        self,
        name: str,
        namespace: str,
        domain_id: int,
        router: str,
        commander: str,
        hashes: Mapping[str, str],
    ) -> None:
        # from the environment as for the gateway: it may have a password, and arguments are public
        overrides = os.environ.get("ZENOH_CONFIG_OVERRIDE", "")
        try:
            opened = open_session(ZenohOptions(router, overrides))
        except RosStartError as error:
            raise SystemExit(str(error)) from error
        self.session = ZenohSession(opened, domain_id)
        self.node = f"{namespace.rstrip('/')}/{name}"
        self.session.add_node(self.node)
        self.commander, self.hashes = commander, hashes
        self._publishers: dict[str, ZenohGuardPublisher] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.session.close(CLOSE_S)

    def advertise(self, topic: str, type_name: str, _: int) -> "ZenohGuardPublisher":
        """Create a publisher. Zenoh has no lifespans."""
        check_topic(topic)
        if type_name not in self.hashes:
            raise RosError("bad_type", f"no definition of {type_name} is known (topic {topic})")
        publisher = ZenohGuardPublisher(self, topic, type_name)
        self._publishers[topic] = publisher
        return publisher

    def readers(self, topic: str) -> set[str]:
        """Return the ids of the subscriptions to a topic."""
        publisher = self._publishers.get(topic)
        return set() if publisher is None else {each.gid.hex() for each in publisher.ends.readers}

    def moves(self, topic: str) -> None:
        """Expect to hear the command that the gateway is about to publish."""
        publisher = self._publishers.get(topic)
        if publisher is not None:
            publisher.expect()

    @property
    def is_cut_off(self) -> bool:
        """Return whether the router is gone, or the gateway's commands do not come back from it."""
        publishers = self._publishers.values()
        return any(each.is_unheard for each in publishers) or not self.session.is_connected

    def flush(self, timeout_s: float) -> None:
        """Do nothing: the end of the session waits for what is still to be sent."""

    def forget(self, topic: str) -> None:
        """Note that a publisher is closed."""
        self._publishers.pop(topic, None)


class TopicEnds:
    """The subscriptions to a topic, and the gateway's publishers. The first `MAX_ENDPOINTS` count.

    The tokens of other topics do not arrive here.
    """

    def __init__(self, session: ZenohSession, topic: str, commander: str) -> None:
        self._commander = commander
        self._lock = threading.Lock()
        self._known: Mapping[str, EndpointToken] = {}
        self.commanders: frozenset[bytes] = frozenset()
        self._tokens: Any = session.watch_tokens(self._change, tokens_of(topic))

    @property
    def readers(self) -> list[EndpointToken]:
        """The subscriptions that are there now."""
        return [each for each in self._known.values() if each.kind == "MS"]

    def close(self) -> None:
        """Follow the tokens no longer."""
        self._tokens.undeclare()

    def _change(self, text: str, is_there: bool) -> None:  # on a thread of Zenoh
        with self._lock:
            if not is_there:
                known = {key: end for key, end in self._known.items() if key != text}
            elif len(self._known) < MAX_ENDPOINTS and (end := self._read(text)) is not None:
                known = {**self._known, text: end}
            else:
                return
            self._known = known  # replaced as a whole: the loop reads it at any time
            self.commanders = frozenset(e.gid for e in known.values() if e.kind == "MP")

    def _read(self, text: str) -> EndpointToken | None:
        try:
            end = parse_token(text)
        except WireError:
            return None
        if isinstance(end, NodeToken):
            return None
        is_commander = end.kind == "MP" and end.of.node == self._commander
        return end if end.kind == "MS" or is_commander else None


class ZenohGuardPublisher:
    """Implements `gateway.sources.guard.GuardPublisher`.

    It publishes with the hash of the type and without, as nodes of Humble need it. A node that has
    not shown yet which it needs must stop as well.
    """

    def __init__(self, node: ZenohGuardNode, topic: str, type_name: str) -> None:
        self._node, self._topic = node, topic
        session = node.session
        self.ends = TopicEnds(session, topic, node.commander)
        self._heard_s = 0.0  # when the gateway was heard last
        self._expected_s: float | None = None
        self._echo: Any = session.zenoh.declare_subscriber(
            session.data_key(topic, type_name, "*").text,
            self._hear,
            allowed_origin=zenoh.Locality.REMOTE,
        )
        key, without_hash = (
            session.data_key(topic, type_name, each)
            for each in (node.hashes[type_name], NO_TYPE_HASH)
        )
        self._publishers = {each.type_hash: self._declare(each) for each in (key, without_hash)}
        self._token = session.add_endpoint(node.node, "MP", key, _NEWEST)
        self._gid, self._number = gid_of(self._token), 0

    @property
    def is_acknowledged(self) -> bool:
        """Return whether there is a way to each subscription. Zenoh reports no more."""
        hashes = {each.key.type_hash for each in self.ends.readers}
        if not hashes:
            return True
        # a subscription with another definition gets nothing anyway
        ways = [self._publishers[each] for each in hashes & self._publishers.keys()]
        is_matching = bool(ways) and all(each.matching_status.matching for each in ways)
        return is_matching and self._node.session.is_connected

    @property
    def is_unheard(self) -> bool:
        """Return whether a command of the gateway has not come back in time."""
        if self._expected_s is not None and self._heard_s >= self._expected_s:
            self._expected_s = None
        expected_s = self._expected_s
        return expected_s is not None and time.monotonic() - expected_s > ECHO_S

    def expect(self) -> None:
        """Expect a command, if the gateway's publisher is known."""
        if self.is_unheard or self._expected_s is not None or not self.ends.commanders:
            return
        now_s = time.monotonic()
        if now_s - self._heard_s > JUST_HEARD_S:
            self._expected_s = now_s

    def publish(self, cdr: bytes) -> None:
        """Publish one sample, encapsulation header included."""
        self._number += 1
        attachment = Attachment(self._number, time.time_ns(), self._gid).packed
        try:
            for each in self._publishers.values():
                each.put(cdr, attachment=attachment)
        except zenoh.ZError as error:
            raise RosError("internal", f"topic {self._topic}: {error}") from error

    def close(self) -> None:
        """Withdraw it."""
        self._node.forget(self._topic)
        self._node.session.remove(self._token)
        self.ends.close()
        for each in (self._echo, *self._publishers.values()):
            each.undeclare()

    def _declare(self, key: DataKey) -> Any:
        return self._node.session.zenoh.declare_publisher(
            key.text,
            congestion_control=zenoh.CongestionControl.DROP,
            reliability=zenoh.Reliability.RELIABLE,
            priority=URGENT,
        )

    def _hear(self, sample: Any) -> None:  # on a thread of Zenoh
        try:
            gid = read_attachment(sample.attachment.to_bytes()).gid
        except (WireError, AttributeError):
            return
        if gid in self.ends.commanders:
            self._heard_s = time.monotonic()
