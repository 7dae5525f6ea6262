# SPDX-License-Identifier: Apache-2.0
"""The beginning of a subscription to a transient-local topic that others receive already.

Only DDS knows which samples a late joiner gets. Each publisher keeps as many as its depth says,
which discovery does not tell, until their lifespan or the publisher ends. So such a subscription
begins with its own ROS subscription, and its topic takes over later.
"""

import asyncio
from collections.abc import Callable, Sequence
from typing import Final

from gateway.sources.source import LateReader, Origin, RosSubscription, Sample

# Nothing more is expected of publishers that have been silent for so long: 8 MB, the map of a
# large building, may take seconds over WiFi.
QUIET_S: Final = 5.0
# Of samples that came to the topic and not here. The reader also gets the oldest, or nobody does.
MAX_AHEAD: Final = 256
MAX_AHEAD_BYTES: Final = 8 * 1024**2
MAX_HEARD: Final = 1024

Offer = Callable[[Sample, int | None], None]
"""Offers a sample to the subscription. The number is that on its topic, if it has come there."""


class LateJoin:
    """Feeds a subscription by its own reader, and then by its topic: each sample once.

    The topic asks by `passes` for each sample that comes to it.
    """

    def __init__(self, topic: RosSubscription, offer: Offer, on_end: Callable[[], None]) -> None:
        """Open the reader. *on_end* is called when the topic alone feeds the subscription.

        Raises:
            RosError: ROS refuses it.
        """
        self._topic = topic
        self._offer = offer
        self._on_end = on_end
        self._ahead: dict[Origin, tuple[int, Sample]] = {}
        self._ahead_bytes = 0
        # when samples came here, 0 once they also came to the topic: not kept, but new
        self._heard_s: dict[Origin, float] = {}
        self._loop = asyncio.get_running_loop()
        self._began_s = self._loop.time()
        self._reader: LateReader | None = topic.join_late(self._on_samples)
        self._timer = self._look_again()

    def passes(self, seq: int, sample: Sample) -> bool:
        """Return whether a sample that has come to the topic is to be offered by it."""
        origin = sample.origin
        if origin in self._heard_s:
            self._heard_s[origin] = 0.0
            return False
        if self._reader is None:
            return True
        self._ahead[origin] = seq, sample
        self._ahead_bytes += len(sample.cdr)
        while len(self._ahead) > MAX_AHEAD or self._ahead_bytes > MAX_AHEAD_BYTES:
            self._take_ahead(next(iter(self._ahead)))
        return False

    def cut_short(self) -> None:
        """End it, and offer what has come to the topic and not to the late reader yet."""
        for seq, sample in self._ahead.values():
            self._offer(sample, seq)
        self.close()

    def close(self) -> None:
        """End it. Closing twice is harmless."""
        self._timer.cancel()
        self._ahead.clear()
        if self._reader is not None:
            self._reader.close()
            self._reader = None

    def _on_samples(self, samples: Sequence[Sample]) -> None:
        now_s = self._loop.time()
        for sample in samples:
            seq = self._take_ahead(sample.origin)
            self._heard_s[sample.origin] = now_s if seq is None else 0.0
            if len(self._heard_s) > MAX_HEARD:
                del self._heard_s[next(iter(self._heard_s))]
            self._offer(sample, seq)

    def _take_ahead(self, origin: Origin) -> int | None:
        ahead = self._ahead.pop(origin, None)
        if ahead is None:
            return None
        seq, sample = ahead
        self._ahead_bytes -= len(sample.cdr)
        return seq

    def _look_again(self) -> asyncio.TimerHandle:
        return self._loop.call_later(QUIET_S / 2, self._look)

    def _look(self) -> None:
        if self._reader is None:
            self._on_end()
            return
        if self._is_complete(self._reader):
            # compare samples of the topic until the next look: they may be on their way to us both
            reader, self._reader = self._reader, None
            reader.close()
            for seq, sample in self._ahead.values():  # of publishers that did not reach the reader
                self._offer(sample, seq)
            self._ahead.clear()
        self._timer = self._look_again()

    def _is_complete(self, reader: LateReader) -> bool:
        newest_s = max(self._heard_s.values(), default=0.0)
        is_quiet = self._loop.time() - max(newest_s, self._began_s) >= QUIET_S
        return is_quiet and reader.publishers >= self._topic.publishers
