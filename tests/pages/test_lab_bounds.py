# SPDX-License-Identifier: Apache-2.0
"""The limits of the parts of the lab, each by itself, in a real browser."""

import math

import pytest

pytestmark = pytest.mark.asyncio(loop_scope="package")


async def test_a_screen_keeps_its_newest_lines_and_breaks_long_ones(evaluate):
    lines = await evaluate("""async () => {
        const { Screen } = await import("/lab/screens.js");
        const screen = new Screen("Log");
        for (let at = 0; at < 40; at += 1) screen.add(`line ${at}`);
        screen.add("x".repeat(60));
        screen.step(1000);
        return screen.text.split("\\n");
    }""")
    assert len(lines) == 15
    assert lines[:2] == ["Log", "line 28"]
    assert lines[-2:] == ["x" * 48, "x" * 12]


async def test_a_screen_is_drawn_at_most_four_times_a_second_and_only_if_it_changed(evaluate):
    drawn = await evaluate("""async () => {
        const { Screen } = await import("/lab/screens.js");
        const screen = new Screen("Log");
        const drawn = [];
        for (let now = 0; now < 1000; now += 50) {
            screen.add("line");
            if (screen.step(now)) drawn.push(now);
        }
        screen.step(2000);
        screen.show("Log", "same");
        drawn.push(screen.step(3000));
        screen.show("Log", "same");
        return [...drawn, screen.step(4000)];
    }""")
    assert drawn == [0, 250, 500, 750, True, False]


@pytest.mark.parametrize(
    ("height", "down", "meets"),
    [(1.6, 0.5, True), (1.6, 0.081, True), (1.6, 0.079, False), (1.6, -0.5, False), (-1, 1, False)],
)
async def test_a_ray_that_is_as_good_as_level_meets_no_floor(evaluate, height, down, meets):
    found = await evaluate(
        """async ([height, down]) => {
            const { Raycaster, Vector3 } = await import("/vendor/three.js");
            const { meet, toRos } = await import("/lab/floor.js");
            const raycaster = new Raycaster();
            raycaster.ray.origin.set(0, height, 0);
            raycaster.ray.direction.set(0, -down, -Math.sqrt(1 - down * down));
            const place = new Vector3();
            return meet(raycaster.ray, place) ? toRos(place) : null;
        }""",
        [height, down],
    )
    assert (found is not None) is meets
    if found:
        assert found["x"] == pytest.approx(height / math.tan(math.asin(down)))
        assert found["y"] == pytest.approx(0)


async def test_after_a_pause_the_viewer_is_not_somewhere_else(evaluate):
    metres = await evaluate("""async () => {
        const { Viewer } = await import("/lab/walk.js");
        const viewer = new Viewer();
        viewer.listen(document.createElement("canvas"), () => {});
        dispatchEvent(new KeyboardEvent("keydown", { code: "KeyW" }));
        const before = viewer.rig.position.z;
        viewer.step(60);
        dispatchEvent(new KeyboardEvent("keyup", { code: "KeyW" }));
        return before - viewer.rig.position.z;
    }""")
    assert 0 < metres < 0.3


@pytest.mark.parametrize(
    ("reach", "robot", "place", "kept"),
    [
        (0, (0, 0), (9, -9), (5, -5)),
        (12, (0, 0), (9, -30), (9, -12)),
        (0, (10, 0), (0, -30), (0, -13)),  # the robot is ahead of the walls, where the room has -z
        (0, (0, 10), (-30, 9), (-13, 5)),
        (0, (math.nan, 0), (9, 0), (5, 0)),
        (0, (0, 0), (4, 4), (4, 4)),
    ],
)
async def test_nobody_goes_beyond_walls_map_and_robot(evaluate, reach, robot, place, kept):
    found = await evaluate(
        """async ([reach, [x, y], place]) => {
            const { Vector3 } = await import("/vendor/three.js");
            const { Bounds } = await import("/lab/bounds.js");
            const bounds = new Bounds();
            bounds.set(reach, { x, y });
            const kept = new Vector3(place[0], 0, place[1]);
            bounds.keep(kept);
            const step = new Vector3(place[0], 0, place[1]);
            bounds.keepStep(step, new Vector3());
            return [[kept.x, kept.z], [step.x, step.z]];
        }""",
        [reach, robot, place],
    )
    assert found == [list(kept), list(kept)]


async def test_a_user_beyond_the_bounds_goes_no_farther_and_is_not_moved_back(evaluate):
    places = await evaluate("""async () => {
        const { Vector3 } = await import("/vendor/three.js");
        const { Bounds } = await import("/lab/bounds.js");
        const bounds = new Bounds();
        return [6.9, 7.1].map((x) => {
            const step = new Vector3(x, 0, 1);
            bounds.keepStep(step, new Vector3(7, 0, 0));
            return [step.x, step.z];
        });
    }""")
    assert places == [[6.9, 1], [7, 1]]


async def test_a_target_is_dropped_where_the_gateway_lets_nothing_move(evaluate):
    words = await evaluate("""async () => {
        const { Pilot } = await import("/lab/pilot.js");
        const sent = [];
        const pilot = new Pilot((...speeds) => sent.push(speeds), () => {});
        const state = { state: "stopped", tripped: true, cause: "stop", guard: "ready" };
        pilot.told(state);
        pilot.odometry({ x: 0, y: 0, yaw: 0 });
        pilot.aim({ x: 1, y: 0 });
        const now = performance.now();
        pilot.step(now + 2000);
        const waits = pilot.isActive;
        pilot.step(now + 4000);
        return [waits, pilot.isActive, pilot.words, sent.some(([linear]) => linear !== 0)];
    }""")
    assert words[:2] == [True, False]
    assert words[2] == "The approach has ended: another client pressed STOP."
    assert not words[3]


async def test_a_viewer_sends_nothing_until_another_connection_permits_it(evaluate):
    sent = await evaluate("""async () => {
        const { Pilot } = await import("/lab/pilot.js");
        const sent = [];
        const pilot = new Pilot((...speeds) => sent.push(speeds), () => {});
        pilot.told({ state: "stopped", tripped: false, guard: "ready", holder: null });
        pilot.odometry({ x: 0, y: 0, yaw: 0 });
        pilot.aim({ x: 1, y: 0 });
        pilot.forbid("not you");
        const ended = [pilot.isActive, pilot.words, sent.at(-1)[0]];
        const before = sent.length;
        const again = pilot.aim({ x: 1, y: 0 });
        pilot.hold(1, 0);
        const more = sent.length - before;
        pilot.forbid("");
        pilot.hold(1, 0);
        pilot.hold(0, 0);
        return [ended, again, more, sent.length - before];
    }""")
    words = "This page may watch, but not drive: not you."
    assert sent == [[False, words, 0], False, 0, 2]


async def test_the_television_takes_pictures_of_any_size_and_shows_the_newest(evaluate):
    sizes = await evaluate("""async () => {
        const { Television } = await import("/lab/television.js");
        const wrong = [];
        const television = new Television((words) => wrong.push(words));
        const picture = async (width, height) => {
            const canvas = new OffscreenCanvas(width, height);
            canvas.getContext("2d").fillRect(0, 0, width, height);
            const blob = await canvas.convertToBlob({ type: "image/jpeg" });
            return { format: "jpeg", data: new Uint8Array(await blob.arrayBuffer()) };
        };
        const pictures = [];
        for (const size of [[64, 48], [32, 32], [80, 20]]) {
            pictures.push(await picture(...size));
        }
        for (const each of pictures) television.show(each); // the second is overtaken
        while (television.shown < 2) await new Promise((done) => setTimeout(done, 10));
        const { width, height } = television.mesh.material.map.image;
        television.show({ format: "jpeg", data: new Uint8Array(3) });
        while (!wrong.length) await new Promise((done) => setTimeout(done, 10));
        return [width, height, television.shown, wrong.length];
    }""")
    assert sizes == [80, 20, 2, 1]
