# SPDX-License-Identifier: Apache-2.0
"""The list of topics on the debug page: by namespace, and with what is measured of each."""

import json

import pytest

from tests.client import client
from tests.gateway_process import gateway_process
from tests.pages.conftest import page_address, robots_domain, severable
from tests.pages.test_debug_page import NOTE_SENT, card, new_token, until

pytestmark = pytest.mark.asyncio(loop_scope="package")

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
    return f"{buttons}.find((each) => {name})?.lastChild.title"


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
async def test_topics_that_share_a_namespace_stand_in_a_branch(evaluate, names, tree):
    assert await evaluate(TREE, names) == tree


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


async def test_a_click_on_what_is_open_brings_its_card_into_view_and_the_list_marks_it(
    demo, open_page
):
    focus = "() => document.activeElement.getAttribute('aria-label')"
    cards = "#card=raw+0+/odom&card=tree+0+/scan&card=tree+0+/imu"
    async with open_page(page_address(demo) + cards) as page:
        marked = page.locator("#topics button[aria-pressed=true]")
        await until(page, "() => document.querySelectorAll('[aria-pressed=true]').length === 3")
        assert await marked.evaluate_all(
            "all => all.map((each) => each.firstChild.textContent)"
        ) == ["/imu", "/odom", "/scan"]
        await page.click("#topics button:has-text('/odom')")
        assert await page.evaluate(focus) == "/odom"
        await page.click("button[aria-label='publish to /goal_pose']")
        await page.click("button[aria-label='publish to /goal_pose']")
        await page.click("#tab-nodes")
        await page.click("#nodes button:has-text('/simulated_robot')")
        assert await page.locator("#nodes button[aria-pressed=true]").count() == 1
        assert await page.locator("article").count() == 5
        await page.click("button[aria-label='close /odom']")
        assert await marked.count() == 2


async def test_a_list_is_one_stop_of_tab_and_arrow_keys_go_through_it(demo, open_page):
    async with open_page(page_address(demo) + "#card=tree+0+/odom") as page:
        await page.wait_for_selector("#topics button:has-text('/tf')")

        async def press(*keys: str) -> str:
            for key in keys:
                await page.keyboard.press(key)
            return await page.evaluate("""() => {
                const { ariaLabel, id, firstChild } = document.activeElement;
                return ariaLabel || id || firstChild.textContent;
            }""")

        await page.focus("#measure")
        assert await press("Tab") == "/battery_state"
        assert await press("ArrowDown", "ArrowDown") == "/camera/camera_info"
        assert await press("ArrowRight") == "plot a number of /camera/camera_info"
        assert await press("ArrowRight", "ArrowRight") == "publish to /camera/camera_info"
        assert await press("ArrowUp", "Enter", "ArrowDown") == "/cmd_vel"  # its branch is closed
        assert await press("End", "Home") == "/battery_state"
        assert await press("End", "Tab") == "view of /odom"  # in the first card
        assert (await press("Shift+Tab")).startswith("/tf")
        assert await press("Shift+Tab") == "measure"
        await page.focus("#tab-topics")
        assert await press("End") == "tab-nodes"
        assert await press("Home") == "tab-topics"


async def test_the_tab_stop_of_a_list_can_be_seen(demo, open_page):
    async with open_page(page_address(demo) + "#card=tree+0+/odom") as page:
        stop = "() => document.querySelector('#topics [tabindex=\"0\"]').textContent"
        await page.focus("#topics button:has-text('/camera/camera_info')")
        await page.click("#topics summary:text-is('/camera')")
        await until(page, f"() => ({stop})() === '/camera'")
        await page.fill("#search", "odom")
        assert (await page.evaluate(stop)).startswith("/odom")


async def test_a_link_skips_the_list(demo, open_page):
    async with open_page(page_address(demo) + "#card=tree+0+/odom&card=tree+0+/imu") as page:
        await page.wait_for_selector(card("/imu"))
        address = page.url
        await page.keyboard.press("Tab")
        assert await page.evaluate("() => document.activeElement.id") == "skip"
        assert await page.locator("#skip").evaluate("each => each.checkVisibility()")
        await page.keyboard.press("Enter")
        assert await page.evaluate("() => document.activeElement.ariaLabel") == "/odom"
        assert page.url == address
        levels = """() => [...document.querySelectorAll("h1, h2, h3")]
            .filter((each) => each.checkVisibility()).map((each) => each.tagName)"""
        assert await page.evaluate(levels) == ["H1", "H2", "H2", "H3", "H3"]


async def test_a_name_that_is_too_long_says_why_it_cannot_be_opened(open_page, nowhere):
    few = ("--set", "limits.max_name_characters=12")
    async with (
        gateway_process("serve", *nowhere) as robot,
        gateway_process("serve", *nowhere, *few) as gateway,
        client(robot.url) as speaker,
        open_page(page_address(gateway)) as page,
    ):
        for topic in ("/as/long/as_it", "/a/longer/one"):
            await speaker.send(op="advertise", topic=topic, type="std_msgs/msg/String")
        words = "its name has 13 characters, the gateway accepts 12"
        button = page.locator("#topics button:has-text('/a/longer/one')")
        await page.wait_for_selector(f"#topics button:has-text('{words}')")
        assert await button.is_disabled()
        assert await button.locator("span wbr").count() > 1  # it breaks at slashes


async def test_only_what_can_be_seen_is_measured(demo, open_page):
    async with open_page(f"{page_address(demo)}#measure=all&card=plot+0+/imu") as page:
        await until(page, f"() => / Hz · /.test({words('/camera/camera_info')})")
        await page.click("#topics summary:text-is('/camera')")
        await until(page, f"() => {words('/camera/camera_info')} === ''")
        await until(page, f"() => / Hz · /.test({words('/battery_state')})")  # of once a second


async def test_every_topic_is_measured_on_request_and_the_address_keeps_it(demo, open_page):
    async with open_page(f"{page_address(demo)}#card=plot+0+/imu", TALL) as page:
        await until(page, f"() => {words('/scan')} === ''")
        await page.check(MEASURE)
        await until(page, f"() => /^[0-9.]+ Hz · 2.9 kB · /.test({words('/scan')})")
        await until(page, f"() => /^[0-9.]+ Hz · /.test({words('/camera/camera_info')})")
        await until(page, f"() => {words('/parameter_events')} === 'no message yet'")
        await page.reload()
        await until(page, f"() => /^[0-9.]+ Hz · 2.9 kB · /.test({words('/scan')})")
        await page.uncheck(MEASURE)
        await until(page, f"() => {words('/scan')} === ''")
        assert "measure" not in page.url
        await until(page, f"() => / Hz · /.test({words('/imu')})")  # a card shows it


async def test_the_rate_is_that_of_the_topic_though_two_frames_a_second_come(open_page, served):
    async with (
        client(served.url) as robot,
        open_page(f"{page_address(served)}#measure=all&card=connection+0+/", TALL) as page,
    ):
        await robot.send(op="advertise", topic="/chatter", type="std_msgs/msg/String")
        shown = f"() => parseFloat({words('/chatter')}) || 0"
        while await page.evaluate(shown) < 20:
            for _ in range(10):
                await robot.send(op="publish", topic="/chatter", msg={"data": "hello"})
            await page.wait_for_timeout(100)
        listed = "[...document.querySelectorAll('article dt')].map((each) => each.textContent)"
        assert await page.evaluate(listed)
        assert "chatter" not in await page.evaluate(listed)  # but what cards show


async def test_a_card_of_a_measured_topic_gets_whole_messages(demo, open_page):
    note = """
        window.frames = [];
        const { parse } = JSON;
        JSON.parse = (text) => {
            const frame = parse(text);
            if (frame?.op === "publish") frames.push([frame.topic, Object.keys(frame.msg).length]);
            return frame;
        };
    """
    of = "topic => frames.filter(([name]) => name === topic).map(([, fields]) => fields)"
    async with open_page(f"{page_address(demo)}#measure=all", TALL, script=note) as page:
        await until(page, f"() => / Hz · /.test({words('/imu')})")
        await page.click("#topics button:has-text('/imu')")
        await until(page, f"() => ({of})('/imu').length > 5")
        assert 0 not in await page.evaluate(of, "/imu")
        assert set(await page.evaluate(of, "imu")) == {0}
        # the card says it as well: what comes of a measured topic ends
        await until(page, "() => frames.slice(-40).every(([name]) => name !== 'imu')")


async def test_a_topic_that_is_not_measured_says_why_until_there_is_room(open_page, nowhere):
    few = ("--set", "limits.max_subscriptions=1")
    both = f"[{words('/rosout')}, {words('/diagnostics')}]"
    async with (
        gateway_process("serve", *nowhere, *few) as gateway,
        open_page(f"{page_address(gateway)}#card=tree+0+/rosout", TALL) as page,
    ):
        await page.wait_for_selector(card("/rosout"))
        await page.check(MEASURE)
        await until(page, f"() => /at most 1 /.test({words('/diagnostics')})")
        assert "at most 1" not in await page.evaluate(f"() => {words('/rosout')}")
        await page.click("button[aria-label='close /rosout']")
        await until(page, f"() => {both}.some((each) => / old$/.test(each))")
        await page.uncheck(MEASURE)
        await until(page, f"() => {both}.every((each) => each === '')")
        assert await page.is_hidden("#notice")  # to end what was refused is nothing to tell of


async def test_measured_topics_stay_so_by_another_connection(demo, open_page):
    async with open_page("about:blank", TALL) as page, severable(page) as line:
        await page.goto(f"{page_address(demo)}#measure=all&card=plot+0+/imu")
        await until(page, f"() => / Hz · /.test({words('/scan')})")
        await line.cut()
        await until(page, "() => state.dataset.state === 'closed'")
        line.mend()
        await until(page, "() => state.dataset.state === 'open'")
        await until(page, f"() => / Hz · .* ms old/.test({words('/scan')})")


async def test_without_a_robot_the_page_says_so_whatever_is_to_be_measured(open_page, nowhere):
    silent = ("--set", "ros.diagnostics=false")
    async with (
        gateway_process("serve", *nowhere, *silent) as gateway,
        open_page(page_address(gateway)) as page,
    ):
        said = "() => /Start a robot/.test(cards.textContent)"
        await until(page, said)
        await page.check(MEASURE)
        assert await page.evaluate(said)
        await page.reload()
        await until(page, said)
        assert await page.is_checked(MEASURE)


async def test_a_long_list_makes_the_page_no_longer(open_page, served):
    phone = {"width": 390, "height": 844}
    async with (
        client(served.url) as robot,
        open_page(page_address(served), phone) as page,
    ):
        for number in range(40):
            name = f"/robot/part{number % 4}/topic{number}"
            await robot.send(op="advertise", topic=name, type="std_msgs/msg/String")
        await until(
            page, "() => document.querySelectorAll('#topics button:first-child').length > 40"
        )
        await page.evaluate("() => scrollTo(0, document.documentElement.scrollHeight)")
        stop = await page.locator("#stop").bounding_box()
        assert 0 <= stop["y"] < phone["height"]
        whole = page.get_by_role("button", name="/robot/part1/topic1 std_msgs/msg/String")
        assert await whole.first.count() == 1  # read out as one name


@pytest.mark.parametrize(
    ("came", "hz"),
    [
        # each: the time of a message in ms, and its number. The clock ticks once a second
        ([(100 * n, n) for n in range(30)], "10 Hz"),
        ([(500 * n, 15 * n) for n in range(6)], "30 Hz"),
        ([(2000, n) for n in range(10)], "1 B"),  # at once: that is not a rate
        ([(0, 1), (2000, 2)], "0.5 Hz"),
        (
            [(0, 70), (500, 75)] + [(1000 + 500 * n, 5 * n) for n in range(5)],
            "10 Hz",
        ),  # counted again
        ([(0, 1), (500, 2)], "0.4 Hz"),  # and none for 2.5 s
    ],
)
async def test_a_rate_is_that_of_the_numbers_whatever_comes_when(evaluate, came, hz):
    reckon = """async came => {
        const { Arrivals } = await import("/shared/arrivals.js");
        const { wordsOf } = await import("/debug/arrival_words.js");
        const { now: clock } = performance;
        let now = 0;
        performance.now = () => now;
        const arrivals = new Arrivals();
        for (now = 0; now <= 3000; now += 100) {
            for (const [ms, seq] of came) if (ms === now) arrivals.add(1, 0, seq);
            if (now % 1000 === 0 && now) arrivals.tick();
        }
        const words = wordsOf(arrivals);
        performance.now = clock;
        return words;
    }"""
    assert (await evaluate(reckon, came)).startswith(f"{hz} · ")


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


async def test_a_press_that_has_begun_counts_though_topics_come_and_go(open_page, served):
    async with (
        client(served.url) as robot,
        open_page(page_address(served) + "#cards=none") as page,
    ):
        for topic in ("/b", "/c", "/e"):
            await robot.send(op="advertise", topic=topic, type="std_msgs/String")
        row = page.locator("#topics li[data-topic='/c'] button:has-text('/c')")
        await row.hover()
        await page.mouse.down()
        await robot.send(op="unadvertise", topic="/b")
        await robot.send(op="unadvertise", topic="/e")
        await robot.send(op="advertise", topic="/d", type="std_msgs/String")
        await page.wait_for_selector("#topics li[data-topic='/d']")
        await page.wait_for_selector("#topics li[data-topic='/b']", state="detached")
        await row.hover()
        await page.mouse.up()
        await page.wait_for_selector(card("/c"))


@pytest.mark.parametrize("size", ["#cards=none", "#cards=none&measure=all"])
async def test_25_topics_have_a_line_each_on_a_screen_of_900_pixels(open_page, served, size):
    laptop = {"width": 1440, "height": 900}
    shown = """() => [...document.querySelectorAll("#topics li")].filter((each) => {
        const { top, bottom } = each.getBoundingClientRect();
        return top > 0 && bottom <= innerHeight && each.offsetHeight < 30;
    }).length"""
    async with (
        client(served.url) as robot,
        open_page(page_address(served) + size, laptop) as page,
    ):
        for number in range(30):
            name = f"/a_topic_with_a_long_name_{number}"
            await robot.send(op="advertise", topic=name, type="geometry_msgs/PoseStamped")
        await until(page, "() => document.querySelectorAll('#topics li').length > 30")
        assert await page.evaluate(shown) >= 25


async def test_rate_and_size_cost_nothing_until_they_can_be_seen(demo, open_page):
    asked = """() => sent.map((each) => JSON.parse(each))
        .filter(({ op, topic }) => op === "subscribe" && topic === "scan").length"""
    ended = """() => sent.map((each) => JSON.parse(each))
        .some(({ op, topic }) => op === "unsubscribe" && topic === "scan")"""
    async with open_page(f"{page_address(demo)}#cards=none", TALL, script=NOTE_SENT) as page:
        row = "#topics li[data-topic='/scan'] .figures"
        await page.wait_for_selector(row, state="attached")
        assert await page.inner_text(row) == ""
        assert await page.evaluate(asked) == 0
        await page.check(MEASURE)
        await until(page, f'() => / Hz/.test(document.querySelector("{row}").innerText)')
        assert await page.locator(f"{row} span").all_inner_texts() != []
        assert await page.evaluate(asked) == 1
        await page.click("#tab-services")
        await until(page, ended)


async def test_namespaces_stay_folded(demo, open_page):
    image = "#topics li[data-topic='/camera/image_raw']"
    async with open_page(f"{page_address(demo)}#cards=none") as page:
        await page.wait_for_selector(image)
        await page.click(".bar .more")
        await page.get_by_role("menuitem", name="Fold all namespaces", exact=True).click()
        await page.wait_for_selector(image, state="hidden")
        await page.reload()
        await page.wait_for_selector(image, state="hidden")
        await page.click(".bar .more")
        await page.get_by_role("menuitem", name="Unfold all namespaces", exact=True).click()
        await page.wait_for_selector(image)


async def test_a_slash_leads_to_the_search_but_in_a_text_it_is_a_slash(demo, open_page):
    async with open_page(f"{page_address(demo)}#card=tree+0+/odom") as page:
        await page.wait_for_selector("#topics li[data-topic='/odom']")
        await page.keyboard.press("/")
        assert await page.evaluate("() => document.activeElement.id") == "search"
        await page.keyboard.type("/odom")
        assert await page.input_value("#search") == "/odom"
        await page.focus("#tab-topics")
        await page.keyboard.press("/")  # and what is there is chosen
        await page.keyboard.type("imu")
        assert await page.input_value("#search") == "imu"


async def test_keys_lead_from_the_search_to_what_it_finds(demo, open_page):
    """The down arrow to the first row, and Enter to the first name, in the list that is shown."""
    async with open_page(f"{page_address(demo)}#card=none") as page:
        await page.wait_for_selector("#topics li[data-topic='/odom']")
        await page.focus("#search")
        for key in ("Enter", "ArrowDown"):  # Enter opens nothing that nobody has searched
            await page.keyboard.press(key)
        first = "() => document.activeElement.closest('#topics')?.querySelector('button, summary')"
        assert await page.evaluate(f"() => document.activeElement === ({first})()")
        assert await page.locator("article").count() == 0
        await page.focus("#search")
        await page.keyboard.type("ODOM")
        await page.keyboard.press("Enter")
        await page.wait_for_selector("article:has-text('/odom')")
        await page.click("#tab-services")
        await page.fill("#search", "/reset")
        await page.press("#search", "ArrowDown")
        text = "() => document.activeElement.textContent"
        assert (await page.evaluate(text)).startswith("/reset")
        await page.fill("#search", "nothing is named so")
        await page.press("#search", "Enter")
        assert await page.locator("article").count() == 1


@pytest.mark.parametrize(
    ("topics", "frames", "robots"),
    [
        ({"/odom": "nav_msgs/msg/Odometry"}, [], []),
        ({"/a/odom": "nav_msgs/msg/Odometry", "/b/image": "sensor_msgs/msg/Image"}, [], ["a"]),
        (
            {"/b/cmd_vel": "geometry_msgs/msg/Twist", "/a/tf": "tf2_msgs/msg/TFMessage"},
            ["map", "c/base_link", "/d/odom"],
            ["a", "b", "c", "d"],
        ),
    ],
)
async def test_a_robot_has_a_namespace_or_a_prefix_of_its_frames(evaluate, topics, frames, robots):
    find = """async ([topics, frames]) => {
        const { robotsOf } = await import("/debug/robots.js");
        const all = Object.entries(topics).map(([name, type]) => ({ name, types: [type] }));
        return robotsOf(all, frames);
    }"""
    assert await evaluate(find, [topics, frames]) == robots


async def test_one_of_several_robots_is_picked_and_the_address_keeps_it(open_page, served):
    names = """() => [...document.querySelectorAll("#topics li[data-topic]")]
        .map((each) => each.dataset.topic).filter((each) => /scan|status/.test(each)).sort()"""
    still = {"translation": {}, "rotation": {"w": 1}}
    frames = [
        {"header": {"frame_id": f"{each}/base_link"}, "child_frame_id": f"{each}/laser"}
        | {"transform": still}
        for each in ("r1", "r2")
    ]
    async with (
        client(served.url) as robot,
        open_page(page_address(served) + "#cards=none") as page,
    ):
        topics = ("/r1/scan", "/r2/scan", "/status")
        for topic in topics:
            await robot.send(op="advertise", topic=topic, type="std_msgs/String")
        await until(page, f"all => String(({names})()) === String(all)", list(topics))
        assert await page.is_hidden("#robot")
        static = {"topic": "/tf_static", "type": "tf2_msgs/TFMessage", "latch": True}
        await robot.send(op="advertise", **static)
        await robot.send(op="publish", topic="/tf_static", msg={"transforms": frames})
        await page.select_option("#robot", "r2")
        await until(page, f"all => String(({names})()) === String(all)", ["/r2/scan", "/status"])
        await page.reload()
        await until(page, f"all => String(({names})()) === String(all)", ["/r2/scan", "/status"])
        await page.select_option("#robot", "")
        await until(page, f"all => String(({names})()) === String(all)", list(topics))
        assert "robot" not in page.url


async def test_without_a_robot_the_page_says_where_the_gateway_searches(open_page, nowhere):
    silent = ("--set", "ros.diagnostics=false")
    async with (
        gateway_process("serve", *nowhere, *silent) as gateway,
        open_page(page_address(gateway)) as page,
    ):
        domain = nowhere[1]
        for row in (
            f"ROS_DOMAIN_ID.* ?{domain}",
            "RMW_IMPLEMENTATION.*rmw_",
            "DISCOVERY_RANGE.*comput",
        ):
            await until(page, "row => new RegExp(row).test(cards.textContent)", row)
