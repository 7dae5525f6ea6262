# SPDX-License-Identifier: Apache-2.0
"""The way of a sample from DDS to the socket: short enough to be read in one go."""

import asyncio
import re
import sys
from collections.abc import AsyncIterator
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

import pytest

import gateway
from gateway.codec.types import Types
from gateway.config.limits import Limits
from schemas.installed import InstalledDefinitions
from tests.client import client
from tests.gateway_here import gateway_here
from tests.sources.outside import Outside

SCAN = "sensor_msgs/msg/LaserScan"
ROOT = str(Path(gateway.__file__).parent)
MAX_CALLS = 12
MAX_FILES = 6


class Way:
    """The functions of the gateway that run from taking a sample until the socket's `write`."""

    def __init__(self) -> None:
        self.calls: list[CodeType] = []
        self.is_over = False

    def __call__(self, frame: FrameType, event: str, argument: Any) -> None:
        code = frame.f_code
        if event != "call" or self.is_over:
            return
        is_reading = code.co_filename.endswith("samples.py") and not self.calls
        if code.co_name == "write" and self.calls:
            self.is_over = True
        elif (is_reading or self.calls) and code.co_filename.startswith((ROOT, "<CDR")):
            self.calls.append(code)

    @property
    def files(self) -> list[str]:
        """The files in order. Generated code belongs to none."""
        found = (code.co_filename for code in self.calls if code.co_filename.startswith(ROOT))
        return list(dict.fromkeys(found))


@pytest.fixture
async def url() -> AsyncIterator[str]:
    async with gateway_here(Limits(max_clients=2, max_clients_per_address=2)) as url:
        yield url


def documented() -> list[str]:
    """Return the calls that the page lists."""
    page = (Path(ROOT).parent / "docs/contributing/data-paths.md").read_text("utf-8")
    table = page.partition("<!-- the way of a sample -->")[2].partition("\n\n")[0]
    return re.findall(r"^\| `([^`]+)`", table, re.MULTILINE)


async def test_a_sample_reaches_the_socket_in_few_calls_over_few_files(url: str, outside: Outside):
    types = Types(InstalledDefinitions())
    scan = types.get(SCAN)
    cdr = scan.encode({"ranges": [1.0] * 360}, now_ns=0)
    publisher = outside.add_publisher("/scan", SCAN)
    async with client(url) as listener:
        await listener.send(op="subscribe", topic="/scan", type=SCAN)
        await listener.sync()
        messages = asyncio.create_task(listener.message("/scan"))
        while not messages.done():  # until it is discovered, and all that is needed compiled
            publisher.publish(cdr)
            await asyncio.wait([messages], timeout=0.1)
        await listener.sync()
        way = Way()
        sys.setprofile(way)
        try:
            publisher.publish(cdr)
            await listener.message("/scan")
        finally:
            sys.setprofile(None)
    told = "\n".join(f"{Path(code.co_filename).name}: {code.co_qualname}" for code in way.calls)
    assert way.is_over, told
    assert [code.co_qualname for code in way.calls] == documented(), told
    assert len(way.calls) <= MAX_CALLS, told
    assert len(way.files) <= MAX_FILES, told
