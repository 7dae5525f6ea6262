# SPDX-License-Identifier: Apache-2.0
"""Cards of the debug page: what they say, what goes on next to a broken one, and what drives."""

import base64
import json

import pytest

from tests.client import client
from tests.pages.conftest import page_address
from tests.pages.test_debug_page import NOTE_SENT, PHONE, card, until, until_painted
from tests.pages.test_drive_page import Watched, drive_by, watched

__all__ = ["watched"]  # a fixture

pytestmark = pytest.mark.asyncio(loop_scope="package")

# as on a page that came by http from another machine
NO_CLIPBOARD = "Object.defineProperty(navigator, 'clipboard', { value: undefined });"
# all drawing of laser scans fails
NO_POINTS = "CanvasRenderingContext2D.prototype.fillRect = () => { throw new Error('no paint'); };"


async def test_a_view_that_does_not_fit_what_comes_later_says_so_and_others_go_on(
    open_page, served
):
    cards = "#card=scan+0+/later&card=trail+0+/later&card=tree+0+/counter"
    async with (
        client(served.url) as speaker,
        open_page(page_address(served) + cards) as page,
    ):
        await until(page, "() => document.querySelectorAll('article').length === 3")
        for topic in ("/later", "/counter"):
            await speaker.send(op="advertise", topic=topic, type="std_msgs/String", latch=True)
        await speaker.send(op="publish", topic="/later", msg={"data": "no scan"})
        said = "[...document.querySelectorAll('.problem')].map((each) => each.textContent)"
        await until(
            page,
            f"() => {said}.filter((each) => /not String: choose/.test(each)).length > 1",
        )
        for text in ("one", "two"):
            await speaker.send(op="publish", topic="/counter", msg={"data": text})
            tree = f"document.querySelector('{card('/counter')} .tree').textContent"
            await until(page, f"text => {tree}.includes(text)", text)
        chosen = f"{card('/later')}:first-child select[aria-label^=view]"
        await page.select_option(chosen, "tree")
        await until(page, "() => document.querySelector('.tree').textContent.includes('no scan')")


async def test_a_view_that_fails_says_so_and_others_go_on(demo, open_page):
    cards = "#card=map+0+/map&card=tree+0+/odom"
    async with open_page(page_address(demo) + cards, script=NO_POINTS) as page:
        await until(page, "() => /cannot show this.*no paint/.test(cards.textContent)")
        tree = "() => document.querySelector('.tree').textContent"
        await until(page, "() => document.querySelector('.tree')?.textContent.includes('odom')")
        await until(page, f"before => ({tree})() !== before", await page.evaluate(tree))


async def test_a_card_says_who_would_have_to_send_something(open_page, served):
    cards = "#card=tree+0+/silent&card=tree+0+/wanted"
    async with (
        client(served.url) as speaker,
        open_page(page_address(served) + cards) as page,
    ):
        await speaker.send(op="advertise", topic="/silent", type="std_msgs/String")
        await speaker.send(op="subscribe", topic="/wanted", type="std_msgs/String")
        footer = "document.querySelector('{} footer')?.textContent"
        silent, wanted = (footer.format(card(topic)) for topic in ("/silent", "/wanted"))
        await until(
            page,
            f"() => /no message yet: .+ sent nothing since this card was/.test({silent})",
        )
        await until(page, f"() => /no message yet: no node publishes it$/.test({wanted})")
        await speaker.send(op="publish", topic="/silent", msg={"data": "at last"})
        await until(page, f"() => / old/.test({silent})")


async def test_a_message_is_copied_where_the_browser_has_no_clipboard_for_pages(demo, open_page):
    async with open_page(f"{page_address(demo)}#card=tree+0+/odom", script=NO_CLIPBOARD) as page:
        await until(page, "() => document.querySelector('.tree')?.textContent.includes('odom')")
        copy = page.get_by_role("button", name="Copy /odom")
        await copy.click()
        assert await copy.evaluate("button => button === document.activeElement")
        await page.evaluate("() => cards.append(document.createElement('textarea'))")
        pasted = page.locator("#cards > textarea")
        await pasted.focus()
        await page.keyboard.press("Control+V")
        assert json.loads(await pasted.input_value())["child_frame_id"]


async def test_a_copy_that_failed_is_said_until_one_works_and_hides_nothing_else(demo, open_page):
    refused = """
        window.refuse = true;
        const write = async () => { if (refuse) throw new Error("no permission"); };
        Object.defineProperty(navigator, "clipboard", { value: { writeText: write } });
    """
    said = "() => document.querySelector('article .problem').textContent"
    async with open_page(f"{page_address(demo)}#card=tree+0+/odom", script=refused) as page:
        await until(page, "() => document.querySelector('.tree')?.textContent.includes('odom')")
        copy = page.get_by_role("button", name="Copy /odom")
        await copy.click()
        await until(page, f"() => ({said})() === 'not copied: no permission'")
        await page.evaluate("() => { window.refuse = false; }")
        await copy.click()
        await until(page, f"() => ({said})() === ''")
        other = "document.querySelector('article .problem').textContent = 'what the gateway says'"
        await page.evaluate(f"() => {{ {other}; }}")
        await copy.click()
        assert await page.evaluate(said) == "what the gateway says"


async def test_a_number_is_chosen_in_the_plot(demo, open_page):
    async with open_page(f"{page_address(demo)}#card=trail+0+/odom") as page:
        await page.click("button[aria-label='plot a number of /odom']")
        await page.click("button[aria-label='plot pose.pose.position.x']")
        plot = f"{card('/odom')}:has(.uplot)"
        await until_painted(page, f"{plot} canvas")
        assert await page.locator(plot).evaluate("card => card === document.activeElement")
        await page.reload()
        await until_painted(page, f"{plot} canvas")


async def test_a_number_that_is_plotted_already_comes_into_view_and_another_joins_it(
    demo, open_page
):
    cards = "#card=plot+0+/odom+pose.pose.position.x&card=tree+0+/odom"
    async with open_page(page_address(demo) + cards) as page:
        plot = page.locator("article:has(.uplot)")
        await plot.wait_for()
        await plot.evaluate("card => { card.dataset.mark = 'before'; }")
        for path in ("pose.pose.position.x", "pose.pose.position.y"):
            await page.get_by_role("button", name=f"plot {path}", exact=True).click()
            focused = "() => document.activeElement.dataset.mark"
            assert await page.evaluate(focused) == "before"
            assert await page.locator("article").count() == 2
            legend = "document.querySelector('.u-legend').innerText"
            await until(page, f"path => {legend}.includes(path)", path)
        kept = "() => new URLSearchParams(location.hash.slice(1)).get('card')"
        assert (await page.evaluate(kept)).endswith(".position.x pose.pose.position.y")


async def test_all_items_of_a_list_can_be_seen_and_plotted(open_page, served):
    async with (
        client(served.url) as speaker,
        open_page(f"{page_address(served)}#card=tree+0+/long") as page,
    ):
        long = {"topic": "/long", "type": "std_msgs/Float32MultiArray", "latch": True}
        await speaker.send(op="advertise", **long)
        await speaker.send(op="publish", topic="/long", msg={"data": list(range(300))})
        more = page.get_by_role("button", name="more of data")
        await more.wait_for()
        await speaker.send(op="publish", topic="/long", msg={"data": [1.0] * 12})
        await more.wait_for(state="detached")
        await speaker.send(op="publish", topic="/long", msg={"data": list(range(300))})
        for hidden in (288, 188, 88):
            assert await more.inner_text() == f"{hidden} more"
            await more.click()
        assert await page.evaluate("() => document.activeElement.ariaLabel") == "plot data.212"
        assert await more.count() == 0
        await page.get_by_role("button", name="plot data.299").click()
        label = "document.querySelector('.u-series:last-child .u-label')?.textContent"
        await until(page, f"() => {label} === 'data.299 299'")


async def test_frames_are_shown_as_they_came(open_page, served):
    async with (
        client(served.url) as speaker,
        open_page(f"{page_address(served)}#card=raw+0+/large") as page,
    ):
        await speaker.send(op="advertise", topic="/large", type="std_msgs/Int64", latch=True)
        await speaker.send(op="publish", topic="/large", msg={"data": 2**53 + 1})
        shown = "document.querySelector('.raw')?.textContent"
        await until(page, f"() => {shown}?.includes('\"data\":9007199254740993')")


async def test_a_picture_has_its_room_before_it_comes(open_page, served):
    canvas = f"{card('/camera')} canvas"
    size = "canvas => [canvas.getBoundingClientRect().width, canvas.getBoundingClientRect().height]"
    image = {"width": 640, "height": 480, "encoding": "mono8", "step": 640}
    image["data"] = base64.b64encode(bytes(range(256)) * 1200).decode()
    async with (
        client(served.url) as camera,
        open_page(f"{page_address(served)}#card=image+0+/camera", PHONE) as page,
    ):
        await page.wait_for_selector(canvas)
        before = await page.eval_on_selector(canvas, size)
        await camera.send(op="advertise", topic="/camera", type="sensor_msgs/Image", latch=True)
        await camera.send(op="publish", topic="/camera", msg=image)
        await until_painted(page, canvas)
        assert await page.eval_on_selector(canvas, size) == before


async def test_pictures_come_as_cbor_which_the_view_of_frames_says(demo, open_page):
    cards = "#card=image+0+/camera/image_raw&card=raw+0+/camera/image_raw"
    async with open_page(page_address(demo) + cards) as page:
        await until_painted(page, f"{card('/camera/image_raw')} canvas")
        shown = "document.querySelector('.raw')?.textContent"
        await until(page, f"() => /^CBOR of .*kB, its message as JSON:/.test({shown})")


async def test_a_first_visit_can_drive_the_robot(demo, open_page, watched: Watched):
    async with open_page(page_address(demo)) as page:
        stick = page.locator(f"{card('Drive /cmd_vel')} .stick")
        await stick.wait_for()
        await stick.focus()
        await drive_by(page, "ArrowLeft")
        await watched.until(state="moving")
        await page.wait_for_selector(f"{card('Drive /cmd_vel')} .control:text-is('Driving.')")
        await page.keyboard.up("ArrowLeft")
        await watched.until(state="stopped", cause="zero")
        await drive_by(page, "ArrowLeft")
        await watched.until(state="moving")
        await page.focus("#search")  # a key that is held elsewhere moves nothing
        await watched.until(state="stopped", cause="zero")
        await page.keyboard.up("ArrowLeft")


async def test_arrow_keys_drive_only_while_the_stick_has_the_focus(demo, open_page):
    commands = "() => sent.filter((each) => JSON.parse(each).op === 'publish').length"
    async with open_page(f"{page_address(demo)}#card=drive+0+/cmd_vel", script=NOTE_SENT) as page:
        await page.wait_for_selector(".control:has-text('Stopped')")
        await page.keyboard.press("ArrowLeft")
        assert await page.evaluate(commands) == 0
        await page.focus(".stick")
        await page.keyboard.press("ArrowLeft")
        assert await page.evaluate(commands) > 0


@pytest.mark.parametrize("how", ["STOP", "closed"])
async def test_a_card_that_drives_obeys_stop_and_ends_with_a_stop(demo, open_page, watched, how):
    async with open_page(f"{page_address(demo)}#card=drive+0+/cmd_vel") as page:
        control = page.locator(".control:has-text('Stopped')")
        await control.wait_for()
        await page.focus(".stick")
        await drive_by(page, "ArrowRight")
        await watched.until(state="moving")
        if how == "STOP":
            await page.keyboard.press("Space")
            await page.wait_for_selector(".notice:has-text('The gateway stopped /cmd_vel')")
            await watched.until(state="stopped")
            await page.wait_for_timeout(300)  # in which it would go on, several times over
            await control.wait_for()
        else:
            await page.evaluate("() => document.querySelector('[aria-label^=close]').click()")
            await watched.until(state="stopped", cause="zero")
        await page.keyboard.up("ArrowRight")


async def test_after_stop_a_card_does_not_say_that_another_client_drives(demo, open_page, watched):
    async with (
        client(demo.url) as other,
        open_page(f"{page_address(demo)}#card=drive+0+/cmd_vel") as page,
    ):
        await page.wait_for_selector(".control:has-text('Stopped')")
        await other.send(op="publish", topic="/cmd_vel", type="geometry_msgs/Twist", msg={})
        await other.send(op="publish", topic="/cmd_vel", msg={"angular": {"z": 0.1}})
        await watched.until(state="moving")
        await page.click("#stop")
        await page.wait_for_selector(".control:text-is('Stopped. Another client has control.')")


async def test_a_card_drives_only_command_topics(demo, open_page):
    async with open_page(f"{page_address(demo)}#card=drive+0+/odom") as page:
        await page.wait_for_selector(".control:has-text('/odom is not a command topic')")
