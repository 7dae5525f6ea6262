# SPDX-License-Identifier: Apache-2.0
"""A buffer of ``/tf`` and ``/tf_static``, filled as long as a lookup needs it."""

import asyncio
import contextlib
import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, Final

from gateway.backports import timeout_at
from gateway.codec.error_text import CodecError, truncate
from gateway.codec.types import MessageType
from gateway.core.errors import ProtocolError
from gateway.core.topic_types import TopicTypes
from gateway.sources.source import Qos, Ros, RosError, RosSubscription, Sample, TopicEvent, Watch
from gateway.tf import TF_MESSAGE
from gateway.tf.buffer import Buffer
from gateway.tf.errors import InvalidTransformError
from gateway.tf.rigid import Rigid

# After the last lookup. A client that asks every few seconds, or reconnects, finds the buffer full.
# The unused subscriptions cost a few percent of a core at the usual 50 Hz.
LINGER_S: Final = 30.0
_DEPTH: Final = 100  # as in tf2's listeners
RETRY_S: Final = 0.02  # between attempts of a waiting lookup: /tf may come in many small messages
_MAX_WARNINGS: Final = 8  # on /rosout, for each kind of fault, about as many frames


class TfListener:
    """The two ROS subscriptions while they are needed, and the buffer that they fill.

    As in tf2, what moves is forgotten when simulated time jumps back.
    """

    def __init__(self, ros: Ros, types: TopicTypes) -> None:
        self.buffer = Buffer()
        self._ros = ros
        self._types = types
        self._followers: list[Callable[[], None]] = []
        self._open: list[RosSubscription | Watch] = []
        self._users = 0
        self._end: asyncio.TimerHandle | None = None
        self._news: asyncio.Event | None = None  # while a lookup waits for it
        self._warned: dict[str, set[str]] = {}  # by kind of fault, the subjects warned about

    def follow(self, on_change: Callable[[], None]) -> None:
        """Call *on_change* whenever an answer of the buffer may have changed."""
        self._followers.append(on_change)

    def acquire(self) -> None:
        """Listen until released, and for a while after.

        Raises:
            ProtocolError: tf2_msgs is not installed.
            RosError: ROS refuses the subscriptions.
        """
        if not self._open:
            self._subscribe()
        if self._end is not None:
            self._end.cancel()
            self._end = None
        self._users += 1

    def release(self) -> None:
        """Stop listening after `LINGER_S`, unless others need it."""
        self._users -= 1
        if not self._users and self._open:
            self._end = asyncio.get_running_loop().call_later(LINGER_S, self.close)

    def close(self) -> None:
        """End the subscriptions, and forget their transforms."""
        if self._end is not None:
            self._end.cancel()
            self._end = None
        for each in self._open:
            each.close()
        self._open.clear()
        self.buffer.forget()
        self._warned.clear()

    async def news(self, deadline: float) -> bool:
        """Wait for new transforms until *deadline*, in loop time. Return false if it had passed."""
        if asyncio.get_running_loop().time() >= deadline:
            return False
        if self._news is None:
            self._news = asyncio.Event()
        with contextlib.suppress(TimeoutError):
            async with timeout_at(deadline):
                await self._news.wait()
                await asyncio.sleep(RETRY_S)
        return True

    def _subscribe(self) -> None:
        try:
            message_type = self._types.get(TF_MESSAGE)
        except ProtocolError as error:
            raise ProtocolError(error.code, f"transforms need package tf2_msgs: {error}") from error
        # like tf2's own listeners, it needs transient local: static frames are published only once
        latched = Qos(durability="transient_local", depth=_DEPTH)
        for topic, qos, is_static in (
            ("/tf", Qos(depth=_DEPTH), False),
            ("/tf_static", latched, True),
        ):
            take = partial(self._on_samples, message_type, is_static)
            try:
                opened = self._ros.subscribe(topic, TF_MESSAGE, qos, take, self._on_event)
            except RosError:
                self.close()
                raise
            self._open.append(opened)
        self._open.append(self._ros.watch_jumps_back(self._on_jump_back))

    def _on_samples(
        self, message_type: MessageType, is_static: bool, samples: Sequence[Sample]
    ) -> None:
        before = self.buffer.revision
        heard_ns = time.monotonic_ns()
        for sample in samples:
            try:
                message: Any = message_type.decode(sample.cdr)
            except CodecError as error:
                self._warn("no message", "", f"{TF_MESSAGE}: {error}")
                continue
            for stamped in message["transforms"]:
                self._insert(stamped, heard_ns, is_static)
        if self.buffer.revision == before:
            return
        if self._news is not None:
            self._news.set()
            self._news = None
        self._report_change()

    def _on_jump_back(self) -> None:
        self.buffer.clear()
        self._report_change()

    def _report_change(self) -> None:
        for follower in self._followers:
            follower()

    def _insert(self, stamped: Mapping[str, Any], heard_ns: int, is_static: bool) -> None:
        header, child = stamped["header"], stamped["child_frame_id"]
        stamp = header["stamp"]
        transform = stamped["transform"]
        try:
            agrees = self.buffer.insert(
                child,
                header["frame_id"],
                stamp["sec"] * 1_000_000_000 + stamp["nanosec"],
                Rigid(*transform["translation"].values(), *transform["rotation"].values()),
                heard_ns=heard_ns,
                is_static=is_static,
            )
        except InvalidTransformError as error:
            self._warn(error.fault, error.frame, str(error))
            return
        if not agrees:
            text = (
                f"frame {child!r}: it is published as static and as moving, so it counts as moving"
            )
            self._warn("contradiction", child, text)

    def _on_event(self, event: TopicEvent) -> None:
        if event.code in {"type_conflict", "qos_incompatible"}:
            self._warn("incompatible", event.text, event.text)

    def _warn(self, fault: str, about: str, text: str) -> None:
        """Log a *fault*, one of a few kinds, once for each subject that it is *about*."""
        warned = self._warned.setdefault(fault, set())
        about = truncate(about)
        if about not in warned and len(warned) < _MAX_WARNINGS:
            warned.add(about)
            self._ros.diagnosis.log("warning", f"tf: {text}")
