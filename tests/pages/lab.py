# SPDX-License-Identifier: Apache-2.0
"""The lab page for tests: opened, waited for, and its robot sent somewhere."""

import contextlib
import math
from collections.abc import AsyncIterator, Awaitable, Callable
from typing import Any

from tests.client import Client
from tests.pages.conftest import OpenPage

SMALL = {"width": 640, "height": 360}  # WebGL is drawn by the processor
LATE_S = 120
# a busy machine may stop an approach, which then begins again
LATE = ("odometry", "stopped arriving", "arrived late", "disconnected")

KEEP = "() => import('/lab/main.js').then(({ lab }) => { window.lab = lab; })"
READY = "() => lab.twin.points > 0 && /^(Stopped|You may watch)/.test(control.textContent)"


@contextlib.asynccontextmanager
async def opened(
    open_page: OpenPage, address: str, chosen: str = "", **options: Any
) -> AsyncIterator[Any]:
    """Open the lab and enter once it shows the robot, with its parts as ``lab``.

    *chosen* is the part of the address that chooses topics.
    """
    async with open_page(f"{address}lab#{chosen}", viewport=SMALL, **options) as page:
        await page.evaluate(KEEP)
        await page.wait_for_function(READY)
        yield page


async def frames(page: Any, count: int = 4) -> None:
    """Wait until some frames were drawn: what was put in has come to the page then."""
    drawn = await page.evaluate("() => lab.renderer.info.render.frame")
    await page.wait_for_function(
        "wanted => lab.renderer.info.render.frame >= wanted", arg=drawn + count
    )


async def send(page: Any, point: Callable[[], Awaitable[None]]) -> None:
    """Point at the floor until the robot is on its way."""
    while True:
        await page.evaluate("() => { lab.pilot.words = ''; }")
        await point()
        await page.wait_for_function("() => lab.pilot.words && !lab.pilot.isWaiting")
        words = await page.evaluate("() => lab.pilot.words")
        if words.startswith(("Approaching", "Arrived")):
            return
        assert any(each in words for each in LATE), words


async def send_and_end(page: Any, point: Callable[[], Awaitable[None]], by: str) -> str:
    """Point at the floor, end the approach by a script once the robot drives. Return what is said.

    A busy machine may have ended it before.
    """
    await send(page, point)
    await page.wait_for_function("() => control.textContent === 'Driving.' || !lab.pilot.isActive")
    await page.evaluate(by)
    await page.wait_for_function("() => !lab.pilot.isActive")
    return str(await page.evaluate("() => lab.pilot.words"))


async def send_and_arrive(page: Any, point: Callable[[], Awaitable[None]]) -> None:
    """Point at the floor until the robot has arrived."""
    while True:
        await send(page, point)
        await page.wait_for_function("() => !lab.pilot.isActive")
        words = await page.evaluate("() => lab.pilot.words")
        if words == "Arrived.":
            return
        assert any(each in words for each in LATE), words


async def until_it_stands_at(speaker: Client, x: float, y: float) -> None:
    """Wait until the odometry says that the robot stands within 5 cm of a place."""

    def stands_there(frame: dict[str, Any]) -> bool:
        if frame["op"] != "publish" or frame["topic"] != "/odom":
            return False
        place = frame["msg"]["pose"]["pose"]["position"]
        speed = frame["msg"]["twist"]["twist"]["linear"]["x"]
        return math.hypot(place["x"] - x, place["y"] - y) < 0.05 and abs(speed) < 0.01

    await speaker.send(op="subscribe", id="odom", topic="/odom")
    await speaker.receive(stands_there, LATE_S)
    await speaker.send(op="unsubscribe", id="odom", topic="/odom")
