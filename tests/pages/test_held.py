# SPDX-License-Identifier: Apache-2.0
"""A held key or joystick moves the robot only while it is held, even if its end gets lost."""

import pytest

from tests.client import client
from tests.gateway_process import gateway_process
from tests.pages.conftest import page_address
from tests.pages.test_cards import NOTE_SENT
from tests.pages.test_drive_page import Watched, drive, drive_by, watched

__all__ = ["drive", "watched"]  # fixtures

pytestmark = pytest.mark.asyncio(loop_scope="package")

AT_REST = "() => ['', 'translate(0rem, 0rem)'].includes(knob.style.transform)"
GOES_ON_MS = 300  # in which what is held would go on, several times over
DRIVE_CARD = "#card=drive+0+/cmd_vel"
# how many commands to move this page has sent
MOTIONS = """() => sent.map((each) => JSON.parse(each)).filter(
    ({ op, msg }) => op === "publish" && (msg.linear.x || msg.angular.z)).length"""
TWIST = "geometry_msgs/msg/Twist"


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


async def assert_it_sends_nothing_that_moves(page) -> None:
    before = await page.evaluate(MOTIONS)
    await page.wait_for_timeout(GOES_ON_MS)
    assert await page.evaluate(MOTIONS) == before


@pytest.mark.parametrize("when", ["from the start", "later"])
@pytest.mark.parametrize("name", ["drive", DRIVE_CARD, "lab"])
async def test_a_key_held_while_another_client_drives_moves_nothing_when_that_ends(
    demo, open_page, watched: Watched, name, when
):
    said = "document.querySelector('.control')?.textContent"
    address = page_address(demo) + name
    async with client(demo.url) as other, open_page(address, script=NOTE_SENT) as page:
        if name == "lab":
            await page.evaluate("() => control.classList.add('control')")  # for `drive_by`
        await page.wait_for_function(f"() => {said}?.startsWith('Stopped')")
        if name == DRIVE_CARD:
            await page.focus(".stick")
        if when == "later":
            await drive_by(page, "ArrowLeft")
            await watched.until(state="moving")
        await other.send(op="acquire_control", topic="/cmd_vel")
        others = (
            "Another client drives" if when != "later" else "Stopped. Another client has control"
        )
        await page.wait_for_function(f"() => {said} === '{others}.'")
        if when != "later":
            await page.keyboard.down("ArrowLeft")
        await page.wait_for_function("() => notice.textContent.includes('drives /cmd_vel')")
        await other.send(op="release_control", topic="/cmd_vel")
        await page.wait_for_function(f"() => /^Stopped[.:]/.test({said})")
        await assert_it_sends_nothing_that_moves(page)
        assert await page.evaluate("() => notice.hidden")  # it is no longer true
        await page.keyboard.up("ArrowLeft")
        await drive_by(page, "ArrowLeft")
        await watched.until(state="moving")
        await page.keyboard.up("ArrowLeft")
        await watched.until(state="stopped")


async def test_a_key_held_while_a_robot_leaves_moves_nothing_when_it_comes_back(open_page, nowhere):
    says = "() => control.textContent.startsWith"
    async with (
        gateway_process("serve", *nowhere) as gateway,
        gateway_process("serve", *nowhere) as robot,
        client(robot.url) as motor,
        open_page(f"{page_address(gateway)}drive", script=NOTE_SENT) as page,
    ):
        await page.wait_for_selector(".state[data-state=open]")
        await page.click("#stop")
        await page.wait_for_function("() => notice.textContent.startsWith('Nothing to stop')")
        await page.keyboard.down("ArrowLeft")
        for _ in range(2):
            await motor.send(op="subscribe", topic="/cmd_vel", type=TWIST)
            await page.wait_for_function(f"{says}('Stopped')")
            await page.wait_for_function("() => notice.hidden")  # there is something to stop now
            await assert_it_sends_nothing_that_moves(page)
            await page.keyboard.up("ArrowLeft")
            await drive_by(page, "ArrowLeft")
            await page.wait_for_function(f"{says}('Commands go out')")  # no odometry comes
            await motor.send(op="unsubscribe", topic="/cmd_vel")
            await page.wait_for_function(f"{says}('No node listens on /cmd_vel')")
        await page.keyboard.up("ArrowLeft")


@pytest.mark.parametrize("by", ["key", "stick"])
async def test_a_key_pressed_while_nobody_could_drive_drives_nothing_later(drive, by):
    reported = """async (by) => {
        const { watch } = await import("/shared/held.js");
        const stick = document.createElement("div");
        stick.style.cssText = "position: fixed; inset: 0 auto auto 0; width: 100px; height: 100px";
        document.body.append(stick);
        stick.setPointerCapture = () => {};
        const heard = [];
        watch(stick, document.createElement("div"), (...shares) => heard.push(shares));
        const place = { pointerId: 1, buttons: 1, clientX: 50, clientY: 0 };
        const press = { key: (code) => dispatchEvent(new KeyboardEvent("keydown", { code })),
            stick: (kind) => stick.dispatchEvent(new PointerEvent(kind, place)) }[by];
        stick.ariaDisabled = "true";
        press(by === "key" ? "ArrowUp" : "pointerdown");
        stick.ariaDisabled = "false"; // the robot is there
        press(by === "key" ? "ArrowLeft" : "pointermove"); // the thumb trembles
        const late = heard.slice();
        press(by === "key" ? "ArrowUp" : "pointerdown"); // pressed anew
        return [late.filter(([linear]) => linear).length, heard.at(-1)[0]];
    }"""
    async with drive() as page:
        assert await page.evaluate(reported, by) == [0, 1]
