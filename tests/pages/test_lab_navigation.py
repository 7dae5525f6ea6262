# SPDX-License-Identifier: Apache-2.0
"""Targets of the lab by Nav2's action: the robot drives there, and each stop cancels the goal."""

import pytest

from tests.pages.conftest import page_address
from tests.pages.lab import LATE, LATE_S, opened, until_it_stands_at
from tests.pages.test_debug_page import NOTE_SENT
from tests.pages.test_lab import HIDE, click_on

pytestmark = pytest.mark.asyncio(loop_scope="package")

CANCELED = "() => sent.map(JSON.parse).some(({ op }) => op === 'cancel_action_goal')"
# a place that is some way off, wherever the robot has been left
AWAY = "() => lab.twin.pose.x < 0 ? 0.9 : -0.9"


@pytest.fixture
def lab(demo, speaker, open_page):
    """Return a function that opens the lab, whose targets are Nav2's."""
    return lambda: opened(open_page, page_address(demo), script=NOTE_SENT)


async def by_nav2(page) -> None:
    await page.wait_for_selector("#ways:not([hidden])")
    await page.select_option("#way", "nav2")
    await page.wait_for_function("() => lab.map.world.visible")


async def send(page, x: float, y: float) -> None:
    """Point at a place until Nav2 drives there."""
    while True:
        await page.evaluate("() => { lab.pilot.words = approach.textContent = ''; }")
        await click_on(page, x, y)()
        await page.wait_for_function("() => /^(?!Nav2 gets|$)/.test(approach.textContent)")
        words = await page.inner_text("#approach")
        if words.startswith("Nav2 drives"):
            return
        assert any(each in words for each in LATE), words


async def until_it_stands(speaker) -> None:
    await speaker.send(op="subscribe", id="odom", topic="/odom")

    def stands(frame):
        if frame["op"] != "publish":
            return False
        twist = frame["msg"]["twist"]["twist"]
        return abs(twist["linear"]["x"]) + abs(twist["angular"]["z"]) < 0.01

    await speaker.receive(stands, LATE_S)
    await speaker.send(op="unsubscribe", id="odom", topic="/odom")


async def test_nav2_drives_to_where_the_user_points(lab, speaker):
    async with lab() as page:
        await by_nav2(page)
        await send(page, 0.5, 0.3)
        await page.wait_for_function("() => approach.textContent === 'Arrived.'")
        await until_it_stands_at(speaker, 0.5, 0.3)
        assert not await page.evaluate("() => lab.pilot.isActive")
        commands = "() => sent.map(JSON.parse).filter(({ op }) => op === 'publish').length"
        assert await page.evaluate(commands) == 0  # this page drives nothing itself


@pytest.mark.parametrize(
    "by",
    [
        "() => document.getElementById('stop').click()",
        "() => dispatchEvent(new Event('blur'))",
        HIDE,
        "() => { way.value = 'page'; way.onchange(); }",
    ],
    ids=["STOP", "blur", "hidden", "another way"],
)
async def test_each_stop_of_an_approach_also_cancels_the_goal(lab, speaker, by):
    async with lab() as page:
        await by_nav2(page)
        await send(page, await page.evaluate(AWAY), 0.1)
        assert not await page.evaluate(CANCELED)
        await page.evaluate(by)
        await page.wait_for_function(CANCELED)
        assert not await page.evaluate("() => lab.pilot.isActive")
        await until_it_stands(speaker)


async def test_arrow_keys_cancel_the_goal_and_drive(lab, speaker):
    async with lab() as page:
        await by_nav2(page)
        await send(page, await page.evaluate(AWAY), 0.1)
        await page.focus("#view canvas")
        await page.keyboard.down("ArrowLeft")
        await page.wait_for_function(CANCELED)
        assert "keys" in await page.inner_text("#approach")
        await page.keyboard.up("ArrowLeft")
        await until_it_stands(speaker)


async def test_without_nav2_a_target_is_refused_until_the_user_chooses_otherwise(lab, speaker):
    gone = "Object.defineProperty(lab.pilot.navigation, 'action', { get: () => '' })"
    async with lab() as page:
        await by_nav2(page)
        await page.evaluate(f"() => {{ {gone}; }}")
        await speaker.send(op="advertise", topic="/graph_changes", type="std_msgs/String")
        await page.wait_for_selector("#topic option[value='/graph_changes']", state="attached")
        assert await page.input_value("#way") == "nav2"
        await page.evaluate("() => { lab.pilot.words = approach.textContent = ''; }")
        await click_on(page, 0.5, 0.3)()
        await page.wait_for_function("() => /not available|odometry/.test(approach.textContent)")
        commands = "() => sent.map(JSON.parse).filter(({ op }) => op === 'publish').length"
        assert await page.evaluate(commands) == 0
        await page.select_option("#way", "page")
        await speaker.send(op="unadvertise", topic="/graph_changes")


async def test_a_page_that_is_closed_takes_its_goal_along(lab, speaker):
    async with lab() as page:
        await by_nav2(page)
        await send(page, await page.evaluate(AWAY), 0.1)
    await until_it_stands(speaker)


# a navigation whose gateway answers as told
MAKE = """async (frames) => {
    const { Navigation } = await import("/lab/navigation.js");
    const said = [];
    const asked = [];
    let hear;
    const node = { name: "/go", types: ["nav2_msgs/action/NavigateToPose"], nodes: ["/n"] };
    const gateway = {
        on: () => () => {},
        graph: { actions: new Map([["/go", node]]) },
        listen: (take) => { hear = take; return { id: "g", end() { hear = () => {}; } }; },
        send: (operation) => asked.push(operation) > 0,
    };
    const navigation = new Navigation(gateway, (words) => said.push(words));
    navigation.go({ x: 1, y: 2, yaw: Math.PI, frame: "map" });
    for (const each of frames) hear(each);
    return { said, asked, isActive: navigation.isActive };
}"""


@pytest.mark.parametrize(
    ("frames", "words", "is_active"),
    [
        ([], [], True),
        (
            [{"op": "action_feedback", "values": {"distance_remaining": 1.234}}],
            ["Nav2 drives: 1.23 m left."],
            True,
        ),
        ([{"op": "action_result", "result": True, "status": 4, "values": {}}], ["Arrived."], False),
        (
            [
                {"op": "action_result", "result": True, "status": 6, "values": {"error_msg": "w"}},
                {"op": "action_feedback", "values": {"distance_remaining": 1}},  # late
            ],
            ["Nav2 has ended: w."],
            False,
        ),
        (
            [{"op": "action_result", "result": True, "status": 6, "values": {"error_code": 9}}],
            ["Nav2 has ended: error 9."],
            False,
        ),
        (
            [{"op": "action_result", "result": False, "status": 0, "values": "no server"}],
            ["Nav2 has ended: no server."],
            False,
        ),
        ([{"op": "status", "level": "error", "msg": "no"}], ["Nav2 has ended: no."], False),
        ([{"op": "status", "level": "warning", "msg": "no"}], [], True),
    ],
)
async def test_each_end_is_said(evaluate, frames, words, is_active):
    made = await evaluate(MAKE, frames)
    assert made["said"] == words
    assert made["isActive"] == is_active
    (goal,) = made["asked"]
    assert goal["action"] == "/go"
    assert "keep" not in goal  # the goal ends with the connection
    assert goal["args"]["pose"]["header"] == {"frame_id": "map"}
    assert goal["args"]["pose"]["pose"]["orientation"]["z"] == pytest.approx(1)


@pytest.mark.parametrize("end", ["STOP", "blur", "nothing"])
async def test_a_finger_that_was_down_at_stop_sends_no_target(evaluate, end):
    found = await evaluate("""async (end) => {
        const { Viewer } = await import("/lab/walk.js");
        const { hold } = await import("/shared/stop_held.js");
        const canvas = document.createElement("canvas");
        document.body.append(canvas);
        canvas.setPointerCapture = () => {};
        let points = 0;
        new Viewer().listen(canvas, () => (points += 1));
        const send = (kind) => canvas.dispatchEvent(new PointerEvent(kind, { isPrimary: true }));
        send("pointerdown");
        if (end === "STOP") hold(7);
        if (end === "blur") dispatchEvent(new Event("blur"));
        send("pointerup");
        return points;
    }""", end)  # fmt: skip
    assert found == (1 if end == "nothing" else 0)
