# SPDX-License-Identifier: Apache-2.0
"""The example of adding-a-front.md: a gateway that speaks lines, started by the command line."""

import subprocess
import sys
from pathlib import Path

import pytest
from websockets.asyncio.client import connect

from gateway.core.errors import StatusCode
from gateway.core.peer import Peer
from gateway.core.router import Router
from gateway.transport.front import ClientSession
from tests.fronts.lines import LineFront, LineSession
from tests.gateway_process import gateway_process

SOURCE = "tests.sources.replayed:open_source"
FRONT = "tests.fronts.lines:LineFront"
EXAMPLE = Path(__file__).parents[1] / "fronts" / "lines.py"


def refused(*fronts: str) -> str:
    """Return what the gateway prints that does not start with these fronts."""
    options = [option for front in fronts for option in ("--front", front)]
    command = (sys.executable, "-m", "tests.without_rclpy", "serve", "--source", SOURCE, *options)
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ended.returncode == 2
    return ended.stderr


async def test_clients_of_two_fronts_get_a_topic_each_in_its_own_form():
    parts = ("--source", SOURCE, "--front", FRONT)
    async with (
        gateway_process("serve", *parts, module="tests.without_rclpy") as gateway,
        connect(gateway.url, proxy=None) as rosbridge,
        connect(gateway.url, proxy=None, subprotocols=["other", "lines", "ros2-gateway"]) as socket,
    ):
        assert (rosbridge.subprotocol, socket.subprotocol) == (None, "lines")
        await rosbridge.send('{"op":"subscribe","topic":"/battery"}')
        frame = '{"op":"publish","topic":"/battery","msg":{"percent":'
        assert (await rosbridge.recv()).startswith(frame)
        await socket.send("watch /battery")
        assert await socket.recv() == "ok subscribed to /battery (replay_msgs/msg/Battery)"
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
    text = "--front: unknown front 'tests.fronts.lines:Nothing'"
    assert text in refused("tests.fronts.lines:Nothing")


def test_two_fronts_with_one_subprotocol_are_refused():
    text = f"--front: {FRONT} and {FRONT} both have subprotocol 'lines': leave out one of them"
    assert text in refused(FRONT, FRONT)


class WithoutReceive:
    """A front that forgets to read."""

    subprotocols = ("silent",)

    def __init__(self, _: Router) -> None: ...

    def open(self, _: Peer) -> LineSession:
        raise AssertionError("it is refused before")

    def rejection(self, _: StatusCode, __: str) -> bytes:
        return b""


class WithoutWarnings(LineFront):
    """A front whose sessions cannot warn."""

    def open(self, peer: Peer) -> LineSession:
        class Terse(LineSession):
            warn = ClientSession.warn  # which is abstract

        return Terse(self._core, peer)


@pytest.mark.parametrize(
    ("front", "lacks"),
    [
        ("WithoutReceive", "does not have receive: add what gateway.transport.front:Front asks"),
        ("WithoutWarnings", "cannot open a session, "),
    ],
)
def test_a_front_that_lacks_a_method_is_refused_at_the_start(front: str, lacks: str):
    text = refused(f"{__name__}:{front}")
    assert f"--front: {__name__}:{front} {lacks}" in text
    assert "Traceback" not in text
    assert front != "WithoutWarnings" or "warn" in text


def test_the_example_stays_short():
    assert len(EXAMPLE.read_text(encoding="utf-8").splitlines()) <= 200
