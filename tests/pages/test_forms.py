# SPDX-License-Identifier: Apache-2.0
"""The debug page sends messages, calls, goals and parameters, in a real browser."""

import json
import re

import pytest

from tests.client import client
from tests.demonstration import until_it_can_be_driven
from tests.pages.conftest import page_address, severable
from tests.pages.test_debug_page import until

pytestmark = pytest.mark.asyncio(loop_scope="package")

# the results of the pure part for a schema and for typed text
FIELDS = """async ([schema, typed]) => {
    const { fieldOf, jsonOf } = await import("/debug/forms/fields.js");
    try {
        return jsonOf(fieldOf(schema), typed) ?? null;
    } catch (error) {
        return `refused: ${error.message}`;
    }
}"""
UINT8 = {"type": "integer", "minimum": 0, "maximum": 255}
INT64 = {"type": "integer", "minimum": -(2**63), "maximum": 2**63 - 1}
FLOAT32 = {
    "type": ["number", "null", "string"],
    "exclusiveMinimum": -3.5e38,
    "exclusiveMaximum": 3.5e38,
}
TIME = {"anyOf": [{"type": "object"}, {"const": "now"}]}
OCTETS = {"anyOf": [{"contentEncoding": "base64"}, {"type": "array"}]}


def form(title: str) -> str:
    return f'article[aria-label="{title}"]'


def field(page, title: str, *names: str):
    """Return the input of a field, in the groups that hold it."""
    place = page.locator(form(title))
    for name in names[:-1]:
        place = place.locator(f"details:has(> summary:text-is('{name}'))")
    return place.locator(f"label:has(> span:text-is('{names[-1]}'))").locator(
        "input, select, textarea"
    )


@pytest.mark.parametrize(
    ("schema", "typed", "wanted"),
    [
        (UINT8, "", None),
        (UINT8, " 255 ", "255"),
        (UINT8, "256", "refused: expected 0 to 255"),
        (UINT8, "-1", "refused: expected 0 to 255"),
        (UINT8, "1.5", 'refused: expected a whole number, not "1.5"'),
        (UINT8, "constructor", 'refused: expected a whole number, not "constructor"'),
        (INT64, "9007199254740993", "9007199254740993"),
        (FLOAT32, "1e-3", "0.001"),
        (FLOAT32, "+.5E2", "50"),
        (FLOAT32, "0x10", 'refused: expected a number, NaN, Infinity or -Infinity, not "0x10"'),
        (FLOAT32, "NaN", '"NaN"'),
        (FLOAT32, "-Infinity", '"-Infinity"'),
        (FLOAT32, "1e39", "refused: too large for a float32"),
        (FLOAT32, "fast", "refused: expected a number, NaN, Infinity or -Infinity"),
        ({"type": "boolean"}, "true", "true"),
        ({"type": "boolean"}, "yes", 'refused: expected true or false, not "yes"'),
        ({"type": "string"}, ' a "b" ', '" a \\"b\\" "'),
        ({"type": "string", "maxLength": 3}, "äöüß", "refused: at most 3 characters"),
        ({"type": "array", "items": UINT8, "maxItems": 2}, "1, 2", "[1,2]"),
        ({"type": "array", "items": UINT8, "maxItems": 2}, "1 2 3", "refused: expected at most 2"),
        ({"type": "array", "items": UINT8, "maxItems": 2}, "1 x", "refused: expected a whole"),
        (
            {"type": "array", "items": FLOAT32, "minItems": 2, "maxItems": 2},
            "1",
            "refused: expected 2 values, not 1",
        ),
        ({"type": "array", "items": {"type": "string"}}, "a b\nc", '["a b","c"]'),
        (TIME, "now", '"now"'),
        (TIME, "1.5", '{"sec":1,"nanosec":500000000}'),
        (TIME, "-0.25", '{"sec":-1,"nanosec":750000000}'),
        (TIME, "1700000000.123456789", '{"sec":1700000000,"nanosec":123456789}'),
        (TIME, "-2", '{"sec":-2,"nanosec":0}'),
        (TIME, ".", 'refused: expected now, or seconds, not "."'),
        (TIME, "soon", 'refused: expected now, or seconds, not "soon"'),
        (OCTETS, "1, 255", "[1,255]"),
        (OCTETS, "256", "refused: expected 0 to 255"),
        (OCTETS, "AP8=", '"AP8="'),
        (OCTETS, "#", "refused: expected numbers from 0 to 255, or base64"),
    ],
)
async def test_typed_text_becomes_json_or_a_refusal_in_words(evaluate, schema, typed, wanted):
    found = await evaluate(FIELDS, [schema, typed])
    if wanted is not None and wanted.startswith("refused: "):
        assert found.startswith(wanted)
    else:
        assert found == wanted


# a form of a type that has all kinds of fields, and back from JSON
BACK = """async ([schema, text]) => {
    const { Form } = await import("/debug/forms/form.js");
    const { parse } = await import("/shared/json.js");
    const form = new Form(parse(schema));
    form.toggle();
    form.element.querySelector("textarea").value = text;
    try {
        form.toggle();
    } catch (error) {
        return error.message;
    }
    return form.json();
}"""
POINT = {"type": "object", "properties": {"x": FLOAT32}}
ALL_KINDS = {
    "type": "object",
    "properties": {
        "count": INT64,
        "counts": {"type": "array", "items": INT64},
        "x": FLOAT32,
        "text": {"type": "string", "default": "hello"},
        "lines": {"type": "array", "items": {"type": "string"}},
        "stamp": TIME,
        "octets": OCTETS,
        "points": {"type": "array", "items": POINT},
        "pair": {"type": "array", "items": POINT, "minItems": 2, "maxItems": 2},
    },
}
STAYS = "it stays JSON, because "


@pytest.mark.parametrize(
    "message",
    [
        '{"count":9223372036854775807,"counts":[9007199254740993,-9223372036854775808]}',
        '{"x":0.1,"text":"a b"}',
        '{"lines":["a b","c"],"octets":"AP8="}',
        '{"stamp":{"sec":1700000000,"nanosec":123456789}}',
        '{"stamp":{"sec":-1,"nanosec":1}}',
        '{"stamp":{"sec":-3,"nanosec":999999999}}',
        '{"points":[{"x":1},{}]}',
    ],
)
async def test_json_that_fits_is_the_same_by_fields(evaluate, message):
    assert await evaluate(BACK, [json.dumps(ALL_KINDS), message]) == message


@pytest.mark.parametrize(
    ("message", "words"),
    [
        ('{"typo_field": 5}', "typo_field does not fit: this field is unknown"),
        ('{"points": [{"y": 5}]}', "points.0.y does not fit: this field is unknown"),
        (
            f'{{"points": [{",".join(["{}"] * 101)}]}}',
            "points does not fit: the fields take at most 100 items, not 101",
        ),
        ('{"pair": [{}]}', "pair does not fit: the fields have 2 items, not 1"),
        ('{"points": 1}', "points does not fit: expected a list, not 1"),
        ('{"text": {"x": 1}}', 'text does not fit: the fields cannot hold {"x":1}'),
        ('{"text": ""}', 'text does not fit: the fields cannot hold ""'),
        ('{"text": "a\\nb"}', "text does not fit: the fields cannot hold "),
        ('{"count": "5"}', 'count does not fit: the fields cannot hold "5"'),
        ('{"count": 9223372036854775808}', "count does not fit: expected -9"),
        ('{"x": null}', "x does not fit: expected a number"),
        ('{"lines": ["a", "", "b"]}', 'lines does not fit: the fields cannot hold ["a","","b"]'),
        ('{"counts": [[1]]}', "counts does not fit: the fields cannot hold [[1]]"),
        ("[]", "it does not fit: expected an object, not []"),
    ],
)
async def test_values_that_the_fields_would_lose_stay_json_and_are_named(evaluate, message, words):
    said = await evaluate(BACK, [json.dumps(ALL_KINDS), message])
    assert said.startswith(STAYS + words)


async def test_a_number_that_no_float64_holds_is_refused_at_its_form(demo, open_page):
    async with open_page(page_address(demo) + "#card=publish+0+/cmd_vel") as page:
        title = "Publish /cmd_vel"
        await page.click(f"{form(title)} button:text-is('JSON')")
        await page.fill(f"{form(title)} textarea", '{"linear": {"x": 1e400}}')
        await page.click(f"{form(title)} button:text-is('Publish')")
        problem = page.locator(f"{form(title)} > .problem")
        assert await problem.inner_text() == "linear.x: this number is larger than any float64"
        assert "sent" not in await page.inner_text(f"{form(title)} footer")


async def test_a_form_publishes_what_another_client_hears(demo, open_page):
    async with client(demo.url) as hearer, open_page(page_address(demo)) as page:
        await hearer.send(op="subscribe", topic="/goal_pose", type="geometry_msgs/PoseStamped")
        await page.click("button[aria-label='publish to /goal_pose']")
        title = "Publish /goal_pose"
        await field(page, title, "header", "frame_id").fill("map")
        await field(page, title, "pose", "position", "x").fill("1.25")
        await page.click(f"{form(title)} button:text-is('Publish')")
        heard = await hearer.receive(lambda frame: frame.get("topic") == "/goal_pose", 120)
        assert heard["msg"]["header"]["frame_id"] == "map"
        assert heard["msg"]["header"]["stamp"]["sec"] > 0
        assert heard["msg"]["pose"]["position"]["x"] == 1.25
        assert heard["msg"]["pose"]["orientation"]["w"] == 1  # the type's own default
        await until(page, "() => cards.textContent.includes('1 sent')")


async def test_a_wrong_number_is_told_of_and_nothing_is_sent(demo, open_page):
    async with open_page(page_address(demo) + "#card=publish+0+/cmd_vel") as page:
        title = "Publish /cmd_vel"
        speed = field(page, title, "linear", "x")
        await speed.fill("fast")
        await page.click(f"{form(title)} button:text-is('Publish')")
        problem = page.locator(f"{form(title)} > .problem")
        assert "x: expected a number" in await problem.inner_text()
        assert await speed.get_attribute("aria-invalid") == "true"
        assert "sent" not in await page.inner_text(f"{form(title)} footer")
        await speed.fill("0")
        assert not await problem.is_visible()
        await page.click(f"{form(title)} button:text-is('Publish')")
        await until(page, "() => cards.textContent.includes('1 sent')")


async def test_refusals_are_shown_in_the_words_of_the_gateway(demo, open_page):
    async with (
        client(demo.url) as other,
        open_page(page_address(demo) + "#card=publish+0+/cmd_vel") as page,
    ):
        await until_it_can_be_driven(other)
        await other.send(op="acquire_control", topic="/cmd_vel")
        title = "Publish /cmd_vel"
        await field(page, title, "angular", "z").fill("0.1")
        await page.click(f"{form(title)} button:text-is('Repeat')")
        await until(page, "() => /control/.test(document.querySelector('.problem')?.textContent)")
        pressed = "() => document.querySelector('.buttons [aria-pressed]')?.ariaPressed"
        await until(page, f"{pressed} === 'false'")  # it gives up
        footer = await page.inner_text(f"{form(title)} footer")
        assert re.fullmatch(r"0 sent, [1-9][0-9]* refused", footer)
        await other.send(op="release_control", topic="/cmd_vel")


async def test_a_message_is_written_as_json_too(demo, open_page):
    async with (
        client(demo.url) as hearer,
        open_page(page_address(demo) + "#card=publish+0+/goal_pose") as page,
    ):
        await hearer.send(op="subscribe", topic="/goal_pose", type="geometry_msgs/PoseStamped")
        title = "Publish /goal_pose"
        await field(page, title, "pose", "position", "y").fill("2")
        await page.click(f"{form(title)} button:text-is('JSON')")
        text = page.locator(f"{form(title)} textarea")
        assert '"y": 2' in await text.input_value()
        await text.fill('{"pose": ')
        await page.click(f"{form(title)} button:text-is('Publish')")
        await until(page, "() => cards.textContent.includes('this is not JSON')")
        await text.fill('{"pose": {"position": {"y": 3}}}')
        await page.click(f"{form(title)} button:text-is('Publish')")
        heard = await hearer.receive(lambda frame: frame.get("topic") == "/goal_pose", 120)
        assert heard["msg"]["pose"]["position"]["y"] == 3
        await page.click(f"{form(title)} button:text-is('JSON')")
        assert await field(page, title, "pose", "position", "y").input_value() == "3"


# keeps what the page sends in `sent`
RECORD = """() => {
    window.sent = [];
    const { send } = WebSocket.prototype;
    WebSocket.prototype.send = function (text) {
        sent.push(text);
        send.call(this, text);
    };
}"""


async def test_a_service_is_called_and_what_it_refuses_is_shown(demo, open_page):
    async with open_page(page_address(demo)) as page:
        await page.evaluate(RECORD)
        await page.click("#tab-services")
        await page.click("#services button:has-text('/motor_power')")
        title = "Call /motor_power"
        await field(page, title, "data").select_option("true")
        await page.click(f"{form(title)} button:text-is('Call')")
        await until(page, '() => /"success": true/.test(cards.textContent)')
        assert '"type":"std_srvs/srv/SetBool"' in await page.evaluate(
            "sent.find((text) => text.includes('call_service'))"
        )
        await page.click(f"{form(title)} button:text-is('JSON')")
        await page.fill(f"{form(title)} textarea", '{"data": "on"}')
        await page.click(f"{form(title)} button:text-is('Call')")
        await until(page, "() => cards.textContent.includes('expected true or false')")


async def test_only_the_newest_call_has_its_answer_shown(open_page, served):
    calls = []
    async with (
        client(served.url) as server,
        open_page(page_address(served) + "#card=call+0+/slow") as page,
    ):
        await server.send(op="advertise_service", service="/slow", type="std_srvs/srv/Trigger")

        async def answer(call, message: str) -> None:
            values = {"success": True, "message": message}
            await server.send(
                op="service_response", id=call["id"], service="/slow", result=True, values=values
            )

        async def press() -> None:
            await page.click(f"{form('Call /slow')} button:text-is('Call')")
            calls.append(await server.receive(lambda frame: frame["op"] == "call_service"))

        await page.locator("article pre").evaluate(
            """place => new MutationObserver(() => (window.said ??= []).push(place.textContent))
            .observe(place, {childList: true})"""
        )
        await press()
        await answer(calls[0], "first")
        await until(page, "() => cards.textContent.includes('first')")
        await press()
        assert "first" not in await page.inner_text("#cards")
        await until(page, "() => cards.textContent.includes('call 2: waiting')")
        await press()
        await answer(calls[1], "second")
        await answer(calls[2], "third")
        await until(page, "() => /third[^]*call 3: after/.test(cards.textContent)")
        await press()
        await press()
        await answer(calls[4], "fifth")
        await until(page, "() => cards.textContent.includes('fifth')")
        await answer(calls[3], "fourth")
        await press()
        await answer(calls[5], "sixth")
        await until(page, "() => cards.textContent.includes('sixth')")
        said = "".join(await page.evaluate("said"))
        assert "fifth" in said
        assert "second" not in said
        assert "fourth" not in said


async def test_a_form_comes_with_its_topic_and_follows_its_type(open_page, served):
    cards = "#card=publish+0+/later&card=call+0+/later_service"
    async with (
        open_page(page_address(served) + cards) as page,
    ):
        await until(page, "() => cards.textContent.includes('/later does not exist')")
        async with client(served.url) as robot:
            service = {"service": "/later_service", "type": "std_srvs/Trigger"}
            await robot.send(op="advertise_service", **service)
            await robot.send(op="advertise", topic="/later", type="std_msgs/Int64")
            await field(page, "Publish /later", "data").fill("12")
            call = page.locator(f"{form('Call /later_service')} button:text-is('Call')")
            await call.wait_for()
            assert "not there" not in await page.inner_text("#cards")
        async with client(served.url) as robot:
            await until(page, "() => !topics.textContent.includes('/later')")
            await robot.send(op="advertise", topic="/later", type="std_msgs/String")
            await until(page, "() => cards.textContent.includes('another type now: std_msgs')")
            await robot.send(op="subscribe", topic="/later")
            await field(page, "Publish /later", "data").fill("a text")
            await page.click(f"{form('Publish /later')} button:text-is('Publish')")
            await robot.receive(lambda frame: frame.get("msg") == {"data": "a text"}, 120)


async def test_that_there_is_no_connection_is_said_until_there_is_one(demo, open_page):
    async with open_page("about:blank") as page, severable(page) as line:
        await page.goto(page_address(demo) + "#card=publish+0+/cmd_vel")
        button = page.locator(f"{form('Publish /cmd_vel')} button:text-is('Publish')")
        await button.wait_for()
        await line.cut()
        await until(page, "() => state.dataset.state === 'closed'")
        await button.click()
        problem = page.locator(f"{form('Publish /cmd_vel')} > .problem")
        assert await problem.inner_text() == "not connected"
        line.mend()
        await problem.wait_for(state="hidden")


@pytest.mark.parametrize("end", ["Cancel", "STOP"])
async def test_a_goal_tells_its_feedback_and_is_cancelled(demo, open_page, end):
    async with client(demo.url) as other, open_page(page_address(demo)) as page:
        await until_it_can_be_driven(other)
        await page.click("#tab-actions")
        await page.click("#actions button:has-text('/navigate_to_pose')")
        title = "Goal of /navigate_to_pose"
        await field(page, title, "pose", "pose", "position", "x").fill("3")
        await page.evaluate(RECORD)
        await page.click(f"{form(title)} button:text-is('Send goal')")
        await until(page, "() => /distance_remaining/.test(cards.textContent)")
        assert '"action_type":"nav2_msgs/action/NavigateToPose"' in await page.evaluate(
            "sent.find((text) => text.includes('send_action_goal'))"
        )
        await page.click(f"{form(title)} button:text-is('Send goal')")
        await until(page, "() => cards.textContent.includes('a goal is in progress')")
        await page.click(f"{form(title)} button:text-is('Cancel')" if end == "Cancel" else "#stop")
        await until(page, "() => /(canceled|aborted) after/.test(cards.textContent)")
        assert await page.evaluate("sent.some((text) => text.includes('cancel_action_goal'))")


@pytest.mark.parametrize(
    "viewport", [{"width": 1280, "height": 700}, {"width": 390, "height": 844}]
)
async def test_a_form_comes_into_view_with_what_comes_of_it(demo, open_page, viewport):
    async with open_page(page_address(demo), viewport) as page:
        await page.wait_for_selector(form("/odom"))
        await page.click("#tab-actions")
        await page.click("#actions button:has-text('/navigate_to_pose')")
        title = "Goal of /navigate_to_pose"
        button = page.locator(f"{form(title)} button:text-is('Send goal')")
        await button.wait_for()
        place = """each => {
            const { top } = each.getBoundingClientRect();
            return top >= document.querySelector(".bar").getBoundingClientRect().bottom - 1;
        }"""
        await until(page, f"() => ({place})(document.activeElement.closest('article'))")
        box = await button.bounding_box()
        assert box["y"] + box["height"] <= viewport["height"] or viewport["width"] == 390
        await field(page, title, "pose", "pose", "position", "x").fill("0.3")
        await button.click()
        seen = """() => {
            const all = [...document.querySelectorAll("article pre")];
            const text = all.find((each) => each.textContent.includes("{"));
            if (!text) return false;
            const { left, top } = text.getBoundingClientRect();
            return text.contains(document.elementFromPoint(left + 5, top + 5));
        }"""
        await until(page, seen)
        await page.click(f"{form(title)} button:text-is('Cancel')")


async def test_a_parameter_is_set_and_a_refusal_is_shown(demo, open_page):
    async with open_page(page_address(demo)) as page:
        await page.click("#tab-nodes")
        await page.click("#nodes button:has-text('/simulated_robot')")
        title = "Node /simulated_robot"
        switch = page.locator(f"{form(title)} label:has-text('use_sim_time') input[type=checkbox]")
        await switch.check()
        await until(page, "() => cards.textContent.includes('use_sim_time is set')")
        await switch.uncheck()
        await until(page, "() => cards.textContent.includes('use_sim_time is set')")
        assert await page.locator(f"{form(title)} label:has-text('read-only') input").is_disabled()


# a node's card, whose gateway knows one parameter and says what `results` has
NODE = """async ({ value, type }) => {
    const { NodeCard } = await import("/debug/cards/node_card.js");
    window.sent = [];
    const ask = async ({ op }, { values } = {}) => {
        if (op === "get_parameters") return { values: { it: value } };
        if (op === "describe_parameters") return { parameters: { it: { type } } };
        sent.push(values);
        return { results: { it: { successful: false, reason: "not now" } } };
    };
    const [topics, services, actions] = [new Map(), new Map(), new Map()];
    const gateway = { graph: { topics, services, actions }, on: () => () => {}, ask };
    window.alone = new NodeCard(gateway, { topic: "/n" }, { grown() {} });
    document.getElementById("cards").append(alone.element);
}"""


async def test_a_value_that_does_not_fit_is_said_and_a_refused_switch_goes_back(demo, open_page):
    async with open_page(page_address(demo) + "#card=none") as page:
        await page.evaluate(NODE, {"value": 0.5, "type": "double"})
        value = page.locator("article[aria-label='Node /n'] label input")
        for wrong, words in (
            ("maybe", "expected a JSON value"),
            ("1e400", "larger than any float64"),
            ("3", "not now"),
        ):
            await value.fill(wrong)
            await value.press("Tab")
            await until(page, f"() => alone.element.textContent.includes('{words}')")
        assert await page.evaluate("() => sent") == ['{"it":3}']
        await page.evaluate("() => alone.close()")
        await page.evaluate(NODE, {"value": True, "type": "bool"})
        await value.click()
        await until(page, "() => alone.element.textContent.includes('not now')")
        assert await page.evaluate("() => sent") == ['{"it":false}']
        await until(page, "() => alone.element.querySelector('label input').checked")


async def test_the_graph_opens_nodes_and_topics_also_by_keyboard(demo, open_page):
    async with open_page(page_address(demo) + "#card=graph+0+/") as page:
        await page.click("svg [aria-label='topic /odom']")
        await page.wait_for_selector(form("/odom"))
        await page.mouse.move(0, 0)  # the pointer also marks its target
        await page.focus("svg [aria-label='node /simulated_robot']")
        await until(page, "() => document.querySelectorAll('svg path.on').length > 5")
        await page.keyboard.press("Enter")
        await page.wait_for_selector(form("Node /simulated_robot"))
        assert await page.locator("svg [aria-label='topic /rosout']").count() == 0
        await page.check("article label:has-text('all')")
        await page.wait_for_selector("svg [aria-label='topic /rosout']")


async def test_a_service_is_called_by_keyboard_alone(demo, open_page):
    async with open_page(page_address(demo)) as page:
        await page.wait_for_selector("#topics button")
        await page.focus("#tab-topics")
        await page.keyboard.press("ArrowRight")
        assert await page.get_attribute("#tab-services", "aria-selected") == "true"
        await page.focus("#search")
        await page.keyboard.type("motor")
        await page.keyboard.press("Tab")  # the scene
        await page.keyboard.press("Tab")  # the tabs
        await page.keyboard.press("Tab")  # what was found
        await page.keyboard.press("Enter")
        await page.wait_for_selector(f"{form('Call /motor_power')} button:enabled:text-is('Call')")
        await page.focus(f"{form('Call /motor_power')} select")
        await page.keyboard.press("Tab")
        await page.keyboard.press("Enter")
        await until(page, '() => /"success":/.test(cards.textContent)')


async def test_a_topic_that_is_gone_is_said(demo, open_page):
    async with open_page(
        page_address(demo) + "#card=call+0+/motor_powr&card=node+0+/nobody"
    ) as page:
        await until(page, "() => cards.textContent.includes('/motor_powr does not exist')")
        await until(
            page, "() => /nobody/.test(document.querySelectorAll('.problem')[1]?.textContent)"
        )


async def test_the_limits_of_the_connection_are_shown_in_words_with_units(demo, open_page):
    async with client(demo.url) as other, open_page(page_address(demo)) as page:
        await other.send(op="hello")
        hello = await other.receive(lambda frame: frame["op"] == "hello")
        await page.click(".bar .more")
        await page.get_by_role("menuitem", name="Limits of this connection").click()
        await page.wait_for_selector(f"{form('Connection')} dt")
        rows = {}
        for row in await page.locator(f"{form('Connection')} dl:first-child > div").all():
            key = await row.locator("small").inner_text()
            rows[key] = await row.inner_text()
        told = {**hello, **hello["limits"]}
        assert set(rows) == set(told) - {"op", "id", "limits"}
        for key, row in rows.items():
            assert not row.startswith(key)
        wanted = {
            "message_bytes": "10.49 MB",
            "client_time_share": "25 % of the gateway's time",
            "frames_per_s": "20,000 per second",
            "service_timeout_s": "5 s",
            "queue_length": "1,024 messages",
        }
        for key, words in wanted.items():
            assert rows[key].endswith(words)
        await until(page, "() => /Topics.*odom.* Hz/.test(cards.textContent)")


async def test_the_search_filters_the_tab_that_is_shown_and_says_how_many(demo, open_page):
    async with open_page(page_address(demo)) as page:
        await until(page, "() => /^[1-9][0-9]* topics$/.test(count.textContent)")
        all_topics = (await page.inner_text("#count")).split()[0]
        await page.fill("#search", "odom")
        assert await page.inner_text("#count") == f"1 of {all_topics} topics"
        for tab, word, one in (("services", "motor", "/motor_power"), ("nodes", "robot", "/sim")):
            await page.fill("#search", word)
            await page.click(f"#tab-{tab}")
            listed = page.locator(f"#{tab} li")
            await page.wait_for_selector(f"#{tab} button:has-text('{one}')")
            shown = await listed.count()
            words = (await page.inner_text("#count")).split()
            assert words[:2] == [str(shown), "of"]
            assert words[3] == tab
            assert int(words[2]) > shown
        await page.fill("#search", "nothing of that name")
        assert (await page.inner_text("#count")).startswith("0 of ")
        assert "nothing of that name" in await page.inner_text("#nodes")


async def test_arrow_keys_go_from_one_to_the_next_in_the_graph(demo, open_page):
    focus = "() => document.activeElement.getAttribute('aria-label')"
    column = "() => Number(document.activeElement.dataset.column)"
    async with open_page(page_address(demo) + "#card=graph+0+/") as page:
        await page.wait_for_selector("svg [aria-label='topic /odom']")
        assert await page.locator("svg [tabindex='0']").count() == 1  # Tab goes on, not through
        await page.focus("svg [aria-label='node /simulated_robot']")
        await page.keyboard.press("ArrowRight")
        assert await page.evaluate(column) == 1
        names = await page.locator("svg .topic").evaluate_all(
            "boxes => boxes.map((each) => each.getAttribute('aria-label'))"
        )
        await page.keyboard.press("Home")
        assert await page.evaluate(focus) == names[0]
        await page.keyboard.press("ArrowUp")
        assert await page.evaluate(focus) == names[0]
        await page.keyboard.press("ArrowDown")
        assert await page.evaluate(focus) == names[1]
        await page.keyboard.press("End")
        assert await page.evaluate(focus) == names[-1]
        await page.focus("svg [aria-label='topic /cmd_vel']")  # that the robot hears
        await page.keyboard.press("ArrowRight")
        assert await page.evaluate(focus) == "node /simulated_robot"
        assert await page.evaluate(column) == 2
        seen = "() => getComputedStyle(document.activeElement.firstElementChild).strokeWidth"
        assert await page.evaluate(seen) == "3px"
        about = "() => document.activeElement.getAttribute('aria-description')"
        heard = await page.evaluate(about)
        assert "/cmd_vel" in heard
        await page.keyboard.press("ArrowLeft")  # along a line, not to what is nearest
        kind, name = (await page.evaluate(focus)).split()
        assert kind == "topic"
        assert name in heard.replace(",", " ").split()  # or /clock, after other tests
        await page.check("article label:has-text('all')")  # drawn again
        opened = await page.get_attribute("svg [tabindex='0']", "data-name")
        await page.focus("svg [tabindex='0']")
        await page.keyboard.press("Enter")
        await page.wait_for_selector(form(opened))
