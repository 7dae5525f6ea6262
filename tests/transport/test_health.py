# SPDX-License-Identifier: Apache-2.0
"""The answers of /healthz, and their status."""

import asyncio
import json
from typing import Any

import pytest

from gateway.faults import Fault
from gateway.transport.health import LIVE, PATH, READY, Health, no_faults
from tests.client import client, eventually
from tests.transport.conftest import Serve, Served
from tests.transport.needs import needs_websockets_17
from tests.transport.test_server import get

DEAD = Fault("dead", "ROS has shut down")
NOT_READY = Fault("not ready", "callbacks hang")
DEGRADED = Fault("degraded", "no guard")


def asked(health: Health, path: str) -> tuple[int, dict[str, Any]]:
    status, text = health.page(path, lambda: {"clients": 3})
    return status, json.loads(text)


@pytest.mark.parametrize(
    ("faults", "status", "live", "ready"),
    [
        ((), "ok", 200, 200),
        ((DEGRADED,), "degraded", 200, 200),
        ((DEGRADED, NOT_READY), "not ready", 200, 503),
        ((NOT_READY, DEGRADED, DEAD), "dead", 503, 503),
    ],
)
def test_the_worst_fault_decides(faults, status, live, ready):
    health = Health(faults)
    for path, code in ((PATH, ready), (READY, ready), (LIVE, live)):
        found, body = asked(health, path)
        assert found == code
        assert (body["status"], body["live"], body["ready"]) == (status, live == 200, ready == 200)


def test_the_reasons_are_in_words_and_the_worst_is_first():
    _, body = asked(Health((DEGRADED, DEAD, NOT_READY)), READY)
    assert body["reasons"] == ["ROS has shut down", "callbacks hang", "no guard"]


def test_the_details_are_on_one_page_alone():
    assert asked(Health(), PATH)[1]["clients"] == 3
    for path in (LIVE, READY):
        assert set(asked(Health(), path)[1]) == {"status", "live", "ready", "reasons"}


def test_nothing_is_wrong_by_default():
    assert list(no_faults()) == []


async def health(served: Served, path: str = PATH, method: str = "GET") -> tuple[int, str]:
    status, _, body = await asyncio.to_thread(get, served, path, method)
    return status, body


@needs_websockets_17
@pytest.mark.parametrize("path", [PATH, LIVE, READY])
async def test_faults_reach_the_page_and_its_status(serve: Serve, path):
    faults: list[Fault] = []
    async with serve(find_faults=lambda: faults) as served:
        assert (await health(served, path))[0] == 200
        faults.append(DEAD)
        status, body = await health(served, path)
        assert (status, json.loads(body)["reasons"]) == (503, ["ROS has shut down"])
        assert await health(served, path, "HEAD") == (503, "")
        faults.clear()
        assert (await health(served, path))[0] == 200


async def test_there_are_no_other_pages(serve: Serve):
    async with serve() as served:
        assert (await health(served, "/healthz/"))[0] == 404
        assert (await health(served, "/healthz/dead"))[0] == 404


async def test_a_full_gateway_is_ready_and_says_that_it_is_full(serve: Serve):
    async with serve({"max_clients": 1}) as served:
        assert json.loads((await health(served))[1])["reasons"] == []
        async with client(served.url) as only:
            await only.sync()
            status, body = await health(served)
            found = json.loads(body)
            assert (status, found["status"], found["ready"]) == (200, "degraded", True)
            text = "1 clients are connected, the maximum: further clients are refused"
            assert found["reasons"] == [text]
        await eventually(lambda: served.clients == 0)
        assert json.loads((await health(served))[1])["status"] == "ok"


async def test_from_the_start_of_the_shutdown_connections_are_refused(serve: Serve):
    refused: list[OSError] = []
    async with serve() as served:
        close_all = served.server.connections.close

        async def ask_first(*which: Any) -> None:
            try:
                await asyncio.open_connection("127.0.0.1", served.port)
            except OSError as error:
                refused.append(error)
            await close_all(*which)

        served.server.connections.close = ask_first  # type: ignore[method-assign]
    assert len(refused) == 1
