# SPDX-License-Identifier: Apache-2.0
"""Measure the lab's own part of a frame: ``python -m tests.pages.frame_work``.

It runs in an emulated headset. The work before drawing and three's own work on the processor are
told apart. The work of the GPU is in neither. A test would measure no more than the machine.
"""

import asyncio

from playwright.async_api import async_playwright

from tests.demonstration import demonstration
from tests.pages.conftest import CHROMIUM, page_address
from tests.pages.lab import KEEP, SMALL
from tests.pages.test_lab_headset import INSTALL, IWER, QUEST

FRAMES = 1000
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


async def main() -> None:
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
    asyncio.run(main())
