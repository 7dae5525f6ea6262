# SPDX-License-Identifier: Apache-2.0
"""Measure the memory of the debug page: ``python -m tests.pages.memory [MINUTES]``.

With 20 cards, all in view: a scene with a cloud, plots, pictures, a map, a log, and more. Print a
line each minute: what the garbage collection leaves of the heap, the elements and listeners that
live, and the memory of the browser's processes. A test would take as long.
"""

import asyncio
import sys
from pathlib import Path

from playwright.async_api import CDPSession, async_playwright

from tests.demonstration import demonstration
from tests.pages.conftest import CHROMIUM, page_address

MINUTES = 30
PATIENCE_MS = 120_000  # a browser that draws in software starts slowly
SIZE = {"width": 1440, "height": 6000}  # a card that is not in view rests
CARDS = (
    "scene+0+/",
    "image+0+/camera/image_raw",
    "image+0+/camera/image_raw/compressed",
    "map+0+/map",
    "scan+0+/scan",
    "imu+0+/imu",
    "joints+0+/joint_states",
    "trail+0+/odom",
    "frames+0+/tf",
    "log+0+/rosout",
    "diagnostics+0+/diagnostics",
    "plot+0+/odom+pose.pose.position.x",
    "plot+0+/imu+linear_acceleration.z",
    "plot+0+/imu+angular_velocity.z",
    "plot+0+/battery_state+voltage",
    "tree+0+/odom",
    "raw+0+/scan",
    "parameters+0+/",
    "drive+0+/cmd_vel",
    "connection+0+/",
)
ALL_LAYERS = """() => {
    for (const each of document.querySelectorAll(".layers input[type=checkbox]"))
        if (!each.checked) each.click();
}"""
MIB = 1024**2


async def line(session: CDPSession, processes: CDPSession) -> str:
    """Return what the page and the browser's processes hold now."""
    await session.send("HeapProfiler.collectGarbage")
    answer = await session.send("Performance.getMetrics")
    counted = {each["name"]: each["value"] for each in answer["metrics"]}
    found = (await processes.send("SystemInfo.getProcessInfo"))["processInfo"]
    own = {each["type"]: anonymous_bytes(each["id"]) for each in found}
    told = ", ".join(f"{name} {size / MIB:.0f} MiB" for name, size in own.items())
    heap, listeners = counted["JSHeapUsedSize"] / MIB, counted["JSEventListeners"]
    return f"heap {heap:.1f} MiB, {counted['Nodes']:.0f} nodes, {listeners:.0f} listeners; {told}"


def anonymous_bytes(process: int) -> int:
    """Return the memory that a process has to itself."""
    lines = Path(f"/proc/{process}/status").read_text().splitlines()
    return next(int(each.split()[1]) for each in lines if each.startswith("RssAnon")) * 1024


async def main(minutes: int) -> None:
    """Open the page and print what it holds, each minute."""
    cards = "&".join(f"card={each}" for each in CARDS)
    async with demonstration() as gateway, async_playwright() as driver:
        browser = await driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        page = await browser.new_page(viewport=SIZE)
        page.set_default_timeout(PATIENCE_MS)
        await page.goto(f"{page_address(gateway)}#{cards}")
        await page.wait_for_selector(".scene canvas")
        await page.evaluate(ALL_LAYERS)
        session = await page.context.new_cdp_session(page)
        await session.send("Performance.enable")
        processes = await browser.new_browser_cdp_session()
        for minute in range(minutes + 1):
            print(f"{minute} min: {await line(session, processes)}", flush=True)  # noqa: T201
            await asyncio.sleep(60)
        print(" ".join((await page.inner_text("#figures")).split()))  # noqa: T201
        await browser.close()


if __name__ == "__main__":
    asyncio.run(main(int(sys.argv[1]) if sys.argv[1:] else MINUTES))
