# SPDX-License-Identifier: Apache-2.0
"""The views of the robot's world: map, scan, trail and battery, in a real browser."""

import math

import cbor2
import cv2
import numpy as np
import pytest

from tests.client import client
from tests.demonstration import until_it_can_be_driven
from tests.gateway_process import gateway_process
from tests.pages.conftest import page_address
from tests.pages.test_cards import NOTE_SENT
from tests.pages.test_debug_page import card, until, until_painted
from tests.pages.test_drive_page import frozen_robot

pytestmark = pytest.mark.asyncio(loop_scope="package")

# the number of pixels of a canvas that have the colour of a token, as good as
COUNT = """([selector, name]) => {
    const canvas = document.querySelector(selector);
    if (!canvas) return 0;
    const colour = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    const wanted = [1, 3, 5].map((at) => Number.parseInt(colour.slice(at, at + 2), 16));
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d");
    copy.drawImage(canvas, 0, 0);
    const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
    let count = 0;
    for (let at = 0; at < data.length; at += 4) {
        count += wanted.every((each, index) => Math.abs(each - data[at + index]) < 3);
    }
    return count;
}"""
# the middle of these pixels
MIDDLE = (
    COUNT.replace("let count = 0", "let count = 0, sum = 0")
    .replace(
        "count += wanted.every((each, index) => Math.abs(each - data[at + index]) < 3);",
        """if (wanted.every((each, index) => Math.abs(each - data[at + index]) < 3)) {
            count += 1;
            sum += (at / 4) % canvas.width;
        }""",
    )
    .replace("return count", "return sum / count")
)
GRID = {
    "info": {"resolution": 0.5, "width": 4, "height": 2},
    "data": [0, 0, 0, 100, -1, 0, 0, 100],
}


async def test_a_map_shows_walls_the_robot_and_its_scan(demo, open_page):
    async with open_page(page_address(demo) + "#card=map+0+/map") as page:
        await until_painted(page, f"{card('/map')} canvas")
        # walls, free floor, hits of the laser, the robot
        for name in ("--map-occupied", "--map-free", "--scan", "--warning"):
            await until(page, f"about => ({COUNT})(about) > 20", [f"{card('/map')} canvas", name])


async def test_the_robot_moves_on_the_map(demo, open_page):
    async with (
        client(demo.url) as speaker,
        open_page(page_address(demo) + "#card=map+0+/map") as page,
    ):
        await until_it_can_be_driven(speaker)
        robot = [f"{card('/map')} canvas", "--warning"]
        await until(page, f"about => ({COUNT})(about) > 20", robot)
        before = await page.evaluate(MIDDLE, robot)
        await speaker.send(op="publish", topic="/cmd_vel", msg={"linear": {"x": 0.2}})
        await until(page, f"([before, about]) => ({MIDDLE})(about) > before + 1", [before, robot])


async def test_a_map_is_zoomed_by_wheel_and_keys_and_moved_by_a_drag(demo, open_page):
    async with open_page(page_address(demo) + "#card=map+0+/map") as page:
        canvas = page.locator(f"{card('/map')} canvas")
        robot = [f"{card('/map')} canvas", "--warning"]
        await until(page, f"about => ({COUNT})(about) > 20", robot)
        before, middle = await page.evaluate(
            f"about => [({COUNT})(about), ({MIDDLE})(about)]", robot
        )
        box = await canvas.bounding_box()
        at = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        await page.mouse.move(*at)
        await page.mouse.wheel(0, -500)
        await until(page, f"([least, about]) => ({COUNT})(about) > least", [2 * before, robot])
        await page.get_by_role("button", name="Fit all of the map").click()
        await page.mouse.move(*at)
        await page.mouse.down()
        await page.mouse.move(at[0] + box["width"] / 12, at[1])  # 40 of 480 pixels
        await page.mouse.up()
        await until(page, f"([middle, about]) => ({MIDDLE})(about) > middle + 30", [middle, robot])
        await canvas.press("ArrowRight")
        await canvas.press("+")
        await until(page, f"([middle, about]) => ({MIDDLE})(about) < middle + 30", [middle, robot])
        await page.get_by_role("button", name="Follow").click()
        await until(page, f"about => Math.abs(({MIDDLE})(about) - 240) < 8", robot)


async def test_the_robot_goes_where_a_pointer_is_dragged_on_a_map(demo, open_page):
    async with (
        client(demo.url) as speaker,
        open_page(page_address(demo) + "#card=map+0+/map", script=NOTE_SENT) as page,
    ):
        await until_it_can_be_driven(speaker)
        await until(
            page, f"about => ({COUNT})(about) > 20", [f"{card('/map')} canvas", "--warning"]
        )
        await page.get_by_role("button", name="Go here").click()
        box = await page.locator(f"{card('/map')} canvas").bounding_box()
        # the middle of the map is at x 1, y 0
        at = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        await page.mouse.move(*at)
        await page.mouse.down()
        await page.mouse.move(at[0], at[1] - 40)
        await page.mouse.up()
        said = "() => document.querySelector('.goal-line output').textContent"
        await until(
            page, f"/^Going to x (0\\.9|1\\.0)\\d, y -?0\\.0\\d m, heading 90°/.test(({said})())"
        )
        # its way, which the robot publishes
        await until(
            page, f"about => ({COUNT})(about) > 5", [f"{card('/map')} canvas", "--series-3"]
        )
        await page.get_by_role("button", name="Cancel", exact=True).click()
        await until(page, f"{said} === 'The goal was canceled.'")
        await page.get_by_role("button", name="I am here").focus()
        for key in ("Enter", "Enter", "ArrowRight", "Enter"):
            await page.keyboard.press(key)
        await until(page, f"{said}.startsWith('Sent to /initialpose')")
        await speaker.send(op="call_service", id="reset", service="/reset")


async def test_a_goal_that_cannot_be_canceled_says_so_before_it_is_sent(served, open_page):
    """It is only published: no node serves NavigateToPose here."""
    async with (
        client(served.url) as speaker,
        open_page(page_address(served) + "#card=map+0+/flat") as page,
    ):
        await speaker.send(op="subscribe", topic="/goal_pose", type="geometry_msgs/PoseStamped")
        await speaker.send(op="advertise", topic="/flat", type="nav_msgs/OccupancyGrid", latch=True)
        map_message = GRID | {"header": {"frame_id": "map"}}
        await speaker.send(op="publish", topic="/flat", msg=map_message)
        await until_painted(page, f"{card('/flat')} canvas")
        await page.get_by_role("button", name="Go here").focus()
        await page.keyboard.press("Enter")
        said = "document.querySelector('.goal-line output').textContent"
        warning = "/\\/goal_pose.* Neither this page nor STOP can end that goal: end it in/"
        await until(page, f"() => /^Press/.test({said}) && {warning}.test({said})")
        for key in ("Enter", "Enter"):
            await page.keyboard.press(key)
        goal = await speaker.message("/goal_pose")
        assert goal["header"]["frame_id"] == "map"
        await until(page, f"() => /^Goal sent/.test({said}) && {warning}.test({said})")
        assert not await page.get_by_role("button", name="Cancel", exact=True).is_visible()


async def test_a_map_whose_numbers_contradict_each_other_is_told_of(demo, open_page):
    async with (
        client(demo.url) as speaker,
        open_page(page_address(demo) + "#card=map+0+/flat") as page,
    ):
        await speaker.send(op="advertise", topic="/flat", type="nav_msgs/OccupancyGrid", latch=True)
        await speaker.send(op="publish", topic="/flat", msg=GRID | {"data": [0, 0, 0]})
        problem = "() => document.querySelector('.problem')?.textContent"
        await until(page, f"{problem}?.includes('3 cells, expected 4 x 2')")
        await speaker.send(op="publish", topic="/flat", msg=GRID)
        await until_painted(page, f"{card('/flat')} canvas")
        await until(page, f"{problem} === ''")
        flat = GRID | {"info": GRID["info"] | {"resolution": 0.0}}
        await speaker.send(op="publish", topic="/flat", msg=flat)
        await until(page, f"{problem}?.includes('cells are 0 m wide')")
        await speaker.send(op="publish", topic="/flat", msg=GRID)
        await until(page, f"{problem} === ''")


async def test_scan_and_robot_turn_grey_on_the_map_when_the_scan_stays_away(demo, open_page):
    async with open_page(page_address(demo) + "#card=map+0+/map") as page:
        seen = [[f"{card('/map')} canvas", name] for name in ("--scan", "--warning")]
        for about in seen:
            await until(page, f"about => ({COUNT})(about) > 20", about)
        # only what has come some times is expected to go on
        await until(page, "() => /LaserScan([3-9]|\\d\\d)(\\.\\d)? Hz/.test(topics.textContent)")
        with frozen_robot(demo):
            for about in seen:
                await until(page, f"about => ({COUNT})(about) === 0", about)
        for about in seen:
            await until(page, f"about => ({COUNT})(about) > 20", about)


async def test_a_part_of_a_map_is_painted_when_it_changes(served, open_page):
    """By the topic of the map with _updates behind it, which comes later."""
    update = {"x": 1, "y": 0, "width": 2, "height": 2, "data": [100] * 4}
    async with (
        client(served.url) as speaker,
        open_page(page_address(served) + "#card=map+0+/part") as page,
    ):
        await speaker.send(op="advertise", topic="/part", type="nav_msgs/OccupancyGrid", latch=True)
        await speaker.send(op="publish", topic="/part", msg=GRID)
        walls = [f"{card('/part')} canvas", "--map-occupied"]
        await until(page, f"about => ({COUNT})(about) > 20", walls)
        before = await page.evaluate(COUNT, walls)
        topic = {"topic": "/part_updates", "type": "map_msgs/msg/OccupancyGridUpdate"}
        await speaker.send(op="advertise", **topic, latch=True)
        await speaker.send(op="publish", **topic, msg=update)
        # six of eight cells instead of two. Lines of the grid lie on some
        more = f"([least, about]) => ({COUNT})(about) > least"
        await until(page, more, [2.5 * before, walls])
        problem = "() => document.querySelector('.problem')?.textContent"
        await speaker.send(op="publish", **topic, msg=update | {"x": 3})
        await until(page, f"{problem}?.includes('2 x 2 cells at 3, 0 with 4 values does not fit')")
        await speaker.send(op="publish", **topic, msg=update | {"data": [0, 0, 0, 0]})
        await until(page, f"([least, about]) => ({COUNT})(about) < least", [1.5 * before, walls])
        await until(page, f"{problem} === ''")


async def test_a_map_that_comes_late_keeps_the_updates_that_are_newer(evaluate):
    """The gateway holds a map back for up to a second, and no update."""
    shown = await evaluate("""async () => {
        const { LiveMap } = await import("/views/live_map.js");
        const shown = [];
        const show = (message, { values }) => shown.push([...values]);
        const tell = (words) => shown.push(words);
        const map = new LiveMap({ tell, untell() {} }, { check() {}, show });
        const header = (sec, nanosec) => ({ stamp: { sec, nanosec } });
        const part = (x, value, sec, nanosec) => ({
            header: header(sec, nanosec), x, y: 0, width: 1, height: 1, data: [value],
        });
        await map.update(part(0, 1, 4, 9));
        await map.update(part(1, 2, 5, 9));
        await map.update(part(2, 3, 6, 0));
        await map.take({ header: header(5, 8), info: { width: 4, height: 1 }, data: [0, 0, 0, 0] });
        await map.update(part(3, 4, 6, 1));
        await map.repaint();
        map.close();
        return shown;
    }""")
    assert shown == [[0, 2, 3, 0], [0, 2, 3, 4], [0, 2, 3, 4]]


# updates of one cell each come while a map is painted. Returns the most that waited as one
MANY_UPDATES = """async () => {
    const { LiveMap } = await import("/views/live_map.js");
    let most = 0;
    const post = Worker.prototype.postMessage;
    Worker.prototype.postMessage = function (message, ...others) {
        most = Math.max(most, message.patches.length);
        return post.call(this, message, ...others);
    };
    let values = [];
    const show = (_, painted) => (values = painted.values);
    const map = new LiveMap({ tell() {}, untell() {} }, { check() {}, show });
    const [width, height] = [200, 100];
    const header = { stamp: { sec: 1, nanosec: 0 } };
    const wanted = new Array(width * height).fill(0);
    map.take({ header, info: { width, height }, data: [...wanted] });
    for (let count = 0; count < 30_000; count += 1) {
        const at = (count * 7) % (wanted.length - 1);
        const data = [(wanted[at] = (count % 101) - 1)];
        map.update({ header, x: at % width, y: Math.floor(at / width), width: 1, height: 1, data });
    }
    while (String(values) !== String(wanted)) await new Promise(requestAnimationFrame);
    map.close();
    Worker.prototype.postMessage = post;
    return most;
}"""


async def test_updates_that_wait_for_a_map_have_limited_room_and_none_is_lost(evaluate):
    assert await evaluate(MANY_UPDATES) < 10_000


async def test_a_map_says_nothing_of_updates_that_do_not_come(evaluate):
    told = await evaluate("""async () => {
        const { LiveMap } = await import("/views/live_map.js");
        const told = [];
        const card = { tell: (words) => told.push(words), untell() {} };
        const map = new LiveMap(card, { check() {}, show() {} });
        let status;
        const gateway = {
            graph: { typeOf: () => "map_msgs/msg/OccupancyGridUpdate" },
            on: () => () => {},
            subscribe: (topic, options, take, tell) => { status = tell; },
        };
        map.follow(gateway, "/map");
        status({ code: "not_found", msg: "is not known yet" });
        status({ code: "forbidden", msg: "no" });
        map.close();
        return told;
    }""")
    assert told == ["no"]


@pytest.mark.parametrize(
    ("shown", "most", "problem"),
    [("map+0+/part", 1, ".problem"), ("scene+0+/+on,/part", 3, ".layers .problem:not([hidden])")],
)
async def test_updates_of_a_map_that_are_refused_are_told_of(
    nowhere, open_page, shown, most, problem
):
    options = (*nowhere, "--set", f"limits.max_subscriptions={most}")
    async with gateway_process("serve", *options) as gateway, client(gateway.url) as robot:
        grid = {"topic": "/part", "type": "nav_msgs/OccupancyGrid"}
        update = {"topic": "/part_updates", "type": "map_msgs/msg/OccupancyGridUpdate"}
        for topic in (grid, update):
            await robot.send(op="advertise", **topic, latch=True)
        await robot.send(op="publish", **grid, msg=GRID)
        async with open_page(f"{page_address(gateway)}#card={shown}") as page:
            said = f"document.querySelector({problem!r})?.textContent"
            await until(page, f"() => {said}?.includes('{most} subscriptions')")


# paints a map of 3000 x 3000 cells with a thin wall. Returns something of some pixels
PAINT_THIN_WALLS = """async (asPicture) => {
    const { Painter } = await import("/views/painter.js");
    const side = 3000;
    const octets = new Uint8Array(side * side).fill(255);
    octets.fill(0, 0, octets.length / 2);
    for (let row = 0; row < side; row += 1) octets[row * side + 1] = 100;
    let map = { info: { width: side, height: side }, data: new Int8Array(octets.buffer) };
    if (asPicture) {
        const canvas = new OffscreenCanvas(side, side);
        const colours = new Uint32Array(octets.length);
        octets.forEach((each, at) => (colours[at] = 0xff000000 | (each * 0x10101)));
        const pixels = new Uint8ClampedArray(colours.buffer);
        canvas.getContext("2d").putImageData(new ImageData(pixels, side), 0, 0);
        const data = new Uint8Array(await (await canvas.convertToBlob()).arrayBuffer());
        map = { ...map, data, format: "png" };
    }
    const painter = new Painter();
    const { bitmap, cells, values } = await painter.paint(map);
    painter.close();
    const copy = new OffscreenCanvas(bitmap.width, bitmap.height);
    const pen = copy.getContext("2d", { willReadFrequently: true });
    pen.drawImage(bitmap, 0, 0);
    const at = (x, y) => [...pen.getImageData(x, y, 1, 1).data].slice(0, 3);
    const last = bitmap.height - 1;
    return {
        shape: [bitmap.width, bitmap.height, cells, values.length],
        colours: [at(0, 0), at(0, last), at(9, last), at(9, 0)],
        values: [0, 1, 999, 500 * 1000 + 9].map((place) => values[place]),
    };
}"""


@pytest.mark.parametrize("as_picture", [True, False], ids=["picture", "cells"])
async def test_a_huge_map_is_painted_small_and_keeps_its_thin_walls(demo, open_page, as_picture):
    async with open_page(page_address(demo) + "drive", color_scheme="dark") as page:
        painted = await page.evaluate(PAINT_THIN_WALLS, as_picture)
        wall, free, unknown = [0xE8, 0xED, 0xF2], [0x2B, 0x37, 0x46], [0x13, 0x19, 0x20]
        assert painted == {
            "shape": [1000, 1000, 3, 1_000_000],
            "colours": [wall, wall, free, unknown],
            "values": [100, 0, 0, -1],
        }


@pytest.mark.parametrize("path", ["drive", "lab", "#card=map+0+/map"])
async def test_a_map_is_asked_for_as_a_picture_once_a_second_at_most(demo, open_page, path):
    async with open_page(page_address(demo) + path, script=NOTE_SENT) as page:
        asked = (
            "sent.map(JSON.parse).filter(({ op, topic }) => op === 'subscribe' && topic === '/map')"
        )
        await until(page, f"() => {asked}.length")
        (subscription,) = await page.evaluate(asked)
        assert subscription["image"] == {"format": "png"}
        assert subscription["throttle_rate"] == 1000


@pytest.mark.parametrize("wide", [1440, 800, 390])
async def test_cells_of_a_map_are_square_at_any_width(demo, open_page, wide):
    size = {"width": wide, "height": 900}
    async with (
        client(demo.url) as speaker,
        open_page(page_address(demo) + "#card=map+0+/wide_map", size, color_scheme="dark") as page,
    ):
        await speaker.send(
            op="advertise", topic="/wide_map", type="nav_msgs/OccupancyGrid", latch=True
        )
        info = {"resolution": 0.5, "width": 8, "height": 4}
        # six cells of a wall, three wide and two high
        wall = [
            100 if row in {1, 2} and 2 <= column < 5 else 0
            for row in range(4)
            for column in range(8)
        ]
        await speaker.send(op="publish", topic="/wide_map", msg={"info": info, "data": wall})
        canvas = f"{card('/wide_map')} canvas"
        await until(page, f"about => ({COUNT})(about) > 20", [canvas, "--map-occupied"])
        picture = cv2.imdecode(
            np.frombuffer(await page.locator(canvas).screenshot(), np.uint8), cv2.IMREAD_COLOR
        )
        bright = picture.min(axis=2) > 200  # in the dark, walls are
        columns = np.flatnonzero(bright.any(axis=0))
        rows = np.flatnonzero(bright.any(axis=1))
        across, down = np.ptp(columns) + 1, np.ptp(rows) + 1
        assert across > 60
        assert across / 3 == pytest.approx(down / 2, abs=1.5)


async def test_a_trail_is_drawn_and_keeps_its_newest_places_alone(demo, open_page):
    async with open_page(page_address(demo) + "#card=trail+0+/odom") as page:
        robot = [f"{card('/odom')} canvas", "--warning"]
        await until(page, f"about => ({COUNT})(about) > 20", robot)
        length = await page.evaluate("""async () => {
            const { TrailView } = await import("/views/trail.js");
            const view = new TrailView({ topic: "/x" });
            for (let x = 0; x < 2500; x += 1) {
                const pose = { position: { x, y: 0 }, orientation: {} };
                view.keep({ pose: { pose } });
            }
            view.show();
            return view.places.length;
        }""")
        assert length == 2000


async def test_a_battery_in_words(demo, open_page):
    async with (
        client(demo.url) as speaker,
        open_page(page_address(demo) + "#card=battery+0+/charge") as page,
    ):
        await speaker.send(
            op="advertise", topic="/charge", type="sensor_msgs/BatteryState", latch=True
        )
        await speaker.send(
            op="publish",
            topic="/charge",
            msg={"percentage": 0.12, "voltage": 11.1, "power_supply_status": 2},
        )
        text = "() => document.querySelector('.battery')?.textContent"
        await until(page, f"{text}?.includes('12 %, low')")
        await until(page, f"{text}?.includes('discharging') && {text[6:]}?.includes('11.1 V')")
        await speaker.send(op="publish", topic="/charge", msg={"percentage": None})
        await until(page, f"{text}?.includes('charge not measured')")
        await speaker.send(op="publish", topic="/charge", msg={"percentage": 85})
        await until(page, f"{text}?.includes('charge 85: out of range (0 to 1)')")


@pytest.mark.parametrize(
    "value",
    [
        {"a": [0, 23, 24, 255, 256, 65536, 2**40], "b": [-1, -25, -(2**33)], "c": "x" * 300},
        [1.5, -2.25, True, False, None, "ü", {}],
    ],
)
async def test_pages_read_what_another_library_writes_in_cbor(demo, open_page, value):
    async with open_page(page_address(demo)) as page:
        assert await read(page, cbor2.dumps(value)) == value


@pytest.mark.parametrize(
    ("tag", "octets", "numbers"),
    [
        (69, "0100feff", [1, 65534]),
        (70, "01000000ffffffff", [1, 2**32 - 1]),
        (71, "0100000000000000", [1]),
        (72, "01ff", [1, -1]),
        (77, "0100ffff", [1, -1]),
        (78, "01000000ffffffff", [1, -1]),
        (79, "ffffffffffffffff", [-1]),
        (85, "0000c03f", [1.5]),
        (86, "000000000000f83f", [1.5]),
    ],
)
async def test_pages_read_typed_arrays_wherever_they_stand(demo, open_page, tag, octets, numbers):
    async with open_page(page_address(demo)) as page:
        for before in ("", "x"):  # at an even place and at an odd one
            value = {before: cbor2.CBORTag(tag, bytes.fromhex(octets))}
            assert await read(page, cbor2.dumps(value)) == {before: numbers}


@pytest.mark.parametrize(
    "octets", ["", "61", "82", "1c", "5803ff", "00ff", "c101", "f8ff", "62c328"]
)
async def test_pages_refuse_invalid_cbor(demo, open_page, octets):
    async with open_page(page_address(demo)) as page:
        assert (await read(page, bytes.fromhex(octets))).startswith("refused: ")


async def read(page, frame: bytes):
    """Return what the page makes of a binary frame, as JSON has it."""
    return await page.evaluate(
        """async (frame) => {
            const { decode } = await import("/shared/cbor.js");
            const { json } = await import("/shared/json.js");
            try {
                return JSON.parse(json(decode(new Uint8Array(frame).buffer)));
            } catch (error) {
                return `refused: ${error.message}`;
            }
        }""",
        list(frame),
    )


async def test_infinite_distances_are_drawn_as_nothing(demo, open_page):
    async with (
        client(demo.url) as speaker,
        open_page(page_address(demo) + "#card=scan+0+/rays&card=raw+0+/rays") as page,
    ):
        await speaker.send(op="advertise", topic="/rays", type="sensor_msgs/LaserScan", latch=True)
        scan = {"angle_increment": 0.1, "range_max": 5.0, "ranges": [math.inf, None, 1.0, 9.0]}
        await speaker.send(op="publish", topic="/rays", msg=scan)
        await until(page, f"about => ({COUNT})(about) > 4", [f"{card('/rays')} canvas", "--scan"])
        text = "() => document.querySelector('.raw')?.textContent"
        await until(page, f'{text}.includes(\'["Infinity","NaN",1,9]\')')
