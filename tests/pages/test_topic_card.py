# SPDX-License-Identifier: Apache-2.0
"""A card of a topic, fed by hand: what it keeps while it is paused, and what it says how long."""

import pytest

from tests.client import client
from tests.pages.conftest import NO_CLIPBOARD, page_address
from tests.pages.test_debug_page import card, until
from tests.pages.test_world_views import COUNT

pytestmark = pytest.mark.asyncio(loop_scope="package")

LOG = "rcl_interfaces/msg/Log"
LINES = "() => [...document.querySelectorAll('.log li')].map((each) => each.textContent.at(-1))"
PROBLEM = "() => document.querySelector('article > .problem').textContent"
FOOTER = "() => document.querySelector('article > footer').textContent"
LABEL = "() => document.querySelector('.u-series:last-child .u-label')?.textContent"


async def plotted(page) -> None:
    """Draw until the plot is there: it waits for its width."""
    await until(page, "() => { alone.draw(now); return document.querySelector('.uplot'); }")


async def test_integers_of_64_bits_are_shown_copied_and_named_in_a_plot_as_they_are(
    open_page, served
):
    cards = "#card=tree+0+/long&card=plot+0+/long+data"
    address = page_address(served) + cards
    async with client(served.url) as speaker, open_page(address, script=NO_CLIPBOARD) as page:
        await speaker.send(op="advertise", topic="/long", type="std_msgs/Int64", latch=True)
        await speaker.send(op="publish", topic="/long", msg={"data": 2**63 - 1})
        tree = "document.querySelector('.tree')?.textContent"
        await until(page, f"() => {tree}?.startsWith('data: 9223372036854775807 plot')")
        await until(page, f"() => ({LABEL})() === 'data 9223372036854775807'")
        await page.get_by_role("button", name="Copy /long").first.click()
        await until(page, "() => copied[0]?.includes('\"data\": 9223372036854775807\\n')")


async def test_lines_of_a_log_that_came_while_it_was_paused_are_shown_at_its_end(open_card):
    log = "(n) => take({ level: 20, stamp: { sec: 0 }, name: 'node', msg: `line ${n}` })"
    async with open_card("log", type=LOG) as page:
        await page.evaluate(f"() => {{ [1, 2].forEach({log}); drawn(); press('Pause /x'); }}")
        await page.evaluate(f"() => {{ [3, 4].forEach({log}); drawn(); }}")
        assert await page.evaluate(LINES) == ["1", "2"]
        await page.evaluate("() => { press('Resume /x'); drawn(); }")
        assert await page.evaluate(LINES) == ["1", "2", "3", "4"]


async def test_a_log_does_not_turn_pale(open_card):
    log = "() => take({ level: 20, stamp: { sec: 0 }, name: 'node', msg: 'line' })"
    for view, is_stale in (("log", False), ("tree", True)):
        async with open_card(view, type=LOG) as page:
            for _ in range(3):
                await page.evaluate(log)
            await page.evaluate("() => { now += 3000; drawn(); }")
            assert await page.evaluate("() => alone.element.matches('.stale')") is is_stale


async def test_a_plot_has_what_came_while_it_was_paused(open_card):
    second = "(value) => { take({ data: value }); now += 1000; drawn(); }"
    async with open_card("plot", fields=["data"]) as page:
        await page.evaluate("() => take({ data: 0 })")
        await plotted(page)
        await page.evaluate(f"() => [1, 2, 3].forEach({second})")
        await page.evaluate("() => press('Pause /x')")
        await page.evaluate(f"() => [4, 5, 6].forEach({second})")
        over = page.locator(".plot .u-over")
        box = await over.bounding_box()
        assert box
        await page.mouse.move(box["x"] + box["width"] - 2, box["y"] + 9)
        await until(page, f"() => ({LABEL})().startsWith('data 3')")  # it stands still
        await page.evaluate("() => press('Resume /x')")
        await page.evaluate(f"() => [7].forEach({second})")
        # drawn 1.1 s after each value, the newest first
        for ago, value in ((1, "7"), (2, "6"), (3, "5"), (4, "4")):
            share = 1 - 1.1 * ago / 30
            await page.mouse.move(box["x"] + box["width"] * share, box["y"] + 9)
            await until(page, f"value => ({LABEL})().startsWith(`data ${{value}},`)", value)


async def test_a_field_that_joins_a_plot_keeps_what_is_plotted(open_card):
    async with open_card("plot", fields=["one"]) as page:
        await page.evaluate("() => { take({ one: 7 }); now += 10_000; take({ one: 8 }); }")
        await plotted(page)
        await page.evaluate("() => { alone.join('two'); take({ one: 9, two: 1 }); drawn(); }")
        assert await page.evaluate("() => subscriptions.at(-1).fields") == ["one", "two"]
        assert await page.evaluate(LABEL) == "two 1"
        await plotted(page)
        box = await page.locator(".plot .u-over").bounding_box()
        assert box
        await page.mouse.move(box["x"] + 2, box["y"] + 9)
        first = "document.querySelector('.u-series:nth-last-child(2) .u-label').textContent"
        await until(page, f"() => /^one 7, 1\\d\\.\\d s ago$/.test({first})")


async def test_marks_of_time_are_round(open_card):
    async with open_card("plot", fields=["data"]) as page:
        await page.evaluate("""() => {
            window.written = [];
            const { fillText } = CanvasRenderingContext2D.prototype;
            CanvasRenderingContext2D.prototype.fillText = function (text, ...where) {
                written.push(text);
                fillText.call(this, text, ...where);
            };
            take({ data: 1 });
            now += 1730;
        }""")
        await plotted(page)
        await until(page, "() => written.includes('0 s')")
        marks = set(await page.evaluate("() => written.filter((each) => each.endsWith(' s'))"))
        assert len(marks) > 3
        assert {int(each.split()[0]) % 5 for each in marks} == {0}


async def test_the_shown_message_is_copied(open_card):
    async with open_card("tree") as page:
        await page.evaluate("() => press('Copy /x')")
        await until(page, f"() => ({PROBLEM})() === 'not copied: no message yet'")
        await page.evaluate("() => { take({ data: 1 }); drawn(); press('Pause /x'); }")
        await page.evaluate("() => { take({ data: 2 }); drawn(); press('Copy /x'); }")
        await until(page, "() => copied.length === 1")
        assert "1" in await page.evaluate("() => copied[0]")
        await page.evaluate("() => { press('Resume /x'); press('Copy /x'); }")
        await until(page, "() => copied[1]?.includes('2')")


async def test_that_it_was_copied_is_said_for_a_while(open_card):
    button = "document.querySelector('[aria-label=\"Copy /x\"]').textContent"
    said = "document.querySelector('article .controls [role=status]').textContent"
    async with open_card("tree") as page:
        await page.evaluate("() => { take({ data: 1 }); press('Copy /x'); }")
        await until(page, f"() => {button} === 'Copied' && {said} === 'Copied'")
        await until(page, f"() => {button} === 'Copy' && {said} === ''")


@pytest.mark.parametrize("code", ["type_conflict", "deadline_missed"])
async def test_a_warning_is_said_until_the_next_message_disproves_it(open_card, code):
    async with open_card("tree") as page:
        await page.evaluate("code => says({ code, msg: 'it is so' })", code)
        await page.evaluate("() => { now += 60_000; alone.tick(); }")
        assert await page.evaluate(PROBLEM) == "it is so"
        await page.evaluate("() => take({ data: 1 })")
        assert await page.evaluate(PROBLEM) == ""


async def test_the_last_messages_do_not_disprove_a_lost_publisher(open_card):
    gone = """() => {
        says({ code: "publisher_gone", msg: "it is so" });
        take({ data: 1 }); // a rate has held it back
    }"""
    later = "() => { now += 1100; alone.tick(); }"
    publishers = "names => { gateway.graph.topics.get('/x').publishers = names; }"
    async with open_card("tree") as page:
        await page.evaluate(gone)
        await page.evaluate("() => alone.tick()")  # the graph may not know it yet
        assert await page.evaluate(PROBLEM) == "it is so"
        await page.evaluate(publishers, [])
        await page.evaluate(later)
        assert await page.evaluate(PROBLEM) == "it is so"
        await page.evaluate(publishers, ["/another"])
        await page.evaluate(later)
        assert await page.evaluate(PROBLEM) == ""
        await page.evaluate("() => says({ code: 'publisher_gone', msg: 'it is so' })")
        await page.evaluate(later)  # someone else publishes it, but nothing comes
        assert await page.evaluate(PROBLEM) == "it is so"


@pytest.mark.parametrize("view", ["tree", "log"])
async def test_without_a_connection_what_came_looks_old(open_card, view):
    type_name = LOG if view == "log" else "std_msgs/msg/Float64"
    stale = "() => { alone.tick(); return alone.element.classList.contains('stale'); }"
    async with open_card(view, type=type_name) as page:
        await page.evaluate("() => { gateway.isOpen = false; }")
        assert not await page.evaluate(stale)  # nothing has come
        await page.evaluate("() => { gateway.isOpen = true; take({ data: 1, stamp: {} }); }")
        assert not await page.evaluate(stale)
        await page.evaluate("() => { gateway.isOpen = false; }")
        assert await page.evaluate(stale)


async def test_that_messages_were_lost_is_said_for_some_seconds(open_card):
    lost = "() => says({ code: 'messages_lost', msg: 'it is so' })"
    async with open_card("tree") as page:
        for _ in range(2):
            await page.evaluate(lost)
            await page.evaluate("() => { take({ data: 1 }); now += 6000; alone.tick(); }")
            assert await page.evaluate(PROBLEM) == "it is so"
        await page.evaluate("() => { now += 6000; alone.tick(); }")
        assert await page.evaluate(PROBLEM) == ""


async def test_a_new_connection_knows_no_warning_of_the_one_before(open_card):
    async with open_card("tree") as page:
        await page.evaluate("() => says({ code: 'qos_incompatible', msg: 'it is so' })")
        await page.evaluate("() => hear.state({ state: 'closed' })")
        assert await page.evaluate(PROBLEM) == "it is so"
        await page.evaluate("() => hear.state({ state: 'open' })")
        assert await page.evaluate(PROBLEM) == ""
    async with open_card("scan") as page:  # which shows no Float64
        await page.evaluate("() => hear.state({ state: 'open' })")
        assert "choose another view" in await page.evaluate(PROBLEM)


async def test_the_footer_does_not_contradict_what_is_wrong(open_card):
    async with open_card("tree") as page:
        await page.evaluate("() => alone.tick()")
        assert "/talker sent nothing" in await page.evaluate(FOOTER)
        await page.evaluate("() => says({ code: 'decode_failed', msg: 'unknown' })")
        await page.evaluate("() => alone.tick()")
        assert await page.evaluate(FOOTER) == ""


async def test_of_several_types_one_is_chosen(open_card):
    types = ["std_msgs/msg/Float64", "sensor_msgs/msg/LaserScan"]
    shown = "() => document.querySelector('article .type').textContent"
    async with open_card("plot", fields=["data"], types=types) as page:
        chosen = page.get_by_role("combobox", name="type of /x")
        assert await chosen.locator("option").all_inner_texts() == ["choose a type", *types]
        await chosen.select_option(types[1])
        assert await page.evaluate("() => subscriptions.at(-1).type") == types[1]
        assert await page.evaluate("() => alone.shown.chosenType") == types[1]
        assert await page.evaluate(shown) == types[1]
        view = page.get_by_role("combobox", name="view of /x")
        assert "Scan" in await view.locator("option").all_inner_texts()
    async with open_card("tree") as page:
        assert await page.get_by_role("combobox", name="type of /x").count() == 0


async def test_the_address_keeps_the_type_that_was_chosen(open_page, served):
    named = "#card=tree+0+/later:std_msgs/msg/String"
    async with client(served.url) as speaker, open_page(page_address(served) + named) as page:
        await page.wait_for_selector(card("/later"))
        await speaker.send(op="advertise", topic="/later", type="std_msgs/String", latch=True)
        await speaker.send(op="publish", topic="/later", msg={"data": "at last"})
        await until(page, "() => document.querySelector('.tree')?.textContent.includes('at last')")
        await page.select_option("select[aria-label='view of /later']", "raw")
        kept = "new URLSearchParams(location.hash.slice(1)).get('card')"
        await until(page, f"() => {kept} === 'raw 0 /later:std_msgs/msg/String'")


async def test_a_number_without_neighbours_is_a_dot(open_card):
    # each time again: a busy machine may lay the card out after the first ones were drawn
    once_more = "take({ data: 5 }); take({ data: NaN }); drawn()"
    async with open_card("plot", fields=["data"]) as page:
        seen = f"about => {{ {once_more}; return ({COUNT})(about) > 20; }}"
        await until(page, seen, ["article canvas", "--series-1"])


async def test_a_name_turns_no_text_around_it(open_card):
    line = {"level": 20, "stamp": {"sec": 1}, "name": "n\u202eevil", "msg": "it is so"}
    async with open_card("log", type=LOG) as page:
        await page.evaluate("line => { take(line); drawn(); }", line)
        apart = "() => [...document.querySelectorAll('.log bdi')].map((each) => each.textContent)"
        assert await page.evaluate(apart) == [line["name"], line["msg"]]


async def test_a_single_message_has_an_age_and_no_rate(open_card):
    async with open_card("tree") as page:
        await page.evaluate("() => { gateway.throttleOf = () => 200; take({ data: 1 }); }")
        await page.evaluate("() => { now += 17_000; drawn(); }")
        assert await page.evaluate(FOOTER) == "came once · 9 B · 17.1 s old"
        await page.evaluate("() => { take({ data: 2 }); now += 1000; drawn(); }")
        await page.evaluate("() => { take({ data: 3 }); drawn(); }")
        assert "limited to 5 Hz" in await page.evaluate(FOOTER)


async def test_the_fields_of_a_type_are_sorted_by_what_may_be_large(open_card, served):
    async with client(served.url) as speaker:
        await speaker.send(op="describe", type="sensor_msgs/msg/PointCloud2")
        cloud = await speaker.receive(lambda frame: frame["op"] == "describe")
        await speaker.send(op="describe", type="nav_msgs/msg/Odometry")
        odometry = await speaker.receive(lambda frame: frame["op"] == "describe")
    async with open_card("tree") as page:
        sort = """async (schema) => {
            gateway.ask = async () => ({ schema });
            return await alone.sortedFields();
        }"""
        small = ["header", "height", "width", "is_bigendian", "point_step", "row_step", "is_dense"]
        assert await page.evaluate(sort, cloud["schema"]) == {
            "small": small, "large": ["fields", "data"]
        }  # fmt: skip
        assert (await page.evaluate(sort, odometry["schema"]))["large"] == []


async def test_a_scan_without_angles_is_said(open_card):
    scan = "{ ranges: [1], range_min: 0, range_max: 9, angle_min: NaN, angle_increment: 1 }"
    async with open_card("scan", type="sensor_msgs/msg/LaserScan") as page:
        await page.evaluate(f"() => {{ take({scan}); drawn(); }}")
        assert "an angle in it is not a number" in await page.evaluate(PROBLEM)
