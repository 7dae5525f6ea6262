# SPDX-License-Identifier: Apache-2.0
"""The 3D scene on the drive page: it is chosen, turned and left while the page drives and stops."""

import itertools
from contextlib import asynccontextmanager

import pytest

from tests.client import client
from tests.gateway_process import gateway_process
from tests.pages.conftest import page_address, severable
from tests.pages.test_debug_page import NOTE_SENT, PHONE, until_painted
from tests.pages.test_drive_layout import PLACE, SCREENS, drive_on
from tests.pages.test_drive_page import drive_by, until_it_drives, watched
from tests.pages.test_gamepad import GAMEPADS, HOLD, LET_GO
from tests.pages.test_gamepad import IS_STOPPED as CAN_DRIVE

__all__ = ["watched"]  # a fixture

pytestmark = pytest.mark.asyncio(loop_scope="package")

TOUCH = {"viewport": PHONE, "has_touch": True, "is_mobile": True}
CANVAS = "#scene canvas"
TOP = ".scene-bar [aria-pressed] >> nth=0"
SCAN = {"angle_increment": 0.1, "range_max": 9, "ranges": [1, 2, 3]}
LAYERS = ".scene-bar [aria-expanded]"
LOADED = """() => performance.getEntriesByType("resource")
    .some(({ name }) => name.endsWith("/vendor/three.js"))"""
NEXT_FRAME = """() => new Promise((done) =>
    requestAnimationFrame(() => requestAnimationFrame(() => done())))"""
IS_LARGE = """(name) => document.getElementById(name).getBoundingClientRect().width >
    0.9 * document.querySelector(".over").getBoundingClientRect().width"""
PUBLISHED = """() => sent.map(JSON.parse).filter(({ op }) => op === "publish").length"""
STOPS = """() => sent.map(JSON.parse).filter(({ op }) => op === "stop").length"""


@pytest.fixture
def scene(demo, open_page):
    """Return a function that opens the page with the scene, and waits until it can drive."""

    @asynccontextmanager
    async def open_it(script: str = "", **options):
        async with open_page(f"{page_address(demo)}drive", script=script, **options) as page:
            await page.wait_for_function(CAN_DRIVE)
            await until_painted(page, "#camera canvas")
            await page.click("#choose-scene")
            await until_painted(page, CANVAS)
            yield page

    return open_it


async def toucher(page):
    """Return a function that touches a page with some fingers."""
    session = await page.context.new_cdp_session(page)

    async def touch(kind: str, *fingers: tuple[float, float]) -> None:
        points = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(fingers)]
        await session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
        await page.evaluate(NEXT_FRAME)  # a browser moves pointers with its frames

    return touch


async def middle(page, selector: str) -> tuple[float, float]:
    box = await page.locator(selector).bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


async def test_the_code_of_the_scene_comes_when_it_is_chosen_and_the_choice_is_kept(
    demo, open_page
):
    async with open_page(f"{page_address(demo)}drive", **TOUCH) as page:
        await until_painted(page, "#camera canvas")
        assert not await page.evaluate(LOADED)
        assert await page.evaluate(IS_LARGE, "camera")
        await page.tap("#choose-scene")
        await until_painted(page, CANVAS)
        assert await page.get_attribute("#choose-scene", "aria-pressed") == "true"
        assert await page.evaluate(IS_LARGE, "scene")
        assert not await page.evaluate(IS_LARGE, "camera")  # in its corner
        assert await page.is_visible("#camera canvas")
        await page.tap(TOP)
        await page.reload()
        await until_painted(page, CANVAS)
        assert await page.get_attribute(TOP, "aria-pressed") == "true"
        await page.tap("#choose-scene")
        await page.wait_for_selector(CANVAS, state="detached")
        await page.reload()
        await until_painted(page, "#camera canvas")
        assert not await page.evaluate(LOADED)


async def test_a_scene_that_is_left_hears_nothing_more(scene):
    async with scene(NOTE_SENT) as page:
        names = """(op) => sent.map(JSON.parse).filter((each) => each.op === op)
            .map(({ topic }) => topic)"""
        await page.wait_for_function(f"() => ({names})('subscribe').includes('/points')")
        await page.click("#choose-scene")
        await page.wait_for_function(f"() => ({names})('unsubscribe').includes('/points')")


async def test_keys_drive_and_stop_while_the_scene_is_shown(demo, open_page, watched):
    async with open_page(f"{page_address(demo)}drive") as page:
        await page.wait_for_function(CAN_DRIVE)
        await page.focus("#choose-scene")
        await page.keyboard.press("Enter")
        await until_painted(page, CANVAS)
        await drive_by(page, "ArrowLeft")
        await watched.until(state="moving")
        await page.keyboard.press("Space")
        await watched.until(state="stopped")
        await page.keyboard.up("ArrowLeft")
        assert await page.is_visible(CANVAS)  # the space bar was for STOP


async def test_stop_and_a_gamepad_work_while_the_scene_is_shown(scene, watched):
    note = """
        window.locks = 0;
        const wakeLock = { request: async () => { locks += 1; return { released: false }; } };
        Object.defineProperty(navigator, "wakeLock", { value: wakeLock });
    """
    async with scene(GAMEPADS + note) as page:
        await page.evaluate("() => plug()")
        await until_it_drives(page, lambda: page.evaluate(HOLD), lambda: page.evaluate(LET_GO))
        await watched.until(state="moving")
        assert await page.evaluate("() => locks") == 1
        await page.click("#stop")
        await watched.until(state="stopped")
        await page.evaluate(LET_GO)


async def test_one_finger_turns_the_scene_while_another_one_drives(scene, watched):
    async with scene(NOTE_SENT, **TOUCH) as page:
        touch = await toucher(page)
        here, stick = await middle(page, "#scene"), await middle(page, "#stick")
        before = await page.evaluate(PUBLISHED)
        await touch("touchStart", here)
        for step in range(5):
            await touch("touchMove", (here[0] + 15 * step, here[1]))
        await touch("touchEnd")
        assert await page.evaluate(PUBLISHED) == before
        assert await page.evaluate("() => knob.style.transform") in {"", "translate(0rem, 0rem)"}

        async def hold() -> None:
            await touch("touchStart", here)
            await touch("touchStart", here, stick)
            await touch("touchMove", here, (stick[0] - 60, stick[1]))

        await until_it_drives(page, hold, lambda: touch("touchEnd"))
        await watched.until(state="moving")
        knob = await page.evaluate("() => knob.style.transform")
        await touch("touchMove", (here[0] - 40, here[1]), (stick[0] - 60, stick[1]))
        assert await page.evaluate("() => knob.style.transform") == knob
        await touch("touchEnd")
        await watched.until(state="stopped", cause="zero")


async def test_a_stick_never_turns_a_scene(served, open_page):
    async with open_page(f"{page_address(served)}#cards=none", **TOUCH) as page:
        await page.evaluate("""async () => {
            const { View3d } = await import("/scene/view3d.js");
            const { watch } = await import("/shared/held.js");
            const made = (name, id, style) =>
                Object.assign(document.createElement(name), { id, style });
            const at = "position: fixed; z-index: 9; left: 0; width: 200px; height: 200px; top: ";
            const canvas = made("canvas", "turned", `${at}100px`);
            const stick = made("div", "held", `${at}400px; touch-action: none`);
            document.body.append(canvas, stick);
            const view = new View3d(canvas, () => {});
            window.pushed = [];
            watch(stick, document.createElement("div"), (...shares) => pushed.push(shares));
            window.seen = () => String(view.camera.position.toArray());
        }""")
        touch = await toucher(page)
        await touch("touchStart", (100, 200))
        await touch("touchMove", (130, 200))
        turned = await page.evaluate("seen()")
        await touch("touchStart", (130, 200), (100, 500))
        await touch("touchMove", (130, 200), (20, 500))
        assert (await page.evaluate("pushed"))[-1] != [0, 0]
        assert await page.evaluate("seen()") == turned
        await touch("touchMove", (190, 200), (20, 500))
        assert await page.evaluate("seen()") != turned
        await touch("touchEnd")
        assert (await page.evaluate("pushed"))[-1] == [0, 0]


async def test_letters_turn_the_scene_and_arrows_do_not(served, open_page):
    async with open_page(f"{page_address(served)}drive") as page:
        await page.wait_for_selector(".state[data-state=open]")
        await page.click("#choose-scene")
        await page.wait_for_function(f"() => document.querySelector('{CANVAS}')?.width > 300")

        async def seen() -> bytes:
            await page.evaluate(NEXT_FRAME)
            return await page.locator(CANVAS).screenshot()

        last = await seen()
        for key in ("q", "e", "+", "-"):
            await page.keyboard.press(key)
            now = await seen()
            assert now != last, key
            last = now
        for key in ("ArrowLeft", "Shift+ArrowUp", "Control+q"):
            await page.keyboard.press(key)
            assert await seen() == last, key


async def test_a_button_that_a_pointer_presses_in_the_scene_keeps_no_keys(scene):
    async with scene(NOTE_SENT) as page:
        layers = page.locator(LAYERS)
        assert not await page.is_visible(".layers")
        await layers.click()
        assert await layers.get_attribute("aria-expanded") == "true"
        scan = page.locator(".layers > li:has-text('/scan') [type=checkbox]")
        await scan.click()
        assert not await scan.is_checked()
        before = await page.evaluate(STOPS)
        await page.keyboard.press("Space")
        assert await page.evaluate(STOPS) == before + 1
        assert not await scan.is_checked()
        await scan.focus()
        await page.keyboard.press("Space")  # chosen by keys, it has them
        assert await scan.is_checked()
        assert await page.evaluate(STOPS) == before + 1


async def test_a_number_of_the_scene_leaves_stop_its_key_and_then_all_keys(scene):
    async with scene(NOTE_SENT) as page:
        await page.click(LAYERS)
        number = page.locator(".layers > li:has-text('/points') [type=number] >> nth=0")
        await number.click()
        await number.fill("70")
        before = await page.evaluate(STOPS)
        await page.keyboard.press("Space")
        assert await page.evaluate(STOPS) == before + 1
        assert await number.input_value() == "70"
        has_keys = "(number) => document.activeElement === number"
        await page.keyboard.press("ArrowUp")
        assert await number.evaluate(has_keys)
        await page.keyboard.press("Enter")
        assert not await number.evaluate(has_keys)
        await number.click()
        await number.evaluate(
            "(number) => number.dispatchEvent(new Event('change', { bubbles: true }))"
        )
        assert not await number.evaluate(has_keys)


async def test_a_failure_of_the_scene_is_told_of_until_it_works_again(scene):
    async with scene() as page:
        await page.evaluate("""async () => {
            const { SceneView } = await import("/scene/scene.js");
            const { tick } = SceneView.prototype;
            SceneView.prototype.tick = () => { throw new Error("no room"); };
            window.mend = () => { SceneView.prototype.tick = tick; };
        }""")
        said = "#scene .problem:text('no room')"
        await page.wait_for_selector(said)
        await page.evaluate("mend()")
        await page.wait_for_selector(said, state="hidden")


async def test_old_transforms_make_the_scene_pale_and_not_the_scan(nowhere, open_page):
    link = {"header": {"frame_id": "odom"}, "child_frame_id": "base_link"}
    async with gateway_process("serve", *nowhere) as gateway, client(gateway.url) as robot:
        await robot.send(op="advertise", topic="/tf", type="tf2_msgs/TFMessage")
        await robot.send(op="advertise", topic="/scan", type="sensor_msgs/LaserScan")
        async with open_page(f"{page_address(gateway)}drive") as page:
            await page.click("#choose-scene")
            is_old = "() => document.querySelector('#scene.stale') !== null"
            for turn in itertools.count():
                if await page.evaluate(is_old):
                    break
                if turn % 100 < 5:  # then none for some seconds
                    await robot.send(op="publish", topic="/tf", msg={"transforms": [link]})
                await robot.send(op="publish", topic="/scan", msg=SCAN)
                await page.wait_for_timeout(50)
            words = "() => document.querySelector('#world .age:not([hidden])')?.textContent ?? ''"
            assert "place" not in await page.evaluate(words)
            assert await page.locator("#world canvas").count()


async def test_without_a_connection_the_scene_is_old_and_says_so(demo, open_page):
    async with open_page("about:blank") as page, severable(page) as line:
        await page.goto(f"{page_address(demo)}drive")
        await page.click("#choose-scene")
        await until_painted(page, CANVAS)
        await page.wait_for_selector("#scene:not(.stale)")
        await line.cut()
        await page.wait_for_selector("#scene.stale .age:not(:empty)")
        await page.wait_for_function("() => control.textContent.startsWith('Not connected')")
        line.mend()
        await page.wait_for_selector("#scene:not(.stale)")


async def test_a_scene_that_does_not_start_says_so_and_the_page_drives(demo, open_page, watched):
    async with open_page("about:blank") as page:
        await page.route("**/scene/scene.js", lambda route: route.abort())
        await page.goto(f"{page_address(demo)}drive")
        await page.wait_for_function(CAN_DRIVE)
        await page.click("#choose-scene")
        await page.wait_for_selector("#scene .problem:text('The scene does not start')")
        page.wrong.clear()  # the browser's word on it
        await drive_by(page, "KeyA")
        await watched.until(state="moving")
        await page.keyboard.up("KeyA")
        await watched.until(state="stopped")


@SCREENS
async def test_scene_stick_sliders_and_stop_are_seen_together(demo, open_page, screen):
    async with drive_on(open_page, demo, screen) as page:
        await page.click("#choose-scene")
        await until_painted(page, CANVAS)
        await page.click(LAYERS)
        for name in ("scene", "stick", "linear", "angular", "stop"):
            left, top, right, bottom = await page.evaluate(PLACE, name)
            assert 0 <= left < right <= screen["width"], name
            assert 0 <= top < bottom <= screen["height"], name
        scene = await page.locator("#scene").bounding_box()
        inside = await page.locator(".layers").bounding_box()
        assert inside["y"] >= scene["y"]
        assert inside["y"] + inside["height"] <= scene["y"] + scene["height"]
        over = await page.locator(".over").bounding_box()
        assert inside["y"] >= over["y"] + over["height"] - 1


async def test_a_text_of_the_storage_that_is_not_a_scene_is_passed_over(demo, open_page):
    wrong = "localStorage.setItem('ros2-gateway.drive-scene', 'shown , {\"a\":1} on,,,, on');"
    async with open_page(f"{page_address(demo)}drive", script=wrong) as page:
        await until_painted(page, CANVAS)
