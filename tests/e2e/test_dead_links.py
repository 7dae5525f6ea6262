# SPDX-License-Identifier: Apache-2.0
"""A link between two network namespaces that dies: the gateway finds it, whatever is on the way."""

import asyncio
import contextlib
import sys
from asyncio.subprocess import PIPE

import pytest

from benchmarks.two_networks import reason_against, two_networks
from tests.client import TIMEOUT_S, eventually
from tests.gateway_process import gateway_process

pytestmark = pytest.mark.skipif(reason_against() is not None, reason=str(reason_against()))

DEAD = "ended by the network"

# its messages from the near side are on the way to the far one whenever the link dies
TALKER = """
import json, sys, time
from websockets.sync.client import connect
message = {"op": "publish", "topic": "/t", "type": "std_msgs/String", "msg": {"data": "x"}}
with connect(sys.argv[1]) as socket:
    while True:
        socket.send(json.dumps(message))
        time.sleep(0.05)
"""


async def test_a_link_that_dies_ends_its_connections_whether_or_not_something_is_on_the_way():
    options = ("--no-auth", "--anyone-may-drive", "--set", "limits.ping_interval_s=3600")
    async with contextlib.AsyncExitStack() as stack:
        networks = stack.enter_context(two_networks())
        gateway = await stack.enter_async_context(
            gateway_process("serve", "--host", networks.url_host, *options, before=networks.near)
        )
        await run(stack, *networks.near, sys.executable, "-c", TALKER, gateway.url)
        for topic in ("-", "/t"):
            far = (*networks.far, sys.executable, "-m", "tests.e2e.far_friend", gateway.url, topic)
            friend = await run(stack, *far)
            assert friend.stdout is not None
            async with asyncio.timeout(TIMEOUT_S):
                assert await friend.stdout.readline() == b"ready\n"
        networks.cut(is_cut=True)
        await eventually(lambda: sum(DEAD in line for line in gateway.log) == 2)
        reasons = [line for line in gateway.log if DEAD in line]
        assert sum("nothing acknowledged for 10 s" in line for line in reasons) == 1


async def run(stack: contextlib.AsyncExitStack, *command: str) -> asyncio.subprocess.Process:
    """Run a command until the context ends."""
    process = await asyncio.create_subprocess_exec(*command, stdin=PIPE, stdout=PIPE)

    async def end() -> None:
        with contextlib.suppress(ProcessLookupError):
            process.kill()
        await process.wait()

    stack.push_async_callback(end)
    return process
