# SPDX-License-Identifier: Apache-2.0
"""Measure the pages' own part of a frame: ``python -m tests.pages.frame_work [lab] [scene]``.

The lab runs in an emulated headset. The work before drawing and three's own work on the processor
are told apart. The work of the GPU is in neither. A test would measure no more than the machine.
"""

import asyncio
import sys

from playwright.async_api import async_playwright

from tests.demonstration import demonstration
from tests.pages.conftest import CHROMIUM, page_address
from tests.pages.lab import KEEP, SMALL
from tests.pages.test_lab_headset import INSTALL, IWER, QUEST
from tests.pages.test_scene import STAGE, URDF

FRAMES = 1000
SCENE_FRAMES = 150  # the software renderer takes its time for each
# the right hand aims, a screen is new each time, and odometry and scan come as fast as they may
MEASURE = """frames => new Promise((resolve) => {
    const spans = { work: [], render: [], message: [] };
    const ranges = new Float32Array(720).fill(2);
    const scan = { ranges, angle_min: 0, angle_increment: 0.0087, range_min: 0.1, range_max: 9 };
    const position = { x: 0, y: 0, z: 0 }, orientation = { x: 0, y: 0, z: 0, w: 1 };
    const take = (name, run) => {
        const began = performance.now();
        run();
        spans[name].push(performance.now() - began);
    };
    device.controllers.right.updateAxes("thumbstick", 0, -1);
    const quantile = (sorted, share) => sorted[Math.floor(share * (sorted.length - 1))].toFixed(3);
    device.activeSession.requestAnimationFrame(function each(now, frame) {
        lab.screens.log.dirty();
        take("message", () => {
            lab.twin.odometry({ pose: { pose: { position, orientation } } });
            lab.twin.scan(scan);
        });
        take("work", () => lab.work(now, 0.011, frame));
        take("render", () => lab.render());
        if (spans.work.length < frames) return frame.session.requestAnimationFrame(each);
        resolve(Object.entries(spans).map(([name, found]) => {
            found.sort((one, other) => one - other);
            const mean = found.reduce((sum, each) => sum + each, 0) / found.length;
            return `${name}: mean ${mean.toFixed(3)} ms, `
                + `p99 ${quantile(found, 0.99)} ms, most ${quantile(found, 1)} ms`;
        }).join("\\n"));
    });
})"""

# a robot, a map, a scan of 720 rays, a cloud of 50,000 points, and 240 markers of all shapes. All
# but the map are new in each frame
SCENE = (
    "async ([frames, urdf]) => {"
    + STAGE
    + """
    const spans = { message: [], markers: [], painted: [], step: [], render: [] };
    const take = (name, run) => {
        const began = performance.now();
        run();
        spans[name].push(performance.now() - began);
    };
    const onmessage = {
        set(hear) {
            this.addEventListener("message", (event) => take("painted", () => hear(event)));
        },
    };
    Object.defineProperty(Worker.prototype, "onmessage", onmessage);
    for (const [topic, type] of [["/map", "nav_msgs/msg/OccupancyGrid"],
        ["/scan", "sensor_msgs/msg/LaserScan"], ["/points", "sensor_msgs/msg/PointCloud2"],
        ["/markers", "visualization_msgs/msg/MarkerArray"],
        ["/robot_description", "std_msgs/msg/String"]]) knows(topic, type);
    const scene = begin();
    scene.element.style.height = "360px";
    const points = 50_000;
    const numbers = Int16Array.from({ length: 3 * points }, (_, at) => (at * 7919) % 32768);
    const data = new Uint8Array(numbers.buffer);
    const fields = ["x", "y", "z"].map((name) => ({ name, scale: 1e-4, offset: 0 }));
    const cloud = { header, format: "int16", points, of: points, fields, available: [], data };
    const scan = { header, ranges: new Float32Array(720).fill(2), angle_min: 0,
        angle_increment: 0.0087, range_min: 0.1, range_max: 9 };
    const info = { resolution: 0.05, width: 1000, height: 1000, origin: pose };
    say("/map", { header, info, data: new Int8Array(1_000_000) });
    say("/robot_description", { data: urdf });
    const corners = Array.from({ length: 12 }, (_, x) => ({ x, y: 0, z: 0 }));
    const markers = (at) => Array.from({ length: 240 }, (_, id) => ({ header, ns: "a", id,
        type: [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12][id % 12], action: 0, text: "here",
        pose: { ...pose, position: { x: id % 20, y: at * 0.001, z: 0 } },
        scale: { x: 0.1, y: 0.1, z: 0.1 }, color: { r: (at % 10) / 10, g: 0, b: 0, a: 1 },
        colors: [], lifetime: { sec: 0, nanosec: 0 },
        points: [1, 2].includes(id % 12) ? [] : corners }));
    const render = scene.renderer.render.bind(scene.renderer);
    let rendered = 0;
    scene.renderer.render = (...of) => {
        const began = performance.now();
        render(...of);
        rendered = performance.now() - began;
        spans.render.push(rendered);
    };
    while (spans.step.length < frames) {
        await frame();
        take("message", () => {
            const translation = { x: spans.step.length * 0.001, y: 0, z: 0 };
            const transform = { ...identity, translation };
            const known = { header: { frame_id: "map" }, child_frame_id: "base_link" };
            say("/tf", { transforms: [{ ...known, transform }] });
            say("/scan", scan);
            say("/points", cloud);
        });
        const array = { markers: markers(spans.step.length) };
        take("markers", () => say("/markers", array));
        const began = performance.now();
        scene.draw();
        spans.step.push(performance.now() - began - rendered);
    }
    const quantile = (sorted, share) => sorted[Math.floor(share * (sorted.length - 1))].toFixed(3);
    return Object.entries(spans).map(([name, found]) => {
        const mean = found.reduce((sum, each) => sum + each, 0) / found.length;
        found.sort((one, other) => one - other);
        return `${name}: mean ${mean.toFixed(3)} ms, median ${quantile(found, 0.5)} ms, `
            + `p99 ${quantile(found, 0.99)} ms, ${found.length} times`;
    }).join("\\n");
}"""
)


async def main(parts: list[str]) -> None:
    """Print what was measured of the lab, the scene, or both."""
    if not parts or "lab" in parts:
        await lab()
    if not parts or "scene" in parts:
        await scene()


async def scene() -> None:
    """Draw a scene that is fed by hand."""
    async with demonstration() as gateway, async_playwright() as driver:
        browser = await driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        page = await browser.new_page(viewport=SMALL)
        await page.goto(f"{page_address(gateway)}#cards=none")
        print(await page.evaluate(SCENE, [SCENE_FRAMES, URDF]))  # noqa: T201  # what it is for
        await browser.close()


async def lab() -> None:
    """Open the lab, enter VR and print what was measured."""
    async with demonstration() as gateway, async_playwright() as driver:
        browser = await driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        context = await browser.new_context(viewport=SMALL)
        await context.add_init_script(IWER.read_text() + INSTALL.replace("HEADSET", QUEST))
        page = await context.new_page()
        await page.goto(f"{page_address(gateway)}lab")
        await page.evaluate(KEEP)
        await page.wait_for_function("() => !vr.disabled && lab.twin.points > 0")
        await page.click("#vr")
        await page.wait_for_function("() => vr.textContent === 'Leave VR'")
        print(await page.evaluate(MEASURE, FRAMES))  # noqa: T201  # what it is for
        await browser.close()


if __name__ == "__main__":
    asyncio.run(main(sys.argv[1:]))
