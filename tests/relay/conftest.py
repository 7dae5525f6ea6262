# SPDX-License-Identifier: Apache-2.0
"""A relay as people start it, behind a real router of Zenoh in this process."""

import asyncio
import contextlib
import json
import urllib.error
import urllib.request
from collections.abc import AsyncIterator, Callable
from typing import Any
from urllib.parse import urlsplit

import pytest

from tests.gateway_process import GatewayProcess, gateway_process
from tests.sources.zenoh.outside import Router, client

SERVED_S = 120


class RelayedRobot:
    """The token of an uplink that is connected. A relay sees no more of it."""

    def __init__(self, router: str, name: str) -> None:
        self._session = client(router)
        self._alive = self._session.liveliness().declare_token(f"gw/{name}/alive")

    def close(self) -> None:
        self._session.close()


class Relay:
    """A relay that runs."""

    def __init__(self, router: Router, process: GatewayProcess) -> None:
        self.router = router
        self.process = process
        self.url = process.url.rstrip("/")
        self.port = urlsplit(self.url).port

    def robot(self, name: str) -> RelayedRobot:
        return RelayedRobot(self.router.address, name)

    async def get(self, path: str, **headers: str) -> tuple[int, str]:
        """Return the status and the text at a path."""
        return await asyncio.to_thread(self._get, path, headers)

    async def health(self, path: str = "/healthz") -> dict[str, Any]:
        _, text = await self.get(path)
        return json.loads(text)

    async def until(self, *names: str) -> None:
        """Wait until exactly these robots are served."""

        def are_served(health: dict[str, Any]) -> bool:
            robots = health["robots"]
            return [*robots] == sorted(names) and all("clients" in each for each in robots.values())

        await self.until_health(are_served)

    async def until_health(self, is_right: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        """Wait until the health is as expected, and return it."""
        async with asyncio.timeout(SERVED_S):
            while not is_right(health := await self.health()):  # noqa: ASYNC110  # of a process
                await asyncio.sleep(0.05)
        return health

    def _get(self, path: str, headers: dict[str, str]) -> tuple[int, str]:
        request = urllib.request.Request(f"http://127.0.0.1:{self.port}{path}", headers=headers)
        try:
            opened = urllib.request.urlopen(request, timeout=SERVED_S)  # noqa: S310  # ours
            with opened as response:
                return response.status, response.read().decode()
        except urllib.error.HTTPError as error:
            return error.code, error.read().decode()


@contextlib.asynccontextmanager
async def open_relay(*arguments: str) -> AsyncIterator[Relay]:
    with contextlib.closing(Router()) as router:
        async with gateway_process("relay", router.address, *arguments) as process:
            yield Relay(router, process)


@pytest.fixture
async def relay() -> AsyncIterator[Relay]:
    async with open_relay("--set", "relay.drain_s=0") as opened:
        yield opened
