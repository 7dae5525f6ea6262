# SPDX-License-Identifier: Apache-2.0
"""The parts of every page: a menu, a theme, a language, and its keys."""

import json
import re

import pytest

from tests.pages.conftest import page_address
from tests.pages.test_debug_page import NOTE_SENT, PHONE, card, until
from tests.pages.test_plot import point
from tests.pages.test_topic_card import LABEL, plotted
from tests.pages.test_words import LANGUAGES
from tests.pages.test_world_views import COUNT

pytestmark = pytest.mark.asyncio(loop_scope="package")

GROUND = "() => getComputedStyle(document.body).backgroundColor"


@pytest.mark.parametrize("path", ["", "drive", "lab"])
async def test_a_theme_is_chosen_kept_and_goes_before_that_of_the_system(demo, open_page, path):
    async with open_page(page_address(demo) + path, color_scheme="dark") as page:
        await page.wait_for_selector(".bar .more")
        dark = await page.evaluate(GROUND)
        await page.evaluate("() => addEventListener('themechange', () => { window.seen = true; })")
        await page.click(".bar .more")
        await page.get_by_role("menuitemradio", name="Light").click()
        light = await page.evaluate(GROUND)
        assert light != dark
        assert await page.evaluate("() => window.seen")  # canvases paint again
        await page.reload()
        await page.wait_for_selector(".bar .more")
        assert await page.evaluate(GROUND) == light
        await page.focus(".bar .more")
        await page.keyboard.press("Enter")
        await page.get_by_role("menuitemradio", name="As the system").click()
        assert await page.evaluate(GROUND) == dark
        await page.emulate_media(color_scheme="light")
        await until(page, f"light => ({GROUND})() === light", light)


@pytest.mark.parametrize("path", ["", "drive", "lab"])
async def test_a_page_is_in_the_language_of_the_browser_or_the_chosen_one(
    demo, open_page, evaluate, path
):
    words = (await evaluate(LANGUAGES))["fi"]
    async with open_page(page_address(demo) + path, PHONE, locale="fi-FI") as page:
        await until(page, "words => state.textContent === words", words["state.open"])
        assert await page.evaluate("() => document.documentElement.lang") == "fi"
        more = page.locator(".bar .more")
        assert await more.get_attribute("aria-label") == words["menu.more"]
        await more.click()
        await page.get_by_role("menuitemradio", name="English").click()
        await until(page, "() => document.getElementById('state')?.textContent === 'connected'")
        assert await page.evaluate("() => document.documentElement.lang") == "en"


CANVASES = "[...document.querySelectorAll('article .body canvas')]"
TOPICS = {"plot": "/odom", "map": "/map", "scan": "/scan", "imu": "/imu"}
HELD = [("plot", "--series-1"), ("map", "--map-free"), ("scan", "--scan"), ("imu", "--warning")]


async def choose_theme(page, name: str) -> None:
    await page.click(".bar .more")
    await page.get_by_role("menuitemradio", name=name).click()


@pytest.mark.parametrize("is_held", [True, False])
async def test_another_theme_recolours_cards_which_go_on_as_they_are(demo, open_page, is_held):
    address = page_address(demo) + (
        "#card=plot+0+/odom+pose.pose.position.x&card=map+0+/map&card=scan+0+/scan&card=imu+0+/imu"
    )
    async with open_page(address, script=NOTE_SENT, color_scheme="dark") as page:
        for view, colour in HELD:
            about = [f"article[aria-label^='{TOPICS[view]}'] canvas", colour]
            await until(page, f"about => ({COUNT})(about) > 20", about)
            if is_held:
                await page.get_by_label(f"Pause {TOPICS[view]}", exact=True).click()
        await page.evaluate(
            f"() => {{ window.canvases = {CANVASES}; window.before = sent.length; }}"
        )
        await choose_theme(page, "Light")
        for view, colour in HELD:
            about = [f"article[aria-label^='{TOPICS[view]}'] canvas", colour]
            await until(page, f"about => ({COUNT})(about) > 20", about)
        assert await page.evaluate(f"() => {CANVASES}.every((each) => canvases.includes(each))")
        asked = "sent.slice(before).map((each) => JSON.parse(each).op)"
        assert "subscribe" not in await page.evaluate(f"() => {asked}")


async def test_another_theme_keeps_what_a_plot_has(open_card):
    async with open_card("plot", fields=["data"]) as page:
        await page.evaluate("() => { take({ data: 7 }); now += 20_000; take({ data: 8 }); }")
        await plotted(page)
        marker = "() => getComputedStyle(document.querySelector('.u-marker')).borderColor"
        before = await page.evaluate(marker)
        await choose_theme(page, "Dark")
        await point(page, 1 / 3)
        await until(page, f"() => ({LABEL})()?.startsWith('data 7')")
        assert await page.evaluate(marker) != before


async def test_another_theme_recolours_the_map_of_the_drive_page(demo, open_page):
    async with open_page(page_address(demo) + "drive", color_scheme="dark") as page:
        about = ["#world canvas", "--map-free"]
        await until(page, f"about => ({COUNT})(about) > 20", about)
        await choose_theme(page, "Light")
        await until(page, f"about => ({COUNT})(about) > 20", about)


READ = """() => {
    const found = [];
    const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    while (walk.nextNode()) {
        if (!walk.currentNode.parentElement.closest("script, noscript, .menu, dialog")) {
            found.push(walk.currentNode.data.trim());
        }
    }
    for (const name of ["aria-label", "title", "placeholder"]) {
        for (const each of document.querySelectorAll(`[${name}]`)) {
            if (!each.closest(".menu, dialog")) found.push(each.getAttribute(name));
        }
    }
    return found.filter(Boolean);
}"""
# the same in all languages: names, numbers with units, and signs
SAME = (
    r"STOP|ROS 2 gateway|Nav2|\W+|/\S+|-?[\d.]+ ?(m/s|rad/s|\u00d7|Hz|%)?"
    r"|(-?[\d.]+ (m/s|rad/s)(, | · )?)+(akku [\d.]+ [%V](, vähissä)?)?"
)


@pytest.mark.parametrize("path", ["drive", "lab"])
async def test_a_page_is_in_one_language(demo, open_page, evaluate, path):
    words = (await evaluate(LANGUAGES))["fi"]
    patterns = [re.sub(r"\\\{\w+\\\}", ".+", re.escape(each.strip())) for each in words.values()]
    known = re.compile("|".join([*patterns, SAME]), re.DOTALL)
    async with open_page(page_address(demo) + path, locale="fi-FI") as page:
        await until(page, "words => control.textContent === words", words["control.stopped"])
        await page.wait_for_selector("main canvas")
        assert [each for each in await page.evaluate(READ) if not known.fullmatch(each)] == []


CARDS = (
    "#card=publish+0+/cmd_vel&card=call+0+/motor_power&card=goal+0+/navigate_to_pose"
    "&card=parameters+0+/&card=node+0+/simulated_robot&card=graph+0+/&card=connection+0+/"
    "&card=raw+0+/odom&card=drive+0+/cmd_vel"
)
OF_ROBOT = "pre, .name, .problem, .form [title], .form :is(input, select, textarea)"
SENTENCE = re.compile(r"[a-z]{2} [a-z]{2}", re.IGNORECASE)


async def test_the_cards_are_in_one_language(demo, open_page, evaluate):
    """As far as their own words go. The robot and the gateway have theirs."""
    words = (await evaluate(LANGUAGES))["fi"]
    patterns = [re.sub(r"\\\{\w+\\\}", ".+", re.escape(each.strip())) for each in words.values()]
    known = re.compile("|".join(patterns), re.DOTALL)
    async with open_page(page_address(demo) + CARDS, locale="fi-FI") as page:
        for each in ("parameters.count.other", "connection.reported", "control.stopped"):
            tail = words[each].replace("{count}", "")
            await until(page, "tail => cards.textContent.includes(tail)", tail)
        forms = "() => document.querySelectorAll('.act:enabled').length === 3"
        await until(page, forms)
        await page.locator(f"{card('Kaikkien solmujen parametrit')} summary").first.click()
        await page.wait_for_selector(".parameters [type=search]")
        read = READ.replace(".menu, dialog", f".menu, dialog, {OF_ROBOT}")
        texts = [each for each in await page.evaluate(read) if not known.fullmatch(each)]
        parts = [part.strip() for each in texts for part in re.split(r" · |, |/\S+", each)]
        assert [each for each in parts if SENTENCE.search(each) and not known.fullmatch(each)] == []


async def test_a_menu_is_used_by_keys_and_these_drive_nothing(demo, open_page):
    focus = "() => document.activeElement.innerText"
    async with open_page(page_address(demo) + "drive", script=NOTE_SENT) as page:
        await until(page, "() => state.textContent === 'connected'")
        await page.focus(".bar .more")
        await page.keyboard.press("Enter")
        await until(page, f"() => ({focus})().includes('Keys')")
        for key, there in (("ArrowDown", "character"), ("End", "Suomi"), ("ArrowUp", "English")):
            await page.keyboard.press(key)
            assert there in await page.evaluate(focus)
        await page.keyboard.press("Home")
        await page.keyboard.press("Space")
        await page.wait_for_selector("#keys[open]")
        commands = [json.loads(each) for each in await page.evaluate("() => sent")]
        assert [each for each in commands if each["op"] in {"publish", "stop"}] == []
        await page.keyboard.press("Escape")
        await page.keyboard.press("?")
        await page.wait_for_selector("#keys[open]:has-text('Stop the robot')")


@pytest.mark.parametrize(("path", "key"), [("", "?"), ("", "/"), ("", "m"), ("drive", "w")])
async def test_characters_do_nothing_once_they_are_off_but_space_stops(demo, open_page, path, key):
    acts = """key => ({
        "?": () => document.querySelector("#keys[open]"),
        "/": () => document.activeElement === document.getElementById("search"),
        m: () => document.querySelector(".card.whole"),
        w: () => document.getElementById("knob").style.transform.includes("-3.5rem"),
    })[key]()"""
    address = page_address(demo) + path + ("" if path else "#card=tree+0+/odom")
    async with open_page(address, script=NOTE_SENT) as page:
        await until(page, "() => state.textContent === 'connected'")
        for _ in range(2):  # off and on. It is kept
            await page.click(".bar .more")
            await page.get_by_role("menuitemcheckbox", name="Keys of one character").click()
            await page.reload()
            await until(page, "() => state.textContent === 'connected'")
            if path:
                await until(page, "() => stick.ariaDisabled !== 'true'")
            else:
                await page.focus("article")
            await page.keyboard.down(key)
            kept = await page.evaluate("() => localStorage.getItem('ros2-gateway.characters')")
            if kept is None:
                await until(page, acts, key)
            else:
                assert not await page.evaluate(acts, key)
            await page.keyboard.up(key)
            if path:
                await page.keyboard.press("Space")
                await until(page, "() => sent.some((each) => JSON.parse(each).op === 'stop')")


async def test_the_space_bar_is_for_stop_after_a_menu_was_used_by_the_mouse(demo, open_page):
    async with open_page(page_address(demo) + "drive", script=NOTE_SENT) as page:
        await until(page, "() => state.textContent === 'connected'")
        await page.click(".bar .more")
        await page.get_by_role("menuitemradio", name="Dark").click()
        await page.keyboard.press("Space")
        await until(page, "() => sent.some((each) => JSON.parse(each).op === 'stop')")
        await page.click(".bar .more")
        held = """() => {  // at once: a key may come before the next event
            document.querySelector("[role=menuitemradio]").click();
            return document.activeElement.matches(".more");
        }"""
        assert not await page.evaluate(held)
