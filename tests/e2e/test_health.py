# SPDX-License-Identifier: Apache-2.0
"""The health of a gateway as people start it."""

import asyncio
import json
import os
import signal
import urllib.error
import urllib.request
from pathlib import Path
from typing import Any

from tests.client import TIMEOUT_S
from tests.gateway_process import GatewayProcess, gateway_process


def health(gateway: GatewayProcess, path: str = "/healthz") -> tuple[int, dict[str, Any]]:
    url = gateway.url.replace("ws://", "http://").rstrip("/") + path
    try:
        with urllib.request.urlopen(url, timeout=TIMEOUT_S) as response:  # noqa: S310  # ours
            return response.status, json.load(response)
    except urllib.error.HTTPError as error:
        with error:
            return error.code, json.load(error)


def guard_of(gateway: GatewayProcess) -> int | None:
    pid = gateway.process.pid
    for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split():
        if b"gateway.guard" in Path(f"/proc/{child}/cmdline").read_bytes():
            return int(child)
    return None


async def wait_for_status(gateway: GatewayProcess, status: str) -> dict[str, Any]:
    async with asyncio.timeout(TIMEOUT_S):
        while True:
            code, found = await asyncio.to_thread(health, gateway)
            if found["status"] == status:
                assert (code, found["ready"]) == (200, True)
                return found
            await asyncio.sleep(0.02)


async def test_without_its_guard_it_is_ready_and_says_that_control_is_refused():
    async with gateway_process("serve") as gateway:
        found = await wait_for_status(gateway, "starting")
        assert found["reasons"][0].startswith("no robot can be driven yet")
        await wait_for_status(gateway, "ok")
        for path in ("/healthz", "/healthz/live", "/healthz/ready"):
            code, found = await asyncio.to_thread(health, gateway, path)
            assert (code, found["status"], found["reasons"]) == (200, "ok", [])
        guard = guard_of(gateway)
        assert guard is not None
        os.kill(guard, signal.SIGKILL)
        found = await wait_for_status(gateway, "degraded")
        (reason,) = found["reasons"]
        assert reason.startswith("the guard process has ended: commands to move are refused")
        await wait_for_status(gateway, "ok")
        assert guard_of(gateway) not in {None, guard}


# Below the gateway, as a fault of ROS would: of its context, and of a callback of its node.
FALLEN = """
import signal
from gateway.sources.rclpy.port import RclpyRos

start = RclpyRos.__init__

def __init__(self, *arguments):
    start(self, *arguments)
    signal.signal(signal.SIGRTMIN, lambda *_: self._debug.context.try_shutdown())

RclpyRos.__init__ = __init__
"""


async def test_if_ros_shuts_down_below_it_another_start_is_asked_for(tmp_path, monkeypatch):
    (tmp_path / "sitecustomize.py").write_text(FALLEN)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    async with gateway_process("serve") as gateway:
        assert (await asyncio.to_thread(health, gateway))[0] == 200
        gateway.process.send_signal(signal.SIGRTMIN)
        async with asyncio.timeout(TIMEOUT_S):
            while (await asyncio.to_thread(health, gateway, "/healthz/live"))[0] == 200:  # noqa: ASYNC110
                await asyncio.sleep(0.02)
        for path in ("/healthz", "/healthz/live", "/healthz/ready"):
            code, found = await asyncio.to_thread(health, gateway, path)
            assert (code, found["live"], found["ready"]) == (503, False, False)
            assert "ROS has shut down below the gateway: it must be restarted" in found["reasons"]
        assert await gateway.stop(signal.SIGTERM) == 0
