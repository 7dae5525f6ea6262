# SPDX-License-Identifier: Apache-2.0
"""What renders the messages of a feed, for each way in which clients want them."""

from concurrent.futures import Executor

from gateway.codec import cbor
from gateway.codec.json import ascii_only, dumps
from gateway.codec.picture import cbor_picture_renderer, picture_renderer
from gateway.codec.png import text_as_png
from gateway.codec.types import MessageType
from gateway.ports import Ros
from gateway.protocol import messages
from gateway.protocol.publish_frames import envelope
from gateway.router.topic_types import TopicTypes
from gateway.router.topics.encoding import Render, Rendition, RenditionKey, ThreadedRendition
from gateway.router.topics.topic import Feed


class Renditions:
    """Makes renditions; what takes milliseconds is rendered by *workers*."""

    def __init__(self, ros: Ros, types: TopicTypes, workers: Executor) -> None:
        self._ros = ros
        self._types = types
        self._workers = workers

    def make(self, feed: Feed, key: RenditionKey) -> Rendition:
        """Return a rendition of a feed's messages."""
        message_type = self._types.get(feed.key.type_name)
        wrapping = envelope(key.topic, key.compression)
        match key.compression:
            case "cbor-raw":
                render: Render = self._raw
            case "cbor":
                render = _cbor(message_type, key)
            case "none":
                render = _json(message_type, key)
            case "png":
                render = _png(_json(message_type, key), key.topic)
        if key.image is None and key.compression != "png":
            return Rendition(key, wrapping, render, feed.on_codec_error)
        return ThreadedRendition(
            key,
            wrapping,
            render,
            feed.on_codec_error,
            workers=self._workers,
            on_ready=feed.wake_all,
        )

    def _raw(self, cdr: bytes) -> bytes:
        secs, nsecs = divmod(self._ros.now_ns(), 1_000_000_000)
        return cbor.dumps({"secs": secs, "nsecs": nsecs, "bytes": cdr})


def _json(message_type: MessageType, key: RenditionKey) -> Render:
    if key.image is not None:
        return picture_renderer(message_type, key.image)
    decode = message_type.decoder(key.fields)
    return lambda cdr: dumps(decode(cdr))


def _cbor(message_type: MessageType, key: RenditionKey) -> Render:
    if key.image is not None:
        return cbor_picture_renderer(message_type, key.image)
    return message_type.transcoder(key.fields)


def _png(render: Render, topic: str) -> Render:
    prefix = messages.publish_prefix(topic)
    return lambda cdr: text_as_png(
        ascii_only(b"".join((prefix, render(cdr), messages.PUBLISH_SUFFIX)))
    )
