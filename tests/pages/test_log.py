# SPDX-License-Identifier: Apache-2.0
"""The view of a log: what it shows of thousands of lines, and what came before."""

import pytest

from tests.client import client
from tests.pages.conftest import page_address
from tests.pages.test_debug_page import card, until

pytestmark = pytest.mark.asyncio(loop_scope="package")

LOG = "rcl_interfaces/msg/Log"
# takes lines from one number to another: every tenth is an error of another node
SAY = """([first, last]) => {
    for (let n = first; n < last; n += 1) {
        const isError = n % 10 === 0;
        const [name, level] = isError ? ["base", 40] : ["lidar", 20];
        take({ level, stamp: { sec: n, nanosec: 0 }, name, msg: `line ${n}`, file: "" });
    }
    drawn();
}"""
COUNTS = "() => document.querySelector('.log > p').textContent"
LAST = "() => document.querySelector('.log li:last-child').textContent"


async def test_of_thousands_of_lines_the_newest_are_kept_and_the_seen_ones_made(open_card):
    async with open_card("log", type=LOG) as page:
        await page.evaluate(SAY, [0, 5600])
        assert await page.evaluate(COUNTS) == "5000 of 5000 lines · 500 errors · 0 warnings"
        assert (await page.evaluate(LAST)).endswith("line 5599")
        assert 5 < await page.locator(".log li").count() < 40
        top = "top => { document.querySelector('.log .window').scrollTop = top; }"
        await page.evaluate(top, 2000)
        await until(page, "() => document.querySelector('.log').innerText.includes('line 700')")
        await page.evaluate(SAY, [5600, 5650])  # the lines that are read stay in their place
        await until(page, "() => document.querySelector('.log').innerText.includes('line 700')")


async def test_lines_by_level_node_and_text(open_card):
    async with open_card("log", type=LOG) as page:
        await page.evaluate(SAY, [1, 101])
        await page.get_by_label("least level of /x").select_option("errors")
        assert await page.evaluate(COUNTS) == "10 of 100 lines · 10 errors · 0 warnings"
        await page.get_by_label("node of /x").select_option("lidar")
        assert "0 of 100" in await page.evaluate(COUNTS)
        assert "No line fits" in await page.inner_text(".log")
        await page.get_by_label("least level of /x").select_option("all")
        await page.get_by_label("text in /x").fill("LINE 7")
        assert await page.evaluate(COUNTS) == "10 of 100 lines · 10 errors · 0 warnings"
        assert (await page.evaluate(LAST)).endswith("line 79")
        await page.evaluate(SAY, [701, 703])
        assert (await page.evaluate(LAST)).endswith("line 702")
        kept = {"node": "lidar", "text": "LINE 7"}
        assert await page.evaluate("() => alone.settings") == kept


async def test_lines_that_fit_are_shown_before_the_browser_has_scrolled_to_them(open_card):
    async with open_card("log", type=LOG) as page:
        await page.evaluate(SAY, [1, 101])
        await page.evaluate("""() => Object.defineProperty(
            document.querySelector('.log .window'), 'scrollTop', { get: () => 1800, set() {} })""")
        await page.get_by_label("text in /x").fill("LINE 7")
        assert (await page.evaluate(LAST)).endswith("line 79")


async def test_one_line_is_shown_as_a_whole_by_the_keyboard(open_card):
    line = """take({ level: 30, stamp: { sec: 1, nanosec: 0 }, name: "arm", msg: "one\\ntwo",
        file: "arm.cpp", function: "go", line: 7 })"""
    whole = "() => document.querySelector('.log .whole').textContent"
    async with open_card("log", type=LOG) as page:
        await page.evaluate(f"() => {{ {line}; }}")
        await page.evaluate(SAY, [1, 30])
        await page.locator(".log [role=listbox]").press("End")
        assert "lidar: line 29" in await page.evaluate(whole)
        await page.keyboard.press("ArrowUp")
        assert "lidar: line 28" in await page.evaluate(whole)
        await page.keyboard.press("Home")
        assert (await page.evaluate(whole)).endswith("warning arm: one\ntwo (arm.cpp, go, line 7)")
        chosen = "document.querySelector('.log [aria-selected=true]').textContent"
        assert (await page.evaluate(f"() => {chosen}")).endswith("arm: one")


async def test_a_viewer_sees_lines_from_before_once(served, open_page):
    line = {"level": 20, "name": "talker", "stamp": {"sec": 5, "nanosec": 7}}
    async with client(served.url) as robot:
        await robot.send(op="advertise", topic="/rosout", type="rcl_interfaces/Log", latch=True)
        for number in range(30):
            await robot.send(op="publish", topic="/rosout", msg=line | {"msg": f"early {number}"})
        names = []
        while "early 29" not in names:
            await robot.send(op="log", id="l")
            log = await robot.receive(lambda frame: frame["op"] == "log")
            names = [each["msg"] for each in log["lines"]]
        async with open_page(page_address(served) + "#card=log+0+/rosout+text=early") as page:
            await page.wait_for_selector(card("/rosout"))
            await until(page, f"() => ({COUNTS})().startsWith('30 of ')")
            await robot.send(op="publish", topic="/rosout", msg=line | {"msg": "early or late"})
            await until(page, f"() => ({COUNTS})().startsWith('31 of ')")
