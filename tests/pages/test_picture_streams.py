# SPDX-License-Identifier: Apache-2.0
"""Pictures by plain HTTP in a real browser, beside the simulated robot."""

import pytest

from tests.client import client
from tests.demonstration import until_it_can_be_driven
from tests.pages.conftest import page_address

pytestmark = pytest.mark.asyncio(loop_scope="module")

SHOW = """address => {
    const shown = document.createElement("img");
    shown.id = "shown";
    shown.src = address;
    document.body.append(shown);
}"""
HAS_PICTURE = "() => document.getElementById('shown').naturalWidth === 160"
# of what moves: until a later picture differs from the one that was drawn before
CHANGES = """() => {
    const shown = document.getElementById("shown");
    const copy = new OffscreenCanvas(shown.naturalWidth, shown.naturalHeight).getContext("2d");
    copy.drawImage(shown, 0, 0);
    const { data } = copy.getImageData(0, 0, shown.naturalWidth, shown.naturalHeight);
    const text = data.join();
    window.first ??= text;
    return text !== window.first;
}"""


async def test_an_img_of_a_page_shows_a_stream(demo, open_page):
    async with client(demo.url) as speaker:
        await until_it_can_be_driven(speaker)
        async with open_page(f"{page_address(demo)}drive") as page:
            await page.evaluate(SHOW, "/stream?topic=/camera/image_raw&width=160&fps=10")
            await page.wait_for_function(HAS_PICTURE)
            await speaker.send(op="publish", topic="/cmd_vel", msg={"angular": {"z": 0.5}})
            await page.wait_for_function(CHANGES)


async def test_an_img_of_a_page_shows_a_snapshot(demo, open_page):
    async with open_page(f"{page_address(demo)}drive") as page:
        await page.evaluate(SHOW, "/snapshot?topic=/camera/image_raw&width=160")
        await page.wait_for_function(HAS_PICTURE)
