# SPDX-License-Identifier: Apache-2.0
"""A thread that takes large samples from DDS, while the event loop serves others."""

import contextlib
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Final, NamedTuple

from rclpy.subscription import Subscription

from gateway.sources.rclpy.rclpy_private.takes import HANDED_OVER_BYTES, sample_taker
from gateway.sources.source import Sample

# Taking so much on the loop lasts as long as handing it to a thread: about 0.1 ms. 16 MB last 35.
LARGE_SAMPLE_BYTES: Final = HANDED_OVER_BYTES
# Each is delivered before the next four are taken: a queue may hold a gigabyte of them.
TAKES_AT_ONCE: Final = 4


class LargeTakes:
    """Takes for all readers, one after the other, without the GIL."""

    def __init__(self) -> None:
        self._take = sample_taker()
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="ros_take")

    def start(
        self, subscription: Subscription, message_class: type, on_end: Callable[[], object]
    ) -> "LargeTake":
        """Take at most `TAKES_AT_ONCE` samples. *on_end* is called by the thread, or by `stop`."""
        take = LargeTake()
        take.result = self._thread.submit(self._run, take, subscription, message_class)
        take.result.add_done_callback(lambda _: on_end())
        return take

    def close(self) -> None:
        """Wait for the take that may be going on. The others never start."""
        self._thread.shutdown(wait=True, cancel_futures=True)

    def _run(self, take: "LargeTake", subscription: Subscription, message_class: type) -> "Taken":
        return take_up_to(
            TAKES_AT_ONCE,
            lambda: self._take(subscription, message_class) if take.is_wanted else None,
        )


class Taken(NamedTuple):
    """The samples of a turn, and whether there may be more."""

    samples: list[Sample]
    has_more: bool


def take_up_to(most: int, take: Callable[[], Sample | None]) -> Taken:
    """Take at most so many samples.

    If rcl raises an error, the samples before it are returned. The next take meets the error.
    """
    samples: list[Sample] = []
    while len(samples) < most:
        try:
            sample = take()
        except RuntimeError:
            if samples:
                break
            raise
        if sample is None:
            return Taken(samples, has_more=False)
        samples.append(sample)
    return Taken(samples, has_more=True)


class LargeTake:
    """One turn of the thread."""

    result: "Future[Taken]"

    def __init__(self) -> None:
        self.is_wanted = True

    def stop(self) -> list[Sample]:
        """End it after the sample that is being taken, within 40 ms, and return what it has."""
        self.is_wanted = False
        if self.result.cancel():
            return []
        with contextlib.suppress(RuntimeError):  # of rcl: there is no sample
            return self.result.result().samples
        return []
