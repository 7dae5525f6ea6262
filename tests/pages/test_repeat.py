# SPDX-License-Identifier: Apache-2.0
"""A form of the debug page publishes repeatedly, until something ends that."""

import pytest

from tests.client import client
from tests.demonstration import until_it_can_be_driven
from tests.pages.conftest import page_address, severable
from tests.pages.test_debug_page import NOTE_SENT, until
from tests.pages.test_forms import field, form
from tests.pages.test_silence import SOCKETS

pytestmark = pytest.mark.asyncio(loop_scope="package")

TITLE = "Publish /goal_pose"
ADDRESS = "#card=publish+0+/goal_pose"
GOES_ON_MS = 1500  # in which one message a second would go on
PRESSED = "article button[aria-pressed=true]"


async def repeat(page, title: str = TITLE) -> None:
    """Press the button, and wait until something has gone out twice."""
    await page.click(f"{form(title)} button:text-is('Repeat')")
    footer = f"document.querySelector('{form(title)} footer')"
    await until(page, f"() => Number.parseInt({footer}.textContent) >= 2")


async def has_ended(page, why: str) -> None:
    """Wait until the card says that it repeats nothing any more, and see that it does not."""
    words = page.locator(f"{form(TITLE)} > .problem:text-is('Repeat has ended: {why}.')")
    await words.wait_for()
    assert await page.locator(PRESSED).count() == 0
    before = await page.inner_text(f"{form(TITLE)} footer")
    await page.wait_for_timeout(GOES_ON_MS)
    assert await words.is_visible()
    assert await page.inner_text(f"{form(TITLE)} footer") == before


async def test_repeating_goes_on_until_the_card_is_closed(demo, open_page):
    async with client(demo.url) as hearer, open_page(page_address(demo)) as page:
        await hearer.send(op="subscribe", topic="/initialpose")
        await page.click("button[aria-label='publish to /initialpose']")
        title = "Publish /initialpose"
        await page.select_option(f"{form(title)} select[aria-label^=rate]", "20")
        await page.click(f"{form(title)} button:text-is('Repeat')")
        for _ in range(3):
            await hearer.receive(lambda frame: frame.get("topic") == "/initialpose", 120)
        count = "() => Number.parseInt(document.querySelector('footer')?.textContent)"
        await until(page, f"{count} >= 3")
        await page.click(f"button[aria-label='close {title}']")
        assert await page.locator("article[aria-label^=Publish]").count() == 0


async def test_stop_ends_every_repeat_of_the_page_and_each_card_says_so(demo, open_page):
    cards = "#card=publish+0+/cmd_vel&card=publish+0+/goal_pose"
    async with client(demo.url) as other, open_page(page_address(demo) + cards) as page:
        await until_it_can_be_driven(other)
        await other.send(op="control", topic="/cmd_vel", watch=True)
        await field(page, "Publish /cmd_vel", "angular", "z").fill("0.1")
        for title in ("Publish /cmd_vel", "Publish /goal_pose"):
            await page.click(f"{form(title)} button:text-is('Repeat')")
        await other.receive(lambda frame: frame.get("state") == "moving", 120)
        await page.click("#stop")
        for title in ("Publish /cmd_vel", "Publish /goal_pose"):
            problem = page.locator(f"{form(title)} > .problem")
            assert await problem.inner_text() == "Repeat has ended: STOP was pressed."
        assert await page.locator("article button[aria-pressed=true]").count() == 0
        await other.receive(lambda frame: frame.get("state") == "stopped", 120)


async def test_a_dead_connection_ends_it_for_good(demo, open_page):
    async with open_page(page_address(demo) + ADDRESS, script=SOCKETS) as page:
        await repeat(page)
        await page.evaluate("() => darken(true)")
        await has_ended(page, "the gateway did not answer")
        await page.evaluate("() => darken(false)")
        await until(page, "() => state.dataset.state === 'open'")
        assert await page.locator(PRESSED).count() == 0


async def test_a_lost_connection_ends_it_for_good(demo, open_page):
    async with open_page("about:blank") as page, severable(page) as line:
        await page.goto(page_address(demo) + ADDRESS)
        await repeat(page)
        await line.cut()
        await has_ended(page, "the connection was lost")
        line.mend()
        await until(page, "() => state.dataset.state === 'open'")
        assert await page.locator(PRESSED).count() == 0


async def test_nothing_goes_out_of_a_page_that_nobody_sees(demo, open_page):
    async with open_page(page_address(demo) + ADDRESS) as page:
        await repeat(page)
        await page.evaluate("""() => {
            Object.defineProperty(document, "hidden", { value: true, configurable: true });
            document.dispatchEvent(new Event("visibilitychange"));
        }""")
        await has_ended(page, "the page is hidden")


async def test_nothing_goes_out_of_a_tab_that_is_not_shown(demo, open_page):
    tabs = "#tab=One&card=publish+0+/goal_pose&tab=Two"
    async with open_page(page_address(demo) + tabs + "&shown=1") as page:
        await repeat(page)
        await page.click("#desk-tabs button:text-is('Two')")
        await page.click("#desk-tabs button:text-is('One')")
        await has_ended(page, "another tab was shown")


async def test_a_stick_is_let_go_when_another_tab_is_shown(demo, open_page):
    tabs = "#tab=One&card=drive+0+/cmd_vel&tab=Two&shown=1"
    async with open_page(page_address(demo) + tabs) as page:
        await page.wait_for_selector(".control:has-text('Stopped')")
        stick = await page.locator(".stick").bounding_box()
        x, y = stick["x"] + stick["width"] / 2, stick["y"] + 20
        await page.mouse.move(x, y)
        await page.mouse.down()
        knob = "() => document.querySelector('.knob').style.transform"
        assert await page.evaluate(knob) != "translate(0rem, 0rem)"
        two = "() => document.querySelector('#desk-tabs button:last-child').click()"
        await page.evaluate(two)  # as a second finger does
        assert await page.evaluate(knob) == "translate(0rem, 0rem)"
        await page.mouse.up()


async def test_half_a_number_is_not_repeated(demo, open_page):
    async with open_page(page_address(demo) + ADDRESS) as page:
        place = field(page, TITLE, "pose", "position", "x")
        await place.fill("0.15")
        await repeat(page)
        await place.press("9")
        await has_ended(page, "the message was changed")


async def test_a_robot_that_was_driven_by_repeat_is_driven_by_it_again(demo, open_page):
    title = "Publish /cmd_vel"
    async with (
        client(demo.url) as other,
        open_page(page_address(demo) + "#card=publish+0+/cmd_vel") as page,
    ):
        await until_it_can_be_driven(other)
        await other.send(op="control", topic="/cmd_vel", watch=True)
        await field(page, title, "angular", "z").fill("0.1")
        await repeat(page, title)
        await other.receive(lambda frame: frame.get("state") == "moving", 120)
        await page.click(f"{form(title)} button:text-is('Repeat')")
        stopped = await other.receive(lambda frame: frame.get("state") == "stopped", 120)
        assert (stopped["cause"], stopped["tripped"]) == ("zero", False)
        await page.wait_for_timeout(300)  # in which the gateway wants nothing that moves
        await page.click(f"{form(title)} button:text-is('Repeat')")
        await other.receive(lambda frame: frame.get("state") == "moving", 120)


async def test_another_rate_lets_the_robot_drive_on(demo, open_page):
    title = "Publish /cmd_vel"
    async with (
        client(demo.url) as other,
        open_page(page_address(demo) + "#card=publish+0+/cmd_vel", script=NOTE_SENT) as page,
    ):
        await until_it_can_be_driven(other)
        await field(page, title, "angular", "z").fill("0.1")
        await repeat(page, title)
        await page.select_option(f"{form(title)} select[aria-label^=rate]", "20")
        await until(page, "() => Number.parseInt(cards.querySelector('footer').textContent) >= 6")
        messages = "sent.map(JSON.parse).filter(({ op }) => op === 'publish').map(({ msg }) => msg)"
        assert {"angular": {"z": 0.1}} in await page.evaluate(f"() => {messages}")
        assert {} not in await page.evaluate(f"() => {messages}")
