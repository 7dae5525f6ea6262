# SPDX-License-Identifier: Apache-2.0
"""The cost of the Unity client, under Mono: reading messages, and receiving them like a scene.

The frames are the gateway's; a server in this process sends them as fast as the client takes them,
or at a rate.
"""

import asyncio
import contextlib
import json
import subprocess
import tempfile
from pathlib import Path
from typing import Any, Final

from websockets.asyncio.server import ServerConnection, serve
from websockets.exceptions import ConnectionClosed
from websockets.protocol import State

from benchmarks.samples import SAMPLES
from gateway.codec.image import ImageOptions
from gateway.codec.json import dumps
from gateway.codec.picture import picture_renderer
from gateway.codec.types import Types
from schemas.installed import InstalledDefinitions
from tests.unity import mono, package

_SOURCES: Final = Path(__file__).parent / "unity_client"
_PICTURE: Final = "picture, 640x480 JPEG"
_PICTURE_HZ: Final = 30
_SECONDS: Final = 6
_BATCH: Final = 64  # frames per write: Python alone would be the limit
_ENOUGH_BYTES: Final = 1024 * 1024  # waiting to be sent: the client is the limit
_POSE: Final = (
    b'{"header":{"stamp":{"sec":1700000000,"nanosec":123456789},"frame_id":"base_footprint"},'
    b'"pose":{"position":{"x":1.2345678901234567,"y":-0.9876543210987654,"z":0.010000000149011612},'
    b'"orientation":{"x":1.1102230246251565e-16,"y":0.0,"z":0.7071067811865475,"w":0.7071067811865476}}}'
)


def main() -> None:
    """Print the table."""
    if reason := mono.missing():
        print(reason)
        return
    program = mono.compile_assembly(
        "unity-benchmark.exe",
        sorted(_SOURCES.glob("*.cs")),
        references=[package.compiled("Ros2Gateway.Core", package.STANDALONE)],
    )
    print("\nThe Unity client under Mono")
    messages = _messages()
    for name, (message_type, text) in messages.items():
        result = _read(program, message_type, text)
        print(f"{name:36}{result['us']:10.1f} us to read {result['bytes']} bytes")
    flood = asyncio.run(_received(program, "geometry_msgs/msg/PoseStamped", _POSE, 0))
    print(f"{f'frames of {len(_frame(_POSE))} bytes':36}{flood['received_per_s']:10.0f} /s at most")
    message_type, text = messages[_PICTURE]
    picture = asyncio.run(_received(program, message_type, text, _PICTURE_HZ))
    print(
        f"{f'that picture at {_PICTURE_HZ} Hz':36}{picture['cpu_percent']:10.1f} % of a core, "
        f"main thread {picture['main_thread_us_per_frame']:.0f} us per frame"
    )


def _messages() -> dict[str, tuple[str, bytes]]:
    """Return the types and the JSON of the messages to read."""
    types = Types(InstalledDefinitions())
    decode = types.get("nav_msgs/msg/Odometry").decode
    odometry = dumps(decode(bytes(SAMPLES["odometry"].cdr())))
    render = picture_renderer(types.get("sensor_msgs/msg/Image"), ImageOptions())
    ranges = [round(0.12 + 0.004 * i, 4) for i in range(720)]
    scan = json.dumps({"ranges": ranges, "intensities": []}, separators=(",", ":"))
    both = json.dumps({"ranges": ranges, "intensities": ranges}, separators=(",", ":"))
    return {
        "pose": ("geometry_msgs/msg/PoseStamped", _POSE),
        "odometry": (
            "nav_msgs/msg/Odometry",
            odometry,
        ),
        "laser scan, 720 rays": ("sensor_msgs/msg/LaserScan", scan.encode()),
        "laser scan, 720 and intensities": ("sensor_msgs/msg/LaserScan", both.encode()),
        _PICTURE: (
            "sensor_msgs/msg/CompressedImage",
            render(bytes(SAMPLES["image"].cdr())),
        ),
    }


def _read(program: mono.Binary, message_type: str, text: bytes) -> dict[str, Any]:
    with tempfile.NamedTemporaryFile(suffix=".json") as file:
        file.write(text)
        file.flush()
        return _result(
            subprocess.run(
                mono.command(program, "read", message_type, file.name),
                env=mono.environment(program),
                stdout=subprocess.PIPE,
                timeout=120,
                check=True,
            ).stdout
        )


async def _received(
    program: mono.Binary, message_type: str, text: bytes, rate_hz: float
) -> dict[str, Any]:
    frame = _frame(text)

    async def send(client: ServerConnection) -> None:
        async for operation in client:
            if '"subscribe"' in str(operation):
                break
        while client.state is State.OPEN:
            if rate_hz:
                with contextlib.suppress(ConnectionClosed):
                    await client.send(frame, text=True)
                await asyncio.sleep(1 / rate_hz)
            else:
                if client.transport.get_write_buffer_size() < _ENOUGH_BYTES:
                    client.transport.write(_websocket(frame) * _BATCH)
                await asyncio.sleep(0)

    async with serve(send, "127.0.0.1", 0, compression=None) as server:
        url = f"ws://127.0.0.1:{next(iter(server.sockets)).getsockname()[1]}"
        process = await asyncio.create_subprocess_exec(
            *mono.command(program, "receive", message_type, url, str(_SECONDS)),
            env=mono.environment(program),
            stdout=subprocess.PIPE,
        )
        async with asyncio.timeout(120):
            output, _ = await process.communicate()
    return _result(output)


def _frame(text: bytes) -> bytes:
    return b'{"op":"publish","topic":"/benchmark","msg":' + text + b"}"


def _websocket(payload: bytes) -> bytes:
    """Frame a text of 126 to 65535 bytes (RFC 6455, section 5.2)."""
    return b"\x81\x7e" + len(payload).to_bytes(2, "big") + payload


def _result(output: bytes) -> dict[str, Any]:
    result: dict[str, Any] = json.loads(output)
    return result


if __name__ == "__main__":
    main()
