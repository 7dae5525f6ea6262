# SPDX-License-Identifier: Apache-2.0
"""Measure the debug page: ``python -m tests.pages.main_thread``.

Its first paint, and the share of the browser's main thread that it takes with a picture, a plot of
each of 60 topics, and 1,500 messages a second. A test would measure no more than the machine.
"""

import asyncio
import contextlib
import time

from playwright.async_api import CDPSession, async_playwright

from tests.client import client
from tests.demonstration import demonstration
from tests.pages.conftest import CHROMIUM, page_address

SIZE = {"width": 1440, "height": 900}
TOPICS = 60
RATE_HZ = 25
SETTLED_S = 5
MEASURED_S = 15
# of a robot in the next room, by its own WiFi: ms there and back, bytes/s
WIFI = {"offline": False, "latency": 20, "downloadThroughput": 2_500_000, "uploadThroughput": 1e6}
FIRST_PAINT = """() => {
    const found = performance.getEntriesByName("first-contentful-paint")[0];
    return found && found.startTime;
}"""


async def publish(url: str) -> None:
    """Publish to all topics until it is cancelled."""
    async with client(url) as speaker:
        for number in range(TOPICS):
            await speaker.send(
                op="advertise", topic=f"/load{number}", type="geometry_msgs/PoseStamped"
            )
        beginning = time.monotonic()
        for turn in range(10**9):
            pose = {"pose": {"position": {"x": turn % 50, "y": 1.5}, "orientation": {"w": 1.0}}}
            for number in range(TOPICS):
                await speaker.send(op="publish", topic=f"/load{number}", msg=pose)
            await asyncio.sleep(max(0.0, beginning + (turn + 1) / RATE_HZ - time.monotonic()))


async def metrics(session: CDPSession) -> dict[str, float]:
    """Return what the browser counts of a page."""
    answer = await session.send("Performance.getMetrics")
    return {each["name"]: each["value"] for each in answer["metrics"]}


async def main() -> None:
    """Open the page as on a first visit, then with all topics, and print what was measured."""
    plots = "&".join(f"card=plot+0+/load{number}+pose.position.x" for number in range(TOPICS))
    async with demonstration() as gateway, async_playwright() as driver:
        browser = await driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        for link, conditions in (("here", None), ("by WiFi of 20 Mbit/s and 20 ms", WIFI)):
            page = await browser.new_page(viewport=SIZE)
            if conditions is not None:
                session = await page.context.new_cdp_session(page)
                await session.send("Network.enable")
                await session.send("Network.emulateNetworkConditions", conditions)
            await page.goto(page_address(gateway))
            await page.wait_for_selector("article canvas")
            drawn = await page.evaluate("() => performance.now()")
            paint = await page.evaluate(FIRST_PAINT)
            told = f"first paint after {paint:.0f} ms, first card after {drawn:.0f} ms"
            print(f"{link}: {told}")  # noqa: T201
            await page.close()
        loading = asyncio.create_task(publish(gateway.url))
        page = await browser.new_page(viewport=SIZE)
        await page.goto(f"{page_address(gateway)}#card=image+0+/camera/image_raw&{plots}")
        session = await page.context.new_cdp_session(page)
        await session.send("Performance.enable")
        await asyncio.sleep(SETTLED_S)
        before = await metrics(session)
        await asyncio.sleep(MEASURED_S)
        after = await metrics(session)
        busy, waits_too = (
            (after[name] - before[name]) / (after["Timestamp"] - before["Timestamp"])
            for name in ("ThreadTime", "TaskDuration")
        )
        figures = " ".join((await page.inner_text("#figures")).split())
        print(f"main thread: {busy:.0%}, with waits for the CPU {waits_too:.0%}; {figures}")  # noqa: T201
        loading.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await loading
        await browser.close()


if __name__ == "__main__":
    asyncio.run(main())
