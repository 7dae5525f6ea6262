# SPDX-License-Identifier: Apache-2.0
"""axe-core finds nothing on any page: names, roles, contrast, sizes of what is touched."""

import pytest

from tests.clients.driver import INSTALLED
from tests.pages.conftest import page_address
from tests.pages.test_debug_page import PHONE, until

AXE = INSTALLED / "axe-core-4.14.1/node_modules/axe-core/axe.min.js"
VIEWS = "#" + "&".join(
    f"card={view}+0+{topic}"
    for view, topic in (
        ("image", "/camera/image_raw"),
        ("map", "/map"),
        ("scan", "/scan"),
        ("battery", "/battery_state"),
        ("log", "/rosout"),
        ("trail", "/odom"),
        ("tree", "/odom"),
        ("raw", "/imu"),
        ("drive", "/cmd_vel"),
    )
)
FORMS = "#" + "&".join(
    f"card={view}+0+{name}"
    for view, name in (
        ("plot", "/imu"),
        ("publish", "/initialpose"),
        ("publish", "/map"),
        ("call", "/motor_power"),
        ("goal", "/navigate_to_pose"),
        ("node", "/simulated_robot"),
        ("graph", "/"),
    )
)
# the findings in words: the rule, and the first elements
FOUND = """async () => {
    const { violations } = await axe.run(document, { rules: { "target-size": { enabled: true } } });
    const shown = (nodes) => nodes.slice(0, 3).map(({ html }) => html).join(" ");
    return violations.map(({ id, nodes }) => `${id}: ${shown(nodes)}`);
}"""

pytestmark = [
    pytest.mark.asyncio(loop_scope="package"),
    pytest.mark.skipif(not AXE.exists(), reason=f"no {AXE}: `sh tools/make-clients.sh VENV`"),
]


@pytest.mark.parametrize("scheme", ["dark", "light"])
@pytest.mark.parametrize(
    ("path", "shown"),
    [
        ("#card=scene+0+/&card=map+0+/map", ".layers input[type=range]"),
        (VIEWS, "article .tree dd"),
        (FORMS, "article .form input"),
        ("drive", "#stick"),
        ("lab", "#vr"),
    ],
)
async def test_axe_finds_nothing(demo, open_page, path, shown, scheme):
    tall = {"width": 1280, "height": 4000}  # only what is seen is drawn
    async with open_page(page_address(demo) + path, tall, color_scheme=scheme) as page:
        await page.wait_for_selector(shown, state="attached")
        await until(page, "() => document.querySelector('[data-state=open]')")
        for details in await page.query_selector_all("article details:not([open])"):
            await details.evaluate("each => { each.open = true; }")
        await page.evaluate(AXE.read_text(encoding="utf-8"))
        assert await page.evaluate(FOUND) == []


async def test_axe_finds_nothing_on_a_phone(demo, open_page):
    async with open_page(page_address(demo) + FORMS, viewport=PHONE, has_touch=True) as page:
        await page.wait_for_selector("article .form input")
        await page.evaluate(AXE.read_text(encoding="utf-8"))
        assert await page.evaluate(FOUND) == []


@pytest.mark.parametrize("scheme", ["dark", "light"])
async def test_axe_finds_nothing_in_the_scene_of_the_drive_page(demo, open_page, scheme):
    options = {"viewport": PHONE, "has_touch": True, "color_scheme": scheme}
    async with open_page(page_address(demo) + "drive", **options) as page:
        await page.wait_for_selector("#camera canvas")
        await page.tap("#choose-scene")
        await page.tap(".scene-bar [aria-expanded]")
        await page.wait_for_selector(".layers input[type=number]")
        await page.evaluate(AXE.read_text(encoding="utf-8"))
        assert await page.evaluate(FOUND) == []


STATES = {
    "menu": "() => document.querySelector('.bar .more').click()",
    "menu of a card": "() => document.querySelector('article .more').click()",
    "layouts": "() => document.querySelector('.bar [aria-label=Layout]').click()",
    "keys": "() => document.getElementById('keys').show()",
    "one card": "() => document.querySelector('article .controls ~ .corner').parentElement"
    ".dispatchEvent(new MouseEvent('dblclick', { bubbles: true }))",
}


@pytest.mark.parametrize("scheme", ["dark", "light"])
@pytest.mark.parametrize("state", STATES)
async def test_axe_finds_nothing_in_any_state(demo, open_page, state, scheme):
    tabs = "#tab=One&card=tree+0+/odom&card=tree+0+/imu&tab=Two"
    async with open_page(page_address(demo) + tabs, color_scheme=scheme) as page:
        await page.wait_for_selector("article .tree dd:not(:empty)")
        await page.evaluate(STATES[state])
        await page.evaluate(AXE.read_text(encoding="utf-8"))
        assert await page.evaluate(FOUND) == []
