# SPDX-License-Identifier: Apache-2.0
"""The layout of the drive page: what drives is in sight, and stays where a finger has found it."""

import json

import pytest

from tests.pages.conftest import DESK, page_address
from tests.pages.test_debug_page import PHONE, until_painted

pytestmark = pytest.mark.asyncio(loop_scope="package")

LARGE = {"width": 1440, "height": 900}
LANDSCAPE = {"width": 844, "height": 390}
TABLET = {"width": 768, "height": 1024}
SCREENS = pytest.mark.parametrize(
    "screen",
    [LARGE, DESK, TABLET, PHONE, LANDSCAPE],
    ids=lambda screen: f"{screen['width']}x{screen['height']}",
)
PLACE = """(id) => {
    const { left, top, right, bottom } = document.getElementById(id).getBoundingClientRect();
    return [left, top, right, bottom].map(Math.round);
}"""
WORDY = "x" * 200
SPEAK = """async (words) => {
    const { tell } = await import("/shared/bar.js");
    tell(words);
    for (const id of ["take", "control"]) {
        const element = document.getElementById(id);
        if (!element) continue;
        element.hidden = false;
        if (id === "control") element.textContent = words;
    }
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
}"""


def drive_on(open_page, demo, screen, **options):
    if screen in (TABLET, PHONE, LANDSCAPE):
        options |= {"has_touch": True, "is_mobile": True}
    return open_page(f"{page_address(demo)}drive", screen, **options)


@SCREENS
async def test_camera_stick_sliders_and_stop_are_seen_together(demo, open_page, screen):
    async with drive_on(open_page, demo, screen) as page:
        await until_painted(page, "#camera canvas")
        for name in ("camera", "stick", "linear", "angular", "stop"):
            left, top, right, bottom = await page.evaluate(PLACE, name)
            assert 0 <= left < right <= screen["width"], name
            assert 0 <= top < bottom <= screen["height"], name
        left, top, right, bottom = await page.evaluate(PLACE, "camera")
        assert right - left >= 300
        assert bottom - top >= 250


async def test_the_camera_is_as_wide_as_an_upright_tablet(demo, open_page):
    async with drive_on(open_page, demo, TABLET) as page:
        await until_painted(page, "#camera canvas")
        left, top, right, bottom = await page.evaluate(PLACE, "camera")
        assert right - left > 700
        assert bottom - top > 0.7 * (right - left)  # as its pictures, so there are no margins
        assert (await page.evaluate(PLACE, "world"))[3] <= TABLET["height"]


@SCREENS
async def test_nothing_that_is_said_moves_the_stick(demo, open_page, screen):
    async with drive_on(open_page, demo, screen) as page:
        await page.wait_for_function("() => control.textContent.startsWith('Stopped')")
        before = await page.evaluate(PLACE, "stick")
        await page.evaluate(SPEAK, f"{WORDY} {'many words ' * 20}")
        assert await page.is_visible("#take")
        assert await page.evaluate(PLACE, "stick") == before
        assert await page.evaluate("() => document.scrollingElement.scrollWidth <= innerWidth")


@SCREENS
async def test_pictures_of_any_shape_move_nothing(demo, open_page, screen):
    async with drive_on(open_page, demo, screen) as page:
        await until_painted(page, "#camera canvas")
        await until_painted(page, "#world canvas")
        before = await page.evaluate(PLACE, "stick")
        for width, height in ((200, 3000), (3000, 200)):
            await page.evaluate(
                """async ([width, height]) => {
                    for (const canvas of document.querySelectorAll(".view canvas")) {
                        const other = canvas.cloneNode();
                        Object.assign(other, { width, height });
                        canvas.replaceWith(other);
                    }
                }""",
                [width, height],
            )
            assert await page.evaluate(PLACE, "stick") == before


@pytest.mark.parametrize("path", ["", "drive", "lab"])
async def test_a_notice_lies_above_the_page_until_it_is_clicked_away(demo, open_page, path):
    top = "() => Math.round(document.querySelector('main').getBoundingClientRect().top)"
    async with open_page(page_address(demo) + path) as page:
        await page.wait_for_selector(".state[data-state=open]")
        before = await page.evaluate(top)
        for taken_away in (lambda: page.click("#notice"), lambda: page.keyboard.press("Escape")):
            await page.evaluate(SPEAK, "The gateway stopped /cmd_vel.")
            await page.wait_for_selector("#notice")
            assert await page.evaluate(top) == before
            assert (await page.evaluate(PLACE, "notice"))[1] >= (
                await page.evaluate(PLACE, "stop")
            )[3]
            await taken_away()
            await page.wait_for_selector("#notice", state="hidden")


async def test_of_a_long_warning_the_beginning_is_quoted(demo, open_page):
    async with open_page(f"{page_address(demo)}drive") as page:
        words = await page.evaluate(
            """async (word) => {
                const { Motion } = await import("/shared/motion.js");
                const motion = new Motion();
                const begin = performance.now();
                performance.now = () => begin;
                motion.command(1, 0, true);
                motion.log({ level: 30, msg: `cmd_vel ${word}` }, "/cmd_vel");
                const still = { linear: { x: 0, y: 0 }, angular: { z: 0 } };
                motion.odometry({ twist: { twist: still } });
                performance.now = () => begin + 1000;
                return motion.words;
            }""",
            WORDY,
        )
        assert "It says: cmd_vel xxx" in words
        assert words.endswith("x…")
        assert len(words) < 250


@pytest.mark.parametrize(("asked", "words"), [(0.2, "in its way"), (0.3, "less than 0.30 m/s")])
async def test_a_speed_that_was_driven_before_is_not_blamed(demo, open_page, asked, words):
    async with open_page(f"{page_address(demo)}drive") as page:
        said = await page.evaluate(
            """async (asked) => {
                const { Motion } = await import("/shared/motion.js");
                const motion = new Motion();
                let now = 0;
                performance.now = () => now;
                const hear = (x) => motion.odometry({
                    twist: { twist: { linear: { x, y: 0 }, angular: { z: 0 } } },
                });
                motion.command(0.2, 0, true);
                now = 1500;
                hear(0.2);
                motion.command(asked, 0, true); // no zero between
                now = 3000;
                hear(0.2);
                motion.command(asked, 0, true);
                now = 4100;
                hear(0);
                return motion.words;
            }""",
            asked,
        )
        assert words in said


async def test_a_viewer_is_told_so_before_trying_to_drive(demo, open_page):
    as_viewer = """
        window.sent = [];
        const { send } = WebSocket.prototype;
        WebSocket.prototype.send = function (data) {
            sent.push(JSON.parse(data).op);
            send.call(this, data);
        };
        const { parse } = JSON;
        JSON.parse = (text) => {
            const read = parse(text);
            return read?.op === "hello" ? { ...read, role: "viewer" } : read;
        };
    """
    async with open_page(f"{page_address(demo)}#card=drive+0+/cmd_vel", script=as_viewer) as page:
        await page.wait_for_selector(".control:text-is('You may watch, but not drive.')")
        assert await page.get_attribute(".stick", "aria-disabled") == "true"
    async with open_page(f"{page_address(demo)}drive", script=as_viewer) as page:
        await page.wait_for_function(
            "() => control.textContent === 'You may watch, but not drive.'"
        )
        assert await page.get_attribute("#stick", "aria-disabled") == "true"
        assert await page.is_disabled("#linear")
        assert await page.is_disabled("#angular")
        await page.keyboard.down("ArrowLeft")
        left, top, right, _ = await page.evaluate(PLACE, "stick")
        await page.mouse.move((left + right) / 2, top + 9)
        await page.mouse.down()
        assert await page.evaluate("() => knob.style.transform") in {"", "translate(0rem, 0rem)"}
        await page.mouse.up()
        await page.keyboard.up("ArrowLeft")
        assert "publish" not in await page.evaluate("sent")


@pytest.mark.parametrize("code", ["forbidden", "tripped"])
async def test_a_role_that_turns_out_not_to_drive_is_told_so(demo, open_page, code):
    async with open_page("about:blank") as page:

        def refuse(route) -> None:
            server = route.connect_to_server()

            def take(message) -> None:
                if json.loads(message)["op"] != "publish":
                    server.send(message)
                    return
                status = {"op": "status", "level": "error", "msg": "no", "request": "publish"}
                route.send(json.dumps(status | {"code": code}))

            route.on_message(take)

        await page.route_web_socket("**/*", refuse)
        await page.goto(f"{page_address(demo)}drive")
        await page.wait_for_function("() => control.textContent.startsWith('Stopped')")
        await page.keyboard.press("ArrowLeft")
        await page.wait_for_selector("#notice")
        is_disabled = code == "forbidden"
        assert await page.is_disabled("#linear") == is_disabled
        watching = await page.evaluate(
            "() => control.textContent === 'You may watch, but not drive.'"
        )
        assert watching or not is_disabled


async def test_the_knob_shows_where_keys_drive(demo, open_page):
    async with open_page(f"{page_address(demo)}drive") as page:
        await page.wait_for_function("() => control.textContent.startsWith('Stopped')")
        for key, where in (
            ("KeyW", "translate(0rem, -3.5rem)"),
            ("KeyA", "translate(-3.5rem, 0rem)"),
        ):
            await page.keyboard.down(key)
            await page.wait_for_function("where => knob.style.transform === where", arg=where)
            await page.keyboard.up(key)
            await page.wait_for_function("() => knob.style.transform === 'translate(0rem, 0rem)'")


async def test_controls_are_large_enough_to_touch(demo, open_page):
    async with drive_on(open_page, demo, PHONE) as page:
        height = "each => each.getBoundingClientRect().height"
        for name in ("stop", "linear", "angular"):
            assert await page.locator(f"#{name}").evaluate(height) >= 44
        for link in await page.query_selector_all(".pages a"):
            assert await link.evaluate(height) >= 24
        assert not await page.is_visible(".hint")  # it is about keys
