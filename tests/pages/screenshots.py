# SPDX-License-Identifier: Apache-2.0
"""Write the pictures of docs/pages.md, with the simulated robot; ``make screenshots``."""

import asyncio
from pathlib import Path

from playwright.async_api import async_playwright

from tests.client import client
from tests.demonstration import demonstration
from tests.pages.conftest import CHROMIUM, page_address

FOLDER = Path(__file__).parents[2] / "docs"
SIZE = {"width": 1440, "height": 900}
SETTLED_MS = 12_000  # the plot has something to show
FLOOR = (560, 560)  # of the lab
APPROACHED_MS = 3_000
GOAL = {
    "op": "send_action_goal",
    "id": "go",
    "action": "/navigate_to_pose",
    "args": {"pose": {"pose": {"position": {"x": 2.5, "y": 1.5}}}},
}


async def main() -> None:
    """Open the page as on a first visit, drive a little, and take the picture."""
    async with demonstration() as gateway, async_playwright() as driver:
        browser = await driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        page = await browser.new_page(viewport=SIZE, color_scheme="dark")
        await page.goto(page_address(gateway))
        await page.wait_for_selector(".uplot")
        await page.click("#topics button:has-text('/imu')")
        async with client(gateway.url) as speaker:
            await speaker.send(
                op="send_action_goal", id="go", action="/navigate_to_pose", args=GOAL
            )
            await page.wait_for_timeout(SETTLED_MS)
        await page.screenshot(path=FOLDER / "debug.png")
        await page.goto(f"{page_address(gateway)}lab")
        await page.wait_for_timeout(SETTLED_MS)
        await page.mouse.click(*FLOOR)
        await page.wait_for_timeout(APPROACHED_MS)
        await page.screenshot(path=FOLDER / "lab.png")
        await browser.close()


if __name__ == "__main__":
    asyncio.run(main())
