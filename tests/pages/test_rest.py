# SPDX-License-Identifier: Apache-2.0
"""Cards that nobody sees ask for nothing, and show what is true once they are seen again."""

import pytest

from tests.client import client
from tests.pages.conftest import page_address
from tests.pages.test_debug_page import NOTE_SENT, until

pytestmark = pytest.mark.asyncio(loop_scope="package")

# the demands that have not ended: names of topics, and of frames
ALL_ASKED = """() => {
    const asked = new Map();
    for (const { op, id, topic, source_frame: frame } of sent.map((each) => JSON.parse(each))) {
        if (op === "subscribe" || op === "lookup_transform") asked.set(id, topic ?? frame);
        if (op === "unsubscribe" || op === "cancel_transform") asked.delete(id);
    }
    return [...new Set(asked.values())].sort();
}"""
# those of cards, as lists name topics without a slash
ASKED = f"""() => ({ALL_ASKED})().filter(
    (each) => each.startsWith("/") || each.startsWith("base"))"""
IS_ASKED = f"wanted => String(({ASKED})()) === String(wanted)"
HAS_ASKED = f"wanted => wanted.every((each) => ({ASKED})().includes(each))"
HIDE = """isHidden => {
    Object.defineProperty(document, "hidden", { value: isHidden, configurable: true });
    document.dispatchEvent(new Event("visibilitychange"));
}"""
TAB = "name => [...document.querySelectorAll('#desk-tabs button')].at(name === 'Two').click()"
WAYS = {"page": (HIDE, True, False), "tab": (TAB, "Two", "One")}
# cards, what they ask for, and what goes on in a page that is hidden, as it is collected
CARDS = {
    "scene": (["/points", "/scan", "/tf", "/tf_static"], []),
    "world": (["/points", "/tf", "/tf_static"], []),
    "joints": (["/joint_states", "/robot_description"], []),
    "map": (["/map", "/scan", "base_footprint", "base_link"], []),
    "frames": (["/tf", "/tf_static"], ["/tf", "/tf_static"]),
    "plot": (["/odom", "/scan"], ["/odom", "/scan"]),
}
SHOWN = {
    "scene": "scene+0+/+on,/points+on,/scan+off,/map+off,/robot_description",
    "world": "world+0+/points+off,/scan+off,/map+off,/robot_description",
    "joints": "joints+0+/joint_states",
    "map": "map+0+/map",
    "frames": "frames+0+/tf",
    "plot": "plot+0+/odom+twist.twist.linear.x+/scan:range_max",
}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("view", CARDS)
async def test_a_card_that_nobody_sees_asks_for_nothing(demo, open_page, view, way):
    asked, collected = CARDS[view]
    act, away, back = WAYS[way]
    address = f"{page_address(demo)}#tab=One&card={SHOWN[view]}&tab=Two&shown=1"
    async with open_page(address, script=NOTE_SENT) as page:
        await until(page, HAS_ASKED, asked)
        await page.evaluate(act, away)
        await until(page, IS_ASKED, collected if way == "page" else [])
        await page.evaluate(act, back)
        await until(page, HAS_ASKED, asked)


async def test_a_list_that_nobody_sees_measures_nothing(demo, open_page):
    is_measured = f"wanted => ({ALL_ASKED})().includes('imu') === wanted"
    async with open_page(f"{page_address(demo)}#measure=all", script=NOTE_SENT) as page:
        await until(page, is_measured, True)
        await page.evaluate(HIDE, True)
        await until(page, is_measured, False)
        await page.evaluate(HIDE, False)
        await until(page, is_measured, True)


LINK = {"header": {"frame_id": "map"}, "child_frame_id": "arm"}
MISSING = "() => document.querySelector('.missing')?.textContent ?? ''"


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("shown", ["scene+0+/", "world+0+/place"])
async def test_a_scene_shows_what_is_true_when_it_is_seen_again(served, open_page, shown, way):
    act, away, back = WAYS[way]
    address = f"{page_address(served)}#tab=One&card={shown}&tab=Two&shown=1"
    kinds = {"/place": "geometry_msgs/PolygonStamped", "/tf_static": "tf2_msgs/TFMessage"}
    async with client(served.url) as robot, open_page(address, script=NOTE_SENT) as page:
        for topic, kind in kinds.items():
            await robot.send(op="advertise", topic=topic, type=kind, latch=True)
        await robot.send(op="publish", topic="/place", msg={"header": {"frame_id": "arm"}})
        await until(page, f"() => ({MISSING})().includes('No transform says where arm is')")
        await page.evaluate(act, away)
        await until(page, IS_ASKED, [])
        await robot.send(op="publish", topic="/tf_static", msg={"transforms": [LINK]})
        await page.evaluate(act, back)
        await until(page, f"() => ({MISSING})() === ''")


async def test_joints_have_the_limits_that_came_while_nobody_saw_them(served, open_page):
    urdf = """<robot name="r"><joint name="elbow" type="prismatic">
        <limit lower="0" upper="1"/></joint></robot>"""
    kinds = {"/joint_states": "sensor_msgs/JointState", "/robot_description": "std_msgs/String"}
    words = "() => document.querySelector('.rows')?.textContent"
    async with (
        client(served.url) as robot,
        open_page(page_address(served) + "#card=joints+0+/joint_states", script=NOTE_SENT) as page,
    ):
        for topic, kind in kinds.items():
            await robot.send(op="advertise", topic=topic, type=kind, latch=True)
        state = {"name": ["elbow"], "position": [0.5]}
        await robot.send(op="publish", topic="/joint_states", msg=state)
        await until(page, f"() => ({words})() === 'elbow0.500 rad'")
        await page.evaluate(HIDE, True)
        await until(page, IS_ASKED, [])
        await robot.send(op="publish", topic="/robot_description", msg={"data": urdf})
        await page.evaluate(HIDE, False)
        await until(page, f"() => ({words})() === 'elbow0.500 m'")


async def test_parts_are_not_stale_because_nobody_listened(served, open_page):
    said = "() => document.querySelector('.diagnostics')?.innerText ?? ''"
    address = f"{page_address(served)}#tab=One&card=diagnostics+0+/parts&tab=Two&shown=1"
    later = "() => { const now = performance.now() + 9000; performance.now = () => now; }"
    async with client(served.url) as robot, open_page(address, script=NOTE_SENT) as page:
        await robot.send(op="advertise", topic="/parts", type="diagnostic_msgs/DiagnosticArray")
        while "1 ok" not in await page.evaluate(said):
            await robot.send(op="publish", topic="/parts", msg={"status": [{"name": "arm"}]})
        await page.evaluate(TAB, "Two")
        await until(page, IS_ASKED, [])
        await page.evaluate(later)
        await page.evaluate(TAB, "One")
        await until(page, f"() => ({said})().includes('1 ok')")
        await page.evaluate("() => new Promise(requestAnimationFrame)")
        assert "0 stale" in await page.evaluate(said)
