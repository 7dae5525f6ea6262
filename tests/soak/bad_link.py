# SPDX-License-Identifier: Apache-2.0
"""A link of 2 Mbit/s, which can be cut: a network namespace and ``tc tbf``, or else a proxy.

The camera alone would take ten times as much.
"""

import asyncio
import contextlib
import signal
from collections.abc import AsyncIterator, Awaitable, Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from tests.soak.actor import acting
from tests.soak.isolation import is_isolated, run

BITS_PER_S: Final = 2_000_000
_NEAR, _FAR = "10.77.0.1", "10.77.0.2"


@dataclass(frozen=True)
class BadLink:
    """A link, and how to use it."""

    description: str
    url: str
    before: tuple[str, ...]
    """The command that runs a client at its far end."""
    cut: Callable[[bool], Awaitable[None]]
    """Cut it, or mend it."""


@contextlib.asynccontextmanager
async def bad_link(port: int) -> AsyncIterator[BadLink]:
    """Have a bad link to a port of this machine."""
    async with _namespace(port) if is_isolated() else _proxy(port) as link:
        yield link


@contextlib.asynccontextmanager
async def _namespace(port: int) -> AsyncIterator[BadLink]:
    # a process that keeps the other network alive, and names it
    holder = await asyncio.create_subprocess_exec(
        "unshare", "--net", "cat", stdin=asyncio.subprocess.PIPE
    )
    try:
        far = ("nsenter", "--net", "--target", str(holder.pid))
        await _until_apart(holder.pid)
        run(
            *("ip", "link", "add", "near", "type", "veth"),
            *("peer", "name", "far", "netns", str(holder.pid)),
        )
        run("ip", "address", "add", f"{_NEAR}/24", "dev", "near")
        run("ip", "link", "set", "near", "up")
        run(*far, "ip", "address", "add", f"{_FAR}/24", "dev", "far")
        run(*far, "ip", "link", "set", "far", "up")
        shape = ("tbf", "rate", str(BITS_PER_S), "burst", "16kb", "latency", "100ms")
        run("tc", "qdisc", "add", "dev", "near", "root", *shape)

        async def cut(is_cut: bool) -> None:
            run("ip", "link", "set", "near", "down" if is_cut else "up")

        words = "a network namespace of its own, 2 Mbit/s by tc tbf"
        yield BadLink(words, f"ws://{_NEAR}:{port}/", far, cut)
    finally:
        holder.kill()
        await holder.wait()


async def _until_apart(pid: int) -> None:
    """Wait until a process has a network of its own."""
    async with asyncio.timeout(60):
        while _network(pid) == _network("self"):  # noqa: ASYNC110  # of another process
            await asyncio.sleep(0.02)


def _network(pid: int | str) -> Path:
    return Path(f"/proc/{pid}/ns/net").readlink()


@contextlib.asynccontextmanager
async def _proxy(port: int) -> AsyncIterator[BadLink]:
    async with acting("throttle", "127.0.0.1", port, BITS_PER_S) as throttle:
        own_port = await throttle.ask("port")

        async def cut(is_cut: bool) -> None:
            throttle.signal(signal.SIGSTOP if is_cut else signal.SIGCONT)

        words = "a proxy on loopback that passes 2 Mbit/s on, as there is no network namespace"
        yield BadLink(words, f"ws://127.0.0.1:{own_port}/", (), cut)
