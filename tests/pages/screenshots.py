# SPDX-License-Identifier: Apache-2.0
"""Write the pictures of the docs with the simulated robot (``make screenshots``)."""

import asyncio
from pathlib import Path

from playwright.async_api import async_playwright

from tests.client import client
from tests.demonstration import demonstration
from tests.pages.conftest import CHROMIUM, page_address

FOLDER = Path(__file__).parents[2] / "docs/images"
DESK = {"width": 1440, "height": 900}
PHONE = {"width": 390, "height": 844}
SETTLED_MS = 12_000  # the plot has something to show
OPENED_MS = 3_000
UNDER_WAY_MS = 1_500
FLOOR = (800, 470)  # of the lab, a metre ahead of the robot's start
GOAL = {"pose": {"pose": {"position": {"x": 2.5, "y": 1.5}}}}
FORMS = "#card=publish+0+/cmd_vel&card=goal+0+/navigate_to_pose&card=graph+0+/"
SCENE = "#card=scene+0+/"


async def main() -> None:
    """Open each page while the robot drives to a place, and take its picture."""
    async with (
        demonstration() as gateway,
        async_playwright() as driver,
        client(gateway.url) as speaker,
    ):
        browser = await driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        address = page_address(gateway)
        page = await browser.new_page(viewport=DESK, color_scheme="dark")
        await page.goto(address)
        await page.wait_for_selector(".uplot")
        await page.wait_for_selector(".stick")
        picture = await page.request.get(f"{address}snapshot?topic=/camera/image_raw")
        (FOLDER / "camera.jpg").write_bytes(await picture.body())
        await speaker.send(
            op="send_action_goal", id="go", action="/navigate_to_pose", args=GOAL, keep=True
        )
        await page.wait_for_timeout(SETTLED_MS)
        await page.screenshot(path=FOLDER / "debug.png")
        for name, path, size in (
            ("forms", FORMS, DESK),
            ("drive", "drive", DESK),
            ("scene", SCENE, DESK),
            ("phone", "", PHONE),
        ):
            other = await browser.new_page(viewport=size, color_scheme="dark")
            await other.goto(address + path)
            await other.wait_for_timeout(OPENED_MS)
            await other.screenshot(path=FOLDER / f"{name}.png")
            await other.close()
        await speaker.send(op="call_service", id="reset", service="/reset")
        await page.goto(f"{address}lab")
        await page.wait_for_timeout(OPENED_MS)
        approach = page.locator("#approach")
        while not (await approach.inner_text()).startswith("Approaching"):
            await page.mouse.click(*FLOOR)
            await page.wait_for_timeout(UNDER_WAY_MS)
        await page.screenshot(path=FOLDER / "lab.png")
        await browser.close()


if __name__ == "__main__":
    asyncio.run(main())
