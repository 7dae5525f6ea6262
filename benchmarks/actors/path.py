# SPDX-License-Identifier: Apache-2.0
"""The gateway's path from DDS to a socket, cut off behind one of its steps.

``SAMPLE COUNT`` as arguments: the gateway's own parts take COUNT of the `steps`. The gateway itself
adds routing, bounds and counters to all of them.
"""

import asyncio
import sys
from collections.abc import Callable, Sequence
from typing import Any, Final

import rclpy
import uvloop
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.signals import SignalHandlerOptions

from benchmarks.actors.audience import Audience
from benchmarks.actors.orders import obey, reply
from benchmarks.samples import SAMPLES, message_type, topic
from gateway.codec.cdr import Cdr
from gateway.codec.image import ImageOptions, compress, confine_to_calling_thread
from gateway.codec.image_encodings import RawImage
from gateway.codec.json import dumps
from gateway.codec.picture import picture_renderer
from gateway.codec.types import MessageType, Types
from gateway.fronts.rosbridge.publish_frames import JsonFrames
from gateway.memory import keep_large_blocks
from gateway.sources.rclpy.ready_events import ReadyEvents
from gateway.sources.rclpy.samples import Samples
from gateway.sources.source import Sample
from schemas.installed import InstalledDefinitions

_IMAGE: Final = "sensor_msgs/msg/Image"
_DEPTH: Final = 32  # as many as the gateway keeps
_RECEIVING: Final = ("reception by DDS", "waking the event loop", "taking by rclpy")

Work = Callable[[Cdr], object]


def steps(name: str) -> tuple[str, ...]:
    """Return the names of the steps for a sample."""
    is_image = message_type(name) == _IMAGE
    rendering = ("colours and JPEG", "base64 and JSON") if is_image else ("JSON",)
    return (*_RECEIVING, "decoding", *rendering, "framing", "writing to the socket")


async def main(name: str, count: int) -> None:
    """Take that many steps with every sample, until the end of stdin."""
    loop = asyncio.get_running_loop()
    over = asyncio.Event()
    obey({}, lambda: loop.call_soon_threadsafe(over.set))
    keep_large_blocks()
    confine_to_calling_thread()
    audience = Audience()
    url = await audience.listen()
    works = _works(name, audience)
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("benchmark_path")
    stop = _receive(node, loop, name, count, works)
    reply(url)
    await over.wait()
    stop()
    node.destroy_node()
    rclpy.shutdown()


def _receive(
    node: Node, loop: asyncio.AbstractEventLoop, name: str, count: int, works: Sequence[Work]
) -> Callable[[], object]:
    """Take *count* steps with every sample. Return the function that ends it."""
    message_class = type(SAMPLES[name].make())

    def create() -> Any:
        return node.create_subscription(message_class, topic(name), _nothing, _DEPTH, raw=True)

    if count == 1:
        create()
        return _nothing
    ready_events = ReadyEvents(loop)
    if count < len(_RECEIVING):
        return ready_events.open("subscription", create, node.destroy_subscription, _nothing).close
    work = works[count - len(_RECEIVING)]

    def on_samples(taken: Sequence[Sample]) -> None:
        for sample in taken:
            work(sample.cdr)

    samples = Samples(node, ready_events)
    return samples.read(message_class, topic(name), QoSProfile(depth=_DEPTH), on_samples).close


def _works(name: str, audience: Audience) -> list[Work]:
    """Return the work on a sample: for each step, that step and all before it."""
    known = Types(InstalledDefinitions()).get(message_type(name))
    decode: Callable[[Cdr], Any] = known.decoder(octets="raw")
    encoding: list[Work] = []
    if known.name == _IMAGE:
        encoding.append(lambda cdr: _encode(decode(cdr)))
        picture = picture_renderer(known, ImageOptions())
        render: Callable[[Cdr], bytes] = lambda cdr: picture(cdr).json()  # noqa: E731
    else:
        render = _json(known)
    shared = JsonFrames(topic(name)).shared
    return [
        _nothing,
        decode,
        *encoding,
        render,
        lambda cdr: shared(render(cdr)),
        lambda cdr: audience.write(shared(render(cdr))),
    ]


def _json(known: MessageType) -> Callable[[Cdr], bytes]:
    decode = known.decode
    return lambda cdr: dumps(decode(cdr))


def _encode(values: dict[str, Any]) -> object:
    return compress(RawImage(*(values[part] for part in RawImage._fields)), ImageOptions())


def _nothing(*_: object) -> None:
    """End here."""


if __name__ == "__main__":
    uvloop.run(main(sys.argv[1], int(sys.argv[2])))
