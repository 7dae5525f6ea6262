# SPDX-License-Identifier: Apache-2.0
"""The example with a fleet: robots, router, two relays, and a load balancer, by one script."""

import asyncio
import contextlib
import json
import os
import signal
import urllib.request

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

from tests.client import TIMEOUT_S, Client, client
from tests.fleet import Fleet, started

VIEWERS = 6


async def watch(url: str) -> None:
    """Get a message, sooner or later: a client tries again when its relay has ended."""
    async with asyncio.timeout(TIMEOUT_S):
        while True:
            try:
                async with client(url) as viewer:
                    await see(viewer)
                    return
            except (ConnectionClosed, InvalidStatus, OSError):
                await asyncio.sleep(0.1)


async def see(viewer: Client) -> None:
    await viewer.send(op="subscribe", topic="/odom")
    await viewer.message("/odom")


def address(fleet: Fleet, path: str) -> str:
    return f"{fleet.url.replace('http', 'ws')}{path}"


async def viewers_of(fleet: Fleet, robot: str) -> dict[str, int]:
    """Return the number of viewers of a robot at each relay."""
    counts = {}
    for name, url in fleet.relays.items():
        health = json.loads(await asyncio.to_thread(read, f"{url}/{robot}/healthz"))
        counts[name] = health["clients"]
    return counts


def read(url: str) -> bytes:
    with urllib.request.urlopen(url, timeout=TIMEOUT_S) as response:  # noqa: S310  # ours
        return bytes(response.read())


@pytest.mark.parametrize("balancer", ["haproxy", "nginx"])
async def test_viewers_of_a_robot_share_a_relay_and_find_the_other_one_when_theirs_ends(
    balancer: str,
):
    async with started(balancer, "--robots", "2") as fleet:
        for path in ("/r1/", "/?robot=r1", "/r2/"):
            await watch(address(fleet, path))
        before = await viewers_of(fleet, "r1")
        async with contextlib.AsyncExitStack() as stack:
            paths = ("/r1/", "/?robot=r1") * (VIEWERS // 2)
            opened = [
                await stack.enter_async_context(client(address(fleet, each))) for each in paths
            ]
            for viewer in opened:
                await see(viewer)
            after = await viewers_of(fleet, "r1")
            more = {name: count - before[name] for name, count in after.items()}
            assert sum(more.values()) == VIEWERS
            of_r1 = max(more, key=lambda name: more[name])
            # HAProxy passes some on when a relay has many more than the mean
            assert more[of_r1] >= (VIEWERS if balancer == "nginx" else VIEWERS / 2 + 1)
        await end(fleet.pids[of_r1])
        for path in ("/r1/", "/r2/"):
            await watch(address(fleet, path))


async def test_a_relay_that_is_marked_in_nginx_keeps_its_viewers_and_gets_no_further_ones():
    async with started("nginx") as fleet, client(address(fleet, "/r1/")) as first:
        await see(first)
        before = await viewers_of(fleet, "r1")
        draining = max(before, key=lambda name: before[name])
        other = next(name for name in before if name != draining)
        assert fleet.config is not None
        server = f"server {fleet.relays[draining].removeprefix('http://')}"
        text = fleet.config.read_text()
        assert server in text
        fleet.config.write_text(text.replace(server, f"{server} down"))
        os.kill(fleet.pids["nginx"], signal.SIGHUP)

        async def go_elsewhere() -> dict[str, int]:
            async with client(address(fleet, "/r1/")) as viewer:
                await see(viewer)
                return await viewers_of(fleet, "r1")

        async with asyncio.timeout(TIMEOUT_S):
            while (await go_elsewhere())[other] == before[other]:  # nginx reads it soon
                pass
        await see(first)
        os.kill(fleet.pids[draining], signal.SIGTERM)
        with pytest.raises(ConnectionClosed, match="1001"):
            await first.receive(lambda _: False)
        await watch(address(fleet, "/r1/"))


async def end(pid: int) -> None:
    """End a process, and wait until it is gone."""
    os.kill(pid, signal.SIGTERM)
    async with asyncio.timeout(TIMEOUT_S):
        with contextlib.suppress(ProcessLookupError):
            while True:
                os.kill(pid, 0)
                await asyncio.sleep(0.1)
