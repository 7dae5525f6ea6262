# SPDX-License-Identifier: Apache-2.0
"""A link of 2 Mbit/s, which can be cut: a network namespace and ``tc tbf``, or else a proxy.

The camera alone would take ten times as much.
"""

import asyncio
import contextlib
import json
import signal
from collections.abc import AsyncIterator, Awaitable, Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from tests.e2e.faults import scene
from tests.soak.isolation import is_isolated, run

BITS_PER_S: Final = 2_000_000
_NEAR, _FAR = "10.77.0.1", "10.77.0.2"


_NOWHERE: Final = "02:00:00:00:00:99"  # a MAC address that nobody has


@dataclass(frozen=True)
class BadLink:
    """A link, and how to use it."""

    description: str
    url: str
    before: tuple[str, ...]
    """The command that runs a client at its far end."""
    cut: Callable[[bool], Awaitable[None]]
    """Cut it, or mend it."""


@dataclass(frozen=True)
class FarNetwork:
    """A second network namespace, at the far end of a pair of interfaces."""

    enter: tuple[str, ...]
    near_mac: str
    far_mac: str

    def cut(self, is_cut: bool) -> None:
        """Let nothing arrive, or mend it. The interfaces stay: DDS would see them go."""
        near_mac, far_mac = (_NOWHERE, _NOWHERE) if is_cut else (self.near_mac, self.far_mac)
        permanent = ("nud", "permanent")
        run("ip", "neigh", "replace", _FAR, "lladdr", far_mac, "dev", "near", *permanent)
        run(
            *(*self.enter, "ip", "neigh", "replace", _NEAR),
            *("lladdr", near_mac, "dev", "far", *permanent),
        )


@contextlib.asynccontextmanager
async def far_network() -> AsyncIterator[FarNetwork | None]:
    """Make it, if this process has a separate network.

    To be called before anybody uses DDS: Fast DDS recognises processes of the same machine by its
    addresses, and talks to the others by UDP, which loses pictures.
    """
    if not is_isolated():
        yield None
        return
    # a process that keeps the network alive, and names it
    holder = await asyncio.create_subprocess_exec(
        "unshare", "--net", "cat", stdin=asyncio.subprocess.PIPE
    )
    try:
        await _until_apart(holder.pid)
        enter = ("nsenter", "--net", "--target", str(holder.pid))
        run(
            *("ip", "link", "add", "near", "type", "veth"),
            *("peer", "name", "far", "netns", str(holder.pid)),
        )
        run("ip", "address", "add", f"{_NEAR}/24", "dev", "near")
        run("ip", "link", "set", "near", "up")
        run(*enter, "ip", "address", "add", f"{_FAR}/24", "dev", "far")
        run(*enter, "ip", "link", "set", "far", "up")
        shape = ("tbf", "rate", str(BITS_PER_S), "burst", "16kb", "latency", "100ms")
        run("tc", "qdisc", "add", "dev", "near", "root", *shape)
        near_mac = _mac("ip", "-json", "link", "show", "near")
        yield FarNetwork(enter, near_mac, _mac(*enter, "ip", "-json", "link", "show", "far"))
    finally:
        holder.kill()
        await holder.wait()


@contextlib.asynccontextmanager
async def bad_link(port: int, far: FarNetwork | None) -> AsyncIterator[BadLink]:
    """Have a bad link to a port of this machine."""
    if far is None:
        async with _proxy(port) as link:
            yield link
        return

    async def cut(is_cut: bool) -> None:
        far.cut(is_cut)

    words = "a separate network namespace, 2 Mbit/s by tc tbf"
    yield BadLink(words, f"ws://{_NEAR}:{port}/", far.enter, cut)


@contextlib.asynccontextmanager
async def _proxy(port: int) -> AsyncIterator[BadLink]:
    async with scene.link(port) as (proxy, url):

        async def cut(is_cut: bool) -> None:
            proxy.send_signal(signal.SIGSTOP if is_cut else signal.SIGCONT)

        yield BadLink("a proxy of any rate, as there is no network namespace", url, (), cut)


async def _until_apart(pid: int) -> None:
    """Wait until a process has a separate network."""
    async with asyncio.timeout(60):
        while _network(pid) == _network("self"):  # noqa: ASYNC110  # of another process
            await asyncio.sleep(0.02)


def _network(pid: int | str) -> Path:
    return Path(f"/proc/{pid}/ns/net").readlink()


def _mac(*command: str) -> str:
    return str(json.loads(run(*command))[0]["address"])
