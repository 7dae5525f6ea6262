# SPDX-License-Identifier: Apache-2.0
"""The bar of a recording on the pages."""

from pathlib import Path

import pytest

from tests import recordings
from tests.gateway_process import gateway_process
from tests.pages.conftest import OpenPage, page_address

pytestmark = pytest.mark.asyncio(loop_scope="package")


@pytest.mark.parametrize("name", ["", "drive"])
async def test_a_recording_is_played_paused_and_sought_from_a_page(
    name: str, open_page: OpenPage, tmp_path: Path
) -> None:
    bag = recordings.write_bag1(tmp_path / "drive.bag")
    async with (
        gateway_process("play", str(bag), "--paused", module="tests.without_rclpy") as gateway,
        open_page(f"{page_address(gateway)}{name}") as page,
    ):
        bar = page.get_by_role("region", name="Recording")
        slider = bar.get_by_role("slider", name="Position in the recording")
        await bar.wait_for()
        assert await bar.locator("output").text_content() == "0:00 / 0:01"
        await bar.get_by_role("combobox", name="Speed").select_option("10")
        await bar.get_by_role("button", name="Play").click()
        await page.wait_for_function(
            "() => document.querySelector('#player output').value.startsWith('0:01')"
        )
        await bar.get_by_role("button", name="Play").wait_for()  # it has ended
        await slider.fill("0.5")
        await page.wait_for_function(
            "() => Number(document.querySelector('#player input').value) < 1"
        )
        assert await bar.locator("output").text_content() == "0:00 / 0:01"


async def test_without_a_recording_there_is_no_bar(open_page: OpenPage, served) -> None:
    async with open_page(page_address(served)) as page:
        await page.get_by_text("connected", exact=True).wait_for()
        assert await page.locator("#player").is_hidden()
