# SPDX-License-Identifier: Apache-2.0
"""Topics of the robot on which clients of relays publish, if the role of the uplink may.

Topics that move the robot are not among them: nothing that comes this way is a command.
"""

import logging
import time
from collections import deque
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

import zenoh

from gateway.codec.error_text import CodecError
from gateway.core.raw_values import RawValues
from gateway.core.requests import Advertise, Publish, Unadvertise
from gateway.sources.zenoh.inbox import Arrival, Arrivals, Inbox
from gateway.sources.zenoh.keys import DataKey

if TYPE_CHECKING:
    from gateway.uplink.link import UplinkLink

# Messages of one topic that wait for the loop, as many as DDS keeps of a burst.
MAX_WAITING_INPUTS: Final = 128
# Messages that may come back from the robot's middleware, and that relays have already.
MAX_ECHOES: Final = 256

_logger = logging.getLogger(__name__)


class _Input:
    """A topic on which a relay publishes."""

    def __init__(self, link: "UplinkLink", inbox: Inbox, key: DataKey) -> None:
        self._link, self.key = link, key
        self._decode = link.types.get(key.type_name).decode
        self.left_out = 0  # messages that are not CDR of the type
        self.echoes: deque[int] = deque(maxlen=MAX_ECHOES)
        self._arrivals = Arrivals(MAX_WAITING_INPUTS, self._publish)
        self._opened: list[Any] = []  # of the thread
        self._inbox = inbox
        link.core.carry_out(link.session, Advertise(topic=key.name, type=key.type_name))
        link.outgoing.finish(self._listen)

    def close(self) -> None:
        """End it."""
        self._arrivals.close()
        self._link.outgoing.finish(self._withdraw)
        self._link.core.carry_out(self._link.session, Unadvertise(topic=self.key.name))

    def _listen(self) -> None:  # on the thread
        # not what this session sends: it would go round
        self._opened.append(
            self._link.opened.zenoh.declare_subscriber(
                self.key.text, self._arrive, allowed_origin=zenoh.Locality.REMOTE
            )
        )

    def _withdraw(self) -> None:
        while self._opened:
            self._opened.pop().undeclare()

    def _arrive(self, sample: Any) -> None:  # on a thread of Zenoh
        arrival = Arrival(sample.payload.to_bytes(), b"", time.time_ns(), self.key.text)
        self._inbox.put(self._arrivals, arrival)

    def _publish(self, arrivals: Sequence[Arrival]) -> None:
        for arrival in arrivals:
            try:
                self._decode(arrival.cdr)
            except CodecError as error:
                self.left_out += 1
                if self.left_out == 1:
                    name = self.key.name
                    _logger.warning(
                        "topic %s: a relay sends a message that is left out: %s", name, error
                    )
                continue
            self.echoes.append(hash(arrival.cdr))
            request = Publish(topic=self.key.name, msg=RawValues(arrival.cdr))
            self._link.core.carry_out(self._link.session, request)


class UplinkInputs:
    """Publishes the messages of relays on topics that nodes of the robot subscribe to."""

    def __init__(self, link: "UplinkLink") -> None:
        self._link = link
        self._inbox = Inbox(link.mailbox.loop)
        self._open: dict[str, _Input] = {}

    def follow(self, inputs: Mapping[str, DataKey]) -> None:
        """Begin and end with topics of these on which relays publish."""
        graph, session = self._link.graph, self._link.session
        wanted = {
            name: key
            for name, key in inputs.items()
            if key in graph.published_by_others(name) and session.may("publish", name)
        }
        for name, known in list(self._open.items()):
            if wanted.get(name) != known.key:
                self._open.pop(name).close()
        for name, key in wanted.items():
            if name not in self._open:
                self._open[name] = _Input(self._link, self._inbox, key)

    def takes_back(self, topic: str, cdr: bytes) -> bool:
        """Return whether a message of the robot is one that a relay has published, once."""
        known = self._open.get(topic)
        if known is None or hash(cdr) not in known.echoes:
            return False
        known.echoes.remove(hash(cdr))
        return True

    def close(self) -> None:
        """End all of them."""
        for known in self._open.values():
            known.close()
        self._open.clear()
        self._inbox.close()
