# SPDX-License-Identifier: Apache-2.0
"""The lab with an emulated headset, in a real browser with the simulated robot."""

import contextlib

import pytest

from tests.clients.driver import INSTALLED
from tests.pages.conftest import page_address
from tests.pages.lab import (
    LATE,
    frames,
    opened,
    send,
    send_and_arrive,
    send_and_end,
    until_it_stands_at,
)
from tests.pages.test_drive_page import Watched

pytestmark = pytest.mark.asyncio(loop_scope="package")

IWER = INSTALLED / "iwer-2.5.0/node_modules/iwer/build/iwer.min.js"

QUEST = "IWER.metaQuest3"
# touchpads instead of sticks, and a trigger that is no more than one
VIVE = """(() => {
    const gamepad = {
        mapping: "xr-standard",
        buttons: [
            { id: "trigger", type: "analog", eventTrigger: "select" },
            { id: "squeeze", type: "analog", eventTrigger: "squeeze" },
            { id: "touchpad", type: "binary" },
        ],
        axes: [{ id: "touchpad", type: "x-axis" }, { id: "touchpad", type: "y-axis" }],
    };
    const hand = { gamepad, numHapticActuators: 1 };
    const controllerConfig = {
        profileId: "htc-vive",
        fallbackProfileIds: ["generic-trigger-squeeze-touchpad"],
        layout: { left: hand, right: hand },
    };
    return { ...IWER.metaQuest3, name: "Vive", controllerConfig };
})()"""
# the native navigator.xr has to give way
INSTALL = """
    window.device = new IWER.XRDevice(HEADSET);
    device.installRuntime({ forceInstall: true });
"""
# a hand that points at a place of the floor. Positions of the device are relative to the rig
POINT = """([hand, x, y]) => {
    const source = device[device.primaryInputMode === "hand" ? "hands" : "controllers"][hand];
    const from = [hand === "left" ? -0.2 : 0.2, 1.3, -0.3];
    source.position.set(...from);
    const place = lab.viewer.rig.worldToLocal(lab.viewer.rig.position.clone().set(-y, 0, -x));
    const way = place.sub(place.clone().set(...from)).normalize();
    const turn = lab.viewer.camera.quaternion.clone();
    turn.setFromUnitVectors(way.clone().set(0, 0, -1), way);
    source.quaternion.set(turn.x, turn.y, turn.z, turn.w);
}"""
PRESS = "([hand, button, value]) => device.controllers[hand].updateButtonValue(button, value)"
PINCH = "([hand, value]) => device.hands[hand].updatePinchValue(value)"
# a place that is some way off, wherever the robot has been left
AWAY = "() => lab.twin.pose.x < 0 ? 0.9 : -0.9"
# the place of the head, in the robot's metres
HEAD = """() => {
    const { x, y, z } = device.position;
    const place = lab.viewer.rig.localToWorld(lab.viewer.rig.position.clone().set(x, y, z));
    return [-place.z, -place.x];
}"""


@pytest.fixture
def enter(demo, speaker, open_page):
    """Return a function that opens the lab and enters VR."""
    if not IWER.exists():
        pytest.skip(f"no {IWER}: `sh tools/make-clients.sh VENV` installs it")

    @contextlib.asynccontextmanager
    async def enter_it(headset=QUEST):
        script = IWER.read_text() + INSTALL.replace("HEADSET", headset)
        async with opened(open_page, page_address(demo), script=script) as page:
            await page.wait_for_function("() => !vr.disabled")
            await page.click("#vr")
            await page.wait_for_function("() => vr.textContent === 'Leave VR'")
            await frames(page)
            yield page

    return enter_it


async def press(page, button, hand="right"):
    for value in (1, 0):
        await page.evaluate(PRESS, [hand, button, value])
        await frames(page)


def trigger(page, x, y, hand="right"):
    """Return what points at a place of the floor and pulls the trigger."""

    async def pull():
        await page.evaluate(POINT, [hand, x, y])
        await frames(page)
        await press(page, "trigger", hand)

    return pull


@pytest.mark.parametrize(
    ("headset", "place"), [(QUEST, (0.4, -0.2)), (VIVE, (0.1, 0.2))], ids=["quest", "vive"]
)
async def test_a_trigger_sends_the_robot_to_where_its_ray_meets_the_floor(
    enter, speaker, headset, place
):
    async with enter(headset) as page:
        await send_and_arrive(page, trigger(page, *place))
        await until_it_stands_at(speaker, *place)


@pytest.mark.parametrize(
    ("headset", "push", "let_go"),
    [
        (
            QUEST,
            "device.controllers.right.updateAxes('thumbstick', 0, -1)",
            "device.controllers.right.updateAxes('thumbstick', 0, 0)",
        ),
        (
            QUEST,
            "device.controllers.right.updateButtonValue('thumbstick', 1)",
            "device.controllers.right.updateButtonValue('thumbstick', 0)",
        ),
        (
            VIVE,
            "device.controllers.right.updateButtonValue('touchpad', 1)",
            "device.controllers.right.updateButtonValue('touchpad', 0)",
        ),
    ],
    ids=["stick", "stick pressed", "touchpad"],
)
async def test_a_stick_or_a_touchpad_moves_the_user_and_not_the_robot(enter, headset, push, let_go):
    async with enter(headset) as page:
        # also a user who has walked away from the middle of the room
        await page.evaluate("() => { device.position.x = 0.3; }")
        before = await page.evaluate("() => ({ ...lab.twin.pose })")
        await page.evaluate(POINT, ["right", 0.5, 0.6])
        await frames(page)
        start = await page.evaluate(HEAD)
        await page.evaluate(f"() => {{ {push}; }}")
        await frames(page)
        assert await page.evaluate(HEAD) == pytest.approx(start, abs=1e-3)
        await page.evaluate(f"() => {{ {let_go}; }}")
        await frames(page)
        assert await page.evaluate(HEAD) == pytest.approx([0.5, 0.6], abs=1e-3)
        after = await page.evaluate("() => ({ ...lab.twin.pose })")
        assert after == pytest.approx(before, abs=0.01)
        assert await page.evaluate("() => lab.pilot.words") == ""


async def test_a_mouse_neither_turns_nor_sends_anything_while_a_headset_is_worn(enter):
    middle = """() => {  // wherever the emulated headset has put it
        const { x, y, width, height } = lab.renderer.domElement.getBoundingClientRect();
        return [x + width / 2, y + 0.8 * height];
    }"""
    state = "() => [lab.viewer.rig.rotation.y, lab.pilot.words]"

    async def drag(page):
        x, y = await page.evaluate(middle)
        await page.mouse.move(x, y)
        await page.mouse.down()
        await page.mouse.move(x + 60, y)
        await page.mouse.up()
        await frames(page)

    async with enter() as page:
        before = await page.evaluate(state)
        await drag(page)
        await page.mouse.click(*await page.evaluate(middle))
        await frames(page)
        assert await page.evaluate(state) == before
        await page.evaluate("() => vr.click()")
        await page.wait_for_function("() => vr.textContent === 'Enter VR'")
        await drag(page)
        assert (await page.evaluate(state))[0] != before[0]


async def test_a_teleport_ends_where_there_is_nothing_beyond(enter):
    async with enter() as page:
        # without walls that would be in the way
        await page.evaluate("() => { lab.room.open(9); lab.room.open = () => {}; }")
        most = await page.evaluate("() => Math.max(5, lab.map.reach)")
        for _ in range(2):
            await page.evaluate(POINT, ["right", -most - 4, 0])
            await frames(page)
            await press(page, "thumbstick")
            assert await page.evaluate(HEAD) == pytest.approx([-most, 0], abs=1e-3)


async def test_a_ray_to_the_television_goes_no_farther(enter):
    async with enter() as page:
        await page.evaluate("() => lab.viewer.rig.position.set(0, 0, -1)")
        await page.evaluate(POINT, ["right", 7, 0])  # by the floor behind it
        await page.evaluate("() => device.controllers.right.position.set(0, 1.9, 0)")
        await frames(page)
        start = await page.evaluate(HEAD)
        await press(page, "thumbstick")
        assert await page.evaluate(HEAD) == pytest.approx(start, abs=1e-3)
        await press(page, "trigger")
        assert "no floor" in await page.evaluate("() => lab.pilot.words")


async def test_a_ray_to_the_ceiling_moves_nobody(enter):
    async with enter() as page:
        await page.evaluate("() => device.controllers.right.quaternion.set(0.7, 0, 0, 0.7)")
        await frames(page)
        start = await page.evaluate(HEAD)
        await press(page, "thumbstick")
        await press(page, "trigger")
        assert await page.evaluate(HEAD) == pytest.approx(start, abs=1e-3)
        assert "no floor" in await page.evaluate("() => lab.pilot.words")


@pytest.mark.parametrize("headset", [QUEST, VIVE], ids=["quest", "vive"])
async def test_a_squeeze_stops_the_robot_and_the_approach(enter, speaker, headset):
    watched = Watched(speaker)
    async with enter(headset) as page:
        await speaker.send(op="control", topic="/cmd_vel", watch=True)
        await send(page, trigger(page, -0.8, 0.3))
        await watched.until(state="moving")
        await press(page, "squeeze", "left")
        await page.wait_for_function("() => lab.pilot.words.includes('STOP')")
        await watched.until(
            state="stopped", cause="stop"
        )  # by this, not because commands stopped arriving
        assert not await page.evaluate("() => lab.pilot.isActive")


def pinch(page, x, y):
    """Return what points at a place of the floor with the right hand, bare, and pinches."""

    async def close():
        await page.evaluate(POINT, ["right", x, y])
        await frames(page)
        for value in (1, 0):
            await page.evaluate(PINCH, ["right", value])
            await frames(page)

    return close


@pytest.mark.parametrize(
    ("mode", "way", "gone"),
    [("controller", trigger, "right"), ("hand", pinch, "right"), ("hand", pinch, "left")],
    ids=["controller that sent it", "hand that sent it", "only hand that could stop it"],
)
async def test_a_robot_stops_where_a_controller_is_gone(enter, speaker, mode, way, gone):
    connect = """([mode, hand, connected]) => {
        device[mode === "hand" ? "hands" : "controllers"][hand].connected = connected;
    }"""
    watched = Watched(speaker)
    async with enter() as page:
        await page.evaluate("mode => { device.primaryInputMode = mode; }", mode)
        await speaker.send(op="control", topic="/cmd_vel", watch=True)
        said = ""
        while "a controller is gone" not in said:
            assert not said or any(each in said for each in LATE), said
            await page.evaluate(connect, [mode, gone, True])
            await frames(page)
            await send(page, way(page, await page.evaluate(AWAY), 0.2))
            await page.evaluate(connect, [mode, gone, False])
            await page.wait_for_function("() => !lab.pilot.isActive")
            said = await page.evaluate("() => lab.pilot.words")
        await watched.until(state="moving")
        await watched.until(state="stopped")


async def test_a_controller_that_did_not_send_the_robot_may_go(enter):
    async with enter() as page:
        await send(page, trigger(page, await page.evaluate(AWAY), -0.2))
        await page.evaluate("() => { device.controllers.left.connected = false; }")
        await frames(page)
        assert "controller" not in await page.evaluate("() => lab.pilot.words")


async def test_a_trigger_sends_nothing_while_the_other_hand_squeezes(enter):
    async with enter() as page:
        await page.evaluate(PRESS, ["left", "squeeze", 1])
        await frames(page)
        await trigger(page, 0.8, -0.3)()
        assert "release it first" in await page.evaluate("() => lab.pilot.words")
        assert not await page.evaluate("() => lab.pilot.isActive")
        await page.evaluate(PRESS, ["left", "squeeze", 0])
        await frames(page)
        await send(page, trigger(page, 0.8, -0.3))


@pytest.mark.parametrize(
    ("by", "words"),
    [
        ("() => { device.activeSession.end(); }", "VR was left"),
        ("() => device.updateVisibilityState('hidden')", "something else"),
        ("() => device.updateVisibilityState('visible-blurred')", "something else"),
    ],
    ids=["ended", "hidden", "blurred"],
)
async def test_a_session_that_ends_or_is_not_seen_stops_the_robot(enter, speaker, by, words):
    watched = Watched(speaker)
    await speaker.send(op="control", topic="/cmd_vel", watch=True)
    said = ""
    while words not in said:
        assert not said or any(each in said for each in LATE), said
        async with enter() as page:
            point = trigger(page, await page.evaluate(AWAY), 0)
            said = await send_and_end(page, point, by)
    await watched.until(state="moving")
    await watched.until(state="stopped")


async def test_bare_hands_point_and_the_left_one_stops(enter, speaker):
    async with enter() as page:
        await page.evaluate("() => { device.primaryInputMode = 'hand'; }")
        await frames(page)
        await send(page, pinch(page, -0.6, 0))
        for value in (1, 0):
            await page.evaluate(PINCH, ["left", value])
            await frames(page)
        await page.wait_for_function("() => lab.pilot.words.includes('STOP')")
        joints = """() => lab.renderer.xr.getHand(0).children.filter(
            (joint) => joint.children.length
        ).length"""
        assert await page.evaluate(joints) == 25


# a pose of the emulated hands in which thumb and middle finger meet
CLOSE = """() => {
    const hand = device.hands.right;
    const inner = Object.getOwnPropertySymbols(hand).map((each) => hand[each]);
    const { poses } = inner.find((each) => each?.poses);
    const { jointTransforms } = poses.default;
    const closed = { ...jointTransforms, "middle-finger-tip": jointTransforms["thumb-tip"] };
    poses.closed ??= { ...poses.default, jointTransforms: closed };
    hand.poseId = "closed";
}"""


async def test_thumb_and_middle_finger_move_the_user_and_not_the_robot(enter):
    async with enter() as page:
        await page.evaluate("() => { device.primaryInputMode = 'hand'; }")
        await page.evaluate(POINT, ["right", 0.5, 0.6])
        await frames(page)
        start = await page.evaluate(HEAD)
        await page.evaluate(CLOSE)
        await frames(page)
        assert await page.evaluate(HEAD) == pytest.approx(start, abs=1e-3)
        await page.evaluate("() => { device.hands.right.poseId = 'default'; }")
        await frames(page)
        assert await page.evaluate(HEAD) == pytest.approx([0.5, 0.6], abs=1e-3)
        assert await page.evaluate("() => lab.pilot.words") == ""


async def test_the_user_leaves_vr_and_stands_in_the_room_again(enter):
    async with enter() as page:
        await page.evaluate("() => lab.viewer.rig.position.set(4, 0, -4)")
        await page.evaluate("() => vr.click()")
        await page.wait_for_function("() => vr.textContent === 'Enter VR'")
        assert await page.evaluate("() => lab.viewer.camera.position.y") == 1.6
        assert await page.evaluate("() => lab.viewer.rig.position.toArray()") == [0, 0, 3.2]
        await page.click("#vr")
        await page.wait_for_function("() => vr.textContent === 'Leave VR'")


async def test_a_ray_on_the_screen_of_any_topic_shows_the_next_one(enter):
    async with enter() as page:
        shown = await page.evaluate("() => document.getElementById('topic').value")
        await page.evaluate("""() => {
            const place = lab.screens.topic.mesh.position;
            const rig = lab.viewer.rig.position;
            const way = place.clone().sub(rig);
            way.y -= 1.3;
            const turn = lab.viewer.camera.quaternion.clone();
            turn.setFromUnitVectors(way.clone().set(0, 0, -1), way.normalize());
            device.controllers.right.position.set(0, 1.3, 0);
            device.controllers.right.quaternion.set(turn.x, turn.y, turn.z, turn.w);
        }""")
        await frames(page)
        await press(page, "trigger")
        await page.wait_for_function(
            "shown => document.getElementById('topic').value !== shown", arg=shown
        )
        assert await page.evaluate("() => lab.pilot.words") == ""
