# SPDX-License-Identifier: Apache-2.0
"""A client that subscribes to all topics of the load and comes back after a lost connection.

``URL [--meta] [--echo PORT]`` as arguments. With ``--meta`` it compares the numbers of the samples
that it did not get with those that the gateway says it has dropped. With the port of an echo it
measures round trips, of the gateway and of the echo in turns. Orders: ``count``, ``report``.
"""

import argparse
import asyncio
import contextlib
import time
from typing import Any, Final

import orjson
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, WebSocketException

from benchmarks.actors.orders import obey, reply
from tests.soak.drops import Drops
from tests.soak.load import NUMBERS, TOPICS, subscribe
from tests.soak.sequence import Sequence
from tests.soak.silences import Silences

_RETURN_S: Final = 0.5
_PING_S: Final = 0.1
_ENDS_KEPT: Final = 1000


class Listener:
    """The record of one client."""

    def __init__(self, url: str, *, meta: bool) -> None:
        self._url = url
        self._meta = meta
        self._pongs: dict[int, asyncio.Future[None]] = {}
        self.silences = {topic.name: Silences() for topic in TOPICS}
        self.sequence = Sequence()
        self.drops = {topic.name: Drops() for topic in TOPICS}
        self.connections = 0
        self.ends: list[str] = []
        self.statuses: dict[str, int] = {}
        self.round_trips: list[tuple[float, float, float]] = []
        self._socket: ClientConnection | None = None

    async def stay(self) -> None:
        """Be connected forever."""
        while True:
            with contextlib.suppress(OSError, WebSocketException, TimeoutError):
                await self._be_connected()
            await asyncio.sleep(_RETURN_S)

    async def _be_connected(self) -> None:
        async with connect(
            f"{self._url}?status=warning", compression=None, proxy=None, max_size=None
        ) as socket:
            self.connections += 1
            self.sequence.connect()
            for drops in self.drops.values():
                drops.connect()
            for topic in TOPICS:
                await socket.send(orjson.dumps(subscribe(topic, meta=self._meta)).decode())
            self._socket = socket
            try:
                while True:
                    self._take(await socket.recv(decode=False))
            except ConnectionClosed as error:
                self.ends = [*self.ends, str(error)][-_ENDS_KEPT:]
            finally:
                self._socket = None

    def _take(self, text: bytes) -> None:
        frame = orjson.loads(text)
        match frame["op"]:
            case "publish":
                self._hear(frame)
            case "pong":
                if waiting := self._pongs.pop(frame["id"], None):
                    waiting.set_result(None)
            case "status":
                code = str(frame.get("code"))
                self.statuses[code] = self.statuses.get(code, 0) + 1

    def _hear(self, frame: dict[str, Any]) -> None:
        name = frame["topic"]
        self.silences[name].hear(time.monotonic())
        if self._meta:
            self.drops[name].add(frame["seq"], frame["dropped"])
        if name == NUMBERS.name:
            self.sequence.add(frame["msg"]["data"])

    async def measure(self, port: int) -> None:
        """Measure round trips forever: when, of the gateway, of the echo, in seconds."""
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        number = 0
        while True:
            await asyncio.sleep(_PING_S)
            socket = self._socket
            if socket is None:
                continue
            number += 1
            text = orjson.dumps({"op": "ping", "id": number}).decode()
            self._pongs[number] = asyncio.get_running_loop().create_future()
            sent_s = time.monotonic()
            with contextlib.suppress(WebSocketException, TimeoutError):
                async with asyncio.timeout(60):
                    await socket.send(text)
                    await self._pongs[number]
                back_s = time.monotonic()
                writer.write(text.encode() + b"\n")
                await reader.readline()
                self.round_trips.append((sent_s, back_s - sent_s, time.monotonic() - back_s))

    def report(self) -> dict[str, Any]:
        """Return everything."""
        return {
            "heard": {name: one.count for name, one in self.silences.items()},
            "gaps": {name: one.so_far() for name, one in self.silences.items()},
            "sequence": self.sequence.as_json(),
            "drops": {name: one.as_json() for name, one in self.drops.items()},
            "connections": self.connections,
            "ends": self.ends,
            "statuses": self.statuses,
            "round_trips": self.round_trips,
        }


async def main() -> None:
    """Listen until the end of stdin."""
    parser = argparse.ArgumentParser()
    parser.add_argument("url")
    parser.add_argument("--meta", action="store_true")
    parser.add_argument("--echo", type=int)
    arguments = parser.parse_args()
    loop = asyncio.get_running_loop()
    listener = Listener(arguments.url, meta=arguments.meta)
    over = asyncio.Event()

    def report() -> None:
        loop.call_soon_threadsafe(lambda: reply(listener.report()))

    def count() -> dict[str, int]:
        return {name: one.count for name, one in listener.silences.items()}

    obey({"report": report, "count": count}, lambda: loop.call_soon_threadsafe(over.set))
    tasks = [asyncio.create_task(listener.stay())]
    if arguments.echo:
        tasks.append(asyncio.create_task(listener.measure(arguments.echo)))
    reply("ready")
    await over.wait()
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)


if __name__ == "__main__":
    asyncio.run(main())
