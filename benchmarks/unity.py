# SPDX-License-Identifier: Apache-2.0
"""The cost of the Unity client, under Mono: reading messages, decoding pictures, receiving.

The frames are the gateway's. A server in this process sends them as fast as the client takes them,
or at a rate.
"""

import asyncio
import base64
import contextlib
import itertools
import json
import subprocess
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

import cv2
import numpy as np
from websockets.asyncio.server import ServerConnection, serve
from websockets.exceptions import ConnectionClosed
from websockets.protocol import State

from benchmarks.samples import SAMPLES
from gateway.backports import timeout
from gateway.codec import cbor
from gateway.codec.image import ImageOptions
from gateway.codec.json import dumps
from gateway.codec.picture import picture_renderer
from gateway.codec.types import Types
from schemas.installed import InstalledDefinitions
from tests.unity import mono, package
from tests.unity.mono import Binary

_SOURCES: Final = Path(__file__).parent / "unity_client"
_SECONDS: Final = 4
_BATCH: Final = 64  # frames per write: Python alone would be the limit
_ENOUGH_BYTES: Final = 1024 * 1024  # waiting to be sent: the client is the limit
# Its collections count what all threads allocate in small objects, to some kB per message. Large
# objects go past it, and stay while it is large: of clouds and pictures they alone are counted.
_NURSERY_BYTES: Final = 512 * 1024
_LARGE_NURSERY_BYTES: Final = 64 * 1024 * 1024
_LARGE_FRAME: Final = 16 * 1024  # bytes
_POSE: Final = (
    b'{"header":{"stamp":{"sec":1700000000,"nanosec":123456789},"frame_id":"base_footprint"},'
    b'"pose":{"position":{"x":1.2345678901234567,"y":-0.9876543210987654,"z":0.010000000149011612},'
    b'"orientation":{"x":1.1102230246251565e-16,"y":0.0,"z":0.7071067811865475,"w":0.7071067811865476}}}'
)

_Wire = Literal["json", "cbor"]
_WIRES: Final[tuple[_Wire, ...]] = ("json", "cbor")


@dataclass(frozen=True)
class _Message:
    name: str
    type: str
    json: bytes
    cbor: bytes
    rate_hz: float
    counting_hz: float = 0
    """Next to it, what is allocated is counted at this rate: as often as memory lasts."""
    others: "tuple[_Message, ...]" = ()
    """Others that are sent in turn with it."""

    def payload(self, wire: _Wire) -> bytes:
        return self.json if wire == "json" else self.cbor

    def frame(self, wire: _Wire) -> bytes:
        if wire == "json":
            return b'{"op":"publish","topic":"/benchmark","msg":' + self.json + b"}"
        head = (cbor.text(text) for text in ("op", "publish", "topic", "/benchmark", "msg"))
        return cbor.head(cbor.MAP, 3) + b"".join(head) + self.cbor


def main() -> None:
    """Print the tables."""
    if reason := mono.missing():
        print(reason)
        return
    library = package.compiled("Ros2Gateway.Displays.Core", package.STANDALONE)
    program = mono.compile_assembly(
        "unity-benchmark.exe",
        sorted(_SOURCES.glob("*.cs")),
        references=list(library.closure()),
    )
    messages = _messages()
    print("\nThe Unity client under Mono: us of CPU to read a message, new and filled again")
    for message in messages:
        for wire in _WIRES:
            result = _read(program, message, wire)
            print(
                f"{message.name:24}{wire:6}{result['bytes']:9} bytes"
                f"{result['us']:10.1f}{result['us_filled_anew']:10.1f}"
            )
    _decode(program)
    flood = asyncio.run(_received(program, messages[0], "json", "new", rate_hz=0))
    frame_bytes = len(messages[0].frame("json"))
    print(f"\nframes of {frame_bytes} bytes: {flood['received_per_s']:.0f} /s at most")
    print("\nreceived at a rate: % of a core, us of the main thread per frame; bytes per message")
    for message in messages[2:]:
        for wire in _WIRES:
            for objects in ("new", "reuse"):
                got = asyncio.run(_received(program, message, wire, objects, message.rate_hz))
                often = asyncio.run(_received(program, message, wire, objects, message.counting_hz))
                print(
                    f"{message.name:24}{wire:6}{objects:6}{message.rate_hz:4.0f} Hz"
                    f"{got['cpu_percent']:8.1f}{got['main_thread_us_per_frame']:8.1f}"
                    f"{often['allocated_per_message'] or float('nan'):12.0f}"
                    f" (of {often['received_per_s']:.0f} /s)",
                    flush=True,
                )


def _messages() -> list[_Message]:
    """Return the messages to read, as the gateway writes them."""
    types = Types(InstalledDefinitions())

    def of(
        name: str, type_name: str, cdr: bytes, rate_hz: float = 0, counting_hz: float = 0
    ) -> _Message:
        message_type = types.get(type_name)
        text = dumps(message_type.decode(cdr))
        return _Message(
            name, type_name, text, bytes(message_type.transcoder()(cdr)), rate_hz, counting_hz
        )

    def picture(quality: int, *others: _Message) -> _Message:
        render = picture_renderer(types.get("sensor_msgs/msg/Image"), ImageOptions(quality=quality))
        message = render(_cdr("image"))
        return _Message(
            "picture, 640x480 JPEG",
            "sensor_msgs/msg/CompressedImage",
            message.json(),
            message.cbor(),
            30,
            60,
            others,  # no two pictures of a camera are of one length
        )

    pose = bytes(types.get("geometry_msgs/msg/PoseStamped").encode(json.loads(_POSE), now_ns=0))
    return [
        of("pose", "geometry_msgs/msg/PoseStamped", pose),
        of("odometry", "nav_msgs/msg/Odometry", bytes(SAMPLES["odometry"].cdr())),
        of("laser scan, 720 rays", "sensor_msgs/msg/LaserScan", _cdr("laser-scan"), 10, 200),
        of("point cloud, 76,800", "sensor_msgs/msg/PointCloud2", _cdr("point-cloud"), 10, 10),
        picture(80, picture(81), picture(79)),
    ]


def _cdr(kind: str) -> bytes:
    return bytes(SAMPLES[kind].cdr())


def _read(program: Binary, message: _Message, wire: _Wire) -> dict[str, Any]:
    return _asked(program, "read", message.type, message.payload(wire), wire)


def _decode(program: Binary) -> None:
    """Compare the decoder with OpenCV's, libjpeg-turbo, for pictures of the gateway."""
    types = Types(InstalledDefinitions())
    render = picture_renderer(types.get("sensor_msgs/msg/Image"), ImageOptions())
    print("\nms of CPU to decode a JPEG, in C# and with OpenCV")
    for name in ("image", "image-1080p"):
        message = json.loads(render(_cdr(name)).json())
        jpeg = np.frombuffer(base64.b64decode(message["data"]), np.uint8)
        mine = _asked(program, "decode", None, jpeg.tobytes())["us"] / 1000
        theirs = min(_decoded_s(jpeg) for _ in range(50)) * 1000
        size = f"{message['width']}x{message['height']}"
        print(f"{size:24}{len(jpeg):15} bytes{mine:10.2f}{theirs:10.2f}")


def _decoded_s(jpeg: "np.ndarray[Any, np.dtype[np.uint8]]") -> float:
    begin = time.thread_time()
    cv2.imdecode(jpeg, cv2.IMREAD_COLOR)
    return time.thread_time() - begin


def _asked(
    program: Binary, what: str, type_name: str | None, payload: bytes, *others: str
) -> dict[str, Any]:
    with tempfile.NamedTemporaryFile() as file:
        file.write(payload)
        file.flush()
        arguments = [*([type_name] if type_name else []), file.name, *others]
        return _result(
            subprocess.run(
                mono.command(program, what, *arguments),
                env=mono.environment(program),
                stdout=subprocess.PIPE,
                timeout=120,
                check=True,
            ).stdout
        )


async def _received(
    program: Binary, message: _Message, wire: _Wire, objects: str, rate_hz: float
) -> dict[str, Any]:
    is_large = len(message.frame(wire)) > _LARGE_FRAME
    nursery = _LARGE_NURSERY_BYTES if is_large else _NURSERY_BYTES
    frames = itertools.cycle([one.frame(wire) for one in (message, *message.others)])

    async def send(client: ServerConnection) -> None:
        async for operation in client:
            if '"subscribe"' in str(operation):
                break
        while client.state is State.OPEN:
            if rate_hz:
                with contextlib.suppress(ConnectionClosed):
                    await client.send(next(frames), text=wire == "json")
                await asyncio.sleep(1 / rate_hz)
            else:
                if client.transport.get_write_buffer_size() < _ENOUGH_BYTES:
                    client.transport.write(_websocket(next(frames)) * _BATCH)
                await asyncio.sleep(0)

    async with serve(send, "127.0.0.1", 0, compression=None) as server:
        url = f"ws://127.0.0.1:{next(iter(server.sockets)).getsockname()[1]}"
        process = await asyncio.create_subprocess_exec(
            *mono.command(
                program, "receive", message.type, url, str(_SECONDS), objects, str(_NURSERY_BYTES)
            ),
            env={**mono.environment(program), "MONO_GC_PARAMS": f"nursery-size={nursery}"},
            stdout=subprocess.PIPE,
        )
        async with timeout(120):
            output, _ = await process.communicate()
    return _result(output)


def _websocket(payload: bytes) -> bytes:
    """Frame a text of 126 to 65535 bytes (RFC 6455, section 5.2)."""
    return b"\x81\x7e" + len(payload).to_bytes(2, "big") + payload


def _result(output: bytes) -> dict[str, Any]:
    result: dict[str, Any] = json.loads(output)
    return result


if __name__ == "__main__":
    main()
