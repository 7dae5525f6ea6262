# SPDX-License-Identifier: Apache-2.0
"""A gateway whose process has no file descriptors left."""

import asyncio
import contextlib
import resource
import signal
import socket
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from tests.client import client
from tests.gateway_process import GatewayProcess, gateway_process

STRING = "std_msgs/msg/String"


def descriptors(pid: int) -> list[int]:
    return [int(path.name) for path in Path(f"/proc/{pid}/fd").iterdir()]


def cpu_ticks(pid: int) -> int:
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return int(fields[11]) + int(fields[12])


@contextlib.contextmanager
def no_descriptors_left(gateway: GatewayProcess) -> Iterator[None]:
    """Allow no further descriptor, and occupy those that are free among the old ones."""
    pid, port = gateway.process.pid, urlsplit(gateway.url).port
    limits = resource.prlimit(pid, resource.RLIMIT_NOFILE)
    resource.prlimit(pid, resource.RLIMIT_NOFILE, (max(descriptors(pid)) + 1, limits[1]))
    with contextlib.ExitStack() as sockets:
        for _ in range(10):
            sockets.enter_context(socket.create_connection(("127.0.0.1", port or 0)))
        yield
    resource.prlimit(pid, resource.RLIMIT_NOFILE, limits)


@pytest.mark.parametrize("has_uvloop", [True, False])
async def test_clients_stay_and_newcomers_wait_until_descriptors_return(
    has_uvloop: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    if not has_uvloop:
        (tmp_path / "uvloop.py").write_text("raise ImportError")
        monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    async with gateway_process("serve", "--set", "limits.open_timeout_s=1") as gateway:
        async with client(gateway.url) as stays:
            await stays.sync()
            with no_descriptors_left(gateway):
                await stays.send(op="subscribe", topic="/a", type=STRING)
                status = await stays.status()
                assert status["code"] in {"internal", "bad_type"}
                before = cpu_ticks(gateway.process.pid)
                for _ in range(20):
                    await asyncio.sleep(0.1)  # of which a busy loop would use each
                    assert await stays.sync() == []
                assert cpu_ticks(gateway.process.pid) - before < 100  # of 200
            await stays.send(op="subscribe", topic="/a", type=STRING)
            assert await stays.sync() == []
            async with client(gateway.url) as newcomer:
                await newcomer.sync()
        assert await gateway.stop(signal.SIGTERM) == 0
    log = "".join(gateway.log)
    assert "Traceback" not in log
    assert len(gateway.log) < 60
