# SPDX-License-Identifier: Apache-2.0
"""The debug page in a real browser."""

import asyncio
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.client import client
from tests.demonstration import until_it_can_be_driven
from tests.gateway_process import gateway_process
from tests.pages.conftest import DESK, page_address

pytestmark = [pytest.mark.brief, pytest.mark.asyncio(loop_scope="package")]

PHONE = {"width": 390, "height": 844}
# the frames of the page, as they are sent
NOTE_SENT = """
    window.sent = [];
    const { send } = WebSocket.prototype;
    WebSocket.prototype.send = function (data) { sent.push(data); send.call(this, data); };
"""
# whether a canvas has more than one colour. Asked of a copy, as reading makes a canvas slow
PAINTED = """canvas => {
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d");
    copy.drawImage(canvas, 0, 0);
    const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
    return new Set(new Uint32Array(data.buffer)).size > 1;
}"""


async def until(page, script: str, argument=None) -> None:
    """Wait until a function of the page returns true."""
    await page.wait_for_function(script, arg=argument)


async def until_painted(page, selector: str) -> None:
    await page.wait_for_selector(selector)
    await until(page, f"selector => ({PAINTED})(document.querySelector(selector))", selector)


async def new_token(file: Path, *options: str) -> str:
    command = [
        sys.executable,
        "-m",
        "gateway",
        "token",
        "--file",
        str(file),
        "create",
        "tablet",
        *options,
    ]
    finished = await asyncio.to_thread(
        subprocess.run, command, capture_output=True, text=True, check=True
    )
    return finished.stdout.strip()


def card(topic: str) -> str:
    return f'article[aria-label="{topic}"]'


async def test_a_first_visit_opens_picture_map_and_plot(demo, open_page):
    async with open_page(page_address(demo)) as page:
        await until_painted(page, f"{card('/camera/image_raw')} canvas")
        await until_painted(page, f"{card('/map')} canvas")
        await until_painted(page, f"{card('/odom')} .uplot canvas")
        await until(page, "() => /Hz/.test(document.querySelector('footer')?.textContent)")
        assert await page.inner_text("#state") == "connected"
        await until(page, "() => /round trip ?[0-9.]+ ms/.test(figures.textContent)")
        await until(page, "() => /messages ?[1-9][0-9]*\\/s/.test(figures.textContent)")


@pytest.mark.parametrize("touched", [{"viewport": PHONE}, {"has_touch": True, "is_mobile": True}])
async def test_a_first_visit_by_finger_opens_no_stick_but_the_list_does(demo, open_page, touched):
    async with open_page(page_address(demo), script=NOTE_SENT, **touched) as page:
        await page.wait_for_selector(card("/odom"))
        asked = "() => sent.some((each) => JSON.parse(each).op === 'control')"
        assert not await page.evaluate(asked)  # which would open a joystick
        # by a key: here the list lies below cards, which grow as pictures come and push it from the
        # place of a click
        await page.focus("button[aria-label='drive by /cmd_vel']")
        await page.keyboard.press("Enter")
        await page.wait_for_selector(f"{card('Drive /cmd_vel')} .control:has-text('Stopped')")
        assert await page.locator(".stick").count() == 1


async def test_a_first_visit_opens_cards_node_by_node_until_the_user_acts(open_page, served):
    parts = {"/odom": "nav_msgs/Odometry", "/scan": "sensor_msgs/LaserScan"}
    late = {"/image": "sensor_msgs/CompressedImage"}
    async with (
        client(served.url) as robot,
        open_page(page_address(served)) as page,
    ):
        for topic, its in parts.items():
            await robot.send(op="advertise", topic=topic, type=its)
            await page.wait_for_selector(card(topic))
        await page.click("button[aria-label='close /odom']")
        for topic, its in late.items():
            await robot.send(op="advertise", topic=topic, type=its)
            await page.wait_for_selector(f"#topics button:has-text('{topic}')")
        assert await page.locator("article").count() == 1


async def test_a_first_visit_ends_half_a_minute_after_its_first_card(evaluate):
    fill = """async later => {
        const { FirstVisit } = await import("/debug/first_visit.js");
        const opened = [];
        const topics = new Map();
        const publishers = ["/a"];
        const publish = (name, type) => topics.set(name, { name, types: [type], publishers });
        const gateway = { graph: { topics }, hello: { role: "viewer" } };
        const visit = new FirstVisit(gateway, ({ topic }) => opened.push(topic));
        const { now } = performance;
        performance.now = () => 1e6;
        visit.fill();
        performance.now = () => 2e6;
        publish("/scan", "sensor_msgs/msg/LaserScan");
        visit.fill();
        performance.now = () => 2e6 + later;
        publish("/odom", "nav_msgs/msg/Odometry");
        visit.fill();
        performance.now = now;
        return opened;
    }"""
    assert await evaluate(fill, 29_000) == ["/scan", "/odom"]
    assert await evaluate(fill, 31_000) == ["/scan"]


async def test_that_all_cards_are_closed_is_kept(demo, open_page):
    async with open_page(page_address(demo) + "#card=tree+0+/odom") as page:
        await page.click("button[aria-label='close /odom']")
        await page.reload()
        await until(page, "() => cards.textContent.includes('Choose a topic in the list')")
        await page.wait_for_selector("#topics button:has-text('/odom')")
        assert await page.locator("article").count() == 0


async def test_any_number_is_plotted_by_two_clicks_and_the_address_keeps_it(demo, open_page):
    async with open_page(page_address(demo) + "#card=tree+0+/battery_state") as page:
        battery = f"{card('/battery_state')}"
        await page.click("#topics button:has-text('/camera/camera_info')")
        camera = card("/camera/camera_info")
        row = page.locator(f"{camera} .row:has(> dt > bdi:text-is('width'))").last
        await row.locator("button").click()
        plot = f"{camera}:has(.uplot)"
        await until_painted(page, f"{plot} canvas")
        assert "roi.width" in await page.inner_text(f"{plot} .u-legend")
        await page.reload()
        await until_painted(page, f"{plot} canvas")
        assert await page.locator("article").count() == 3
        assert await page.locator(battery).count() == 1


async def test_the_views_of_a_topic(demo, open_page):
    async with open_page(page_address(demo) + "#card=tree+0+/odom") as page:
        odom = card("/odom")
        await until(page, "() => document.querySelector('.tree')?.textContent.includes('odom')")
        await page.select_option(f"{odom} select[aria-label^=view]", "raw")
        await page.wait_for_selector(f"{odom} .raw")
        await until(page, "() => document.querySelector('.raw')?.textContent?.startsWith('{')")
        frame = json.loads(await page.inner_text(f"{odom} .raw"))
        assert (frame["op"], frame["topic"]) == ("publish", "/odom")
        await page.select_option(f"{odom} select[aria-label^=view]", "plot")
        await page.wait_for_selector(f"{odom} .body:has-text('Which number?')")
        await page.click("#topics button:has-text('/rosout')")
        await page.wait_for_selector(f"{card('/rosout')} .log li")


async def test_pausing_a_rate_cap_and_closing(demo, open_page):
    async with open_page(page_address(demo) + "#card=raw+0+/odom") as page:
        odom = card("/odom")
        text = "() => document.querySelector('.raw')?.textContent"
        await until(page, "() => document.querySelector('.raw')?.textContent?.length > 0")
        await page.click(f"{odom} button:text-is('Pause')")
        shown = await page.evaluate(text)
        assert await page.inner_text(f"{odom} footer") == "paused"
        newest = "topics.querySelector('[data-topic=\"/odom\"] .figures').title"
        await until(page, f"before => {newest} !== before", await page.evaluate(f"() => {newest}"))
        assert await page.evaluate(text) == shown
        resume = page.get_by_role("button", name="Resume /odom", exact=True)
        assert await resume.inner_text() == "Resume"
        await resume.click()
        await until(page, "() => /Hz/.test(document.querySelector('footer')?.textContent)")
        await until(page, "before => document.querySelector('.raw')?.textContent !== before", shown)
        await page.select_option(f"{odom} select[aria-label^=rate]", "1")
        await until(
            page, "() => /^[012](\\.[0-9])? Hz/.test(document.querySelector('footer')?.textContent)"
        )
        await page.click(f"{odom} button[aria-label='close /odom']")
        assert await page.locator("article").count() == 0


async def test_controls_that_look_the_same_have_different_names(demo, open_page):
    cards = "#card=tree+0+/odom&card=publish+0+/cmd_vel"
    async with open_page(page_address(demo) + cards) as page:
        for role, name in (
            ("button", "plot twist.twist.linear.x"),
            ("button", "Pause /odom"),
            ("button", "Copy /odom"),
            ("combobox", "view of /odom"),
            ("combobox", "rate of /odom"),
            ("combobox", "rate of /cmd_vel"),
            ("textbox", "linear x"),
            ("textbox", "angular x"),
        ):
            await page.get_by_role(role, name=name, exact=True).wait_for()


async def test_a_topic_that_nobody_has_is_told_of(demo, open_page):
    async with open_page(page_address(demo) + "#card=tree+0+/odm&card=nothing+0+/odom") as page:
        problem = await page.wait_for_selector(f"{card('/odm')} .problem:not([hidden])")
        assert "did you mean /odom?" in await problem.inner_text()
        assert await page.locator("article").count() == 1


async def test_a_view_that_does_not_fit_says_so_in_words(demo, open_page):
    async with open_page(page_address(demo) + "#card=image+0+/odom") as page:
        problem = page.locator(f"{card('/odom')} > .problem")
        words = "The view Image shows Image, CompressedImage, not Odometry: choose another view."
        await until(page, "() => document.querySelector('article > .problem')?.textContent")
        assert await problem.inner_text() == words
        await page.select_option(f"{card('/odom')} select[aria-label^=view]", "tree")
        await until(page, "() => document.querySelector('.tree')?.textContent.includes('odom')")
        assert not await problem.is_visible()


@pytest.mark.parametrize("part", ["foo+0+/odom", "%"])
async def test_the_page_says_which_names_in_its_address_are_unknown(demo, open_page, part):
    async with open_page(page_address(demo) + f"#card={part}") as page:
        await until(page, "() => notice.textContent.includes('The address names unknown cards')")
        assert part.replace("+", " ") in await page.inner_text("#notice")
        await until(page, "() => cards.textContent.includes('Choose a topic in the list')")


@pytest.mark.parametrize("viewport", [DESK, PHONE], ids=["desk", "phone"])
async def test_the_focus_goes_to_a_new_card_and_from_a_closed_one_to_the_next(
    demo, open_page, viewport
):
    cards = "#card=tree+0+/odom&card=tree+0+/scan"
    focus = "() => document.activeElement.getAttribute('aria-label') ?? document.activeElement.id"
    async with open_page(page_address(demo) + cards, viewport) as page:
        for topic in ("/odom", "/scan"):  # a later card above one moves it
            await page.wait_for_selector(f"{card(topic)} .row")
        await page.focus("#topics button:has-text('/imu')")
        await page.keyboard.press("Enter")
        assert await page.evaluate(focus) == "/imu"
        await until(
            page,
            """() => {
                const { top } = document.activeElement.getBoundingClientRect();
                const bar = document.querySelector(".bar").getBoundingClientRect().bottom;
                return top >= bar && top < innerHeight - 100;
            }""",
        )
        for closed, after in (("/odom", "/scan"), ("/scan", "/imu"), ("/imu", "search")):
            await page.focus(f"button[aria-label='close {closed}']")
            await page.keyboard.press("Enter")
            assert await page.evaluate(focus) == after


async def test_on_a_phone_a_new_card_stays_in_view_when_it_grows(demo, open_page):
    topic, rows = "/grows", 40
    async with client(demo.url) as publisher:
        await publisher.send(op="advertise", topic=topic, type="std_msgs/msg/Float64MultiArray")
        cards = "#card=tree+0+/odom&card=tree+0+/scan"
        async with open_page(page_address(demo) + cards, PHONE) as page:
            for above in ("/odom", "/scan"):
                await page.wait_for_selector(f"{card(above)} .row")
            await page.focus(f"#topics button:has-text('{topic}')")
            await page.keyboard.press("Enter")
            place = "topic => document.querySelector(topic).getBoundingClientRect().top"
            await until(page, f"topic => ({place})(topic) < innerHeight / 2", card(topic))
            message = {"data": [0.5] * rows}
            await publisher.send(op="publish", topic=topic, msg=message)
            await page.wait_for_selector(f"{card(topic)} .row")
            frame = "requestAnimationFrame"  # by the second one it has been laid out
            await page.evaluate(f"() => new Promise(done => {frame}(() => {frame}(done)))")
            # a line of the cards above may wrap while their figures change
            is_in_view = f"topic => 0 <= ({place})(topic) && ({place})(topic) < innerHeight / 2"
            assert await page.evaluate(is_in_view, card(topic))


async def test_the_list_stays_in_view_while_the_cards_scroll(demo, open_page):
    cards = "#" + "&".join(f"card=tree+0+/{name}" for name in ("odom", "imu", "scan") * 5)
    async with open_page(page_address(demo) + cards) as page:
        await until(page, "() => document.querySelectorAll('article').length === 15")
        await page.evaluate("() => scrollTo(0, document.body.scrollHeight)")
        await until(page, "() => scrollY > 300")
        for place in ("#search", "#topics > li:first-child"):
            box = await page.locator(place).bounding_box()
            assert 0 <= box["y"] < DESK["height"]


async def test_a_plot_says_the_newest_value_next_to_the_name_of_each_curve(open_page, served):
    async with (
        client(served.url) as speaker,
        open_page(f"{page_address(served)}#card=plot+0+/vector+x+y") as page,
    ):
        await speaker.send(
            op="advertise", topic="/vector", type="geometry_msgs/Vector3", latch=True
        )
        for x, y in ((1, 0.25), (2, -0.5)):
            await speaker.send(op="publish", topic="/vector", msg={"x": x, "y": y})
            labels = "[...document.querySelectorAll('.u-label')].map((each) => each.textContent)"
            wanted = [f"x {x}", f"y {y:.3f}"]
            await until(page, f"wanted => wanted.every((each) => {labels}.includes(each))", wanted)


async def test_a_plot_says_what_was_when_one_points_at_and_can_be_looked_at_closer(demo, open_page):
    async with open_page(f"{page_address(demo)}#card=plot+0+/odom+pose.pose.position.x") as page:
        over = page.locator(".plot .u-over")
        label = ".u-series:last-child .u-label"
        says = "([place, words]) => new RegExp(words).test(document.querySelector(place).innerText)"

        async def point(share: float) -> None:
            box = await over.bounding_box()
            place = (box["x"] + share * box["width"], box["y"] + box["height"] / 2)
            await page.mouse.move(*place, steps=3)

        async def age_s(share: float) -> float:
            """Return how old what is under the pointer is, as the legend says."""
            await point(share)
            found = re.search(r"x \S+ m, ([\d.]+) s ago$", await page.inner_text(label))
            assert found
            return float(found[1])

        await over.wait_for()
        await until(page, says, [label, r"x \S+ m$"])
        await point(0.5)  # before the first value: the oldest counts
        await until(page, says, [label, r"x \S+ m, [3-9]\.\d s ago$"])
        await page.get_by_role("button", name="Pause /odom").click()
        await until(page, says, ["article footer", "^paused: drag across the plot"])
        whole_s = await age_s(0.5)
        assert whole_s > 2 * await age_s(0.97)
        await page.mouse.down()
        await point(0.99)
        await page.mouse.up()
        assert await age_s(0.0) < whole_s / 2
        await over.dblclick()
        assert await age_s(0.0) == whole_s  # the present values fill the plot
        await page.get_by_role("button", name="Resume /odom").click()
        await until(page, says, [label, r"x \S+ m$"])  # it is no longer pointed at


async def test_a_plot_is_as_wide_as_its_card(demo, open_page):
    widths = (
        "[document.querySelector('.uplot').offsetWidth,"
        " document.querySelector('.plot').clientWidth]"
    )
    async with open_page(f"{page_address(demo)}#card=plot+0+/odom+pose.pose.position.x") as page:
        await page.wait_for_selector(".uplot")
        for size in (DESK, PHONE, DESK):
            await page.set_viewport_size(size)
            fits = f"room - plot <= 1 && plot <= room && room <= {size['width']}"
            room = f"[plot, room] = {widths}; return {fits}"
            await until(page, f"() => {{ const {room} }}")


async def test_stop_stops_what_another_client_drives(demo, open_page):
    async with open_page(page_address(demo)) as page, client(demo.url) as speaker:
        await until_it_can_be_driven(speaker)
        await speaker.send(op="control", topic="/cmd_vel", watch=True)
        await speaker.send(op="publish", topic="/cmd_vel", msg={"angular": {"z": 0.2}})
        await page.click("#stop")
        await until(page, "() => notice.textContent === 'The gateway stopped /cmd_vel.'")
        await speaker.receive(lambda frame: frame.get("cause") in {"stop", "deadline"})


async def test_without_a_robot_the_page_says_so(open_page, served):
    async with (
        open_page(page_address(served)) as page,
    ):
        await until(page, "() => cards.textContent.includes('No robot yet')")
        assert "ros2-gateway demo" in await page.inner_text("#cards")
        async with client(served.url) as speaker:
            await speaker.send(op="advertise", topic="/scan", type="sensor_msgs/msg/LaserScan")
            await page.wait_for_selector(card("/scan"))


async def test_a_card_of_regular_messages_that_stay_away_turns_pale(open_page, served):
    async with (
        client(served.url) as speaker,
        open_page(f"{page_address(served)}#card=tree+0+/often&card=tree+0+/once") as page,
    ):
        for topic in ("/often", "/once"):
            await speaker.send(op="advertise", topic=topic, type="std_msgs/String", latch=True)
        for text, topic in [("first", "/once"), *((f"{n}th", "/often") for n in range(3))]:
            await speaker.send(op="publish", topic=topic, msg={"data": text})
            await until(page, f"() => cards.textContent.includes('{text}')")  # one by one
        await page.wait_for_selector(f"{card('/often')}.stale")
        assert not await page.query_selector(f"{card('/once')}.stale")
        style = "body => [getComputedStyle(body).color, getComputedStyle(body).opacity]"
        bodies = [page.locator(f"{card(topic)} > .body") for topic in ("/often", "/once")]
        pale, usual = [await body.evaluate(style) for body in bodies]
        assert pale[0] != usual[0]
        assert [pale[1], usual[1]] == ["1", "1"]  # or no rule says how well a text is read


async def test_a_lost_publisher_is_said_until_the_next_message(open_page, served):
    async with (
        client(served.url) as speaker,
        open_page(f"{page_address(served)}#card=tree+0+/text") as page,
    ):
        about = {"topic": "/text", "type": "std_msgs/String"}
        for text in ("first", "again"):
            await speaker.send(op="advertise", **about, latch=True)
            await speaker.send(op="publish", topic="/text", msg={"data": text})
            await until(page, f"() => cards.textContent.includes('{text}')")
            await until(page, "() => document.querySelector('article > .problem').hidden")
            if text == "again":
                break
            await speaker.send(op="unadvertise", topic="/text")
            await until(page, "() => cards.textContent.includes('publishes no longer')")


async def test_each_card_of_a_topic_says_that_its_publisher_is_lost(open_page, served):
    async with (
        client(served.url) as speaker,
        open_page(f"{page_address(served)}#card=tree+0+/text&card=raw+0+/text") as page,
    ):
        await speaker.send(op="advertise", topic="/text", type="std_msgs/String", latch=True)
        await speaker.send(op="publish", topic="/text", msg={"data": "first"})
        await until(page, "() => document.querySelector('.tree')?.textContent.includes('first')")
        await until(page, "() => document.querySelector('.raw')?.textContent.includes('first')")
        await speaker.send(op="unadvertise", topic="/text")
        said = "each => each.textContent.includes('publishes no longer')"
        await until(
            page, f"() => [...document.querySelectorAll('article > .problem')].some({said})"
        )
        await page.evaluate("() => new Promise(requestAnimationFrame)")
        assert await page.locator("article > .problem:has-text('publishes no longer')").count() == 2


async def test_a_lost_connection_is_said_and_comes_back(open_page, nowhere):
    async with gateway_process("serve", *nowhere) as gateway:
        address = page_address(gateway)
        port = address.rstrip("/").rpartition(":")[2]
        async with open_page(address + "#card=tree+0+/text") as page:
            await until(page, "() => state.textContent === 'connected'")
            await gateway.stop()
            await until(page, "() => state.textContent.startsWith('not connected')")
            async with (
                gateway_process("serve", *nowhere, "--port", port) as other,
                client(other.url) as speaker,
            ):
                await until(page, "() => state.textContent === 'connected'")
                await speaker.send(
                    op="advertise", topic="/text", type="std_msgs/String", latch=True
                )
                await speaker.send(op="publish", topic="/text", msg={"data": "again"})
                await until(page, "() => cards.textContent.includes('again')")
            # that nobody listens in the meantime is the browser's to say
            page.wrong[:] = [each for each in page.wrong if "ERR_CONNECTION_REFUSED" not in each]


async def test_a_token_is_asked_for_and_kept_for_the_tab(open_page, tmp_path):
    file = tmp_path / "tokens.json"
    token = await new_token(file)
    settings = ("--set", "access.authentication=token", "--set", f"access.token_file={file}")
    async with gateway_process("serve", *settings) as gateway:
        async with open_page(page_address(gateway)) as page:
            await page.fill("#token-text", "r2g_wrong")
            await page.click("#token button")
            await until(page, "() => document.getElementById('token-problem').textContent")
            await page.fill("#token-text", token)
            await page.click("#token button")
            await until(page, "() => state.textContent === 'connected'")
            await page.reload()
            await until(page, "() => state.textContent === 'connected'")
            assert "r2g_" not in page.url
        async with open_page(f"{page_address(gateway)}#token={token}") as page:
            await until(page, "() => state.textContent === 'connected'")
            assert "r2g_" not in page.url


async def test_invalid_json_and_unknown_operations_are_said_and_harm_nothing(demo, open_page):
    async with open_page("about:blank") as page:
        routes = []

        def garble(route) -> None:
            routes.append(route)
            server = route.connect_to_server()
            route.send("this is no JSON {")
            server.on_message(lambda message: route.send(message))

        await page.route_web_socket("**/*", garble)
        await page.goto(page_address(demo))
        await until(page, "() => notice.textContent.startsWith('the gateway sent invalid JSON')")
        for frame in (
            "null",
            "12",
            "[]",
            '{"topic":"/odom"}',
            '{"op":"publish","msg":null}',
            '{"n":12345678901234567890}',
        ):
            routes[0].send(frame)
            told = f"the gateway sent an unknown operation: {frame}"
            await until(page, "told => notice.textContent === told", told)
        await until_painted(page, f"{card('/map')} canvas")


async def test_on_a_phone_the_bar_leaves_the_screen_to_the_cards(demo, open_page):
    async with open_page(page_address(demo), PHONE) as page:
        await until(page, "() => state.textContent === 'connected'")
        heights = await page.evaluate("""() => {
            const parts = [...document.querySelectorAll(".bar > :not(h1)")];
            return [parts.find((each) => each.id === "stop"), document.querySelector(".bar")].map(
                (each) => each.offsetHeight);
        }""")
        assert heights[1] < 3 * heights[0]  # two rows, and what lies around them


@pytest.mark.long
@pytest.mark.parametrize("viewport", [DESK, {"width": 800, "height": 600}, PHONE])
@pytest.mark.parametrize("name", ["", "drive"])
async def test_stop_stays_where_it_is_whatever_the_bar_says(demo, open_page, viewport, name):
    lost = "not connected; trying again"
    place = "() => JSON.stringify(document.getElementById('stop').getBoundingClientRect())"
    say = "words => { state.textContent = words; }"
    async with open_page(page_address(demo) + name, viewport) as page:
        await until(page, "() => state.textContent === 'connected'")
        places = []
        for words in ("connected", lost, f"not connected: {'on and on ' * 12}; trying again"):
            await page.evaluate(say, words)
            places.append(await page.evaluate(place))
        assert places == places[:1] * 3
        box = json.loads(places[0])
        assert box["right"] <= viewport["width"]
        bar = await page.locator(".bar").bounding_box()
        assert 0 <= box["top"] < box["bottom"] <= bar["height"]


@pytest.mark.long
async def test_a_finger_hits_every_control(demo, open_page):
    cards = "#card=tree+0+/odom&card=publish+0+/goal_pose&card=plot+0+/imu&card=graph+0+/"
    small = """() => [...document.querySelectorAll("button, summary, select, a, [type=checkbox]")]
        .filter((each) => each.checkVisibility())
        .map((each) => [each, each.getBoundingClientRect()])
        .filter(([{ type }, { width, height }]) =>
            Math.min(width, height) < (type === "checkbox" ? 24 : 32))
        .map(([each]) => each.outerHTML)"""
    async with open_page(page_address(demo) + cards, PHONE, has_touch=True) as page:
        await page.wait_for_selector(f"{card('/odom')} .row button")
        await page.wait_for_selector(f"{card('Publish /goal_pose')} button:enabled:text-is('JSON')")
        await page.wait_for_selector("svg [aria-label='topic /odom']")
        assert await page.evaluate(small) == []


@pytest.mark.long
@pytest.mark.parametrize("viewport", [DESK, PHONE], ids=["desk", "phone"])
async def test_the_close_button_of_a_card_stands_in_its_corner(demo, open_page, viewport):
    cards = "#card=tree+0+/odom&card=tree+0+/camera/image_raw/compressed&card=call+0+/motor_power"
    far = """() => [...document.querySelectorAll("article")].filter((each) => {
        const [outer, inner] = [each, each.querySelector("[aria-label^=close]")].map(
            (part) => part.getBoundingClientRect());
        return inner.top - outer.top > 12 || outer.right - inner.right > 16;
    }).length"""
    async with open_page(page_address(demo) + cards, viewport) as page:
        await until(page, "() => document.querySelectorAll('article').length === 3")
        assert await page.evaluate(far) == 0


@pytest.mark.long
@pytest.mark.parametrize("viewport", [DESK, PHONE], ids=["desk", "phone"])
@pytest.mark.parametrize(
    ("name", "scheme", "ready"),
    [
        ("", "dark", f"{card('/map')} canvas"),
        ("", "light", f"{card('/map')} canvas"),
        ("drive", "light", "#camera canvas"),
        ("lab", "light", "#view canvas"),
    ],
)
async def test_nothing_is_wider_than_the_screen_and_every_control_has_a_name(
    demo, open_page, viewport, name, scheme, ready
):
    address = f"{page_address(demo)}{name}"
    async with open_page(address, viewport, color_scheme=scheme) as page:
        await page.wait_for_selector(ready)
        await until(page, "() => state.textContent === 'connected'")
        assert await page.evaluate("() => document.scrollingElement.scrollWidth <= innerWidth")
        for role in ("button", "slider", "combobox", "searchbox", "checkbox"):
            assert await page.get_by_role(role, name=re.compile(r"^\s*$")).count() == 0
        assert await page.evaluate(
            "() => document.getElementById('stop').getBoundingClientRect().right <= innerWidth"
        )
