# SPDX-License-Identifier: Apache-2.0
"""A gamepad on the drive page: it drives while its dead-man button is held, and each end stops."""

import contextlib

import pytest

from tests.pages.conftest import page_address, severable
from tests.pages.test_drive_page import until_it_drives, watched

__all__ = ["watched"]  # a fixture

pytestmark = pytest.mark.asyncio(loop_scope="package")

# Chromium without a screen has no gamepads
GAMEPADS = """
    window.pads = [];
    window.shaken = [];
    navigator.getGamepads = () => pads;
    const say = (name, gamepad) => dispatchEvent(Object.assign(new Event(name), { gamepad }));
    window.plug = (mapping = "standard", held = false) => {
        const buttons = Array.from({ length: 17 }, () => ({ pressed: false }));
        buttons[5].pressed = held;
        const playEffect = async (kind, { duration }) => shaken.push(duration);
        const vibrationActuator = { playEffect };
        const axes = [0, held ? -1 : 0, 0, 0];
        pads = [{ index: 0, connected: true, mapping, buttons, axes, vibrationActuator }];
        say("gamepadconnected", pads[0]);
    };
    window.unplug = () => {
        const [gone] = pads;
        pads = [];
        say("gamepaddisconnected", gone);
    };
"""
HOLD = "() => { pads[0].axes[0] = -1; pads[0].buttons[5].pressed = true; }"
LET_GO = "() => { for (const each of pads[0].buttons) each.pressed = false; }"
HIDE = """Object.defineProperty(document, 'hidden', { value: true, configurable: true });
document.dispatchEvent(new Event('visibilitychange'))"""
SEEN = "() => { Object.defineProperty(document, 'hidden', { value: false, configurable: true }); }"
IS_STOPPED = "() => control.textContent.startsWith('Stopped')"


@pytest.fixture
def drive(demo, open_page):
    """Return a function that opens the page with a gamepad, and waits until it can drive."""

    @contextlib.asynccontextmanager
    async def open_it():
        async with open_page(f"{page_address(demo)}drive", script=GAMEPADS) as page:
            await page.wait_for_function(IS_STOPPED)
            await page.evaluate("() => plug()")
            yield page

    return open_it


async def drive_by_pad(page) -> None:
    await until_it_drives(page, lambda: page.evaluate(HOLD), lambda: page.evaluate(LET_GO))


async def test_a_stick_alone_moves_nothing_and_with_the_button_it_drives(drive, watched):
    async with drive() as page:
        assert "shoulder button" in await page.inner_text("#hint")
        await page.evaluate("() => { pads[0].axes[0] = -1; }")
        await page.wait_for_timeout(200)  # in which it would be read, several times over
        assert await page.evaluate("() => knob.style.transform") in {"", "translate(0rem, 0rem)"}
        await drive_by_pad(page)
        await watched.until(state="moving")
        assert await page.evaluate("() => knob.style.transform") == "translate(-3.5rem, 0rem)"
        await page.evaluate("() => { pads[0].axes[0] = 0.1; }")  # springs back, not quite
        await watched.until(state="stopped", cause="zero")
        await page.evaluate(LET_GO)


@pytest.mark.parametrize(
    ("by", "cause"),
    [
        ("pads[0].buttons[5].pressed = false", "zero"),
        ("unplug()", "zero"),
        ("dispatchEvent(new Event('blur'))", "zero"),
        (HIDE, "zero"),
        ("pads[0].buttons[1].pressed = true", "stop"),
        ("document.getElementById('stop').click()", "stop"),
    ],
    ids=["let go", "unplugged", "blur", "hidden", "B", "STOP"],
)
async def test_it_stops_at_once_and_moves_nothing_until_the_button_is_pressed_again(
    drive,
    watched,
    by,
    cause,
):
    async with drive() as page:
        await drive_by_pad(page)
        await watched.until(state="moving")
        await page.evaluate(f"() => {{ {by}; }}")
        ended = await watched.until(state="stopped")
        assert ended["cause"] in {cause, "zero"}
        if by == HIDE:
            await page.evaluate(SEEN)
        if by == "unplug()":  # and plugged in again while it is held
            await page.evaluate("() => plug('standard', true)")
        await page.wait_for_timeout(300)  # in which it would go on, several times over
        await page.wait_for_function(IS_STOPPED)
        assert await page.evaluate("() => knob.style.transform") == "translate(0rem, 0rem)"
        await page.evaluate(LET_GO)
        await page.wait_for_timeout(100)
        await drive_by_pad(page)
        await watched.until(state="moving")
        await page.evaluate(LET_GO)
        await watched.until(state="stopped")


async def test_a_line_that_is_cut_stops_for_good(demo, open_page, watched):
    async with open_page("about:blank", script=GAMEPADS) as page, severable(page) as line:
        await page.goto(f"{page_address(demo)}drive")
        await page.wait_for_function(IS_STOPPED)
        await page.evaluate("() => plug()")
        await drive_by_pad(page)
        await watched.until(state="moving")
        await line.cut()
        assert (await watched.until(state="stopped"))["cause"] == "disconnect"
        line.mend()
        await page.wait_for_function(IS_STOPPED)
        await page.wait_for_timeout(300)
        assert (await page.inner_text("#control")).startswith("Stopped")
        assert await page.evaluate("() => shaken.at(-1)") == 250  # another cause than the driver


async def test_a_gamepad_whose_buttons_are_unknown_drives_nothing(drive):
    async with drive() as page:
        await page.evaluate("() => { unplug(); plug('', true); }")
        assert "Arrow keys" in await page.inner_text("#hint")
        await page.evaluate(HOLD)
        await page.wait_for_timeout(200)
        assert await page.evaluate("() => knob.style.transform") in {"", "translate(0rem, 0rem)"}
