# SPDX-License-Identifier: Apache-2.0
"""Pictures and clouds of a topic that several encodings share: a sample is compressed once."""

import threading
from collections.abc import Callable

from gateway.codec.cdr import Cdr
from gateway.codec.cloud import CloudOptions, cloud_renderer
from gateway.codec.grid_picture import GRID, grid_renderer
from gateway.codec.image import ImageOptions
from gateway.codec.picture import picture_renderer
from gateway.codec.picture_message import PictureMessage
from gateway.codec.types import MessageType

Render = Callable[[Cdr], PictureMessage]


class TopicPictures:
    """The pictures, or thinned clouds, of one topic, by their options."""

    def __init__(self) -> None:
        self._open: dict[ImageOptions | CloudOptions, SharedPictures] = {}

    def open(
        self, message_type: MessageType, options: ImageOptions | CloudOptions
    ) -> "SharedPictures":
        """Return the pictures with these options for one more encoding, which closes them."""
        found = self._open.get(options)
        if found is None:
            if isinstance(options, CloudOptions):
                render = cloud_renderer(message_type, options)
            elif message_type.name == GRID:
                render = grid_renderer(message_type)
            else:
                render = picture_renderer(message_type, options)
            found = self._open[options] = SharedPictures(render, lambda: self._open.pop(options))
        found.encodings += 1
        return found


class SharedPictures:
    """Compresses each sample once, for all encodings that want the same picture of it.

    In the workers, one compresses a sample, and others that want the same wait for it.
    """

    def __init__(self, render: Render, on_last: Callable[[], object]) -> None:
        self.encodings = 0
        self._render = render
        self._on_last = on_last
        self._lock = threading.Lock()
        self._newest: tuple[Cdr, PictureMessage] | None = None

    def encoder(self, to_message: Callable[[PictureMessage], bytes]) -> Callable[[Cdr], bytes]:
        """Return a function for a worker, from CDR to the message of one encoding."""
        return lambda cdr: to_message(self._picture(cdr))

    def close(self) -> None:
        """End one encoding. Nothing is kept for a single one."""
        self.encodings -= 1
        self._newest = None
        if not self.encodings:
            self._on_last()

    def _picture(self, cdr: Cdr) -> PictureMessage:
        if self.encodings == 1:
            return self._render(cdr)
        with self._lock:
            newest = self._newest
            if newest is None or newest[0] is not cdr:
                newest = self._newest = (cdr, self._render(cdr))
            return newest[1]
