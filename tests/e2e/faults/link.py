# SPDX-License-Identifier: Apache-2.0
"""A link that can be cut: it passes bytes on until this process is stopped by SIGSTOP.

While it is stopped, the kernels on both sides keep what is sent, as they do over a dead radio link.
When it continues, all of that arrives at once.
"""

import asyncio
import contextlib
import sys


async def passing(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    with contextlib.suppress(OSError):
        while data := await reader.read(65536):
            writer.write(data)
            await writer.drain()
    writer.close()


async def main(host: str, port: int) -> None:
    async def both(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            far_reader, far_writer = await asyncio.open_connection(host, port)
        except OSError:
            writer.close()
            return
        await asyncio.gather(passing(reader, far_writer), passing(far_reader, writer))

    server = await asyncio.start_server(both, "127.0.0.1", 0)
    sys.stdout.write(f"{server.sockets[0].getsockname()[1]}\n")
    sys.stdout.flush()
    await server.serve_forever()


if __name__ == "__main__":
    with contextlib.suppress(KeyboardInterrupt):
        asyncio.run(main(sys.argv[1], int(sys.argv[2])))
