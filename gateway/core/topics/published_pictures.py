# SPDX-License-Identifier: Apache-2.0
"""Pictures that clients publish as an Image or a map: worker threads turn them into pixels."""

import asyncio
import time
from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import replace
from functools import partial
from typing import Final, NamedTuple

from gateway.codec.error_text import CodecError
from gateway.codec.grid_picture import GRID, grid_maker
from gateway.codec.picture import COMPRESSED_IMAGE, IMAGE, pixel_maker
from gateway.codec.types import MessageType
from gateway.core.errors import ProtocolError
from gateway.core.names import TopicName
from gateway.core.requests import Publish
from gateway.core.session import Session
from gateway.core.tasks import answered
from gateway.core.topic_types import TopicTypes
from gateway.sources.source import Ros

# of pictures as the gateway sends them, next to the fields of CompressedImage, not needed here
_OF_PICTURES: Final = frozenset({"width", "height", "depth_range_m"})


class PublishedPictures:
    """Has one picture decoded at a time, of the clients in turn: subscribers also need the workers.

    The newest picture of each topic waits, while all of a client fit in one message. Dropped
    pictures are counted with the other messages that newer ones replaced.
    """

    def __init__(self, ros: Ros, types: TopicTypes, workers: Executor) -> None:
        self._ros = ros
        self._types = types
        self._workers = workers
        self._turn = asyncio.Semaphore()
        self._waiting: dict[Session, dict[TopicName, _Picture]] = {}
        self._working: dict[Session, asyncio.Task[None]] = {}

    def check(self, message_type: MessageType) -> None:
        """Check that a topic of this type may be given pictures.

        Raises:
            ProtocolError: it is of neither images nor maps.
        """
        if message_type.name not in {IMAGE, GRID}:
            text = f"image: {message_type.name} is not an image type, use {IMAGE} or {GRID}"
            raise ProtocolError("bad_request", text)

    def publish(
        self,
        session: Session,
        topic: TopicName,
        message_type: MessageType,
        request: Publish,
        send: Callable[[bytes], None],
    ) -> None:
        """Call *send* with the CDR of the Image or map, as soon as there is one.

        Raises:
            ProtocolError: it is not a CompressedImage, or not a map with a PNG as its data.
        """
        is_map = message_type.name == GRID
        compressed_type = message_type if is_map else self._types.get(COMPRESSED_IMAGE)
        msg = request.msg
        if isinstance(msg, dict):
            of_pictures = _OF_PICTURES | {"format"} if is_map else _OF_PICTURES
            msg = {name: value for name, value in msg.items() if name not in of_pictures}
        try:
            cdr = compressed_type.encode(msg, self._ros.now_ns)
        except CodecError as error:
            raise ProtocolError("invalid_value", str(error)) from error
        waiting = self._waiting.setdefault(session, {})
        replaced = waiting.pop(topic, None)
        session.count_replaced(replaced is not None)
        # without the message: it is as long as its CDR
        waiting[topic] = _Picture(replace(request, msg=None), is_map, cdr, send)
        while sum(len(each.cdr) for each in waiting.values()) > session.limits.max_message_bytes:
            del waiting[next(iter(waiting))]
            session.count_replaced(1)
        if session not in self._working:
            self._working[session] = asyncio.create_task(self._work(session, waiting))

    def forget(self, session: Session, topic: TopicName) -> None:
        """Drop the picture that waits for a topic."""
        self._waiting.get(session, {}).pop(topic, None)

    def leave(self, session: Session) -> None:
        """Drop all pictures of a client."""
        self._waiting.pop(session, None)
        working = self._working.pop(session, None)
        if working is not None:
            working.cancel()

    async def _work(self, session: Session, waiting: "dict[TopicName, _Picture]") -> None:
        while waiting:
            picture = waiting.pop(next(iter(waiting)))
            await answered(session, picture.request, partial(self._deliver, session, picture))
        del self._working[session]

    async def _deliver(self, session: Session, picture: "_Picture") -> None:
        if picture.is_map:
            make = grid_maker(self._types.get(GRID))
        else:
            make = pixel_maker(self._types.get(COMPRESSED_IMAGE), self._types.get(IMAGE))
        loop = asyncio.get_running_loop()
        async with self._turn:
            try:
                cdr = await loop.run_in_executor(self._workers, make, picture.cdr)
            except CodecError as error:
                raise ProtocolError("invalid_value", f"msg.data: {error}") from error
        start_s = time.monotonic()
        picture.send(cdr)
        now_s = time.monotonic()
        session.turns.spend(now_s - start_s, now_s)


class _Picture(NamedTuple):
    request: Publish
    is_map: bool
    cdr: bytes  # of the CompressedImage, or of the map with the PNG as its cells
    send: Callable[[bytes], None]
