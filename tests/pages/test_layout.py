# SPDX-License-Identifier: Apache-2.0
"""The cards of the debug page have places: size, order, tabs, and layouts that are kept."""

import json

import pytest

from tests.pages.conftest import page_address
from tests.pages.test_debug_page import NOTE_SENT, PHONE, card, until

pytestmark = pytest.mark.asyncio(loop_scope="package")

TWO = "#card=tree+0+/odom&card=tree+0+/imu"
WORDS = """async text => {
    const { read, write } = await import("/debug/address.js");
    const read_ = read(text);
    write(read_.tabs, read_.at, { measure: "" });
    return [read_, location.hash.slice(1)];
}"""
ORDER = """() => [...document.querySelectorAll("article:not([hidden])")]
    .map((each) => each.ariaLabel)"""
SIZE = """topic => {
    const { width, height } = document.querySelector(topic).getBoundingClientRect();
    return [width, height];
}"""


async def choose(page, menu: str, entry: str) -> None:
    """Choose an entry of a menu."""
    await page.get_by_role("button", name=menu, exact=True).click()
    await page.locator(".menu:popover-open").get_by_role("menuitem", name=entry).click()


@pytest.mark.parametrize(
    ("text", "kept"),
    [
        ("card=tree+0+/odom", None),
        ("card=tree+0+/odom&size=6x12&card=raw+5+/imu&size=0x9", None),
        ("tab=One&card=tree+0+/odom&tab=Two%26&card=raw+0+/imu&shown=2", None),
        ("tab=One&tab=Two&card=raw+0+/imu", None),
        ("size=6x12&card=tree+0+/odom&size=many", "card=tree+0+/odom"),
        ("card=tree+0+/odom&shown=7", "card=tree+0+/odom"),
        ("cards=none", None),
    ],
)
async def test_an_address_keeps_tabs_cards_and_sizes(evaluate, text, kept):
    read, written = await evaluate(WORDS, text)
    assert written.replace("%2F", "/") == (kept or text)
    assert read["unknown"] == []


@pytest.mark.parametrize("locale", ["en-US", "fi-FI"])
async def test_the_controls_of_a_narrow_card_stay_in_one_line(demo, open_page, locale):
    """With three cards next to each other."""
    lines = """() => [...document.querySelectorAll("article .controls")].map((controls) => {
        const shown = [...controls.children].filter((each) => each.checkVisibility());
        return [shown.length, new Set(shown.map(({ offsetTop }) => offsetTop)).size];
    })"""
    address = (
        page_address(demo) + "#card=diagnostics+0+/diagnostics&size=4x11&card=map+0+/map&size=4x11"
    )
    async with open_page(address, locale=locale) as page:
        await page.wait_for_selector("article canvas")
        assert await page.evaluate(lines) == [[4, 1], [4, 1]]
        corner = await page.locator("article .corner").first.bounding_box()
        title = await page.locator("article h3").first.bounding_box()
        assert title["x"] + title["width"] <= corner["x"]


async def test_a_card_is_resized_by_mouse_and_keys_and_stays_so(demo, open_page):
    async with open_page(page_address(demo) + TWO) as page:
        odom = card("/odom")
        grip = page.locator(f"{odom} .grip")
        await grip.wait_for()
        width, height = await page.evaluate(SIZE, odom)
        box = await grip.bounding_box()
        await page.mouse.move(box["x"] + 12, box["y"] + 12)
        await page.mouse.down()
        await page.mouse.move(box["x"] + 150, box["y"] + 100, steps=5)
        await page.mouse.up()
        wider, taller = await page.evaluate(SIZE, odom)
        assert wider > width + 100
        assert taller > height + 70
        await page.reload()
        await page.wait_for_selector(odom)
        assert await page.evaluate(SIZE, odom) == [wider, taller]
        await grip.focus()
        await page.keyboard.press("ArrowLeft")
        await page.keyboard.press("ArrowUp")
        narrower, lower = await page.evaluate(SIZE, odom)
        assert narrower < wider
        assert lower < taller
        await choose(page, "more actions of /odom", "Usual size")
        assert await page.evaluate(SIZE, odom) == [width, height]
        assert "size" not in page.url


async def test_a_card_is_moved_by_mouse_and_keys_and_stays_there(demo, open_page):
    cards = TWO + "&card=raw+0+/scan"
    async with open_page(page_address(demo) + cards) as page:
        await page.wait_for_selector(card("/scan"))
        await page.drag_and_drop(
            f"{card('/odom')} h3", card("/imu"), target_position={"x": 300, "y": 90}
        )
        assert await page.evaluate(ORDER) == ["/imu", "/odom", "/scan"]
        await page.reload()
        await page.wait_for_selector(card("/scan"))
        assert await page.evaluate(ORDER) == ["/imu", "/odom", "/scan"]
        await page.drag_and_drop(
            f"{card('/odom')} h3", card("/imu"), target_position={"x": 300, "y": 90}
        )
        assert await page.evaluate(ORDER) == ["/imu", "/odom", "/scan"]  # it is there already
        pause = page.locator(f"{card('/odom')} button:text-is('Pause')")
        await pause.focus()
        await page.keyboard.press("[")
        assert await page.evaluate(ORDER) == ["/odom", "/imu", "/scan"]
        assert await pause.evaluate("each => each === document.activeElement")
        for _ in range(3):  # it stays at the end
            await page.keyboard.press("]")
        assert await page.evaluate(ORDER) == ["/imu", "/scan", "/odom"]


async def test_a_card_has_the_whole_page_on_request(demo, open_page):
    async with open_page(page_address(demo) + TWO) as page:
        odom, imu = page.locator(card("/odom")), page.locator(card("/imu"))
        await imu.wait_for()
        size = await page.evaluate(SIZE, card("/odom"))
        await page.dblclick(f"{card('/odom')} h3")
        await imu.wait_for(state="hidden")
        assert (await page.evaluate(SIZE, card("/odom")))[0] > 1200
        assert await page.evaluate("() => document.documentElement.scrollHeight <= innerHeight")
        assert await page.locator("#stop").is_visible()
        await page.keyboard.press("Escape")
        await imu.wait_for()
        assert await page.evaluate(SIZE, card("/odom")) == size
        await odom.focus()
        await page.keyboard.press("m")
        await imu.wait_for(state="hidden")
        await choose(page, "more actions of /odom", "Restore all cards")
        await imu.wait_for()


@pytest.mark.parametrize("view", ["image+0+/camera/image_raw", "scene+0+/"])
async def test_full_screen_and_maximize_are_one_and_end_above_the_links_of_a_phone(
    demo, open_page, view
):
    fills = """() => {
        const place = (each) => document.querySelector(each).getBoundingClientRect();
        const { top, bottom, width } = place("article.whole");
        return top === place(".bar").bottom && bottom === place(".pages").top
            && width === innerWidth;
    }"""
    restored = "() => !document.querySelector('.whole') && !document.fullscreenElement"
    async with open_page(page_address(demo) + f"#card={view}&card=tree+0+/odom", PHONE) as page:
        article = page.locator("article").first
        full = page.get_by_role("button", name="Full screen").or_(
            page.get_by_role("button", name="Full screen of /camera/image_raw")
        )
        await full.wait_for()
        await article.focus()
        await page.keyboard.press("m")
        await until(page, fills)
        assert await page.evaluate("() => !document.fullscreenElement")
        await full.click()  # which leaves it
        await until(page, restored)
        await full.click()
        await until(page, f"() => document.fullscreenElement && ({fills})()")
        await page.evaluate("() => document.exitFullscreen()")  # as the key of the browser does
        await until(page, restored)
        assert await page.locator("article").count() == 2


async def test_the_tools_of_a_map_lie_below_it_whatever_its_size(demo, open_page):
    address = page_address(demo) + "#card=map+0+/map&size=4x11"
    async with open_page(address, {"width": 768, "height": 1024}) as page:
        await until(
            page,
            """() => {
            const edge = (each) => document.querySelector(each)?.getBoundingClientRect();
            const [drawn, tools] = [edge("article canvas"), edge(".map-tools")];
            return drawn && tools.height && drawn.bottom <= tools.top + 1;
        }""",
        )


async def test_cards_of_another_tab_ask_for_nothing_and_come_back(demo, open_page):
    ended = """topic => sent.map((each) => JSON.parse(each))
        .some((each) => each.op === "unsubscribe" && each.topic === topic)"""
    async with open_page(page_address(demo) + TWO, script=NOTE_SENT) as page:
        await until(page, "() => document.querySelector('.tree')?.textContent.includes('odom')")
        await choose(page, "Layout", "New tab")
        await page.keyboard.type("Second")
        await page.keyboard.press("Enter")
        await page.wait_for_selector("#desk-tabs [aria-selected=true]:text-is('Second')")
        assert await page.evaluate(ORDER) == []
        await until(page, ended, "/odom")
        await page.click("#topics button:has-text('/scan')")
        await choose(page, "more actions of /scan", "Move to the tab Tab 1")
        assert await page.evaluate(ORDER) == ["/odom", "/imu", "/scan"]
        await page.reload()
        await page.wait_for_selector(card("/scan"))
        assert await page.evaluate(ORDER) == ["/odom", "/imu", "/scan"]
        await until(page, "() => document.querySelector('.tree')?.textContent.includes('odom')")
        await page.focus("#desk-tabs [aria-selected=true]")
        await page.keyboard.press("ArrowRight")
        assert await page.evaluate("() => document.activeElement.textContent") == "Second"
        await page.click("#topics button:has-text('/odom')")  # it has a card in the other one
        await page.wait_for_selector("#desk-tabs [aria-selected=true]:text-is('Tab 1')")
        await choose(page, "Layout", "Close this tab and its cards")
        assert await page.is_hidden("#desk-tabs")
        assert await page.locator("article").count() == 0


async def test_a_layout_is_kept_by_name_and_shared_as_a_link_and_as_a_file(
    demo, open_page, tmp_path
):
    copied = """
        const writeText = async (text) => { window.copied = text; };
        Object.defineProperty(navigator, "clipboard", { value: { writeText } });
    """
    async with open_page(page_address(demo) + TWO, script=copied) as page:
        await page.wait_for_selector(card("/imu"))
        await choose(page, "Layout", "Save as")
        await page.keyboard.type("Two cards")
        await page.keyboard.press("Enter")
        await page.wait_for_selector("dialog.question", state="detached")
        address = page.url
        await choose(page, "Layout", "Copy a link")
        await until(page, "() => window.copied === location.href")
        await page.click("#notice")
        async with page.expect_download() as download:
            await choose(page, "Layout", "Save to a file")
        file = tmp_path / (await download.value).suggested_filename
        assert file.name == "Two cards.json"
        await (await download.value).save_as(file)
        assert json.loads(file.read_text())["name"] == "Two cards"
        await page.click("button[aria-label='close /odom']")
        await page.get_by_role("button", name="Layout", exact=True).click()
        await page.get_by_role("menuitemradio", name="Two cards").click()
        await page.wait_for_selector(card("/odom"))
        assert page.url == address
        await choose(page, "Layout", "Delete")
        await page.click("button[aria-label='close /odom']")
        async with page.expect_file_chooser() as chooser:
            await choose(page, "Layout", "Open a file")
        await (await chooser.value).set_files(file)
        await page.wait_for_selector(card("/odom"))
        await page.get_by_role("button", name="Layout", exact=True).click()
        await page.get_by_role("menuitemradio", name="Two cards").wait_for()
        await page.keyboard.press("Escape")
        bad = tmp_path / "bad.json"
        for text in ("no JSON", '{"layout": "token=r2g_x"}', json.dumps({"x": "y" * 64_000})):
            bad.write_text(text)
            async with page.expect_file_chooser() as chooser:
                await choose(page, "Layout", "Open a file")
            await (await chooser.value).set_files(bad)
            await until(page, "() => notice.textContent.startsWith('bad.json is not a layout: ')")
            await page.click("#notice")


async def test_on_a_phone_cards_stand_in_one_column_and_move_by_a_menu(demo, open_page):
    sized = "#card=tree+0+/odom&size=3x20&card=tree+0+/imu"
    async with open_page(page_address(demo) + sized, PHONE, has_touch=True) as page:
        await page.wait_for_selector(card("/imu"))
        widths = {(await page.evaluate(SIZE, card(each)))[0] for each in ("/odom", "/imu")}
        assert len(widths) == 1
        assert widths.pop() > 300
        await choose(page, "more actions of /imu", "Move forward")
        assert await page.evaluate(ORDER) == ["/imu", "/odom"]
        await choose(page, "more actions of /imu", "Maximize")
        await page.locator(card("/odom")).wait_for(state="hidden")
        assert await page.evaluate("() => document.scrollingElement.scrollWidth <= innerWidth")
