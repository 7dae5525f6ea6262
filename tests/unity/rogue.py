# SPDX-License-Identifier: Apache-2.0
"""A gateway that misbehaves, by the path that a client connects to. For tests of clients.

``/through`` is the exception: it passes everything on to a real gateway, until a client sends
``{"op":"cut"}`` and the line is cut. ``/assets`` serves meshes, some of which are refused, held
back or cut off, by their names.
"""

import asyncio
import base64
import contextlib
import itertools
import json
import re
import struct
from collections.abc import AsyncIterator, Awaitable, Callable
from typing import Any, Final

from websockets.asyncio.client import connect
from websockets.asyncio.server import ServerConnection, serve
from websockets.exceptions import ConnectionClosed

GOOD: Final = '{"op":"publish","topic":"/odom","msg":{"child_frame_id":"the good one"}}'
HUGE_BYTES: Final = 20_000_000
CHUNK_BYTES: Final = 256 * 1024

# Each is wrong in its own way, and comes before a good one.
BAD_FRAMES: Final = (
    "not json",
    "",
    "[]",
    "null",
    "{}",
    '{"op":7}',
    '{"op":"nonsense"}',
    '{"op":"publish"}',
    '{"op":"publish","topic":"/odom"}',
    '{"op":"publish","topic":"/odom","msg":null}',
    '{"op":"publish","topic":"/odom","msg":5}',
    '{"op":"publish","topic":"/odom","msg":{"pose":[1]}}',
    '{"op":"publish","topic":"/odom","msg":{"header":{"stamp":{"sec":null}}}}',
    '{"op":"publish","topic":"/odom","msg":{"pose":{"covariance":[1,2]}}}',
    '{"op":"publish","topic":"/odom","msg":{"child_frame_id":"cut of',
    '{"op":"publish","topic":"/odom","msg":{}} and more',
    '{"op":"publish","msg":{"child_frame_id":"nowhere"}}',
    '{"op":"publish","topic":"/elsewhere","msg":{}}',
    '{"op":"status"}',
    '{"op":"status","level":"error","msg":{"no":"text"}}',
    '{"op":"status","level":"error","msg":"words of the gateway","code":"bad_type","request":"subscribe"}',  # noqa: E501
    '{"op":"service_response"}',
    '{"op":"service_response","id":"r1","result":"yes"}',
    '{"op":"service_response","id":"unknown","values":{},"result":true}',
    '{"op":"action_result","id":"unknown","values":{},"result":true,"status":4}',
    '{"op":"action_feedback","id":"unknown"}',
    '{"op":"call_service"}',
    '{"op":"call_service","id":"c","service":"/not_ours","args":{}}',
    '{"op":"pong"}',
    '{"op":"pong","value":"yesterday","ros_time":7}',
    '{"op":"graph","topics":7}',
    '{"op":"graph","changes":[]}',
    '{"op":"publish","topic":"/odom","msg":' + "[" * 10_000 + "]" * 10_000 + "}",
)


RED_DAE: Final = """<COLLADA>
<library_effects><effect id="e"><profile_COMMON><technique><lambert><diffuse>
<color>1 0 0 1</color></diffuse></lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry><mesh>
<source id="s"><float_array id="f">0 0 1 1 0 1 0 2 1</float_array>
<technique_common><accessor source="#f" count="3" stride="3"/></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles material="m"><input semantic="VERTEX" source="#v"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries></COLLADA>"""


class Rogue:
    """The server of all paths. *Gateway* is where ``/through`` leads."""

    def __init__(self, gateway: str) -> None:
        self._gateway = gateway
        self._paths: dict[str, Callable[[ServerConnection], Awaitable[None]]] = {
            "/bad-frames": self._bad_frames,
            "/bad-text": self._bad_text,
            "/huge": self._huge,
            "/dies": self._dies,
            "/slow": self._slow,
            "/mute": self._mute,
            "/refuses": self._refuses,
            "/token": self._token,
            "/full": self._full,
            "/stops-reading": self._stops_reading,
            "/refuses-commands": self._refuses_commands,
            "/through": self._through,
            "/assets": self._assets,
        }
        self._cut_off = False

    async def serve(self, client: ServerConnection) -> None:
        """Live one connection."""
        with contextlib.suppress(ConnectionClosed):
            await self._paths[client.request.path.partition("?")[0]](client)

    async def _bad_frames(self, client: ServerConnection) -> None:
        await _subscribed(client)
        for frame in BAD_FRAMES:
            await client.send(frame)
        await client.send(GOOD)
        await client.wait_closed()

    async def _bad_text(self, client: ServerConnection) -> None:
        await _subscribed(client)
        frame = b'{"op":"publish","topic":"/odom","msg":{"child_frame_id":"\xc0\xaf"}}'
        await client.send(frame, text=True)
        await client.wait_closed()

    async def _huge(self, client: ServerConnection) -> None:
        await _subscribed(client)
        await client.send('{"op":"publish","topic":"/odom","msg":"' + "x" * HUGE_BYTES + '"}')
        await client.send(GOOD)
        await client.wait_closed()

    async def _dies(self, client: ServerConnection) -> None:
        await _subscribed(client)
        # a text frame of 1000 bytes, of which five come (RFC 6455, section 5.2)
        client.transport.write(b'\x81\x7e\x03\xe8{"op"')
        client.transport.close()

    async def _slow(self, client: ServerConnection) -> None:
        """Send one message, a piece at a time, as over a weak network."""
        await _subscribed(client)
        frame = GOOD.replace('"msg"', " " * 200_000 + '"msg"').encode()
        client.transport.write(b"\x81\x7f" + len(frame).to_bytes(8, "big"))
        for start in range(0, len(frame), 5000):
            client.transport.write(frame[start : start + 5000])
            await asyncio.sleep(0.05)
        await client.wait_closed()

    async def _mute(self, client: ServerConnection) -> None:
        async for _ in client:
            pass

    async def _refuses(self, client: ServerConnection) -> None:
        await client.close(4401, "the token is wrong")

    async def _token(self, client: ServerConnection) -> None:
        """Say which token the client sends, and refuse it."""
        frame = json.loads(await client.recv())
        token = frame["token"] if frame["op"] == "auth" else "none"
        await client.close(4401, f"the token is {token}")

    async def _full(self, client: ServerConnection) -> None:
        reason = "at most 32 clients"
        await client.send(json.dumps({"op": "status", "level": "error", "msg": reason}))
        await client.close(1013, reason)

    async def _stops_reading(self, client: ServerConnection) -> None:
        """Read nothing from the first message on until told how many came. Then echo the rest."""
        async for text in client:
            if json.loads(text)["op"] == "publish":
                client.transport.pause_reading()
                await asyncio.sleep(2)  # a stalled network
                client.transport.resume_reading()
                break
        async for text in client:
            frame = json.loads(text)
            if frame["op"] == "publish":
                frame["topic"] = "/echo"
                del frame["msg"]["padding"]
                await client.send(json.dumps(frame))
            elif frame["op"] == "ping":
                await client.send(json.dumps({"op": "pong", "value": frame["value"]}))

    async def _refuses_commands(self, client: ServerConnection) -> None:
        """Have lost the guard process, and forbid to publish on ``/forbidden``."""
        async for text in client:
            frame = json.loads(text)
            topic = frame.get("topic")
            answer = {"op": frame["op"], "id": frame.get("id"), "topic": topic}
            refusal = {"op": "status", "level": "error", "id": answer["id"], "request": frame["op"]}
            if frame["op"] == "ping":
                await client.send(json.dumps({"op": "pong", "value": frame["value"]}))
            elif frame["op"] == "control" and topic != "/forbidden":
                state = {"state": "stopped", "tripped": False, "cause": None, "holder": None}
                await client.send(json.dumps({**answer, **state, "guard": "lost"}))
            elif frame["op"] == "control":
                await client.send(json.dumps({**refusal, "msg": "no topic", "code": "not_found"}))
            elif frame["op"] == "publish" and topic == "/forbidden":
                reason = "you may not publish on /forbidden"
                await client.send(json.dumps({**refusal, "msg": reason, "code": "forbidden"}))

    async def _assets(self, client: ServerConnection) -> None:
        """Serve ``package://rogue/N.stl``, N triangles as high as the number of their fetch.

        ``held.stl`` is answered before the next fetch, ``cut.stl`` on every other connection,
        ``deadly.stl`` on none: with these the line is cut. ``busy.stl`` is refused once,
        ``missing.stl`` each time. ``red.dae`` is a red triangle.
        """
        fetches = 0
        held: list[str] = []
        refusals = {"missing.stl": 3, "busy.stl": 1}
        async for text in client:
            frame = json.loads(text)
            if frame["op"] == "ping":
                await client.send(json.dumps({"op": "pong", "value": frame["value"]}))
            if frame["op"] == "cut":
                client.transport.abort()
            if frame["op"] != "fetch_asset":
                continue
            name = frame["uri"].removeprefix("package://rogue/")
            fetches += frame["offset"] == 0
            if name == "cut.stl":
                self._cut_off = not self._cut_off
            if name == "deadly.stl" or (name == "cut.stl" and self._cut_off):
                client.transport.abort()
                return
            if refusals.get(name, 0) > 0:
                refusals[name] -= 1
                await client.send(json.dumps(_refused(frame)))
                continue
            answer = json.dumps(_asset(frame, name, fetches))
            if name == "held.stl":
                held.append(answer)
                continue
            for one in [*held, answer]:
                await client.send(one)
            held.clear()

    async def _through(self, client: ServerConnection) -> None:
        async with connect(self._gateway, max_size=None) as gateway, asyncio.TaskGroup() as group:
            back = group.create_task(_pass_on(gateway, client))
            with contextlib.suppress(ConnectionClosed):
                async for frame in client:
                    if b'"cut"' in (frame if isinstance(frame, bytes) else frame.encode()):
                        client.transport.abort()
                        break
                    if b'"stall"' in (frame if isinstance(frame, bytes) else frame.encode()):
                        await asyncio.sleep(2.5)
                        continue
                    await gateway.send(frame)
            back.cancel()


def _refused(frame: dict[str, Any]) -> dict[str, Any]:
    refusal = {"op": "status", "level": "error", "id": frame["id"], "request": "fetch_asset"}
    return {**refusal, "code": "not_found", "msg": f"there is no file {frame['uri']}"}


def _asset(frame: dict[str, Any], name: str, fetches: int) -> dict[str, Any]:
    if name == "red.dae":
        return _chunk(frame, RED_DAE.encode())
    number = re.fullmatch(r"(\d+)\.stl", name, re.IGNORECASE)
    count = int(number[1]) if number else 1
    corners = (0, 0, fetches), (1, 0, fetches), (0, 2, fetches)
    triangle = struct.pack("<12fH", 0, 0, 1, *itertools.chain(*corners), 0)
    stl = bytes(80) + struct.pack("<I", count) + triangle * count
    if name == "broken.stl":
        stl = stl[:-1]
    return _chunk(frame, stl)


def _chunk(frame: dict[str, Any], asset: bytes) -> dict[str, Any]:
    offset = frame["offset"]
    data = base64.b64encode(asset[offset : offset + CHUNK_BYTES]).decode()
    answer = {"op": "fetch_asset", "id": frame["id"], "uri": frame["uri"]}
    return {**answer, "offset": offset, "size": len(asset), "data": data}


async def _pass_on(gateway: object, client: ServerConnection) -> None:
    with contextlib.suppress(ConnectionClosed):
        async for frame in gateway:  # type: ignore[attr-defined]  # a connection of the other side
            await client.send(frame)


async def _subscribed(client: ServerConnection) -> None:
    async for text in client:
        if json.loads(text)["op"] == "subscribe":
            return


@contextlib.asynccontextmanager
async def rogue(gateway: str) -> AsyncIterator[str]:
    """Serve on a free port until the context ends. The value is the address, without path."""
    handler = Rogue(gateway).serve
    async with serve(handler, "127.0.0.1", 0, compression=None, max_size=None) as server:
        port = next(iter(server.sockets)).getsockname()[1]
        yield f"ws://127.0.0.1:{port}"


@contextlib.asynccontextmanager
async def deaf() -> AsyncIterator[str]:
    """Accept connections on a free port, and never say a word."""

    async def ignore(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        with contextlib.suppress(ConnectionError, asyncio.CancelledError):
            await reader.read()
        writer.close()

    async with await asyncio.start_server(ignore, "127.0.0.1", 0) as server:
        port = server.sockets[0].getsockname()[1]
        yield f"ws://127.0.0.1:{port}"
