# SPDX-License-Identifier: Apache-2.0
"""The lab without a headset, in a real browser with the simulated robot."""

import asyncio

import pytest

from tests.gateway_process import gateway_process
from tests.pages.conftest import TIMEOUT_S, page_address, robots_domain, severable
from tests.pages.lab import (
    KEEP,
    LATE,
    READY,
    SMALL,
    frames,
    opened,
    send,
    send_and_arrive,
    send_and_end,
    until_it_stands_at,
)
from tests.pages.test_drive_page import Watched, frozen_robot

pytestmark = pytest.mark.asyncio(loop_scope="package")

# the position of a place of the floor on the page
WHERE = """([x, y]) => {
    const place = lab.viewer.rig.position.clone().set(-y, 0, -x).project(lab.viewer.camera);
    // what the gateway says above it may push it out of a small window
    lab.renderer.domElement.scrollIntoView({ block: "end" });
    const { left, top, width, height } = lab.renderer.domElement.getBoundingClientRect();
    return [left + (place.x + 1) * width / 2, top + (1 - place.y) * height / 2];
}"""
# before something that hangs on a wall: its position on the page, so low that
# the ray goes on to the floor behind
BEFORE = """(thing) => {
    const { rig, camera } = lab.viewer;
    const { position } = thing(lab);
    rig.position.set(0.4 * position.x, 0, 0.4 * position.z);
    rig.rotation.y = Math.atan2(-position.x, -position.z);
    camera.rotation.x = 0;
    rig.updateWorldMatrix(true, true);
    const place = position.clone().setY(1.3).project(camera);
    const { left, top, width, height } = lab.renderer.domElement.getBoundingClientRect();
    return [left + (place.x + 1) * width / 2, top + (1 - place.y) * height / 2];
}"""
HIDE = """() => {
    Object.defineProperty(document, 'hidden', { value: true, configurable: true });
    document.dispatchEvent(new Event('visibilitychange'));
}"""


@pytest.fixture
def lab(demo, speaker, open_page):
    """Return a function that opens the lab."""
    return lambda **options: opened(open_page, page_address(demo), **options)


def click_on(page, x, y):
    """Return what clicks on a place of the floor."""

    async def click():
        await page.mouse.click(*await page.evaluate(WHERE, [x, y]))

    return click


async def test_it_shows_camera_twin_and_text(lab):
    async with lab() as page:
        assert await page.evaluate("() => document.activeElement.tagName") == "CANVAS"
        await page.wait_for_function("() => lab.television.shown > 1")
        await page.wait_for_function("() => lab.screens.state.text.includes('connected')")
        await page.wait_for_function("() => lab.screens.topic.text.includes('voltage')")
        await page.wait_for_function("() => lab.screens.log.text.includes('gateway')")
        await page.select_option("#topic", "/odom")
        await page.wait_for_function("() => lab.screens.topic.text.includes('child_frame_id')")
        assert await page.evaluate("() => document.scrollingElement.scrollWidth <= innerWidth")
        assert await page.get_attribute(".pages a[aria-current]", "href") == "/lab"


async def test_a_first_text_moves_nothing(lab):
    moved = """() => {
        const low = () => view.getBoundingClientRect().bottom;
        const texts = [control, approach].map((each) => [each, each.textContent]);
        for (const [each] of texts) each.textContent = "";
        const before = low();
        for (const [each] of texts) each.textContent = "nobody drives";
        const after = low();
        for (const [each, text] of texts) each.textContent = text;
        return after - before;
    }"""
    async with lab() as page:
        for width in (1280, 800, 390):
            await page.set_viewport_size({"width": width, "height": 800})
            assert await page.evaluate(moved) == 0


async def test_a_click_on_the_floor_sends_the_robot_there(lab, speaker):
    async with lab() as page:
        for x, y in [(0.4, 0.2), (0.1, -0.2)]:
            await send_and_arrive(page, click_on(page, x, y))
            await until_it_stands_at(speaker, x, y)
            pose = await page.evaluate("() => lab.twin.pose")
            assert abs(pose["x"] - x) < 0.05
        await page.wait_for_function("() => lab.screens.commands.text.includes('/cmd_vel')")


async def test_enter_sends_the_robot_to_the_middle_of_the_view(lab):
    async with lab() as page:
        await page.focus("#view canvas")
        await send(page, lambda: page.keyboard.press("Enter"))
        await page.keyboard.press("Space")
        await page.wait_for_function("() => !lab.pilot.isActive")


async def test_space_stops_a_moving_robot_wherever_the_focus_is_and_once(lab):
    async with lab() as page:
        await page.evaluate("""() => {
            window.stops = 0;
            document.getElementById("stop").addEventListener("click", () => (stops += 1));
        }""")
        await send(page, click_on(page, 1.2, 0))
        await page.focus("#topic")
        for _ in range(3):  # the second and third are repeats of a key that is held
            await page.keyboard.down("Space")
        await page.keyboard.up("Space")
        await page.wait_for_function("() => !lab.pilot.isActive")
        assert await page.evaluate("() => stops") == 1


@pytest.mark.parametrize("thing", ["television", "screens.state", "screens.log"])
async def test_a_click_on_what_hangs_there_sends_the_robot_nowhere(lab, thing):
    async with lab() as page:
        where = f"() => ({BEFORE})(() => lab.{thing}.mesh)"
        await page.mouse.click(*await page.evaluate(where))
        await page.wait_for_function("() => lab.pilot.words.startsWith('There is no floor')")
        assert not await page.evaluate("() => lab.pilot.isActive")


@pytest.mark.parametrize(
    ("by", "words"),
    [
        ("() => document.getElementById('stop').click()", "STOP"),
        ("() => { dispatchEvent(new Event('blur')); }", "focus"),
        (HIDE, "hidden"),
        ("() => { lab.pilot.odometry = () => {}; }", "no odometry"),
    ],
)
async def test_every_end_of_an_approach_stops_the_robot_and_says_why(lab, speaker, by, words):
    watched = Watched(speaker)
    async with lab() as page:
        await speaker.send(op="control", topic="/cmd_vel", watch=True)
        said = ""
        while words not in said:
            assert not said or any(each in said for each in LATE), said
            said = await send_and_end(page, click_on(page, 1.2, 0), by)
        await watched.until(state="moving")
        await watched.until(state="stopped")
        assert not await page.evaluate("() => lab.pilot.isActive")


async def test_a_stop_by_another_client_ends_an_approach(lab, speaker):
    async with lab() as page:
        is_driving = False
        while not is_driving:  # an approach whose commands were late has ended by itself
            await send(page, click_on(page, -0.5, 0))
            ready = "() => control.textContent === 'Driving.' || !lab.pilot.isActive"
            await page.wait_for_function(ready)
            is_driving = await page.evaluate("() => lab.pilot.isActive")
        await speaker.send(op="stop")
        await page.wait_for_function("() => !lab.pilot.isActive")
        # and a new target is approached, though the gateway wants a zero first
        await send_and_arrive(page, click_on(page, 0.2, 0))


async def test_odometry_that_jumps_ends_an_approach(lab, speaker):
    async with lab() as page:
        said = ""
        while "jumped" not in said:
            assert not said or any(each in said for each in (*LATE, "Arrived.")), said
            await send_and_arrive(page, click_on(page, 1.3, 0))
            await send(page, click_on(page, 1.6, 0.2))
            await speaker.send(op="call_service", id="reset", service="/reset")
            await page.wait_for_function("() => !lab.pilot.isActive")
            said = await page.evaluate("() => lab.pilot.words")
        assert said.startswith("The approach has ended: the odometry jumped by 1.")


async def test_the_words_of_stop_are_over_when_the_robot_drives_again(lab):
    async with lab() as page:
        await page.click("#stop")
        await page.wait_for_function("() => notice.textContent === 'The gateway stopped /cmd_vel.'")
        await send_and_arrive(page, click_on(page, 0.3, 0.2))
        await page.wait_for_function("() => notice.hidden")


async def test_a_lost_connection_ends_an_approach_and_says_so(lab):
    script = """{
        const Real = WebSocket;
        window.WebSocket = class extends Real {
            constructor(...about) {
                super(...about);
                window.sockets = [...(window.sockets ?? []), this];
            }
        };
    }"""
    async with lab(script=script) as page:
        said = ""
        while "connection" not in said:
            assert not said or any(each in said for each in LATE), said
            await page.wait_for_function(READY)
            close = "() => sockets.at(-1).close()"
            said = await send_and_end(page, click_on(page, 1.2, 0), close)


async def test_a_room_that_is_not_drawn_any_more_ends_an_approach_and_says_so(lab, speaker):
    watched = Watched(speaker)
    context = "() => window.context = lab.renderer.getContext().getExtension('WEBGL_lose_context')"
    async with lab() as page:
        await speaker.send(op="control", topic="/cmd_vel", watch=True)
        await page.evaluate(context)
        said = ""
        while "no longer drawn" not in said:
            assert not said or any(each in said for each in LATE), said
            if said:
                await page.evaluate("() => context.restoreContext()")
            await page.wait_for_selector("#view .lost", state="hidden")
            said = await send_and_end(page, click_on(page, 1.2, 0), "() => context.loseContext()")
        await watched.until(state="moving")
        await watched.until(state="stopped")
        await page.wait_for_selector("#view .lost:has-text('WebGL')")
        await page.focus("#view canvas")
        await page.keyboard.press("Enter")  # at what nobody sees
        await page.wait_for_function("() => lab.pilot.words.startsWith('The room is not drawn')")
        await page.evaluate("() => context.restoreContext()")
        await page.wait_for_selector("#view .lost", state="hidden")
        await send(page, click_on(page, -0.5, 0))
        page.wrong[:] = [each for each in page.wrong if "context" not in each.lower()]  # three.js


async def test_old_data_turn_pale_without_a_connection(demo, speaker, open_page):
    async with open_page("about:blank", viewport=SMALL) as page, severable(page) as line:
        await page.goto(f"{page_address(demo)}lab")
        await page.evaluate(KEEP)
        await page.wait_for_function(READY)
        await line.cut()
        await page.wait_for_function("() => /odometry .* old/.test(view.textContent)")
        await page.wait_for_function("() => /odometry .* old/.test(lab.screens.state.text)")
        opacity = "() => Number(getComputedStyle(document.querySelector('#view canvas')).opacity)"
        assert await page.evaluate(opacity) < 0.8
        line.mend()
        await page.wait_for_selector("#view:not(.stale)")
        await page.wait_for_function(f"() => ({opacity})() === 1")  # it fades in


async def test_arrow_keys_drive_and_end_an_approach(lab):
    async with lab() as page:
        await page.keyboard.press("ArrowLeft")  # after a stop a zero comes first
        await page.wait_for_function("() => /^Stopped(?!.*[Ll]et go)/.test(control.textContent)")
        await page.wait_for_timeout(300)  # in which the gateway wants nothing that moves
        await page.keyboard.down("ArrowLeft")
        await page.wait_for_function("() => control.textContent.startsWith('Driving')")
        await page.keyboard.up("ArrowLeft")
        await page.wait_for_function("() => control.textContent.startsWith('Stopped')")
        await send(page, click_on(page, 0.8, 0.1))
        await page.keyboard.down("ArrowLeft")
        await page.wait_for_function("() => lab.pilot.words === 'The keys ended the approach.'")
        await page.keyboard.up("ArrowLeft")
        await page.wait_for_function("() => control.textContent.startsWith('Stopped')")


# notes what the two lines below the room say, each time that one of them has changed
NOTE = """() => {
    window.said = [];
    const note = () => said.push([control.textContent, approach.textContent]);
    const observer = new MutationObserver(note);
    for (const line of [control, approach]) observer.observe(line, { childList: true });
}"""


async def test_the_words_about_the_robot_and_its_approach_never_contradict(lab, speaker):
    async with lab() as page:
        await page.evaluate(NOTE)
        await send(page, click_on(page, -0.6, 0.2))
        await speaker.send(op="stop", topic="/cmd_vel")
        await page.wait_for_function("() => /STOP|Arrived/.test(approach.textContent)")
        await send(page, click_on(page, 0.6, -0.2))
        await page.keyboard.down("ArrowLeft")
        await page.wait_for_function("() => !lab.pilot.isActive")
        await page.keyboard.up("ArrowLeft")
        await page.wait_for_function("() => /^Stopped(?!.*[Ll]et go)/.test(control.textContent)")
        await page.keyboard.down("ArrowRight")
        await page.wait_for_function("() => control.textContent.startsWith('Driving')")
        assert await page.inner_text("#approach") == ""
        await page.keyboard.up("ArrowRight")
        await page.wait_for_function("() => control.textContent.startsWith('Stopped')")
        said = await page.evaluate("() => said")
    assert [words for words in said if words[1].startswith("Stopped")] == []
    under_way = [words for words in said if words[1].startswith(("Approaching", "Waiting"))]
    assert under_way
    assert {words[0] for words in under_way} <= {"Driving.", "About to move."}


async def test_keys_that_drive_a_robot_without_odometry_are_told_so(demo, lab):
    async with lab() as page:
        await page.keyboard.press("ArrowLeft")  # after a stop a zero comes first
        await page.wait_for_function("() => /^Stopped(?!.*[Ll]et go)/.test(control.textContent)")
        await page.wait_for_timeout(300)  # in which the gateway wants nothing that moves
        await page.keyboard.down("ArrowLeft")
        await page.wait_for_function("() => control.textContent.startsWith('Driving')")
        with frozen_robot(demo):
            await page.wait_for_function("() => /odometry has stopped/.test(control.textContent)")
        await page.keyboard.up("ArrowLeft")
        await page.wait_for_function("() => control.textContent.startsWith('Stopped')")


async def test_wasd_and_the_mouse_move_the_viewer_alone(lab):
    async with lab() as page:
        await page.keyboard.down("KeyW")
        await page.wait_for_function("() => lab.viewer.rig.position.z < 2")
        await page.keyboard.up("KeyW")
        await page.keyboard.down("KeyD")
        await page.wait_for_function("() => lab.viewer.rig.position.x > 0.2")
        await page.keyboard.up("KeyD")
        box = await page.locator("#view canvas").bounding_box()
        await page.mouse.move(box["x"] + 100, box["y"] + 80)
        await page.mouse.down()
        await page.mouse.move(box["x"] + 200, box["y"] + 80, steps=4)
        await page.mouse.up()
        await page.wait_for_function("() => lab.viewer.rig.rotation.y > 0.2")
        assert await page.evaluate("() => lab.pilot.words") == ""


async def test_nothing_is_sent_where_another_client_drives(lab, speaker):
    async with lab() as page:
        await speaker.send(op="acquire_control", topic="/cmd_vel")
        await page.wait_for_selector("#take")
        await click_on(page, 0.3, 0)()
        await page.wait_for_function("() => /another client/i.test(lab.pilot.words)")
        await page.click("#take")
        await page.wait_for_selector("#take", state="hidden")


@pytest.mark.parametrize("by", ["key", "button"])
async def test_home_leads_back_from_wherever_one_has_walked(lab, by):
    async with lab() as page:
        await page.evaluate("() => { lab.viewer.rig.position.z = 4.9; }")
        await page.keyboard.down("KeyS")
        await page.wait_for_function("() => lab.viewer.rig.position.z === 5")
        await frames(page)
        await page.keyboard.up("KeyS")
        assert await page.evaluate("() => lab.viewer.rig.position.z") == 5
        await page.evaluate("() => { lab.viewer.rig.rotation.y = 2; }")
        if by == "key":
            await page.keyboard.press("Home")
        else:
            await page.get_by_role("button", name="Home").click()
        assert await page.evaluate("() => lab.viewer.rig.position.toArray()") == [0, 0, 3.2]
        assert await page.evaluate("() => lab.viewer.rig.rotation.y") == 0


async def test_a_key_that_is_held_drives_no_more_once_another_client_drives(lab, speaker):
    async with lab() as page:
        await page.keyboard.press("ArrowLeft")  # after a stop a zero comes first
        await page.wait_for_function("() => /^Stopped(?!.*[Ll]et go)/.test(control.textContent)")
        await page.wait_for_timeout(300)  # in which the gateway wants nothing that moves
        await page.keyboard.down("ArrowLeft")
        await page.wait_for_function("() => control.textContent.startsWith('Driving')")
        await speaker.send(op="acquire_control", topic="/cmd_vel")
        await page.wait_for_function("() => control.textContent.startsWith('Stopped. Another')")
        # only zeros go out, though the key is held
        await page.wait_for_function("""() => {
            const lines = lab.screens.commands.text.split("\\n").slice(-3);
            return lines.every((line) => line.endsWith(" 0.00 rad/s"));
        }""")
        await speaker.send(op="release_control", topic="/cmd_vel")
        await page.wait_for_function("() => /^Stopped[.:]/.test(control.textContent)")
        await page.keyboard.up("ArrowLeft")


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        (("access.anonymous_role=viewer",), "its role is viewer"),
        (
            ("access.anonymous_role=operator", "access.operator.deny_publish=/cmd_vel"),
            "publishing on /cmd_vel",
        ),
    ],
    ids=["viewer", "operator who may not drive"],
)
async def test_a_viewer_is_told_so(open_page, speaker, settings, words):
    options = [part for setting in settings for part in ("--set", setting)]
    domain = ("--domain-id", str(robots_domain()))
    async with (
        gateway_process("serve", *domain, *options) as gateway,
        opened(open_page, page_address(gateway)) as page,
    ):
        await page.focus("#view canvas")
        for key in ("Enter", "ArrowLeft"):
            await until_told(page, key, words)
        assert not await page.evaluate("() => lab.pilot.isActive")


async def until_told(page, key: str, words: str) -> None:
    """Press a key until the page says why it may only look. It may first miss robot or guard."""
    async with asyncio.timeout(TIMEOUT_S):
        while True:
            await page.keyboard.press(key)
            said = await page.inner_text("#approach")
            if said.startswith("This page may watch") and words in said:
                return
            await asyncio.sleep(0.1)


@pytest.mark.parametrize(
    ("script", "words"),
    [
        ("Object.defineProperty(window, 'isSecureContext', { value: false })", "https"),
        ("Object.defineProperty(navigator, 'xr', { value: undefined })", "no WebXR"),
        ("", "No headset"),
    ],
)
async def test_why_there_is_no_vr_is_said(lab, script, words):
    async with lab(script=script) as page:
        await page.wait_for_function(
            "words => document.getElementById('vr-note').textContent.includes(words)", arg=words
        )
        assert await page.is_disabled("#vr")


async def test_the_colours_follow_the_desktop(lab):
    async with lab(color_scheme="dark") as page:
        dark = await page.evaluate("() => lab.room.scene.background.getHex()")
        await page.emulate_media(color_scheme="light")
        await page.wait_for_function(
            "dark => lab.room.scene.background.getHex() !== dark", arg=dark
        )
        await frames(page)


async def test_a_list_that_has_the_focus_keeps_it_and_drives_nothing(lab):
    async with lab() as page:
        await page.focus("#topic")
        for _ in range(2):
            await page.keyboard.press("ArrowDown")
            assert await page.evaluate("() => document.activeElement.id") == "topic"
        await page.keyboard.press("Enter")
        assert not await page.evaluate("() => lab.pilot.isActive")
        assert await page.evaluate("() => lab.screens.commands.text") == "Commands"


async def test_a_robot_that_says_nothing_has_no_place(demo, open_page):
    async with open_page(f"{page_address(demo)}lab#odometry=/nowhere", viewport=SMALL) as page:
        await page.evaluate(KEEP)
        await page.wait_for_function("() => lab.screens.state.text.includes('place unknown')")


async def test_of_a_huge_scan_the_first_points_are_drawn_and_bad_ranges_are_not(lab):
    async with lab() as page:
        scan = """length => {
            const ranges = new Float32Array(length).fill(1);
            ranges.set([NaN, Infinity, 0.01, 99]);
            const about = { angle_min: 0, angle_increment: 0.001, range_min: 0.1, range_max: 9 };
            lab.twin.scan({ ranges, ...about });
            return lab.twin.points;
        }"""
        assert await page.evaluate(scan, 100) == 96
        assert await page.evaluate(scan, 10_000) == 4096
