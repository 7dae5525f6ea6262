# SPDX-License-Identifier: Apache-2.0
"""What is held moves the robot only while it is held, whatever swallows that it is let go of."""

import pytest

from tests.pages.test_drive_page import Watched, drive, drive_by, watched

__all__ = ["drive", "watched"]  # fixtures

pytestmark = pytest.mark.asyncio(loop_scope="module")

AT_REST = "() => ['', 'translate(0rem, 0rem)'].includes(knob.style.transform)"


async def push_the_stick(page) -> tuple[float, float]:
    """Push it ahead by half with the mouse, and return where that is."""
    box = await page.locator("#stick").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 4
    await page.mouse.move(x, y)
    await page.mouse.down()
    assert not await page.evaluate(AT_REST)
    return x, y


@pytest.mark.parametrize("key", ["Meta", "Control", "Alt"])
async def test_a_key_whose_end_a_modifier_may_swallow_is_let_go_of(drive, watched: Watched, key):
    async with drive() as page:
        await drive_by(page, "ArrowLeft")
        await watched.until(state="moving")
        await page.keyboard.down(key)
        await watched.until(state="stopped", cause="zero")
        await page.keyboard.up(key)
        await page.keyboard.up("ArrowLeft")


async def test_a_menu_lets_go_of_a_key(drive, watched: Watched):
    async with drive() as page:
        await drive_by(page, "ArrowLeft")
        await watched.until(state="moving")
        await page.click(".hint", button="right")
        await watched.until(state="stopped", cause="zero")
        await page.keyboard.up("ArrowLeft")


async def test_a_stick_pushes_no_other_way_when_it_moves_away_below_the_finger(drive):
    pushed = "() => new DOMMatrix(getComputedStyle(knob).transform).f"  # pixels, down
    async with drive() as page:
        x, y = await push_the_stick(page)
        before = await page.evaluate(pushed)
        await page.evaluate("() => { document.querySelector('main').style.marginTop = '-150px'; }")
        await page.mouse.move(x + 1, y)  # as any thumb does
        assert before < -1
        assert abs(await page.evaluate(pushed) - before) < 1
        await page.mouse.up()
        assert await page.evaluate(AT_REST)


async def test_a_screen_that_is_turned_lets_go_of_the_stick(drive):
    async with drive() as page:
        x, y = await push_the_stick(page)
        await page.set_viewport_size({"width": 800, "height": 1280})
        await page.wait_for_function(AT_REST)
        await page.mouse.move(x + 1, y)
        assert await page.evaluate(AT_REST)
        await page.mouse.up()


async def test_a_button_that_is_let_go_of_while_another_is_down_lets_go_of_the_stick(drive):
    async with drive() as page:
        await push_the_stick(page)
        await page.mouse.down(button="right")
        await page.mouse.up()
        await page.wait_for_function(AT_REST)
        await page.mouse.up(button="right")


async def test_a_thumb_that_rests_on_the_stick_opens_no_menu_and_goes_on(drive):
    open_menu = """() => stick.dispatchEvent(
        new MouseEvent("contextmenu", { bubbles: true, cancelable: true }))"""
    async with drive() as page:
        await push_the_stick(page)
        assert not await page.evaluate(open_menu)
        assert not await page.evaluate(AT_REST)
        await page.mouse.up()
