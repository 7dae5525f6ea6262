# SPDX-License-Identifier: Apache-2.0
"""From DDS to the event loop: the data path.

`EventfdSamples` is the fast one. The listener thread of DDS writes an eventfd, in C and without
the GIL, and the loop takes the samples itself. It stands on rcl's
``rcl_subscription_set_on_new_message_callback``, whose callback ``(user_data, count)`` fits libc's
``eventfd_write(fd, count)``. `ExecutorSamples` stands on nothing but rclpy, and needs an executor
that spins its node in a thread.
"""

import asyncio
import ctypes
import os
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any, Protocol

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import HistoryPolicy, QoSProfile

from gateway.ports import MAX_TAKES_PER_TURN, Sample
from gateway.ros.qos import MAX_DEPTH

OnSamples = Callable[[Sequence[Sample]], None]


class Reader(Protocol):
    """One rclpy subscription whose samples come to the event loop."""

    @property
    def topic_name(self) -> str:
        """The name that ROS gave the topic."""

    def flush(self) -> None:
        """Deliver now what has arrived, at most `MAX_TAKES_PER_TURN` samples."""

    def close(self) -> None:
        """Deliver nothing any more and destroy the subscription. To be called once."""


class Samples(Protocol):
    """A way to bring samples to the event loop."""

    def read(
        self, message_class: type, topic: str, profile: QoSProfile, on_samples: OnSamples
    ) -> Reader:
        """Create a subscription; raises what rclpy raises."""


class UnsupportedError(Exception):
    """Raised when this platform or this ROS lacks what `EventfdSamples` stands on."""


class EventfdSamples:
    """Readers whose samples the event loop takes by itself; no executor may spin their node."""

    def __init__(self, node: Node, loop: asyncio.AbstractEventLoop) -> None:
        """Find what this needs.

        Raises:
            UnsupportedError: rcl, libc, Python or the loop lacks it.
        """
        _require_readers(loop)
        self._node = node
        self._loop = loop
        self._arrivals = _Arrivals()

    def read(
        self, message_class: type, topic: str, profile: QoSProfile, on_samples: OnSamples
    ) -> Reader:
        """Create a subscription; raises what rclpy raises."""
        subscription = self._node.create_subscription(
            message_class, topic, _never_called, profile, raw=True, event_callbacks=_no_events()
        )
        return _EventfdReader(
            self._node, self._loop, self._arrivals, subscription, message_class, on_samples
        )


class _EventfdReader:
    def __init__(
        self,
        node: Node,
        loop: asyncio.AbstractEventLoop,
        arrivals: "_Arrivals",
        subscription: Any,
        message_class: type,
        on_samples: OnSamples,
    ) -> None:
        self._node = node
        self._loop = loop
        self._arrivals = arrivals
        self._subscription = subscription
        self._message_class = message_class
        self._take_message = subscription.handle.take_message
        self._on_samples = on_samples
        # non-blocking: the thread of DDS must not wait when the loop does not read
        self._fd = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)
        loop.add_reader(self._fd, self._deliver)
        arrivals.count(subscription, self._fd)

    @property
    def topic_name(self) -> str:
        return str(self._subscription.topic_name)

    def close(self) -> None:
        """Unhook, then destroy, then close.

        In any other order the thread of DDS might write into whatever reuses the number.
        """
        self._loop.remove_reader(self._fd)
        self._arrivals.stop(self._subscription)
        self._node.destroy_subscription(self._subscription)
        os.close(self._fd)

    def flush(self) -> None:
        samples = self._take()
        if samples:
            self._on_samples(samples)

    def _deliver(self) -> None:
        os.eventfd_read(self._fd)
        samples = self._take()
        if len(samples) == MAX_TAKES_PER_TURN:
            os.eventfd_write(self._fd, 1)  # there may be more, after the others' turn
        if samples:
            self._on_samples(samples)

    def _take(self) -> list[Sample]:
        """Take until empty, whatever was counted: one arrival may complete several samples."""
        take = self._take_message
        message_class = self._message_class
        samples: list[Sample] = []
        while len(samples) < MAX_TAKES_PER_TURN:
            taken = take(message_class, True)  # True: raw
            if taken is None:
                break
            cdr, info = taken
            samples.append(Sample(cdr, info["received_timestamp"]))
        return samples


class ExecutorSamples:
    """Readers whose samples an executor's thread takes and hands over."""

    def __init__(self, node: Node, loop: asyncio.AbstractEventLoop) -> None:
        self._node = node
        self._loop = loop

    def read(
        self, message_class: type, topic: str, profile: QoSProfile, on_samples: OnSamples
    ) -> Reader:
        """Create a subscription; raises what rclpy raises."""
        return _ExecutorReader(self._node, self._loop, message_class, topic, profile, on_samples)


class _ExecutorReader:
    def __init__(
        self,
        node: Node,
        loop: asyncio.AbstractEventLoop,
        message_class: type,
        topic: str,
        profile: QoSProfile,
        on_samples: OnSamples,
    ) -> None:
        self._node = node
        self._loop = loop
        self._on_samples = on_samples
        # DDS' own queue is always empty here, so this one drops the oldest in its stead.
        keeps_all = profile.history == HistoryPolicy.KEEP_ALL
        self._waiting: deque[Sample] = deque(maxlen=MAX_DEPTH if keeps_all else profile.depth)
        self._is_scheduled = False
        self._is_closed = False
        arrive: Any = self._arrive  # rclpy's annotation knows callbacks without info only
        self._subscription = node.create_subscription(
            message_class, topic, arrive, profile, raw=True, event_callbacks=_no_events()
        )

    @property
    def topic_name(self) -> str:
        return str(self._subscription.topic_name)

    def close(self) -> None:
        self._is_closed = True
        self._node.destroy_subscription(self._subscription)
        self._waiting.clear()

    def _arrive(self, cdr: bytes, info: dict[str, int]) -> None:
        """Keep one sample for the loop; runs on the executor's thread."""
        self._waiting.append(Sample(cdr, info["received_timestamp"]))
        if not (self._is_scheduled or self._is_closed):
            self._is_scheduled = True
            self._loop.call_soon_threadsafe(self._deliver)

    def flush(self) -> None:
        waiting = self._waiting
        samples = [waiting.popleft() for _ in range(min(len(waiting), MAX_TAKES_PER_TURN))]
        if samples:
            self._on_samples(samples)

    def _deliver(self) -> None:
        if self._is_closed:
            return
        # Before looking: a sample that arrives while we look schedules the next turn.
        self._is_scheduled = False
        if len(self._waiting) > MAX_TAKES_PER_TURN:
            self._is_scheduled = True
            self._loop.call_soon(self._deliver)
        self.flush()


class _Arrivals:
    """The two C functions that count arrivals in an eventfd."""

    def __init__(self) -> None:
        try:
            self._set = ctypes.CDLL("librcl.so").rcl_subscription_set_on_new_message_callback
            self._write = ctypes.cast(ctypes.CDLL(None).eventfd_write, ctypes.c_void_p)
        except (OSError, TypeError, AttributeError) as error:  # TypeError: CDLL(None) on Windows
            raise UnsupportedError(str(error)) from error
        self._set.argtypes = [ctypes.c_void_p] * 3
        self._set.restype = ctypes.c_int

    def count(self, subscription: Any, fd: int) -> None:
        """Add each arrival to an eventfd from now on, and at once what has arrived before."""
        self._call(subscription, self._write, fd)

    def stop(self, subscription: Any) -> None:
        """Stop counting; once this returns no thread writes the eventfd any more."""
        self._call(subscription, None, None)

    def _call(self, subscription: Any, function: object, user_data: int | None) -> None:
        with subscription.handle:
            code = self._set(subscription.handle.pointer, function, user_data)
        if code != 0:
            raise RuntimeError(f"rcl_subscription_set_on_new_message_callback returned {code}")


def _require_readers(loop: asyncio.AbstractEventLoop) -> None:
    if not hasattr(os, "eventfd"):
        raise UnsupportedError("this Python has no eventfd")
    fd = os.eventfd(0, os.EFD_CLOEXEC)
    try:
        loop.add_reader(fd, _never_called)
        loop.remove_reader(fd)
    except NotImplementedError as error:
        raise UnsupportedError("this event loop watches no file descriptors") from error
    finally:
        os.close(fd)


def _no_events() -> SubscriptionEventCallbacks:
    # The graph tells about mismatches, with names; nobody would take these events.
    return SubscriptionEventCallbacks(use_default_callbacks=False)


def _never_called(*_: object) -> None:
    """Stand in where rclpy wants a callback and nothing calls it."""
