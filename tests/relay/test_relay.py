# SPDX-License-Identifier: Apache-2.0
"""Many robots behind one port: each at its path, while it is there."""

import contextlib
import signal

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

from tests.client import client
from tests.gateway_process import gateway_process
from tests.relay.conftest import Relay, open_relay

AT_ONCE = ("--set", "relay.drain_s=0")


async def test_a_robot_with_an_uplink_is_served_at_its_path_and_by_its_name(relay: Relay):
    uplink = ("--uplink", relay.router.address, "--robot-name", "r1")
    async with gateway_process("demo", "--recorded", "--no-browser", *uplink):
        await relay.until("r1")
        for url in (f"{relay.url}/r1/", f"{relay.url}/r1", f"{relay.url}/?robot=r1"):
            async with client(url) as viewer:
                await viewer.send(op="subscribe", topic="/odom")
                assert (await viewer.message("/odom"))["child_frame_id"] == "base_footprint"
        assert (await relay.health())["robots"]["r1"]["status"] == "ok"
        status, _ = await relay.get("/r1/healthz/ready")
        assert status == 200
        _, picture = await relay.get("/r1/stream_viewer?topic=/camera/image_raw")
        assert "stream?topic=/camera/image_raw" in picture


async def test_pages_know_their_robot(relay: Relay):
    with contextlib.closing(relay.robot("r1")):
        await relay.until("r1")
        _, page = await relay.get("/r1/drive", Accept="text/html")
        assert 'content="/r1/"' in page
        assert 'src="/r1/drive/main.js"' in page
        assert (await relay.get("/r1/drive/main.js"))[0] == 200
        _, listed = await relay.get("/", Accept="text/html")
        assert '<a href="/r1/">r1</a>' in listed
        assert await relay.get("/") == (200, "/r1/\n")


async def test_a_robot_that_nobody_knows_is_not_found(relay: Relay):
    assert await relay.get("/r9/") == (
        404,
        "nothing is at this path: connect the WebSocket to /ROBOT/\n",
    )
    for path in ("/r9/", "/", "/?robot=r9"):
        with pytest.raises(InvalidStatus, match="404"):
            async with client(f"{relay.url}{path}"):
                pass


async def test_so_many_robots_are_served_and_the_next_one_when_one_has_gone():
    async with open_relay(*AT_ONCE, "--set", "relay.max_robots=2") as relay:
        with contextlib.ExitStack() as stack:
            for name in ("r1", "r2"):
                stack.enter_context(contextlib.closing(relay.robot(name)))
            await relay.until("r1", "r2")
            stack.enter_context(contextlib.closing(relay.robot("r3")))

            health = await relay.until_health(lambda health: bool(health["reasons"]))
            assert health["reasons"] == [
                "2 robots are served, the maximum (relay.max_robots), and others not"
            ]
            assert health["status"] == "degraded"


async def test_names_that_are_paths_of_the_relay_or_no_names_are_left_out(relay: Relay):
    with contextlib.ExitStack() as stack:
        for name in ("metrics", "Upper", "x" * 33, "r1"):
            stack.enter_context(contextlib.closing(relay.robot(name)))
        await relay.until("r1")
        assert any("metrics cannot be served" in line for line in relay.process.log)


async def test_a_relay_that_ends_says_so_first_and_serves_on():
    async with open_relay("--set", "relay.drain_s=600") as relay:
        with contextlib.closing(relay.robot("r1")):
            await relay.until("r1")
            async with client(f"{relay.url}/r1/") as viewer:
                await viewer.sync()
                relay.process.process.send_signal(signal.SIGTERM)
                health = await relay.until_health(lambda health: not health["ready"])
                assert health["reasons"] == ["the relay is shutting down: connect to another one"]
                assert (await relay.get("/healthz/ready"))[0] == 503
                await viewer.sync()
                relay.process.process.send_signal(signal.SIGTERM)  # the second one ends it now
                with pytest.raises(ConnectionClosed, match="1001"):
                    await viewer.receive(lambda _: False)
