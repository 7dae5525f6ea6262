# SPDX-License-Identifier: Apache-2.0
"""Write the pictures of the docs with the simulated robot (``make screenshots``)."""

import asyncio
import itertools
import re
import sys
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Literal

import cv2
import numpy as np
from playwright.async_api import Browser, Page, async_playwright

from tests.client import Client, client
from tests.demonstration import demonstration
from tests.pages.conftest import CHROMIUM, page_address
from tests.pages.patient_demo import PATIENT

FOLDER = Path(__file__).parents[2] / "docs/images"
SIZES = {"desk": (1440, 900), "tablet": (768, 1024), "phone": (390, 844)}
Theme = Literal["dark", "light"]
THEMES: tuple[Theme, ...] = ("dark", "light")
FIRST: tuple[str, Theme] = ("desk", "dark")
QUALITY = 82  # of WebP: texts stay sharp, and a picture is a fifth of a PNG
SETTLED_MS = 9_000  # the plot has something to show
UNDER_WAY_MS = 1_500
PATIENCE_MS = 120_000  # a browser that draws in software starts slowly
FLOOR = ((0.55, 0.58), (0.6, 0.7), (0.4, 0.7), (0.5, 0.8))  # of the lab, as shares of its view
GOALS = ((2.5, 1.5), (0.5, -1.0))
CARDS = (
    "#card=image+0+/camera/image_raw&size=4x11&card=map+0+/map&size=4x11&card=scan+0+/scan&size=4x11"
    "&card=plot+0+/odom+pose.pose.position.x+pose.pose.position.y&size=4x11"
    "&card=imu+0+/imu&size=4x11&card=diagnostics+0+/diagnostics&size=4x11"
)
FORMS = "#card=publish+0+/cmd_vel&card=goal+0+/navigate_to_pose&card=graph+0+/"
SCENE = "#card=scene+0+/&size=12x22"


async def approach(page: Page) -> None:
    """Send the robot to a place on the floor of the lab."""
    words = page.locator("#approach")
    place = await page.locator("#view canvas").bounding_box()
    assert place is not None
    for right, down in FLOOR:
        x, y = place["x"] + right * place["width"], place["y"] + down * place["height"]
        await page.mouse.click(x, y)
        await page.wait_for_timeout(UNDER_WAY_MS)
        if (await words.inner_text()).startswith("Approaching"):
            return


# a name, a path, a selector of what is drawn, and what to do before the picture is taken
Shown = tuple[str, str, str, Callable[[Page], Awaitable[None]] | None]
PAGES: list[Shown] = [
    ("cards", CARDS, "article canvas", None),
    ("scene", SCENE, ".scene canvas", None),
    ("forms", FORMS, "article", None),
    ("drive", "drive", "#world canvas", None),
    ("lab", "lab", "#view canvas", approach),
]


def compressed(png: bytes) -> bytes:
    """Return a picture as WebP."""
    pixels = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR)
    assert pixels is not None
    return cv2.imencode(".webp", pixels, [cv2.IMWRITE_WEBP_QUALITY, QUALITY])[1].tobytes()


async def take(browser: Browser, address: str, kind: str, theme: Theme, shown: Shown) -> None:
    """Take the picture of one page."""
    name, path, last, prepare = shown
    width, height = SIZES[kind]
    context = await browser.new_context(
        viewport={"width": width, "height": height},
        color_scheme=theme,
        is_mobile=kind != "desk",
        has_touch=kind != "desk",
    )
    page = await context.new_page()
    page.set_default_timeout(PATIENCE_MS)
    # on a small screen a card is as high as its content
    await page.goto(address + (path if kind == "desk" else re.sub(r"&size=\w+", "", path)))
    await page.wait_for_selector(last)
    await page.wait_for_timeout(SETTLED_MS)
    if prepare:
        await prepare(page)
    picture = compressed(await page.screenshot())
    (FOLDER / f"{name}-{kind}-{theme}.webp").write_bytes(picture)
    await context.close()


async def drive_about(speaker: Client) -> None:
    """Send the robot to and fro, so that all pages have something to show."""
    for number in itertools.count():
        x, y = GOALS[number % len(GOALS)]
        args = {"pose": {"pose": {"position": {"x": x, "y": y}}}}
        await speaker.send(
            op="send_action_goal", id="go", action="/navigate_to_pose", args=args, keep=True
        )
        await speaker.receive(lambda frame: frame["op"] == "action_result")


async def main() -> None:
    """Take the picture of each page in each size and theme, or of those that are named."""
    async with (
        demonstration(*PATIENT, module="tests.pages.patient_demo") as gateway,
        async_playwright() as driver,
        client(gateway.url) as speaker,
    ):
        browser = await driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        address = page_address(gateway)
        for each in PAGES:
            if sys.argv[1:] and each[0] not in sys.argv[1:]:
                continue
            await speaker.send(op="call_service", id="reset", service="/reset")
            driving = asyncio.create_task(drive_about(speaker)) if each[0] != "lab" else None
            screens = itertools.product(SIZES, THEMES) if each[0] != "forms" else [FIRST]
            for kind, theme in screens:
                await take(browser, address, kind, theme, each)
            if driving:
                driving.cancel()
                await asyncio.gather(driving, return_exceptions=True)
                await speaker.send(op="cancel_action_goal", action="/navigate_to_pose")
        page = await browser.new_page()
        picture = await page.request.get(f"{address}snapshot?topic=/camera/image_raw")
        (FOLDER / "camera.jpg").write_bytes(await picture.body())
        await browser.close()


if __name__ == "__main__":
    asyncio.run(main())
