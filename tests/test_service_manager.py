# SPDX-License-Identifier: Apache-2.0
"""The reports to systemd, read from the socket that systemd would have."""

import asyncio
import os
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from gateway.service_manager import reporting_to_systemd
from tests.gateway_process import STARTUP_S, gateway_process

WATCHDOG_US = "30000"


class Systemd:
    """Reads the reports of a service."""

    def __init__(self, address: str) -> None:
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)
        self.socket.bind(address.replace("@", "\0", 1))
        self.environment = {"NOTIFY_SOCKET": address}

    async def hears(self, state: str) -> None:
        async with asyncio.timeout(STARTUP_S):
            while await asyncio.get_running_loop().sock_recv(self.socket, 4096) != state.encode():
                pass

    def rest(self) -> list[bytes]:
        reports = []
        while True:
            try:
                reports.append(self.socket.recv(4096))
            except BlockingIOError:
                return reports


@pytest.fixture(params=["file", "abstract"])
def systemd(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Systemd]:
    is_file = request.param == "file"
    systemd = Systemd(str(tmp_path / "notify") if is_file else f"@ros2_gateway_{os.getpid()}")
    yield systemd
    systemd.socket.close()


async def test_a_service_reports_that_it_lives_is_ready_and_ends(systemd: Systemd):
    with reporting_to_systemd(systemd.environment | {"WATCHDOG_USEC": WATCHDOG_US}) as ready:
        for _ in range(3):
            await systemd.hears("WATCHDOG=1")
        systemd.rest()
        ready()
        assert systemd.rest() == [b"READY=1"]
    assert systemd.rest() == [b"STOPPING=1"]
    await asyncio.sleep(int(WATCHDOG_US) / 1e6)
    assert systemd.rest() == []


@pytest.mark.parametrize(
    "watchdog", [{}, {"WATCHDOG_USEC": "?"}, {"WATCHDOG_USEC": WATCHDOG_US, "WATCHDOG_PID": "1"}]
)
async def test_nothing_is_fed_without_a_watchdog_of_this_process(systemd: Systemd, watchdog):
    with reporting_to_systemd(systemd.environment | watchdog):
        await asyncio.sleep(int(WATCHDOG_US) / 1e6)
        assert systemd.rest() == []


async def test_nothing_is_reported_where_nobody_asks_or_listens(tmp_path: Path):
    for environment in ({}, {"NOTIFY_SOCKET": str(tmp_path / "gone")}):
        with reporting_to_systemd(environment) as ready:
            ready()


async def test_a_gateway_is_ready_for_systemd_once_it_serves(systemd: Systemd, monkeypatch):
    # systemd sets the process for which it waits, and bash keeps the number for what it executes
    for name, value in (systemd.environment | {"WATCHDOG_USEC": "1000000"}).items():
        monkeypatch.setenv(name, value)
    async with gateway_process() as gateway:
        await systemd.hears("READY=1")
        await systemd.hears("WATCHDOG=1")
        assert await gateway.stop() == 0
        await systemd.hears("STOPPING=1")
