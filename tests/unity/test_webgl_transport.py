# SPDX-License-Identifier: Apache-2.0
"""The transport of WebGL builds as the client uses it: C# under Mono, JavaScript under Node."""

import asyncio
import contextlib
import shutil
from asyncio.subprocess import PIPE
from collections.abc import Awaitable, Callable

import pytest
from websockets.asyncio.server import ServerConnection, serve
from websockets.exceptions import ConnectionClosed

from tests.unity import mono, package
from tests.unity.mono import Binary
from tests.unity.webgl import page

pytestmark = pytest.mark.skipif(
    bool(mono.missing()) or shutil.which("node") is None,
    reason=mono.missing() or "node is missing",
)


@pytest.fixture(scope="module")
def probe() -> Binary:
    runtime = package.CLIENT / "Runtime"
    # The declarations for wasm are what the page's stand-in replaces.
    sources = [
        *sorted((runtime / "Core" / "Transport").glob("ITransport*.cs")),
        runtime / "Unity" / "WebGL" / "WebGlTransport.cs",
        *sorted(page.HERE.glob("*.cs")),
    ]
    return mono.compile_assembly("TransportProbe.exe", sources, defines=["UNITY_WEBGL"])


async def run(
    probe: Binary, url: str, max_message_bytes: int = 2**20, frames: int = 0
) -> list[str]:
    arguments = (url, str(max_message_bytes), str(frames))
    process = await asyncio.create_subprocess_exec(
        *mono.command(probe, *arguments),
        env=mono.environment(probe) | {"WEBGL_PAGE_ARGUMENTS": " ".join(page.command()[1:])},
        stdout=PIPE,
    )
    try:
        async with asyncio.timeout(page.TIMEOUT_S):
            output, _ = await process.communicate()
    finally:
        if process.returncode is None:
            process.kill()
    assert process.returncode == 0
    return output.decode().splitlines()


async def meet(
    probe: Binary,
    behaviour: Callable[[ServerConnection], Awaitable[None]],
    max_message_bytes: int = 2**20,
    frames: int = 0,
) -> list[str]:
    async with serve(behaviour, "127.0.0.1", 0, max_size=None, compression=None) as server:
        url = f"ws://127.0.0.1:{server.sockets[0].getsockname()[1]}"
        return (await run(probe, url, max_message_bytes, frames))[:-1]


async def test_everything_is_told_in_order_and_the_end_once(probe):
    async def speak(connection: ServerConnection) -> None:
        for text in ("first", "x" * 200_000, "x" * 400_001, "世界 🤖", ""):
            await connection.send(text)
        await connection.close(4503, "a slow consumer")

    assert await meet(probe, speak, max_message_bytes=400_000) == [
        "open",
        "frame first",
        "frame 200000 bytes",
        "oversized 400001",
        "frame 世界 🤖",
        "frame ",
        "closed 4503 a slow consumer",
    ]


async def test_the_listener_may_close_from_within_a_call(probe):
    async def speak(connection: ServerConnection) -> None:
        await connection.send("close")
        await connection.wait_closed()

    assert await meet(probe, speak) == ["open", "frame close", "closed 4001 as told"]


async def test_nothing_is_told_after_dispose(probe):
    async def speak(connection: ServerConnection) -> None:
        with contextlib.suppress(ConnectionClosed):
            for text in ("dispose", "not heard", "nor this"):
                await connection.send(text)
        await connection.wait_closed()

    assert await meet(probe, speak) == ["open", "frame dispose"]


async def test_frames_leave_one_by_one_and_many_in_a_poll(probe):
    received: list[str | bytes] = []

    async def listen(connection: ServerConnection) -> None:
        async for frame in connection:
            received.append(frame)
            if len(received) == 100:
                await connection.close()

    async with serve(listen, "127.0.0.1", 0) as server:
        url = f"ws://127.0.0.1:{server.sockets[0].getsockname()[1]}"
        *told, over = await run(probe, url, frames=100)
    assert told == ["open", "closed 1000 "]
    assert received == ["x" * 20_000] * 100
    assert int(over.split()[3]) > 1


async def test_a_refused_connection_is_closed_without_having_been_open(probe):
    async with serve(lambda connection: connection.close(), "127.0.0.1", 0) as server:
        url = f"ws://127.0.0.1:{server.sockets[0].getsockname()[1]}"
    told = await run(probe, url)
    assert told[:-1] == ["closed 0 cannot connect, the browser does not tell why"]
