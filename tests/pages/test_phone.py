# SPDX-License-Identifier: Apache-2.0
"""The pages on a phone: the links to them are at the bottom, within a thumb's reach."""

import pytest

from tests.pages.conftest import DESK, page_address
from tests.pages.test_debug_page import PHONE

pytestmark = pytest.mark.asyncio(loop_scope="package")

PHONES = {"viewport": PHONE, "has_touch": True, "is_mobile": True}
PLACES = """() => [...document.querySelectorAll(".pages a")].map((each) => {
    const { left, top, width, height } = each.getBoundingClientRect();
    return [each.innerText, left, top, width, height];
})"""
IN_VIEW = """() => {
    const { top, bottom } = document.getElementById("tabs").getBoundingClientRect();
    return top >= 0 && bottom <= innerHeight;
}"""


@pytest.mark.parametrize("path", ["", "drive", "lab"])
async def test_the_pages_are_at_the_bottom_and_hide_nothing(demo, open_page, path):
    async with open_page(page_address(demo) + path, **PHONES) as page:
        await page.wait_for_selector("[data-state=open]")
        places = await page.evaluate(PLACES)
        assert [name for name, *_ in places] == ["Cards", "Topics", "Drive", "Lab"]
        for _, _, top, width, height in places:
            assert min(width, height) >= 44
            assert top + height <= PHONE["height"]
            assert top > PHONE["height"] - 80
        # cards still grow while they get their first messages
        hides_nothing = """top => {
            scrollTo(0, document.body.scrollHeight);
            return document.querySelector("main").getBoundingClientRect().bottom <= top;
        }"""
        await page.wait_for_function(hides_nothing, arg=places[0][2])


async def test_topics_are_a_touch_away_from_any_page(demo, open_page):
    async with open_page(page_address(demo), **PHONES) as page:
        await page.wait_for_selector("article canvas")  # cards above the list
        assert not await page.evaluate(IN_VIEW)
        await page.get_by_role("link", name="Topics").tap()
        await page.wait_for_function(IN_VIEW)
        await page.goto(f"{page_address(demo)}drive")
        await page.get_by_role("link", name="Topics").tap()
        await page.wait_for_function("() => location.pathname === '/'")
        await page.wait_for_function(IN_VIEW)


async def test_the_links_tell_whether_the_cards_or_the_list_is_in_view(demo, open_page):
    current = "() => document.querySelector('.pages [aria-current]').innerText"
    cards = "#card=map+0+/map&card=scan+0+/scan&card=imu+0+/imu"
    async with open_page(page_address(demo) + cards, **PHONES) as page:
        await page.wait_for_selector("article canvas")
        assert await page.evaluate(current) == "Cards"
        await page.get_by_role("link", name="Topics").tap()
        await page.wait_for_function(f"() => ({current})() === 'Topics'")
        assert await page.locator(".pages [aria-current]").count() == 1
        await page.locator("#search").tap()  # the list is held no longer
        await page.evaluate("() => scrollTo(0, 0)")
        await page.wait_for_function(f"() => ({current})() === 'Cards'")
        await page.evaluate("() => scrollTo(0, document.body.scrollHeight)")
        await page.wait_for_function(f"() => ({current})() === 'Topics'")
        before = page.url
        await page.get_by_role("link", name="Cards", exact=True).tap()
        await page.wait_for_function(f"() => ({current})() === 'Cards'")
        assert page.url == before  # with the cards
        await page.evaluate("() => scrollTo(0, document.body.scrollHeight)")
        await page.wait_for_function(f"() => ({current})() === 'Topics'")
        await page.set_viewport_size(DESK)  # it is next to the cards then
        await page.wait_for_function(f"() => ({current})() === 'Debug'")


async def test_the_list_stays_in_view_while_cards_above_it_grow(demo, open_page):
    """Until the user moves the page."""
    async with open_page(page_address(demo), **PHONES) as page:
        await page.wait_for_selector("article canvas")
        await page.get_by_role("link", name="Topics").tap()
        await page.wait_for_function(IN_VIEW)
        last = "[...document.querySelectorAll('article')].at(-1)"
        grow = "height => { const card = LAST; card.style.minHeight = height; }"
        await page.evaluate(grow.replace("LAST", last), "150vh")
        await page.wait_for_function(f"() => {last}.clientHeight > innerHeight")
        await page.wait_for_function(IN_VIEW)
        await page.locator("#search").tap()
        await page.evaluate(grow.replace("LAST", last), "400vh")
        await page.wait_for_function(f"() => {last}.clientHeight > 3 * innerHeight")
        await page.wait_for_function(f"() => !({IN_VIEW})()")


async def test_a_finger_can_hide_a_curve_of_a_plot(demo, open_page):
    plotted = "#card=plot+0+/odom+twist.twist.linear.x+twist.twist.angular.z"
    async with open_page(page_address(demo) + plotted, **PHONES) as page:
        names = page.locator(".plot .u-label[aria-pressed]")
        await names.nth(1).wait_for()
        for at in (0, 1):
            assert (await names.nth(at).bounding_box())["height"] >= 32
        await names.nth(1).tap()
        await page.wait_for_selector(".plot .u-label[aria-pressed=false]:has-text('angular')")


async def test_a_desk_has_them_at_the_top(demo, open_page):
    async with open_page(page_address(demo), viewport=DESK) as page:
        await page.wait_for_selector("[data-state=open]")
        assert not await page.is_visible(".of-phone")
        for name, _, top, _, _ in await page.evaluate(PLACES):
            assert name == "Topics" or top < 60
