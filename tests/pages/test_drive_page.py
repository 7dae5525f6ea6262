# SPDX-License-Identifier: Apache-2.0
"""The drive page in a real browser, with the simulated robot: it moves while something is held."""

import asyncio
import contextlib
import json
import os
import re
import signal
from pathlib import Path

import pytest
import pytest_asyncio

from tests.client import Client, client
from tests.demonstration import until_it_can_be_driven
from tests.pages.conftest import page_address, severable
from tests.pages.test_debug_page import PHONE, until_painted

pytestmark = pytest.mark.asyncio(loop_scope="package")

LATE_S = 120


class Watched:
    """The state of /cmd_vel, as another client hears it."""

    def __init__(self, speaker: Client) -> None:
        self._speaker = speaker

    async def until(self, **wanted: object) -> dict[str, object]:
        """Wait for a state of these members."""
        return await self._speaker.receive(
            lambda frame: frame["op"] == "control" and wanted.items() <= frame.items(),
            LATE_S,
        )


@pytest_asyncio.fixture(loop_scope="package")
async def watched(demo):
    async with client(demo.url) as speaker:
        await until_it_can_be_driven(speaker)
        await speaker.send(op="control", topic="/cmd_vel", watch=True)
        yield Watched(speaker)


@pytest.fixture
def drive(demo, open_page):
    """Return a function that opens the page and waits until it can drive."""

    @contextlib.asynccontextmanager
    async def open_it():
        async with open_page(f"{page_address(demo)}drive") as page:
            await page.wait_for_function("() => control.textContent.startsWith('Stopped')")
            yield page

    return open_it


@pytest.mark.brief
async def test_a_held_key_drives_and_letting_go_stops(drive, watched):
    async with drive() as page:
        await page.keyboard.down("ArrowLeft")
        await watched.until(state="moving")
        await page.wait_for_function("() => control.textContent === 'Driving.'")
        await page.keyboard.up("ArrowLeft")
        assert (await watched.until(state="stopped"))["cause"] == "zero"
        await page.keyboard.down("KeyD")
        await watched.until(state="moving")
        await page.keyboard.up("KeyD")
        await watched.until(state="stopped", cause="zero")


async def test_sliders_have_names_and_leave_letters_to_the_robot(drive, watched):
    async with drive() as page:
        slider = page.get_by_role("slider", name="Speed")
        assert await page.get_by_role("slider", name="Turning").count() == 1
        await slider.focus()
        before = await slider.input_value()
        await page.keyboard.press("ArrowRight")
        assert float(await slider.input_value()) > float(before)
        assert await slider.get_attribute("aria-valuetext") == "0.25 m/s"
        await drive_by(page, "KeyA")
        await watched.until(state="moving")
        await page.keyboard.up("KeyA")
        await watched.until(state="stopped", cause="zero")


async def test_the_stick_drives_while_it_is_dragged(drive, watched):
    async with drive() as page:
        box = await page.locator("#stick").bounding_box()
        await page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        await page.mouse.down()
        await page.mouse.move(box["x"] + 5, box["y"] + box["height"] / 2)
        await watched.until(state="moving")
        await page.mouse.up()
        await watched.until(state="stopped", cause="zero")


@pytest.mark.parametrize(
    "event",
    [
        "dispatchEvent(new Event('blur'))",
        """Object.defineProperty(document, 'hidden', {value: true, configurable: true});
        document.dispatchEvent(new Event('visibilitychange'))""",
    ],
    ids=["blur", "hidden"],
)
async def test_a_page_that_nobody_looks_at_stops(drive, watched, event):
    async with drive() as page:
        await page.keyboard.down("ArrowRight")
        await watched.until(state="moving")
        await page.evaluate(f"() => {{ {event} }}")
        await watched.until(state="stopped", cause="zero")
        await page.keyboard.up("ArrowRight")


@pytest.mark.parametrize("by", ["button", "space"])
async def test_stop_stops_and_what_is_still_held_moves_nothing(drive, watched, by):
    async with drive() as page:
        await page.keyboard.down("ArrowLeft")
        await watched.until(state="moving")
        if by == "space":
            await page.keyboard.press("Space")
        else:
            await page.evaluate("() => document.getElementById('stop').click()")
        await watched.until(state="stopped")
        await page.wait_for_timeout(300)  # in which it would go on, several times over
        assert (await page.inner_text("#control")).startswith("Stopped")
        await page.keyboard.up("ArrowLeft")


async def test_a_page_that_is_closed_while_it_drives_stops_the_robot(drive, watched):
    async with drive() as page:
        await page.keyboard.down("ArrowLeft")
        await watched.until(state="moving")
    await watched.until(state="stopped")


async def test_another_driver_is_said_and_can_be_taken_over(demo, drive, watched):
    async with client(demo.url) as other, drive() as page:
        await other.send(op="acquire_control", topic="/cmd_vel")
        # after any stop of the robot
        await page.wait_for_function("() => /another client/i.test(control.textContent)")
        await page.wait_for_selector("#take")
        await page.keyboard.down("ArrowLeft")
        await page.wait_for_function("() => notice.textContent.includes('/cmd_vel')")
        assert await page.inner_text("#notice") == "Another client drives /cmd_vel."
        await page.keyboard.up("ArrowLeft")
        await page.evaluate(
            """() => new MutationObserver(() => (window.said ??= []).push(control.textContent))
            .observe(control, {childList: true})"""
        )
        await page.click("#take")
        await page.wait_for_selector("#take", state="hidden")
        await page.wait_for_function("() => /^Stopped(?!.*[Ll]et go)/.test(control.textContent)")
        assert not any("another client took" in words for words in await page.evaluate("said"))
        await page.keyboard.down("ArrowLeft")
        await watched.until(state="moving")
        await page.keyboard.up("ArrowLeft")
        await watched.until(state="stopped")


async def until_it_drives(page, hold, let_go) -> None:
    """Hold something until it drives, whatever has stopped the robot before."""
    words = "document.querySelector('.control').textContent"
    while True:
        await hold()
        await page.wait_for_function(
            f"() => /[Ll]et go|^(?!Stopped|Not conn|Another|No node|Nothing|$)/.test({words})"
        )
        if await page.evaluate(f"() => !/[Ll]et go/.test({words})"):
            return
        await let_go()
        await page.wait_for_function(f"() => !/[Ll]et go/.test({words})")


async def drive_by(page, key: str) -> None:
    """Hold a key until it drives."""
    await until_it_drives(page, lambda: page.keyboard.down(key), lambda: page.keyboard.up(key))


async def until_while_driving(page, key: str, condition: str) -> None:
    """Hold a key until something holds. A busy machine may keep the page longer than its lease."""
    async with asyncio.timeout(LATE_S):
        while not await page.evaluate(condition):
            if await page.evaluate("control.textContent.startsWith('Stopped')"):
                await page.keyboard.up(key)
                await drive_by(page, key)
            await asyncio.sleep(0.1)


@contextlib.contextmanager
def frozen_robot(demo):
    """Freeze the robot's process: it says nothing more, and stays in the graph."""
    pid = demo.process.pid
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    (robot,) = (c for c in children if "\0sim\0" in Path(f"/proc/{c}/cmdline").read_text())
    os.kill(int(robot), signal.SIGSTOP)
    try:
        yield
    finally:
        os.kill(int(robot), signal.SIGCONT)


# counts the pictures that are shown from now on: what came but once is not missed
COUNT = """() => {
    const { prototype } = ImageBitmapRenderingContext;
    const show = prototype.transferFromImageBitmap;
    window.pictures = 0;
    prototype.transferFromImageBitmap = function (bitmap) {
        window.pictures += 1;
        show.call(this, bitmap);
    };
}"""
STALE = "() => ['camera', 'world'].every((id) => document.querySelector(`#${id}.stale .age`))"
ODOMETRY_IS_OLD = (
    "() => document.querySelector('#world.stale .age')?.innerText.includes('odometry')"
)
FRESH = (
    "() => !document.querySelector('.view.stale') && document.querySelectorAll('.view canvas')[1]"
)


async def test_the_data_of_a_dead_robot_turn_pale_and_nobody_says_that_it_drives(
    demo, drive, watched
):
    async with drive() as page:
        await page.wait_for_selector("#camera canvas")
        await page.evaluate(COUNT)
        shown = "pictures >= 6 && control.textContent === 'Driving.'"
        await until_while_driving(page, "KeyA", shown)
        with frozen_robot(demo):
            await page.wait_for_function(STALE)
            await page.wait_for_function(ODOMETRY_IS_OLD)  # the scan may be so first
            assert re.fullmatch(r"camera [0-9.]+ s old", await page.inner_text("#camera .age"))
            missed = "/odometry has stopped/.test(control.textContent)"
            await until_while_driving(page, "KeyA", missed)
        await page.wait_for_function(FRESH)
        await page.keyboard.up("KeyA")
        await watched.until(state="stopped")


async def test_a_line_that_is_cut_while_a_key_is_held_stops_the_robot_for_good(
    demo, open_page, watched
):
    async with open_page("about:blank") as page, severable(page) as line:
        await page.goto(f"{page_address(demo)}drive")
        await page.wait_for_function("() => control.textContent.startsWith('Stopped')")
        await drive_by(page, "ArrowLeft")
        await watched.until(state="moving")
        await line.cut()
        assert (await watched.until(state="stopped"))["cause"] == "disconnect"
        await page.wait_for_function("() => control.textContent.startsWith('Not connected')")
        line.mend()
        await page.wait_for_function("() => control.textContent.startsWith('Stopped')")
        await page.wait_for_timeout(300)  # in which it would go on, several times over
        assert (await page.inner_text("#control")).startswith("Stopped")
        await page.keyboard.up("ArrowLeft")


async def test_a_thumb_drives_on_a_phone(demo, open_page, watched):
    options = {"viewport": PHONE, "has_touch": True, "is_mobile": True}
    async with open_page(f"{page_address(demo)}drive", **options) as page:
        await page.wait_for_function("() => control.textContent.startsWith('Stopped')")
        await until_painted(page, "#camera canvas")  # which moves what is below it
        stick = page.locator("#stick")
        session = await page.context.new_cdp_session(page)

        async def touch(kind: str, *points: dict[str, float]) -> None:
            event = {"type": kind, "touchPoints": points}
            await session.send("Input.dispatchTouchEvent", event)

        async def hold() -> None:
            await stick.scroll_into_view_if_needed()
            box = await stick.bounding_box()
            await touch("touchStart", {"x": box["x"] + 8, "y": box["y"] + box["height"] / 2})

        await until_it_drives(page, hold, lambda: touch("touchEnd"))
        await watched.until(state="moving")
        await touch("touchEnd")
        await watched.until(state="stopped", cause="zero")
        stop = await page.locator("#stop").bounding_box()  # in view, wherever one has scrolled to
        assert 0 <= stop["x"] <= PHONE["width"] - stop["width"]
        assert 0 <= stop["y"] < PHONE["height"]


@pytest.mark.parametrize("what", ["another finger on STOP", "a cut line"])
async def test_a_stick_that_is_still_held_after_a_stop_moves_nothing(
    demo, open_page, watched, what
):
    async with open_page("about:blank") as page, severable(page) as line:
        await page.goto(f"{page_address(demo)}drive")
        await page.wait_for_function("() => control.textContent.startsWith('Stopped')")
        await until_painted(page, "#camera canvas")  # which moves what is below it
        box = await page.locator("#stick").bounding_box()

        async def hold() -> None:
            await page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
            await page.mouse.down()
            await page.mouse.move(box["x"] + 5, box["y"] + box["height"] / 2)

        await until_it_drives(page, hold, page.mouse.up)
        await watched.until(state="moving")
        if what == "a cut line":
            await line.cut()
            await watched.until(state="stopped")
            line.mend()
            await page.wait_for_selector(".state[data-state=open]")
        else:
            await page.evaluate("() => document.getElementById('stop').click()")
            await watched.until(state="stopped")
        await page.mouse.move(box["x"] + 9, box["y"] + box["height"] / 2)  # as any thumb does
        assert await page.evaluate("() => knob.style.transform") == "translate(0rem, 0rem)"
        await page.mouse.up()


async def test_another_button_than_the_first_drives_nothing(drive):
    pushed = "() => !['', 'translate(0rem, 0rem)'].includes(knob.style.transform)"
    async with drive() as page:
        box = await page.locator("#stick").bounding_box()
        await page.mouse.move(box["x"] + 9, box["y"] + box["height"] / 2)
        await page.mouse.down(button="right")
        assert not await page.evaluate(pushed)
        await page.mouse.up(button="right")
        await page.mouse.down()
        assert await page.evaluate(pushed)
        await page.mouse.up()


async def test_without_a_connection_all_is_old(demo, open_page):
    async with open_page("about:blank") as page, severable(page) as line:
        await page.goto(f"{page_address(demo)}drive")
        for place in ("camera", "world"):
            await until_painted(page, f"#{place} canvas")
        await line.cut()
        await page.wait_for_function(STALE)
        opacity = "canvas => Number(getComputedStyle(canvas).opacity)"
        for place in ("camera", "world"):
            assert await page.locator(f"#{place} canvas").evaluate(opacity) < 0.8
        line.mend()
        await page.wait_for_function(FRESH)


async def test_a_stop_that_failed_stays_said_while_the_page_tries_to_connect(demo, open_page):
    count = """() => {
        window.tries = 0;
        const note = () => { tries += state.dataset.state === "closed"; };
        new MutationObserver(note).observe(state, { attributes: true });
    }"""
    async with open_page("about:blank") as page, severable(page) as line:
        await page.goto(f"{page_address(demo)}drive")
        await page.wait_for_selector(".state[data-state=open]")
        await page.evaluate(count)
        await line.cut()
        await page.wait_for_function("() => tries >= 1")
        await page.click("#stop")
        failed = "() => notice.textContent.startsWith('STOP was not carried out')"
        await page.wait_for_function(failed)
        await page.wait_for_function("() => tries >= 3")
        assert await page.evaluate(failed)
        line.mend()
        await page.wait_for_selector(".state[data-state=open]")


@pytest.mark.parametrize("path", ["drive", "lab"])
async def test_a_warning_that_passes_by_itself_is_left_to_the_views(demo, open_page, path):
    note = """
        window.said = [];
        const note = () => {
            const places = document.querySelectorAll("#notice, .problem");
            for (const each of places) said.push(each.textContent);
        };
        new MutationObserver(note).observe(document, { childList: true, subtree: true });
    """
    async with open_page("about:blank", script=note) as page:

        def warn(route) -> None:
            server = route.connect_to_server()

            def take(message) -> None:
                server.send(message)
                asked = json.loads(message)
                if asked["op"] != "subscribe" or asked["topic"] != "/camera/image_raw":
                    return
                status = {"op": "status", "id": asked["id"], "level": "warning"}
                for code in ("messages_lost", "publisher_gone", "qos_incompatible"):
                    route.send(json.dumps(status | {"code": code, "msg": f"it is {code}"}))

            route.on_message(take)

        await page.route_web_socket("**/*", warn)
        await page.goto(page_address(demo) + path)
        await page.wait_for_function("() => said.includes('it is qos_incompatible')")
        assert not {"it is messages_lost", "it is publisher_gone"} & set(
            await page.evaluate("said")
        )


async def test_a_command_after_a_stop_is_refused_in_words_for_the_driver(evaluate):
    words = await evaluate("""async () => {
        const { refusal } = await import("/shared/control_words.js");
        const msg = '/cmd_vel is stopped because commands stopped arriving: publish "msg":{}';
        return refusal({ code: "tripped", msg });
    }""")
    assert words.endswith("To drive on, let go of everything, then press again.")
    assert "msg" not in words


async def test_a_late_command_is_refused_in_words_for_the_driver(evaluate):
    words = await evaluate("""async () => {
        const { refusal } = await import("/shared/control_words.js");
        return refusal({ code: "stale_command", msg: "over 250 ms old, by monotonic_ms" });
    }""")
    assert words.startswith("Your command arrived late")
    assert "monotonic" not in words


async def test_a_robot_that_does_not_move_is_said_with_its_own_reason(drive, watched):
    async with drive() as page:
        await page.fill("#linear", "0.3")
        await page.locator("#linear").blur()
        await drive_by(page, "KeyW")
        await page.wait_for_function("() => /does not move/.test(control.textContent)")
        words = await page.inner_text("#control")
        assert "it may accept less than 0.30 m/s. It says: cmd_vel dismissed" in words
        await page.keyboard.up("KeyW")
        await watched.until(state="stopped")


async def test_it_shows_camera_and_scan(drive):
    async with drive() as page:
        await page.wait_for_selector("#camera canvas")
        await page.wait_for_selector("#world canvas")
        assert await page.evaluate("() => document.scrollingElement.scrollWidth <= innerWidth")


# the rings of the board behind the dock in the camera's picture: their middle, and their width,
# negative where they are not in it. The red crate to their right is of a more yellow red.
RINGS = """(() => {
    const canvas = document.querySelector("#camera canvas");
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d");
    copy.drawImage(canvas, 0, 0);
    const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
    let [left, right] = [canvas.width, 0];
    for (let at = 0; at < data.length; at += 4) {
        if (data[at] < 185 || data[at + 1] > 0.24 * data[at] || data[at + 2] > 80) continue;
        const x = (at / 4) % canvas.width;
        left = Math.min(left, x);
        right = Math.max(right, x);
    }
    return { middle: (left + right) / 2 / canvas.width, width: (right - left) / canvas.width };
})()"""


async def hold_until(page, key: str, condition: str) -> None:
    """Hold a key until a person who looks at the picture would let go of it."""
    seen = f"() => {{ const rings = {RINGS}; return {condition}; }}"
    stopped = "control.textContent.startsWith('Stopped:')"  # as commands are late: press it again
    while not await page.evaluate(seen):
        await page.keyboard.down(key)
        await page.wait_for_function(f"() => ({seen})() || {stopped}")
        await page.keyboard.up(key)
        await page.wait_for_function("() => control.textContent.startsWith('Stopped')")


async def set_rate(page, rate: float) -> None:
    await page.fill("#angular", f"{rate:.3f}")
    await page.locator("#angular").blur()


async def face_the_rings(page) -> None:
    """Turn until they are in the middle: slower each time, as late pictures let it turn too far."""
    rate = 0.2
    while True:
        rings = await page.evaluate(RINGS)
        if rings["width"] > 0 and 0.45 < rings["middle"] < 0.55:
            return
        await set_rate(page, rate)
        rate = max(0.02, rate / 2)
        if rings["width"] > 0 and rings["middle"] > 0.5:
            await hold_until(page, "ArrowRight", "rings.width > 0 && rings.middle < 0.52")
        else:
            await hold_until(page, "ArrowLeft", "rings.width > 0 && rings.middle > 0.48")


async def park(page) -> None:
    """Drive until the rings are large, back where a late picture has let it drive too far."""
    while not 0.3 < (width := (await page.evaluate(RINGS))["width"]) < 0.6:
        if width > 0.3:
            await hold_until(page, "ArrowDown", "rings.width < 0.6")
        else:
            await face_the_rings(page)
            aside = "rings.middle < 0.4 || rings.middle > 0.6"
            await hold_until(page, "ArrowUp", f"rings.width > 0.3 || {aside}")


async def metres_to_the_wall(speaker) -> float:
    await speaker.send(op="subscribe", topic="/odom")
    odometry = await speaker.message("/odom")
    await speaker.send(op="unsubscribe", topic="/odom")
    return 4 - odometry["pose"]["pose"]["position"]["x"]


async def test_the_robot_parks_before_the_dock_by_camera_and_keys(demo, drive, watched):
    async with client(demo.url) as speaker, drive() as page:
        await speaker.send(op="call_service", id="reset", service="/reset")
        await speaker.receive(lambda frame: frame.get("id") == "reset", LATE_S)
        await page.wait_for_selector("#camera canvas")
        # the start looks past the board, which is to the right, and far
        start = "rings.middle > 0.58 && rings.middle < 0.65 && rings.width < 0.1"
        await page.wait_for_function(f"() => {{ const rings = {RINGS}; return {start}; }}")
        while not 0.4 < await metres_to_the_wall(speaker) < 1.5:
            await park(page)
        assert 0.3 < await page.evaluate(f"() => {RINGS}.middle") < 0.7
