# SPDX-License-Identifier: Apache-2.0
"""The example of adding-a-source.md: a gateway without rclpy, started by the command line."""

import asyncio
import contextlib
import subprocess
import sys
from collections.abc import AsyncIterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from gateway.sources.source import Source
from tests.client import client, eventually
from tests.e2e.test_health import health
from tests.gateway_process import gateway_process
from tests.sources.replayed import RECORDING, Recorded, ReplaySource

SOURCE = "tests.sources.replayed:open_source"
EXAMPLE = Path(__file__).parents[1] / "sources" / "replayed.py"


async def test_a_client_of_rosbridge_gets_what_is_replayed_without_rclpy():
    # which concerns nodes: this source carries the definition
    arguments = ("serve", "--source", SOURCE, "--set", "types.ask_nodes=false")
    async with (
        gateway_process(*arguments, module="tests.without_rclpy") as gateway,
        client(gateway.url) as watching,
    ):
        await watching.send(op="subscribe", topic="/battery")
        seen = [await watching.message("/battery") for _ in range(3)]
        assert [each["percent"] for each in seen] in ([9, 8, 9], [8, 9, 8])
        await watching.send(op="call_service", id="t", service="/rosapi/topics")
        answer = await watching.receive(lambda frame: frame["op"] == "service_response")
        assert answer["values"]["topics"] == ["/battery"]
        for operation, part in (
            ({"op": "call_service", "service": "/reboot"}, "services"),
            ({"op": "publish", "topic": "/cmd_vel", "msg": {}}, "publishing"),
        ):
            await watching.send(**operation, id=part)
            refusal = await watching.receive(lambda frame: frame.get("id") == part)  # noqa: B023  # awaited here
            assert f"this source has no {part}: " in str(refusal)


def test_an_unknown_source_is_refused():
    for name in ("tests.sources.replayed", "tests.sources.replayed:nothing", "no_module:open", ""):
        command = (sys.executable, "-m", "tests.without_rclpy", "serve", "--source", name)
        ended = subprocess.run(command, capture_output=True, text=True, check=False)
        assert ended.returncode == 2
        assert f"--source: unknown source '{name}'" in ended.stderr
        assert "name it as MODULE:FUNCTION" in ended.stderr


class Broken(ReplaySource):
    """A source whose task fails at its first sample."""

    def deliver(self, *_: Recorded) -> None:
        raise ZeroDivisionError("the recording is broken")


@contextlib.asynccontextmanager
async def open_broken(*_: object) -> AsyncIterator[ReplaySource]:
    source = Broken({})
    playing = asyncio.create_task(source.play(RECORDING), name="play")
    yield source
    playing.cancel()


async def test_a_task_of_the_source_that_fails_is_logged_and_makes_the_gateway_unhealthy():
    source = f"{__name__}:open_broken"
    parts = ("--source", source, "--set", "types.ask_nodes=false")
    async with gateway_process("serve", *parts, module="tests.without_rclpy") as gateway:
        await eventually(lambda: "the recording is broken" in "".join(gateway.log))
        code, found = await asyncio.to_thread(health, gateway)
    text = "task play of the source has failed, ZeroDivisionError"
    assert text in "".join(gateway.log)
    assert (code, found["status"]) == (503, "dead")
    assert f"{text}: it must be restarted" in str(found)


class WithoutClock(Source):  # type: ignore[misc]  # that is the point
    """Inherits what it does not write from the interface, where it does nothing."""


class WithoutCalls(ReplaySource):
    """Has a part, but not all of it."""

    services = SimpleNamespace(connect_service=None)  # type: ignore[assignment]


def open_named(source: Any) -> Any:
    return lambda *_: contextlib.nullcontext(source)


open_without_clock = open_named(WithoutClock())
open_without_calls = open_named(WithoutCalls({}))


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("open_without_clock", ("WithoutClock does not have", "now_ns", "source:Source")),
        ("open_without_calls", ("SimpleNamespace does not have", "services:Services")),
    ],
)
def test_a_source_that_lacks_a_method_is_refused_at_the_start(name: str, words: tuple[str, ...]):
    command = (sys.executable, "-m", "tests.without_rclpy", "serve", "--source")
    ended = subprocess.run(
        (*command, f"{__name__}:{name}"), capture_output=True, text=True, check=False
    )
    assert ended.returncode == 2
    assert all(each in ended.stderr for each in words), ended.stderr
    assert "Traceback" not in ended.stderr


def test_the_example_stays_short():
    assert len(EXAMPLE.read_text(encoding="utf-8").splitlines()) <= 200
