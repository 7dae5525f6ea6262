# SPDX-License-Identifier: Apache-2.0
"""STOP, at the top of every page."""

import pytest

from tests.pages.conftest import page_address
from tests.pages.test_cards import NOTE_SENT
from tests.pages.test_debug_page import PHONE
from tests.pages.test_drive_page import Watched, drive, until_it_drives, watched

__all__ = ["drive", "watched"]  # fixtures

pytestmark = pytest.mark.asyncio(loop_scope="package")

FINGER_PX = 44
THUMBS = {"viewport": PHONE, "has_touch": True, "is_mobile": True}
STOPPED = "() => notice.textContent === 'The gateway stopped /cmd_vel.'"
STOPS = "() => sent.filter((each) => JSON.parse(each).op === 'stop').length"


async def middle_of(page, selector: str) -> dict[str, float]:
    box = await page.locator(selector).bounding_box()
    return {"x": box["x"] + box["width"] / 2, "y": box["y"] + box["height"] / 2}


async def fingers(page):
    """Return a function that says where fingers are now."""
    session = await page.context.new_cdp_session(page)

    async def touch(kind: str, *points: dict[str, float]) -> None:
        numbered = [point | {"id": number} for number, point in enumerate(points)]
        event = {"type": kind, "touchPoints": numbered}
        await session.send("Input.dispatchTouchEvent", event)

    return touch


@pytest.mark.parametrize("name", ["", "drive", "lab"])
async def test_a_second_finger_stops_while_another_rests_on_the_screen(demo, open_page, name):
    async with open_page(page_address(demo) + name, **THUMBS) as page:
        await page.wait_for_selector(".state[data-state=open]")
        touch = await fingers(page)
        stop = await middle_of(page, "#stop")
        elsewhere = {"x": 20.0, "y": 600.0}
        await touch("touchStart", elsewhere)
        await touch("touchStart", elsewhere, stop)
        await page.wait_for_function(STOPPED)
        await touch("touchEnd")
        assert (await page.locator("#stop").bounding_box())["height"] >= FINGER_PX


async def test_a_second_finger_stops_what_the_first_one_drives(demo, open_page, watched: Watched):
    async with open_page(f"{page_address(demo)}drive", **THUMBS) as page:
        await page.wait_for_function("() => control.textContent.startsWith('Stopped')")
        touch = await fingers(page)
        thumb: dict[str, float] = {}

        async def hold() -> None:
            await page.locator("#stick").scroll_into_view_if_needed()
            thumb.update(await middle_of(page, "#stick"))
            thumb["y"] -= 40
            await touch("touchStart", thumb)

        await until_it_drives(page, hold, lambda: touch("touchEnd"))
        await watched.until(state="moving")
        await touch("touchStart", thumb, await middle_of(page, "#stop"))
        await watched.until(state="stopped")
        assert await page.evaluate("() => knob.style.transform") == "translate(0rem, 0rem)"
        await page.wait_for_function("() => control.textContent === 'Stopped: you pressed STOP.'")
        await touch("touchEnd")


async def test_each_way_to_press_it_stops_once(demo, open_page):
    async with open_page(f"{page_address(demo)}drive", script=NOTE_SENT, **THUMBS) as page:
        await page.wait_for_function("() => control.textContent.startsWith('Stopped')")

        async def hold(key: str) -> None:
            for _ in range(3):
                await page.keyboard.down(key)  # which repeats it
            await page.keyboard.up(key)

        ways = [
            lambda: page.tap("#stop"),
            lambda: page.click("#stop"),
            lambda: page.evaluate("() => document.activeElement.blur()"),
            lambda: hold("Space"),
            lambda: page.focus("#stop"),
            lambda: hold("Enter"),
            lambda: hold("Space"),
        ]
        counts = []
        for way in ways:
            await way()
            counts.append(await page.evaluate(STOPS))
        assert counts == [1, 2, 2, 3, 3, 4, 5]


async def test_the_page_says_truly_who_stopped_the_robot(evaluate):
    words = await evaluate("""async () => {
        const { sentence } = await import("/shared/control_words.js");
        const frame = { state: "stopped", tripped: false, holder: null, guard: "ready" };
        return [true, false].map(
            (isStopper) => sentence({ ...frame, cause: "stop", isStopper }));
    }""")
    assert words == ["Stopped: you pressed STOP.", "Stopped: another client pressed STOP."]


async def test_nothing_moves_while_space_holds_stop(drive, watched: Watched):
    async with drive() as page:
        await page.keyboard.down("Space")
        await page.wait_for_function(STOPPED)
        await page.keyboard.down("ArrowUp")
        assert await page.evaluate("() => knob.style.transform") == "translate(0rem, 0rem)"
        await page.keyboard.up("Space")  # the key has to be pressed again
        assert await page.evaluate("() => knob.style.transform") == "translate(0rem, 0rem)"
        await page.keyboard.up("ArrowUp")
        await until_it_drives(
            page, lambda: page.keyboard.down("ArrowUp"), lambda: page.keyboard.up("ArrowUp")
        )
        await page.keyboard.up("ArrowUp")


async def test_nothing_moves_while_a_finger_rests_on_stop(demo, open_page):
    async with open_page(f"{page_address(demo)}drive", **THUMBS) as page:
        await page.wait_for_function("() => control.textContent.startsWith('Stopped')")
        touch = await fingers(page)
        stop = await middle_of(page, "#stop")
        thumb = await middle_of(page, "#stick")
        thumb["y"] -= 40
        await touch("touchStart", stop)
        await page.wait_for_function(STOPPED)
        await touch("touchStart", stop, thumb)
        assert await page.evaluate("() => knob.style.transform") == "translate(0rem, 0rem)"
        await touch("touchEnd")
        await page.wait_for_timeout(300)  # in which the gateway wants nothing that moves
        await touch("touchStart", thumb)
        assert await page.evaluate("() => knob.style.transform") != "translate(0rem, 0rem)"
        await touch("touchEnd")


@pytest.mark.parametrize("end", ["keyup", "blur"])
async def test_stop_is_held_until_its_key_is_up_or_nobody_can_tell(evaluate, end):
    held = """async ([end]) => {
        const { hold, isHeld } = await import("/shared/stop_held.js");
        const before = isHeld();
        hold("Space");
        const during = isHeld();
        const Kind = end === "blur" ? Event : KeyboardEvent;
        window.dispatchEvent(new Kind(end, { code: "Space" }));
        return [before, during, isHeld()];
    }"""
    assert await evaluate(held, [end]) == [False, True, False]


async def test_no_form_moves_anything_while_stop_is_held(demo, open_page):
    cards = "#card=publish+0+/cmd_vel&card=goal+0+/navigate_to_pose"
    async with open_page(page_address(demo) + cards, script=NOTE_SENT) as page:
        for name in ("Publish /cmd_vel", "Send goal /navigate_to_pose"):
            button = page.locator(f"article button.act[aria-label='{name}']:enabled")
            await button.wait_for()
        await page.evaluate("() => import('/shared/stop_held.js').then(({ hold }) => hold(1))")
        await page.evaluate("() => document.querySelectorAll('.act').forEach((e) => e.click())")
        assert (
            await page.locator(
                "article > .problem:text-is('STOP is held: release it first.')"
            ).count()
            == 2
        )
        sent = "sent.map(JSON.parse).filter(({ op }) => /^(publish|send_action_goal)$/.test(op))"
        assert await page.evaluate(f"() => {sent}.length") == 0


async def test_stop_stays_in_reach_while_a_dialog_is_open(demo, open_page):
    async with open_page(f"{page_address(demo)}drive", script=NOTE_SENT) as page:
        await page.wait_for_function("() => control.textContent.startsWith('Stopped')")
        await page.keyboard.press("?")
        await page.wait_for_selector("#keys[open]")
        await page.keyboard.press("Space")
        assert await page.evaluate(STOPS) == 1
        await page.click("#stop", timeout=10_000)
        assert await page.evaluate(STOPS) == 2
        await page.focus("#keys button")
        moving = "({ stopBySpace }) => stopBySpace({ isMoving: () => true })"
        await page.evaluate(f"() => import('/shared/stop.js').then({moving})")
        await page.keyboard.press("Space")
        assert await page.evaluate(STOPS) == 3
        assert await page.is_visible("#keys")
        await page.keyboard.press("Escape")
        await page.wait_for_selector("#keys", state="hidden")


async def test_stop_stays_in_reach_while_a_name_is_asked_for(demo, open_page):
    async with open_page(page_address(demo) + "#card=tree+0+/odom", script=NOTE_SENT) as page:
        await page.wait_for_selector("article .tree dd:not(:empty)")
        await page.dblclick("article h3")  # Escape closes the question alone
        for _ in range(2):  # one question at a time
            await page.get_by_role("button", name="Layout", exact=True).click()
            await page.get_by_role("menuitem", name="New tab").click()
        await page.wait_for_function(
            "() => document.querySelectorAll('dialog.question').length === 1"
        )
        await page.click("#stop", timeout=10_000)
        assert await page.evaluate(STOPS) == 1
        await page.keyboard.press("Escape")
        await page.wait_for_selector("dialog.question", state="detached")
        assert await page.locator("article.whole").count() == 1


@pytest.mark.parametrize("size", [PHONE, {"width": 1280, "height": 800}])
async def test_a_notice_lies_above_a_card_that_fills_the_page(demo, open_page, size):
    on_top = """each => {
        const { x, y, width, height } = each.getBoundingClientRect();
        return each.contains(document.elementFromPoint(x + width / 2, y + height / 2));
    }"""
    address = page_address(demo) + "#card=image+0+/camera/image_raw"
    async with open_page(address, size) as page:
        await page.click("text='Full screen'")
        await page.wait_for_selector("article.whole")
        await page.evaluate("import('/shared/notice.js').then(({ tell }) => tell('Note'))")
        await page.evaluate("() => { recorder.hidden = false; }")
        full = page.locator(".card.whole .pictured button")
        for each in (page.locator("#notice"), page.locator("#stop"), full):
            assert await each.evaluate(on_top)
        await page.evaluate("() => { notice.hidden = true; }")
        assert await page.locator("#recorder").evaluate(on_top)
        await page.evaluate("() => { recorder.hidden = true; }")
        await page.select_option("select[aria-label='view of /camera/image_raw']", "tree")
        assert await page.locator("article.whole").count() == 1  # whatever it shows
        await page.keyboard.press("Escape")
        await page.wait_for_selector("article.whole", state="detached")


async def test_a_menu_covers_no_stop_on_a_small_screen(demo, open_page):
    small = {"width": 320, "height": 300}
    async with open_page(page_address(demo) + "#card=tree+0+/odom", small) as page:
        await page.click(".bar .more")
        top = await page.evaluate("() => document.querySelector('.menu:popover-open').offsetTop")
        bar = await page.locator(".bar").bounding_box()
        assert top >= bar["y"] + bar["height"]


async def test_a_page_whose_storage_is_blocked_has_stop(demo, open_page):
    blocked = """for (const name of ["localStorage", "sessionStorage"]) {
        const get = () => { throw new DOMException("denied", "SecurityError"); };
        Object.defineProperty(window, name, { configurable: true, get });
    }"""
    async with open_page(f"{page_address(demo)}drive", script=blocked) as page:
        await page.wait_for_selector(".state[data-state=open]", timeout=30_000)
        await page.click("#stop")
        await page.wait_for_function(STOPPED)
