# SPDX-License-Identifier: Apache-2.0
"""The example of adding-a-front.md: a gateway that speaks lines, started by the command line."""

import subprocess
import sys
from pathlib import Path

from websockets.asyncio.client import connect

from tests.gateway_process import gateway_process

SOURCE = "tests.sources.replayed:open_source"
FRONT = "tests.fronts.lines:LineFront"
EXAMPLE = Path(__file__).parents[1] / "fronts" / "lines.py"


async def test_a_client_watches_a_topic_by_lines():
    parts = ("--source", SOURCE, "--front", FRONT)
    async with (
        gateway_process("serve", *parts, module="tests.without_rclpy") as gateway,
        connect(gateway.url, proxy=None) as socket,
    ):
        await socket.send("watch /battery")
        assert (await socket.recv()).startswith("ok topic /battery: ")
        assert (await socket.recv()).startswith('/battery {"percent":')
        await socket.send("unwatch /battery")
        await socket.send("unwatch /battery")
        while (line := await socket.recv()).startswith("/battery "):
            pass
        assert line == "error not subscribed to /battery"
        await socket.send("stop")
        assert await socket.recv() == 'ok stop {"topics":[]}'
        await socket.send("dance")
        assert await socket.recv() == "error expected watch TOPIC, unwatch TOPIC, or stop"


def test_an_unknown_front_is_refused():
    command = (sys.executable, "-m", "tests.without_rclpy", "serve", "--source", SOURCE)
    ended = subprocess.run(
        (*command, "--front", "tests.fronts.lines:Nothing"),
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 2
    assert "--front: unknown front 'tests.fronts.lines:Nothing'" in ended.stderr


def test_the_example_stays_short():
    assert len(EXAMPLE.read_text(encoding="utf-8").splitlines()) <= 200
