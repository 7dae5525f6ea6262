# SPDX-License-Identifier: Apache-2.0
"""The list of topics on the debug page: by namespace, and with what is measured of each."""

import json

import pytest

from tests.client import client
from tests.gateway_process import gateway_process
from tests.pages.conftest import page_address, robots_domain
from tests.pages.test_debug_page import card, new_token, until

pytestmark = pytest.mark.asyncio(loop_scope="module")

MEASURE = "#measure"
TALL = {"width": 1280, "height": 2400}  # all topics can be seen
# the tree of names, as nested lists of their labels
TREE = """async names => {
    const { treeOf } = await import("/debug/namespaces.js");
    const labels = (nodes) => nodes.map(({ name, label, below }) =>
        below ? [label, ...labels(below)] : `${label} = ${name}`);
    return labels(treeOf(names));
}"""


def words(topic: str) -> str:
    """Return a script for what the list says of a topic."""
    buttons = "[...document.querySelectorAll('#topics li > button:first-child')]"
    name = f"each.firstChild.textContent === {json.dumps(topic)}"
    return f"{buttons}.find((each) => {name})?.lastChild.textContent"


@pytest.mark.parametrize(
    ("names", "tree"),
    [
        ([], []),
        (["/odom", "/scan"], ["/odom = /odom", "/scan = /scan"]),
        (["/a/b", "/c"], ["/a/b = /a/b", "/c = /c"]),
        (["/a/b", "/a/c"], [["/a", "/b = /a/b", "/c = /a/c"]]),
        # a namespace alone in another one makes one branch with it
        (
            ["/robot/left/a", "/robot/left/b"],
            [["/robot/left", "/a = /robot/left/a", "/b = /robot/left/b"]],
        ),
        (
            ["/r/c/image", "/r/c/info", "/r/odom"],
            [["/r", ["/c", "/image = /r/c/image", "/info = /r/c/info"], "/odom = /r/odom"]],
        ),
        # a topic, and topics below its name
        (
            ["/image", "/image/compressed", "/image/theora"],
            [
                "/image = /image",
                ["/image", "/compressed = /image/compressed", "/theora = /image/theora"],
            ],
        ),
        (
            ["/image", "/image/compressed"],
            ["/image = /image", "/image/compressed = /image/compressed"],
        ),
        (["/ab/x", "/abc/y"], ["/ab/x = /ab/x", "/abc/y = /abc/y"]),
    ],
)
async def test_topics_that_share_a_namespace_stand_in_a_branch(demo, open_page, names, tree):
    async with open_page(page_address(demo)) as page:
        assert await page.evaluate(TREE, names) == tree


async def test_a_branch_is_closed_and_what_is_searched_is_found_all_the_same(demo, open_page):
    camera = page_topic = "/camera/camera_info"
    async with open_page(page_address(demo)) as page:
        item = page.locator(f"#topics button:has-text('{page_topic}')").first
        await item.wait_for()
        await page.click("#topics summary:text-is('/camera')")
        await item.wait_for(state="hidden")
        await page.fill("#search", "camera_info")
        await item.wait_for()
        await page.fill("#search", "")
        await item.wait_for(state="hidden")  # as it was left
        await page.click("#topics summary:text-is('/camera')")
        await item.click()
        await page.wait_for_selector(card(camera))


async def test_only_what_can_be_seen_is_measured(demo, open_page):
    async with open_page(f"{page_address(demo)}#measure=all&card=plot+0+/imu") as page:
        await until(page, f"() => / Hz · /.test({words('/camera/camera_info')})")
        await page.click("#topics summary:text-is('/camera')")
        await until(page, f"() => {words('/camera/camera_info')} === ''")
        assert "Hz" in await page.evaluate(f"() => {words('/battery_state')}")


async def test_every_topic_is_measured_on_request_and_the_address_keeps_it(demo, open_page):
    async with open_page(f"{page_address(demo)}#card=plot+0+/imu", TALL) as page:
        await until(page, f"() => {words('/scan')} === ''")
        await page.check(MEASURE)
        await until(page, f"() => /^[0-9.]+ Hz · 2.9 kB · /.test({words('/scan')})")
        await until(page, f"() => /^[0-9.]+ Hz · /.test({words('/camera/camera_info')})")
        await until(page, f"() => {words('/parameter_events')} === 'nothing yet'")
        await page.reload()
        await until(page, f"() => /^[0-9.]+ Hz · 2.9 kB · /.test({words('/scan')})")
        await page.uncheck(MEASURE)
        await until(page, f"() => {words('/scan')} === ''")
        assert "measure" not in page.url
        await until(page, f"() => / Hz · /.test({words('/imu')})")  # a card shows it


async def test_the_rate_is_that_of_the_topic_though_two_frames_a_second_come(open_page, nowhere):
    async with (
        gateway_process("serve", *nowhere) as gateway,
        client(gateway.url) as robot,
        open_page(f"{page_address(gateway)}#measure=all&card=connection+0+/", TALL) as page,
    ):
        await robot.send(op="advertise", topic="/chatter", type="std_msgs/msg/String")
        shown = f"() => parseFloat({words('/chatter')}) || 0"
        while await page.evaluate(shown) < 20:
            for _ in range(10):
                await robot.send(op="publish", topic="/chatter", msg={"data": "hello"})
            await page.wait_for_timeout(100)
        came = "[...document.querySelectorAll('article td')].map((each) => each.textContent)"
        assert "chatter" not in await page.evaluate(came)  # the card says what cards get


async def test_a_card_of_a_measured_topic_gets_whole_messages(demo, open_page):
    async with open_page(f"{page_address(demo)}#measure=all&card=raw+0+/imu", TALL) as page:
        await until(page, f"() => / Hz · /.test({words('/scan')})")
        await page.evaluate(
            """() => {
                window.shown = [];
                const raw = document.querySelector(".raw");
                new MutationObserver(() => shown.push(raw.textContent)).observe(
                    raw, { childList: true, characterData: true, subtree: true });
            }"""
        )
        await until(page, "() => shown.length > 40")
        assert [
            text for text in await page.evaluate("() => shown") if "orientation" not in text
        ] == []


async def test_a_topic_that_is_not_measured_says_why(open_page, nowhere):
    few = ("--set", "limits.max_subscriptions=1")
    async with (
        gateway_process("serve", *nowhere, *few) as gateway,
        open_page(f"{page_address(gateway)}#measure=all&card=connection+0+/", TALL) as page,
    ):
        await until(page, f"() => /at most 1/.test([{words('/rosout')}, {words('/diagnostics')}])")


async def test_a_first_visit_of_who_may_not_drive_has_no_stick(demo, open_page, tmp_path):
    file = tmp_path / "tokens.json"
    token = await new_token(file, "--role", "viewer")
    settings = ("--set", "access.authentication=token", "--set", f"access.token_file={file}")
    async with (
        gateway_process("serve", *settings, "--domain-id", str(robots_domain())) as gateway,
        open_page(f"{page_address(gateway)}#token={token}") as page,
    ):
        await page.wait_for_selector(card("/odom"))
        await until(page, "() => /role ?viewer/.test(figures.textContent)")
        assert await page.locator(".stick").count() == 0
