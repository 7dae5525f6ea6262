# SPDX-License-Identifier: Apache-2.0
"""The drive page beyond driving: its cameras, readout, trail and outline, the thumb, the screen."""

import base64
import json
import struct
from urllib.parse import urlsplit

import pytest

from gateway.transport.static_files import PAGES
from tests.pages.conftest import page_address
from tests.pages.test_debug_page import NOTE_SENT, PHONE
from tests.pages.test_drive_page import drive_by, until_it_drives, watched
from tests.pages.test_named_topics import PICTURES, SUBSCRIBED

__all__ = ["watched"]  # a fixture

pytestmark = pytest.mark.asyncio(loop_scope="package")

CAN_DRIVE = "() => control.textContent.startsWith('Stopped')"
BATTERY = "sensor_msgs/msg/BatteryState"


async def test_speed_and_battery_are_read_while_it_drives(demo, open_page, watched):
    async with open_page(f"{page_address(demo)}drive") as page:
        await page.wait_for_function(CAN_DRIVE)
        await page.wait_for_function(r"() => /battery \d+ %/.test(readout.textContent)")
        await drive_by(page, "KeyA")
        await page.wait_for_function(r"() => /m\/s, 0\.[1-9]/.test(readout.textContent)")
        await page.keyboard.up("KeyA")
        await watched.until(state="stopped")


@pytest.mark.parametrize(
    ("message", "words", "is_low"),
    [
        ({"percentage": 0.874, "voltage": 12.0}, "battery 87 %", False),
        ({"percentage": 0.1, "voltage": 11.0}, "battery 10 %, low", True),
        ({"percentage": None, "voltage": 11.06}, "battery 11.1 V", False),
        ({"percentage": None, "voltage": None}, "", False),
        ({"percentage": 80, "voltage": None}, "", False),  # out of range
    ],
)
async def test_a_battery_is_read_as_far_as_it_is_measured(evaluate, message, words, is_low):
    said = await evaluate(
        """async (message) => {
            const { Readout } = await import("/drive/readout.js");
            const element = document.createElement("p");
            const topics = new Map([["/b", { name: "/b", types: ["TYPE"], publishers: ["/n"] }]]);
            let hear;
            const subscribe = (topic, options, take) => { hear = take; };
            const readout = new Readout({ graph: { topics }, subscribe }, element);
            readout.look();
            hear({ percentage: message.percentage ?? NaN, voltage: message.voltage ?? NaN });
            readout.write();
            const now = performance.now;
            const said = [element.textContent, element.classList.contains("low")];
            performance.now = () => now.call(performance) + 30_001;
            readout.write();
            performance.now = now;
            return [...said, element.textContent];
        }""".replace("TYPE", BATTERY),
        message,
    )
    assert said == [words, is_low, ""]


async def test_a_robot_that_stands_has_no_negative_speed(evaluate):
    said = await evaluate("""async () => {
        const { Readout } = await import("/drive/readout.js");
        const element = document.createElement("p");
        const readout = new Readout({ graph: { topics: new Map() } }, element);
        const linear = { x: -0.001, y: -0.001 };
        readout.odometry({ twist: { twist: { linear, angular: { z: -0.004 } } } });
        readout.write();
        return element.textContent;
    }""")
    assert said == "0.00 m/s, 0.00 rad/s"


async def test_another_camera_is_chosen_and_stays_in_the_address(demo, open_page):
    async with open_page(f"{page_address(demo)}drive#scan=/scan", script=NOTE_SENT) as page:
        option = "#cameras option[value='/camera/image_raw/compressed']"
        await page.wait_for_selector(option, state="attached")
        assert await page.input_value("#cameras") == "/camera/image_raw"
        await page.select_option("#cameras", "/camera/image_raw/compressed")
        await page.wait_for_function(SUBSCRIBED, arg="/camera/image_raw/compressed")
        left = 'frame => frame.op === "unsubscribe" && frame.topic === "/camera/image_raw"'
        await page.wait_for_function(f"() => sent.map(JSON.parse).some({left})")
        assert page.url.endswith("#scan=/scan&camera=/camera/image_raw/compressed")
        assert await page.evaluate("() => document.activeElement.id") != "cameras"
        await page.wait_for_selector("#camera canvas[aria-label$='compressed']")


async def test_a_camera_that_comes_later_is_listed(demo, open_page, speaker):
    async with open_page(f"{page_address(demo)}drive") as page:
        await speaker.send(**PICTURES, topic="/rear/image")
        await page.wait_for_selector("#cameras option[value='/rear/image']", state="attached")


# a plan that notes its lines
DRAWN = """async ([places, frames]) => {
    const { Trail } = await import("/drive/overlays.js");
    const trail = new Trail();
    let drawn = 0;
    const plan = { line: (line) => { drawn = line.length; } };
    places.forEach((x, at) => trail.draw(plan, frames?.[at] ?? "map", { x, y: 0 }));
    return [trail.length, drawn];
}"""


@pytest.mark.parametrize(
    ("places", "frames", "kept"),
    [
        ([0, 0.01, 0.06, 0.12], None, [3, 4]),  # the robot itself is its end
        ([0, 1, 2], ["map", "map", "other"], [1, 2]),
        ([each * 0.05001 for each in range(1002)], None, [1000, 1001]),
    ],
)
async def test_a_trail_has_a_place_each_5_cm_of_one_map(evaluate, places, frames, kept):
    assert await evaluate(DRAWN, [places, frames]) == kept


async def test_trail_and_outline_are_drawn_on_the_map(demo, open_page, speaker):
    type_name = "geometry_msgs/msg/PolygonStamped"
    corners = [{"x": x, "y": y} for x, y in ((-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2))]
    outline = {"header": {"frame_id": "base_link"}, "polygon": {"points": corners}}
    note = """
        window.lines = [];
        const { stroke, lineTo, beginPath } = CanvasRenderingContext2D.prototype;
        const of = CanvasRenderingContext2D.prototype;
        let line = [];
        of.beginPath = function () { line = []; beginPath.call(this); };
        of.lineTo = function (...place) { line.push(place); lineTo.apply(this, place); };
        of.stroke = function (...path) { lines.push(line); stroke.apply(this, path); };
    """
    async with open_page(f"{page_address(demo)}drive", script=note) as page:
        await page.wait_for_function(CAN_DRIVE)
        # from each drawing the trail: before the robot moves it begins and ends at one place
        await page.wait_for_function("() => lines.some((line) => line.length === 2)")
        topic = {"topic": "/local_costmap/published_footprint"}
        await speaker.send(op="advertise", **topic, type=type_name, latch=True)
        await speaker.send(op="publish", **topic, msg=outline)
        square = """() => lines.some((line) => {
            const along = (at, axis) => line[at][axis] - line[at + 1][axis];
            const side = (at) => Math.hypot(along(at, 0), along(at, 1));
            return line.length === 5 && Math.abs(side(0) - side(1)) < 0.5 && side(0) > 10;
        })"""
        await page.wait_for_function(square)


async def test_the_stick_comes_to_a_thumb_next_to_it(demo, open_page, watched):
    options = {"viewport": PHONE, "has_touch": True, "is_mobile": True}
    async with open_page(f"{page_address(demo)}drive", **options) as page:
        await page.wait_for_function(CAN_DRIVE)
        await page.wait_for_selector("#camera canvas")
        session = await page.context.new_cdp_session(page)

        async def touch(kind: str, *points: dict[str, float]) -> None:
            event = {"type": kind, "touchPoints": points}
            await session.send("Input.dispatchTouchEvent", event)

        async def hold() -> None:
            box = await page.locator("#pad").bounding_box()
            x, y = box["x"] + 15, box["y"] + box["height"] - 15
            await touch("touchStart", {"x": x, "y": y})
            stick = await page.locator("#stick").bounding_box()
            assert stick["x"] + stick["width"] / 2 == pytest.approx(x, abs=1)
            assert stick["y"] + stick["height"] / 2 == pytest.approx(y, abs=1)
            assert await page.evaluate("() => knob.style.transform") in {
                "",
                "translate(0rem, 0rem)",
            }
            await touch("touchMove", {"x": x + 60, "y": y})

        before = await page.locator("#stick").bounding_box()
        await until_it_drives(page, hold, lambda: touch("touchEnd"))
        await watched.until(state="moving")
        await touch("touchEnd")
        await watched.until(state="stopped", cause="zero")
        assert await page.locator("#stick").bounding_box() == before


async def test_the_screen_stays_on_from_the_first_command(demo, open_page, watched):
    count = """
        window.locks = [];
        const wakeLock = { request: async (kind) => {
            const lock = { kind, released: false };
            locks.push(lock);
            return lock;
        } };
        Object.defineProperty(navigator, "wakeLock", { value: wakeLock });
    """
    async with open_page(f"{page_address(demo)}drive", script=count) as page:
        await page.wait_for_function(CAN_DRIVE)
        assert await page.evaluate("() => locks.length") == 0
        await drive_by(page, "KeyA")
        await page.wait_for_function("() => locks.length === 1")
        await page.keyboard.up("KeyA")
        await watched.until(state="stopped")
        await page.evaluate("""() => {
            locks[0].released = true;
            document.dispatchEvent(new Event("visibilitychange")); // seen again
        }""")
        await page.wait_for_function("() => locks.length === 2")


async def test_a_phone_shakes_when_something_else_stops_the_robot(
    demo, open_page, speaker, watched
):
    note = "window.shaken = []; navigator.vibrate = (ms) => shaken.push(ms);"
    async with open_page(f"{page_address(demo)}drive", script=note) as page:
        await page.wait_for_function(CAN_DRIVE)
        await drive_by(page, "KeyA")
        await page.wait_for_function("() => shaken.at(-1) === 30")
        await page.keyboard.up("KeyA")
        await watched.until(state="stopped", cause="zero")
        assert 250 not in await page.evaluate("shaken")
        await drive_by(page, "KeyA")
        await watched.until(state="moving")
        await speaker.send(op="stop")
        await page.wait_for_function("() => shaken.at(-1) === 250")
        await page.keyboard.up("KeyA")


def size_of(png: bytes) -> str:
    assert png.startswith(b"\x89PNG")
    return "{}x{}".format(*struct.unpack(">II", png[16:24]))


async def test_a_browser_can_install_the_pages(demo, open_page):
    for path in ("", "drive", "lab"):
        async with open_page(page_address(demo) + path) as page:
            session = await page.context.new_cdp_session(page)
            told = await session.send("Page.getAppManifest")
            assert told["errors"] == []
            assert urlsplit(told["url"]).path == "/manifest.webmanifest"
            missing = await session.send("Page.getInstallabilityErrors")
            found = {each["errorId"] for each in missing["installabilityErrors"]}
            assert found <= {"in-incognito"}  # each page of a test is
            manifest = json.loads(told["data"])
            for icon in manifest["icons"]:
                answer = await page.request.get(page_address(demo) + icon["src"])
                assert answer.headers["content-type"] == icon["type"]
                body = await answer.body()
                assert body == (PAGES / icon["src"]).read_bytes(), base64.b64encode(body)
                assert icon["sizes"] in {"any", size_of(body) if body[:1] == b"\x89" else ""}
            workers = "() => navigator.serviceWorker.getRegistrations().then((all) => all.length)"
            assert await page.evaluate(workers) == 0  # nothing serves an older page
