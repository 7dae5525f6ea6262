# SPDX-License-Identifier: Apache-2.0
"""A link of little bandwidth, for machines without a separate network.

``HOST PORT BITS_PER_S``: a proxy on loopback that passes on so many bits per second from the
server, with small buffers. Orders: ``port``.
"""

import asyncio
import contextlib
import os
import socket
import sys
from typing import Final

from benchmarks.actors.orders import obey, reply

_CHUNK_BYTES: Final = 4096
_BUFFER_BYTES: Final = 16 * 1024  # of the kernel: else it would hide the slowness from the server


async def _pass(
    reader: asyncio.StreamReader, writer: asyncio.StreamWriter, bits_per_s: float
) -> None:
    with contextlib.suppress(OSError):
        while chunk := await reader.read(_CHUNK_BYTES):
            if bits_per_s:
                await asyncio.sleep(len(chunk) * 8 / bits_per_s)
            writer.write(chunk)
            await writer.drain()
    writer.close()


async def main(host: str, port: int, bits_per_s: float) -> None:
    """Pass bytes on until the end of stdin."""
    loop = asyncio.get_running_loop()
    over = asyncio.Event()

    async def both(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        near = socket.socket()
        near.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFER_BYTES)
        near.setblocking(False)
        try:
            await loop.sock_connect(near, (host, port))
        except OSError:
            writer.close()
            return
        far_reader, far_writer = await asyncio.open_connection(sock=near, limit=_BUFFER_BYTES)
        await asyncio.gather(_pass(reader, far_writer, 0), _pass(far_reader, writer, bits_per_s))

    server = await asyncio.start_server(both, "127.0.0.1", 0)
    listening = server.sockets[0].getsockname()[1]
    obey({"port": lambda: listening}, lambda: loop.call_soon_threadsafe(over.set))
    reply("ready")
    await over.wait()
    os._exit(0)  # the rest of its data is of no interest


if __name__ == "__main__":
    asyncio.run(main(sys.argv[1], int(sys.argv[2]), float(sys.argv[3])))
