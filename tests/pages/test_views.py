# SPDX-License-Identifier: Apache-2.0
"""Every view with a message of its type, on a desk, on a phone, and by the keyboard."""

import math
import re
from collections.abc import Iterable

import pytest

from tests.client import client
from tests.pages.conftest import page_address
from tests.pages.test_axe import AXE, FOUND
from tests.pages.test_debug_page import NOTE_SENT, PHONE, card, until, until_painted
from tests.pages.test_looks import LANGUAGES
from tests.pages.test_world_views import GRID

pytestmark = pytest.mark.asyncio(loop_scope="package")

URDF = """<robot name="arm">
  <joint name="elbow" type="revolute"><limit lower="-1" upper="1" velocity="2" effort="3"/></joint>
  <joint name="slide" type="prismatic"><limit lower="0" upper="0.5"/></joint>
  <joint name="wheel" type="continuous"/>
</robot>"""
STATUSES = [
    {
        "level": 0,
        "name": "/base/motors/left",
        "message": "runs",
        "values": [{"key": "t", "value": "41"}],
    },
    {"level": 2, "name": "/base/motors/right", "message": "too hot", "hardware_id": "m2"},
    {"level": 1, "name": "lidar", "message": "dusty"},
]
ROLLED = {"orientation": {"x": math.sin(math.pi / 12), "w": math.cos(math.pi / 12)}}


def tf(parent: str, child: str) -> dict[str, object]:
    return {"transforms": [{"header": {"frame_id": parent}, "child_frame_id": child}]}


def pose(x: float, y: float) -> dict[str, object]:
    return {"position": {"x": x, "y": y}, "orientation": {"w": 1.0}}


# view, type, message, words that must be visible, a canvas that must be painted
CASES = [
    (
        "diagnostics",
        "diagnostic_msgs/DiagnosticArray",
        {"status": STATUSES},
        [
            "1 error · 1 warning · 1 ok",
            "base",
            "motors",
            "left: runs",
            "right: too hot",
            "lidar: dusty",
        ],
        "",
    ),
    (
        "imu",
        "sensor_msgs/Imu",
        ROLLED | {"angular_velocity": {"z": 0.25}},
        ["roll 30.0°", "pitch 0.0°", "0, 0, 0.250 rad/s"],
        "canvas",
    ),
    (
        "imu",
        "sensor_msgs/Imu",
        {"orientation_covariance": [-1] + [0] * 8},
        ["orientation not measured"],
        "",
    ),
    (
        "joints",
        "sensor_msgs/JointState",
        {
            "name": ["elbow", "slide", "wheel", "cable"],
            "position": [0.99, 0.25, 7.0, 0.5],
            "velocity": [0.1],
        },
        [
            "elbow 0.990 rad · 0.100 rad/s · near its limit",
            "slide 0.250 m",
            "wheel 7 rad",
            "cable 0.500 rad",
        ],
        "",
    ),
    (
        "fix",
        "sensor_msgs/NavSatFix",
        {
            "status": {"status": 0},
            "latitude": 60.1695,
            "longitude": -24.9354,
            "altitude": 12.5,
            "position_covariance": [4.0] + [0.0] * 8,
            "position_covariance_type": 2,
        },
        ["60.1695000° N", "24.9354000° W", "12.5 m", "0.00 m east", "accuracy 2.00 m"],
        "canvas",
    ),
    ("fix", "sensor_msgs/NavSatFix", {"status": {"status": -1}}, ["no fix", "no fix yet"], ""),
    (
        "range",
        "sensor_msgs/Range",
        {"range": 1.25, "min_range": 0.1, "max_range": 4.0, "field_of_view": 0.5},
        ["1.250 m", "ultrasound · 0.10 to 4.00 m · 29° wide"],
        "canvas",
    ),
    (
        "range",
        "sensor_msgs/Range",
        {"range": "Infinity", "max_range": 4.0},
        ["nothing within 4.00 m"],
        "",
    ),
    (
        "joy",
        "sensor_msgs/Joy",
        {"axes": [0.5, -1.0], "buttons": [0, 1]},
        ["axis 0 0.500", "axis 1 -1", "1: on"],
        "",
    ),
    ("joy", "sensor_msgs/Joy", {}, ["no axes and no buttons"], ""),
    ("poses", "geometry_msgs/PoseArray", {"poses": [pose(1, 2), pose(-1, 0)]}, [], "canvas"),
    ("frames", "tf2_msgs/TFMessage", tf("map", "odom"), ["map", "odom", "Hz"], ""),
    ("lamp", "std_msgs/Bool", {"data": True}, ["on"], ""),
    ("lamp", "std_msgs/Bool", {}, ["off"], ""),
    ("value", "std_msgs/Int64", {"data": 2**62}, [str(2**62)], ""),
    ("value", "std_msgs/Float32", {"data": "NaN"}, ["NaN"], ""),
    ("value", "std_msgs/String", {"data": "gripper open"}, ["gripper open"], ""),
    ("value", "sensor_msgs/Temperature", {"temperature": 21.5}, ["21.500 °C"], ""),
    (
        "value+0+/seen+angular.z",
        "geometry_msgs/Twist",
        {"angular": {"z": 0.5}},
        ["0.500 rad/s", "angular.z"],
        "",
    ),
    ("value", "geometry_msgs/Twist", {"angular": {"z": 0.5}}, ["Which field?", "z: 0.5"], ""),
    ("gauge", "std_msgs/Float64", {"data": 7.25}, ["7.250", "low", "high"], ""),
    (
        "gauge+0+/seen+voltage+low=20+high=28",
        "sensor_msgs/BatteryState",
        {"voltage": 24.0},
        ["24 V"],
        "",
    ),
    ("gauge", "geometry_msgs/Twist", {}, ["Which number?"], ""),
    ("plot+0+/seen+data", "std_msgs/Float64", {"data": 1.5}, ["data 1.500"], ".uplot canvas"),
    ("log", "rcl_interfaces/Log", {"msg": "dusty", "name": "lidar"}, ["lidar: dusty"], ""),
]
TEXT = "document.querySelector('article .body').innerText.replaceAll(/\\s+/g, ' ')"
WIDER = """() => [...document.querySelectorAll('article *')].filter((each) =>
    each.getBoundingClientRect().right > innerWidth + 1 && !each.closest('.unseen, .apart')
).map((each) => each.outerHTML.slice(0, 80))"""


def address(view: str) -> str:
    return f"#card={view}" if "+" in view else f"#card={view}+0+/seen"


async def test_limits_of_joints_that_come_late_are_shown_without_another_message(served, open_page):
    [(*_, message, words, _)] = [case for case in CASES if case[0] == "joints"]
    async with (
        client(served.url) as robot,
        open_page(page_address(served) + address("joints")) as page,
    ):
        joints, robots = {"topic": "/seen"}, {"topic": "/robot_description"}
        await robot.send(op="advertise", **joints, type="sensor_msgs/JointState", latch=True)
        await robot.send(op="publish", **joints, msg=message)
        await page.wait_for_selector(card("/seen"))
        await until(page, f"() => {TEXT}.includes('elbow')")
        await robot.send(op="advertise", **robots, type="std_msgs/String", latch=True)
        await robot.send(op="publish", **robots, msg={"data": URDF})
        for each in words:
            await until(page, f"words => {TEXT}.includes(words)", each)


@pytest.mark.parametrize(("view", "type_name", "message", "words", "painted"), CASES)
async def test_a_view_shows_its_message(
    served, open_page, view, type_name, message, words, painted
):
    async with (
        client(served.url) as robot,
        open_page(page_address(served) + address(view)) as page,
    ):
        await robot.send(
            op="advertise", topic="/robot_description", type="std_msgs/String", latch=True
        )
        await robot.send(op="publish", topic="/robot_description", msg={"data": URDF})
        await robot.send(op="advertise", topic="/seen", type=type_name, latch=True)
        await robot.send(op="publish", topic="/seen", msg=message)
        await page.wait_for_selector(card("/seen"))
        for each in words:
            await until(page, f"words => {TEXT}.includes(words)", each)
        if painted:
            await until_painted(page, f"article {painted}")
        await page.set_viewport_size(PHONE)
        await until(page, f"() => ({WIDER})().length === 0")
        assert await page.text_content("article .problem") == ""
        if AXE.exists():
            await page.evaluate(AXE.read_text(encoding="utf-8"))
            assert await page.evaluate(FOUND.replace("(document,", "('article',")) == []


async def test_the_parts_of_a_robot_by_level_and_what_has_changed(open_card):
    said = "(status) => { take({ status }); drawn(); drawn(); drawn(); }"
    right = [STATUSES[1] | {"values": []}]
    body = "() => document.querySelector('.diagnostics').innerText.replaceAll(/\\s+/g, ' ')"
    async with open_card("diagnostics", type="diagnostic_msgs/msg/DiagnosticArray") as page:
        plain = [each | {"values": [], "hardware_id": ""} for each in STATUSES]
        await page.evaluate(said, plain)
        level = page.get_by_role("combobox", name="least level of /x")
        await level.select_option("errors")
        assert "right: too hot" in await page.evaluate(body)
        assert "lidar" not in await page.evaluate(body)
        assert await page.evaluate("() => alone.settings") == {"level": "errors"}
        await page.evaluate(said, [right[0] | {"level": 1, "message": "warm"}])
        assert "choose all to see 3 parts" in await page.evaluate(body)
        await level.select_option("all")
        await page.get_by_text("right", exact=True).click()
        changes = "() => [...document.querySelectorAll('[open] > .changes li bdi')]"
        assert await page.evaluate(f"{changes}.map((each) => each.textContent)") == [
            "warning: warm",
            "error: too hot",
        ]
        await page.evaluate("() => { now += 6000; drawn(); }")
        assert "3 stale · 0 errors" in await page.evaluate(body)


async def test_the_faults_of_a_tree_of_frames_are_said(open_card):
    takes = "(each) => { take(each); now += 600; drawn(); }"
    wrong = "() => document.querySelector('.wrong').innerText"
    async with open_card("frames", type="tf2_msgs/msg/TFMessage") as page:
        await page.evaluate(takes, tf("map", "odom"))
        await page.evaluate(takes, tf("odom", "base"))
        assert await page.evaluate(wrong) == ""
        assert await page.locator(".frames li li li .frame").inner_text() == "base"
        await page.evaluate(takes, tf("earth", "mast"))
        assert "2 trees are not connected: map, earth" in await page.evaluate(wrong)
        await page.evaluate(takes, tf("map", "base"))
        assert "base has several parents: odom, map" in await page.evaluate(wrong)
        await page.evaluate(takes, tf("base", "map"))
        assert "their own parents: odom, base, map" in await page.evaluate(wrong)


async def test_a_tree_of_frames_has_a_limit_and_says_so(open_card):
    wrong = "() => document.querySelector('.wrong').innerText"
    many = """([prefix, count]) => {
        const each = (n) => ({ header: { frame_id: "map" }, child_frame_id: `${prefix}${n}` });
        take({ transforms: Array.from({ length: count }, (_, n) => each(n)) });
        now += 600;
        drawn();
    }"""
    frames = "() => document.querySelectorAll('.frames .frame').length"
    async with open_card("frames", type="tf2_msgs/msg/TFMessage") as page:
        await page.evaluate(many, ["a", 1000])
        assert await page.evaluate(wrong) == ""
        await page.evaluate(many, ["b", 1])
        assert await page.evaluate(wrong) == "There are too many frames: 1000 are shown."
        assert await page.evaluate(frames) == 1001  # with the root
        await page.evaluate("() => { now += 3000; }")
        await page.evaluate(many, ["b", 1])  # one that is silent gives way to it
        assert await page.evaluate(frames) == 1001
        names = "() => [...document.querySelectorAll('.frame')].map((each) => each.textContent)"
        assert {"b0", "a1"} <= {*await page.evaluate(names)}
        assert "a0" not in await page.evaluate(names)


async def test_parts_their_groups_and_their_values_have_a_limit_and_say_so(open_card):
    said = "(status) => { take({ status }); drawn(); drawn(); drawn(); now += 1; }"
    text = "() => document.querySelector('.diagnostics').textContent"
    groups = "() => document.querySelectorAll('.diagnostics details:not(.status)').length"
    blank = {"level": 0, "message": "", "hardware_id": "", "values": []}
    async with open_card("diagnostics", type="diagnostic_msgs/msg/DiagnosticArray") as page:
        await page.evaluate(said, [blank | {"name": f"/g{n}/part"} for n in range(1000)])
        assert "left out" not in await page.evaluate(text)
        assert await page.evaluate(groups) == 1000
        deep = "/".join(f"d{n}" for n in range(500))
        await page.evaluate(said, [blank | {"name": deep}])
        assert "more than 1000 parts: those that were silent" in await page.evaluate(text)
        assert await page.evaluate(groups) == 999 + 8  # the first one is gone
        values = [{"key": str(n), "value": ""} for n in range(203)]
        await page.evaluate(said, [blank | {"name": "last", "values": values}])
        await page.evaluate(
            "() => { [...document.querySelectorAll('.status')].at(-1).open = true; }"
        )
        await until(page, f"() => ({text})().includes('left out3 more values')")


async def test_joints_that_are_left_out_are_said(open_card):
    state = """count => {
        const name = Array.from({ length: count }, (_, n) => `j${n}`);
        take({ name, position: [], velocity: [], effort: [] });
        drawn();
    }"""
    words = "() => document.querySelector('.rows').innerText"
    async with open_card("joints", type="sensor_msgs/msg/JointState") as page:
        await page.evaluate(state, 200)
        assert "There are more joints" not in await page.evaluate(words)
        await page.evaluate(state, 201)
        assert "There are more joints: 200 are shown." in await page.evaluate(words)


DEPTH = {
    "encoding": "16UC1",
    "width": 4,
    "height": 2,
    "step": 8,
    "data": [0, 0, 232, 3, 208, 7, 184, 11] * 2,
}


async def test_a_depth_image_has_its_range_and_colours(served, open_page):
    async with (
        client(served.url) as robot,
        open_page(page_address(served) + "#card=image+0+/seen+far=4", script=NOTE_SENT) as page,
    ):
        await robot.send(op="advertise", topic="/seen", type="sensor_msgs/Image", latch=True)
        await robot.send(op="publish", topic="/seen", msg=DEPTH)
        asked = "() => sent.map(JSON.parse).filter(({ op }) => op === 'subscribe').at(-1).image"
        await page.get_by_label("far end of /seen").fill("6")
        await page.keyboard.press("Tab")
        await until(page, f"() => String(({asked})().depth_range_m) === '0,6'")
        await page.get_by_label("colors of /seen").select_option("turbo")
        filtered = "getComputedStyle(document.querySelector('article canvas')).filter"
        await until(page, f"() => {filtered}.includes('depth-turbo')")
        kept = "new URLSearchParams(location.hash.slice(1)).get('card')"
        await until(page, f"() => {kept} === 'image 0 /seen far=6 colors=turbo'")


async def test_a_picture_fills_the_screen_below_stop_and_is_zoomed_by_keys(demo, open_page):
    address = page_address(demo) + "#card=image+0+/camera/image_raw&card=tree+0+/odom"
    async with open_page(address, PHONE, script=NOTE_SENT) as page:
        picture = "article canvas"
        await until_painted(page, picture)
        await page.get_by_role("button", name="Full screen of /camera/image_raw").press("Enter")
        await until(page, "() => document.activeElement.matches('.stage')")
        asked = "sent.map(JSON.parse).filter(({ op, image }) => op === 'subscribe' && image).at(-1)"
        await until(page, f"() => {asked}.image.max_width === 1920")
        on_top = """([selector]) => {
            const its = document.querySelector(selector);
            const { x, y, width, height } = its.getBoundingClientRect();
            return document.elementFromPoint(x + width / 2, y + height / 2) === its;
        }"""
        assert await page.evaluate(on_top, ["#stop"])
        assert await page.evaluate(on_top, [".stage canvas"])
        scale = f"new DOMMatrix(getComputedStyle(document.querySelector('{picture}')).transform)"
        for key, larger in (("+", "a > 1"), ("ArrowLeft", "e > 0"), ("0", "a === 1")):
            await page.keyboard.press(key)
            await until(page, f"() => {scale}.{larger}")
        await page.mouse.move(100, 400)
        await page.mouse.wheel(0, -100)
        await until(page, f"() => {scale}.a > 1")
        await page.keyboard.press("Escape")
        await until(page, "() => !document.querySelector('.whole') && !document.fullscreenElement")
        await until(page, "() => document.activeElement.textContent === 'Full screen'")
        await until(page, f"() => {asked}.image.max_width === 640")


async def test_a_value_that_is_chosen_by_its_type_once_it_is_known(served, open_page):
    async with (
        client(served.url) as robot,
        open_page(page_address(served) + "#card=value+0+/later") as page,
    ):
        await page.wait_for_selector(card("/later"))
        await robot.send(op="advertise", topic="/later", type="std_msgs/Float64", latch=True)
        await robot.send(op="publish", topic="/later", msg={"data": 2.5})
        await until(page, "() => document.querySelector('.big')?.textContent === '2.500'")


LARGE = {"width": 1400, "height": 7000}  # a view shows its message once it is seen
NAMES = {"wheel", "gripper", "open"}  # texts of the robot that stand alone
# further views, with a message of each
OTHERS = [
    ("map", "nav_msgs/OccupancyGrid", GRID),
    ("scan", "sensor_msgs/LaserScan", {"ranges": [1.0], "range_max": 4.0}),
    ("battery", "sensor_msgs/BatteryState", {"percentage": 0.1, "power_supply_health": 5}),
    ("trail", "nav_msgs/Odometry", {}),
    ("tree", "geometry_msgs/Twist", {}),
    ("raw", "std_msgs/String", {}),
    ("image", "sensor_msgs/Image", DEPTH),
    ("world", "visualization_msgs/Marker", {"type": 99}),
]
# the words of the views and the scenes. The texts of the robot are in elements of `bdi`
SAID = """() => {
    const found = [];
    for (const body of document.querySelectorAll("article .body")) {
        const walk = document.createTreeWalker(body, NodeFilter.SHOW_TEXT);
        while (walk.nextNode()) {
            const { data, parentElement } = walk.currentNode;
            const isRobots = parentElement.closest("bdi, pre, .diagnostics dd");
            if (!isRobots || parentElement.closest(".noted, .beside")) found.push(data);
        }
        for (const name of ["aria-label", "title", "placeholder"]) {
            const named = [...body.querySelectorAll(`[${name}]`)];
            found.push(...named.map((each) => each.getAttribute(name)));
        }
    }
    return found;
}"""


def words_of(texts: Iterable[str]) -> set[str]:
    """Return the words, except the names of values and of ROS."""
    parts = (re.sub(r"\{\w+\}", "", text).lower().split() for text in texts)
    found = {part.strip("().,:;…") for each in parts for part in each}
    return {each for each in found if len(each) > 1 and each.isalpha()}


async def test_the_views_and_the_scene_are_in_the_language_of_the_page(served, open_page, evaluate):
    texts = await evaluate(LANGUAGES)
    english = words_of(texts["en"].values()) - words_of(texts["fi"].values()) - NAMES
    shown = [(view, kind, message) for view, kind, message, _, _ in CASES] + OTHERS
    cards = [
        address(view).replace("/seen", f"/seen{index}").removeprefix("#")
        for index, (view, _, _) in enumerate(shown)
    ]
    where = page_address(served) + "#" + "&".join([*cards, "card=scene+0+/"])
    async with client(served.url) as robot, open_page(where, LARGE, locale="fi-FI") as page:
        for index, (_, kind, message) in enumerate(shown):
            await robot.send(op="advertise", topic=f"/seen{index}", type=kind, latch=True)
            await robot.send(op="publish", topic=f"/seen{index}", msg=message)
        said = f"({SAID})().join(' ')"
        for words in ("marker.type", "battery.health.failure", "joy.none", "tool.measure"):
            await until(page, f"words => {said}.includes(words)", texts["fi"][words].split("{")[0])
        found = await page.evaluate(SAID)
        assert [each for each in found if words_of([each]) & english] == []
