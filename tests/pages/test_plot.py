# SPDX-License-Identifier: Apache-2.0
"""The data that a plot keeps, and the ways to look at it."""

import pytest

from tests.client import client
from tests.pages.conftest import page_address, saved
from tests.pages.test_debug_page import until
from tests.pages.test_topic_card import LABEL, plotted
from tests.pages.test_world_views import COUNT

pytestmark = pytest.mark.asyncio(loop_scope="package")

LABELS = "() => [...document.querySelectorAll('.u-label')].map((each) => each.textContent)"


async def point(page, share: float) -> None:
    """Point at a place of the plot, as a share of its width."""
    over = page.locator(".plot .u-over")
    width = await over.evaluate("each => each.clientWidth")
    await over.hover(position={"x": width * share, "y": 9})  # when it has ceased to move


async def test_a_window_of_ten_minutes_has_what_was_kept_before_it_was_chosen(open_card):
    second = "(value) => { now += 1000; take({ data: value }); drawn(); }"
    async with open_card("plot", fields=["data"]) as page:
        await page.evaluate("() => take({ data: 0 })")
        await plotted(page)
        await page.evaluate(f"() => Array.from({{ length: 700 }}, (_, n) => n).forEach({second})")
        await page.get_by_label("window of /x").select_option("10 min")
        await page.evaluate(f"() => [700].forEach({second})")
        await point(page, 0.01)
        await until(page, f"() => /^data 1[56]\\d, 59\\d/.test(({LABEL})())")
        assert await page.evaluate("() => alone.settings") == {"window": "600"}
        await page.get_by_label("window of /x").select_option("10 s")
        await page.evaluate(f"() => [701].forEach({second})")
        await point(page, 0.02)
        await until(page, f"() => /^data 69\\d, [89]\\.\\d s ago$/.test(({LABEL})())")


@pytest.mark.parametrize("is_held", [True, False])
async def test_a_plot_fills_its_card_however_large_that_is(demo, open_page, is_held):
    high = "document.querySelector('.uplot canvas')?.getBoundingClientRect().height"
    body = "document.querySelector('article .body')"
    full = f"{body}.scrollHeight <= {body}.clientHeight"
    address = page_address(demo) + "#card=plot+0+/odom+pose.pose.position.x"
    async with open_page(address) as page:
        await until(page, f"() => {high} > 100 && {full}")
        usual = await page.evaluate(f"() => {high}")
        if is_held:
            await page.get_by_label("Pause /odom", exact=True).click()
        await page.focus(".grip")
        for _ in range(6):  # 36 pixels each
            await page.keyboard.press("ArrowDown")
        await until(page, f"usual => {high} > usual + 100 && {full}", usual)
        resized = await page.evaluate(f"() => {high}")
        await page.focus("article")
        await page.keyboard.press("m")
        await until(page, f"resized => {high} > resized + 50 && {full}", resized)
        await page.keyboard.press("Escape")
        await page.focus(".grip")
        for _ in range(6):
            await page.keyboard.press("ArrowUp")
        await until(page, f"resized => {high} < resized - 50 && {full}", resized)


async def test_time_is_that_of_the_stamps_if_they_are_chosen(open_card):
    stamped = """(sec) => {
        take({ data: sec, header: { stamp: { sec, nanosec: 500_000_000 } } });
        drawn();
    }"""
    async with open_card("plot", fields=["data"]) as page:
        await page.evaluate("() => take({ data: 1 })")
        await plotted(page)
        await page.get_by_label("time of /x").select_option("by stamp")
        assert await page.evaluate("() => subscriptions.at(-1).fields") == ["data", "header.stamp"]
        await page.evaluate(f"() => [100, 110, 120].forEach({stamped})")
        await plotted(page)
        await point(page, 0.35)
        await until(page, f"() => ({LABEL})() === 'data 100, 20.0 s ago'")
        await page.evaluate(f"() => [5, 6].forEach({stamped})")  # time went back
        await point(page, 0.35)
        await until(page, f"() => ({LABEL})() === 'data 5, 1.0 s ago'")


async def test_a_change_has_the_unit_of_the_change(open_card):
    speed = "(x) => { take({ linear: { x } }); now += 900; drawn(); }"
    async with open_card("plot", fields=["linear.x"], type="geometry_msgs/msg/Twist") as page:
        await page.evaluate("() => take({ linear: { x: 0 } })")
        await plotted(page)
        await page.evaluate(f"() => [2, 4, 6].forEach({speed})")
        drawn = f"text => {{ alone.draw(now); return ({LABEL})() === text; }}"
        await until(page, drawn, "linear.x 6 m/s")
        await page.get_by_label("mode of /x").select_option("change per second")
        await page.evaluate(f"() => [8].forEach({speed})")
        await until(page, drawn, "linear.x 2 m/s²")


async def test_one_number_against_another(open_card):
    pair = "(n) => { take({ a: Math.cos(n), b: Math.sin(n) }); drawn(); }"
    async with open_card("plot", fields=["a", "b"], settings={"mode": "xy"}) as page:
        await page.evaluate("() => take({ a: 1, b: 0 })")
        await plotted(page)
        await page.evaluate(f"() => Array.from({{ length: 40 }}, (_, n) => n / 6).forEach({pair})")
        assert len(await page.evaluate(LABELS)) == 1
        assert (await page.evaluate(LABEL)).startswith("b 0.")
        await until(page, f"about => ({COUNT})(about) > 100", ["article canvas", "--series-1"])


async def test_a_curve_is_hidden_by_its_name_with_the_keyboard(open_card):
    async with open_card("plot", fields=["a", "b"]) as page:
        await page.evaluate("() => { take({ a: 1, b: 5 }); now += 5000; take({ a: 2, b: 6 }); }")
        await plotted(page)
        seen = ["article canvas", "--series-1"]
        await until(page, f"about => {{ drawn(); return ({COUNT})(about) > 20; }}", seen)
        curve = page.get_by_role("button", name="a 2")
        await curve.press("Enter")
        assert await curve.get_attribute("aria-pressed") == "false"
        await until(page, f"about => ({COUNT})(about) === 0", seen)
        await page.evaluate("() => { alone.join('c'); take({ a: 3, b: 5, c: 1 }); drawn(); }")
        await plotted(page)
        assert await page.evaluate(f"about => ({COUNT})(about)", seen) == 0


async def test_a_plot_that_stands_still_goes_back(open_card):
    second = "(value) => { now += 1000; take({ data: value }); drawn(); }"
    async with open_card("plot", fields=["data"], settings={"window": "10"}) as page:
        await page.evaluate("() => take({ data: 0 })")
        await plotted(page)
        await page.evaluate(f"() => Array.from({{ length: 100 }}, (_, n) => n).forEach({second})")
        back = page.get_by_label("seconds back in the plot of /x")
        assert not await back.is_visible()
        await page.evaluate("() => press('Pause /x')")
        await back.press("Home")
        await point(page, 0.98)
        await until(page, f"() => /^data [89],/.test(({LABEL})())")
        await back.press("End")
        await point(page, 0.98)
        await until(page, f"() => ({LABEL})().startsWith('data 99,')")
        await page.evaluate("() => press('Resume /x')")
        assert not await back.is_visible()


async def test_all_that_is_kept_is_saved_as_csv(open_card):
    async with open_card("plot", fields=["a", "b"]) as page:
        await page.evaluate("() => take({ a: 1, b: true })")
        await plotted(page)
        await page.evaluate("() => { now += 100_000; take({ a: NaN, b: 0.25 }); }")
        button = page.get_by_role("button", name="CSV of /x")
        name, text = await saved(page, button.press("Enter"))
        lines = text.splitlines()
        assert name == "x.csv"
        assert lines[0] == '"time (s)","a","b"'
        assert [each.split(",")[1:] for each in lines[1:]] == [["1", "1"], ["", "0.25"]]


# the pixels of a curve in the middle fifth of a plot. It is drawn first
IN_THE_MIDDLE = """() => {
    drawn();
    const canvas = document.querySelector("article canvas");
    const { left, width } = document.querySelector(".u-over").getBoundingClientRect();
    const scale = canvas.width / canvas.getBoundingClientRect().width;
    const first = (left - canvas.getBoundingClientRect().left + width * 0.4) * scale;
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d");
    copy.drawImage(canvas, 0, 0);
    const colour = getComputedStyle(document.documentElement).getPropertyValue("--series-1").trim();
    const wanted = [1, 3, 5].map((at) => Number.parseInt(colour.slice(at, at + 2), 16));
    const { data } = copy.getImageData(first, 0, width * 0.2 * scale, canvas.height);
    let count = 0;
    for (let at = 0; at < data.length; at += 4) {
        count += wanted.every((each, index) => Math.abs(each - data[at + index]) < 8);
    }
    return count;
}"""
REST = "() => { alone.rest(); now += 20_000; alone.wake(); }"


@pytest.mark.parametrize("rests", [True, False])
@pytest.mark.parametrize("mode", ["value", "xy"])
async def test_no_line_leads_over_a_time_in_which_nobody_saw_the_plot(open_card, mode, rests):
    """Its values are at 0 and 1 on either side. CSV has the rows of messages alone."""
    settings = {"mode": mode, "window": "30"}
    side = "(x) => [0, 1, 0].forEach((y) => { now += 1000; take({ x: x + y / 9, y }); drawn(); })"
    async with open_card("plot", fields=["x", "y"], settings=settings) as page:
        await page.evaluate("() => take({ x: 0, y: 0 })")
        await plotted(page)
        await page.evaluate(f"() => [0].forEach({side})")
        await page.evaluate(REST if rests else "() => { now += 20_000; }")
        await page.evaluate(f"() => [9].forEach({side})")
        await until(page, f"rests => (({IN_THE_MIDDLE})() > 5) !== rests", rests)
        button = page.get_by_role("button", name="CSV of /x")
        _, text = await saved(page, button.press("Enter"))
        assert [len(each.split(",")[1]) > 0 for each in text.splitlines()] == [True] * 8


async def test_numbers_of_several_topics_in_one_plot(served, open_page):
    address = page_address(served) + "#card=plot+0+/one+data"
    kept = "new URLSearchParams(location.hash.slice(1)).get('card')"
    async with client(served.url) as robot:
        for topic, value in (("/one", 1.5), ("/two", 2.5)):
            await robot.send(op="advertise", topic=topic, type="std_msgs/Float64", latch=True)
            await robot.send(op="publish", topic=topic, msg={"data": value})
        async with open_page(address) as page:
            await page.wait_for_selector(".uplot")
            await page.wait_for_selector("#topics button:has-text('/two')")
            others = page.get_by_label("add a topic to the plot of /one")
            await others.focus()
            await others.select_option("/two")
            await page.get_by_role("button", name="plot data").press("Enter")
            await until(page, f"() => {kept} === 'plot 0 /one data /two:data'")
            both = "data 1.500|/two:data 2.500"
            await until(page, f"both => ({LABELS})().join('|') === both", both)
            await page.reload()
            await until(page, f"both => ({LABELS})().join('|') === both", both)


async def test_a_plot_keeps_a_limited_number_of_values(evaluate):
    kept = """async ([count, hz]) => {
        const { Samples } = await import("/views/plot_data.js");
        const samples = new Samples(1);
        for (let n = 0; n < count; n += 1) samples.add(n / hz, [n]);
        return [samples.length, samples.newest - samples.oldest];
    }"""
    length, _ = await evaluate(kept, [200_000, 1000])
    assert 60_000 <= length <= 66_000
    _, seconds = await evaluate(kept, [20_000, 10])
    assert 600 <= seconds <= 660


async def test_stamps_that_come_out_of_order_are_put_in_order(evaluate):
    found = await evaluate("""async () => {
        const { Samples } = await import("/views/plot_data.js");
        const samples = new Samples(1);
        // two nodes publish, one of them a second late, and twice at the same time
        const times = [10, 9, 11, 10, 12, 11, 13, 12, 13, 8.5];
        const again = times.map((time) => samples.add(time, [time]));
        const [ordered, values] = samples.within(-Infinity, Infinity);
        const isNew = samples.add(7.9, [1]); // a recording begins again
        return { again: again.some(Boolean), ordered, values, isNew, left: samples.length };
    }""")
    ordered = [8.5, 9, 10, 10, 11, 11, 12, 12, 13, 13]
    assert found == {
        "again": False,
        "ordered": ordered,
        "values": ordered,
        "isNew": True,
        "left": 1,
    }


STAMPED = """([time, message]) => {
    const sec = Math.floor(time);
    const header = { stamp: { sec, nanosec: (time - sec) * 1e9 } };
    const { topic = "/x", ...values } = message;
    takes[topic]({ ...values, header });
    drawn();
}"""


async def test_topics_whose_stamps_go_back_begin_again_together(open_card):
    fields, settings = ["data", "/y:data"], {"time": "stamp"}
    async with open_card("plot", fields=fields, settings=settings) as page:
        for time in (100, 101, 102):
            await page.evaluate(STAMPED, [time, {"data": time}])
            await page.evaluate(STAMPED, [time - 0.5, {"data": -time, "topic": "/y"}])
        await plotted(page)
        await until(page, f"() => ({LABELS})().join('|') === 'data 102|/y:data -102'")
        await page.evaluate(STAMPED, [1, {"data": 1}])
        await page.evaluate(STAMPED, [2, {"data": 2}])
        await until(page, f"() => ({LABELS})()[0] === 'data 2'")
        await point(page, 1 - 1 / 30)
        await until(page, f"() => ({LABELS})()[0] === 'data 1, 1.0 s ago'")


async def test_another_topic_is_drawn_while_that_of_the_card_is_silent(open_card):
    async with open_card("plot", fields=["data", "/y:data"]) as page:
        await page.evaluate(STAMPED, [0, {"data": 5, "topic": "/y"}])
        await plotted(page)
        await until(page, f"() => {{ drawn(); return ({LABELS})()[1] === '/y:data 5'; }}")
        await page.evaluate(STAMPED, [0, {"data": "text", "topic": "/y"}])
        problem = "document.querySelector('article > .problem').textContent"
        await until(page, f"() => {problem} === '/y: data is not a number'")
        await page.evaluate(STAMPED, [0, {"data": 6, "topic": "/y"}])
        await until(page, f"() => {problem} === ''")
