# SPDX-License-Identifier: Apache-2.0
"""The button that records, on every page."""

import json
from pathlib import Path

import pytest

from tests import dds_domain
from tests.client import client
from tests.gateway_process import gateway_process
from tests.pages.conftest import OpenPage, page_address
from tests.pages.test_debug_page import PHONE
from tests.recording.readers import EVENTS, decoded

pytestmark = pytest.mark.asyncio(loop_scope="package")

TOP = "() => document.querySelector('main').getBoundingClientRect().top"


@pytest.mark.parametrize("name", ["", "drive", "lab"])
async def test_a_page_records_marks_and_ends(name: str, open_page: OpenPage, tmp_path: Path):
    settings = ("--set", f"recording.directory={tmp_path}", "--set", "recording.min_free_bytes=0")
    nowhere = ("--domain-id", str(dds_domain.claim()))
    async with (
        gateway_process("serve", *nowhere, *settings) as gateway,
        open_page(page_address(gateway) + name, PHONE) as page,
        client(gateway.url) as other,
    ):
        button = page.locator("#record")
        await button.click()
        recorder = page.get_by_role("region", name="Recorder")
        await recorder.get_by_text(" topics, ").wait_for()
        assert await button.text_content() == "Recording"
        # space stops the robot, and does not press the button again
        assert await page.evaluate("() => document.activeElement === document.body")
        await recorder.get_by_role("textbox", name="Note").fill("the cup fell")
        await recorder.get_by_role("button", name="Mark").click()
        await page.wait_for_function("() => document.querySelector('#recorder input').value === ''")
        await button.click()
        await recorder.wait_for(state="hidden")
        await button.click()
        await recorder.get_by_role("button", name="Stop recording").click()
        await page.get_by_text("on the computer of the gateway.").wait_for()
        (folder,) = tmp_path.glob("*")  # noqa: ASYNC240  # nothing else waits
        assert f"Saved {folder.name}" in await page.locator("#notice").text_content()
        events = [json.loads(each.data) for each in decoded(folder)[EVENTS]]
        assert [each["text"] for each in events if each["event"] == "mark"] == ["the cup fell"]
        # a recording of another client moves nothing
        top = await page.evaluate(TOP)
        await other.send(op="record", action="start")
        await page.wait_for_function("() => record.textContent === 'Recording'")
        assert await page.evaluate(TOP) == top
        await other.send(op="record", action="stop")
        await page.wait_for_function("() => record.textContent === 'Record'")


async def test_a_refusal_is_shown_as_the_gateway_says_it(open_page: OpenPage, tmp_path: Path):
    settings = (f"directory={tmp_path}", f"min_free_bytes={10**18}", "min_free_share=1")
    flags = [text for each in settings for text in ("--set", f"recording.{each}")]
    async with (
        gateway_process("serve", "--domain-id", str(dds_domain.claim()), *flags) as gateway,
        open_page(page_address(gateway)) as page,
    ):
        await page.locator("#record").click()
        words = "delete old recordings, or lower recording.min_free_share"
        await page.get_by_text(words).wait_for()
        assert await page.locator("#record").text_content() == "Record"


async def test_a_role_that_may_not_record_sees_no_button(open_page: OpenPage):
    nowhere = ("--domain-id", str(dds_domain.claim()))
    setting = ("--set", "access.anonymous_role=viewer")
    async with (
        gateway_process("serve", *nowhere, *setting) as gateway,
        open_page(page_address(gateway)) as page,
    ):
        await page.wait_for_function("() => !record.disabled")
        assert await page.locator("#record").is_hidden()
