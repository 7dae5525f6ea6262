# SPDX-License-Identifier: Apache-2.0
"""The parameters of nodes: their controls, and files of them."""

import pytest
import pytest_asyncio

from tests.pages.conftest import page_address, saved
from tests.pages.test_axe import AXE, FOUND
from tests.pages.test_debug_page import PHONE, until

pytestmark = pytest.mark.asyncio(loop_scope="package")

NODE = """async () => {
    const { NodeCard } = await import("/debug/cards/node_card.js");
    window.sent = [];
    const values = {
        "base.speed": 0.5, "base.mode": "fast", "base.is_on": true, "base.wheels": [1, 2.5],
        serial: 9007199254740993n, fixed: "a: b", nothing: null,
    };
    const parameters = {
        "base.speed": { type: "double", range: { from: 0, to: 2, step: 0.25 } },
        "base.mode": { type: "string", additional_constraints: "one of: fast, slow" },
        "base.is_on": { type: "bool" }, "base.wheels": { type: "double_array" },
        serial: { type: "integer" }, fixed: { type: "string", read_only: true },
        nothing: { type: "not_set" },
    };
    const ask = async ({ op }, { values: text } = {}) => {
        if (op === "get_parameters") return { values };
        if (op === "describe_parameters") return { parameters };
        sent.push(text);
        const result = (name) => ({ successful: name !== "fixed", reason: "it is read-only" });
        const names = Object.keys(JSON.parse(text));
        return { results: Object.fromEntries(names.map((name) => [name, result(name)])) };
    };
    const [topics, services, actions] = [new Map(), new Map(), new Map()];
    const gateway = { graph: { topics, services, actions }, on: () => () => {}, ask };
    window.alone = new NodeCard(gateway, { topic: "/ns/n" }, { grown() {} });
    document.getElementById("cards").append(alone.element);
}"""
YAML = """/ns/n:
  ros__parameters:
    base:
      is_on: true
      mode: fast
      speed: 0.5
      wheels: [1.0, 2.5]
    fixed: "a: b"
    serial: 9007199254740993
"""
SENT = "() => sent"
SEEN = """[...document.querySelectorAll('.parameter')].filter((each) => each.checkVisibility())"""


@pytest_asyncio.fixture(loop_scope="package")
async def node(open_page, served):
    async with open_page(page_address(served) + "#card=none") as page:
        await page.wait_for_selector("#cards > .empty")
        await page.evaluate(NODE)
        await page.wait_for_selector("article summary:has-text('base (4)')")
        yield page


async def test_each_kind_has_its_control_and_the_keyboard_sets_it(node):
    await node.get_by_label("base.speed as a slider").press("ArrowRight")
    await until(node, "() => sent.length === 1")
    await node.get_by_label("base.mode", exact=True).select_option("slow")
    await until(node, "() => sent.length === 2")
    await node.get_by_label("base.is_on", exact=True).press(" ")
    await until(node, "() => sent.length === 3")
    assert await node.evaluate(SENT) == [
        '{"base.speed":0.75}', '{"base.mode":"slow"}', '{"base.is_on":false}'
    ]  # fmt: skip
    assert await node.get_by_label("base.speed", exact=True).input_value() == "0.75"
    await node.get_by_role("button", name="undo base.speed").press("Enter")
    await until(node, "() => sent.at(-1) === '{\"base.speed\":0.5}'")
    await until(node, "() => document.querySelector('[aria-label$=slider]').value === '0.5'")


async def test_only_those_are_shown_that_fit_the_filter_or_were_changed(node):
    rows = f"() => {SEEN}.length"
    assert await node.evaluate(rows) == 7
    await node.get_by_label("filter of /ns/n").fill("SPEED")
    assert await node.evaluate(rows) == 1
    await node.get_by_label("filter of /ns/n").fill("")
    await node.get_by_label("base.is_on", exact=True).press(" ")
    changed = node.get_by_role("button", name="changed of /ns/n")
    await until(node, "() => document.body.innerText.includes('Changed (1)')")
    await changed.press("Enter")
    assert await node.evaluate(rows) == 1


async def test_parameters_are_saved_and_loaded_as_yaml(node):
    button = node.get_by_role("button", name="save the parameters of /ns/n as YAML")
    assert await saved(node, button.press("Enter")) == ("ns-n.yaml", YAML)
    changed = YAML.replace("0.5", "1.0").replace("a: b", "c").replace("serial", "unknown")
    file = {"name": "n.yaml", "mimeType": "application/yaml", "buffer": changed.encode()}
    await node.locator("input[type=file]").set_input_files(file)
    await until(node, "() => sent.length === 1")
    assert await node.evaluate(SENT) == ['{"base.speed":1.0,"fixed":"c"}']
    footer = "() => alone.footer.textContent"
    words = "1 set, 4 as they were, 1 refused, 1 unknown to the node"
    await until(node, f"words => ({footer})() === words", words.replace("4 as", "3 as"))
    assert "it is read-only" in await node.inner_text("article")
    other = file | {"buffer": b"/other:\n  ros__parameters:\n    a: 1\n"}
    await node.locator("input[type=file]").set_input_files(other)
    await until(node, "() => alone.problem.textContent.includes('no parameters of /ns/n')")


async def test_a_phone_shows_all_of_it(node):
    await node.set_viewport_size(PHONE)
    is_wide = "(each) => each.getBoundingClientRect().right > innerWidth + 1"
    assert await node.evaluate(f"() => {SEEN}.filter({is_wide}).length") == 0
    if AXE.exists():
        await node.evaluate(AXE.read_text(encoding="utf-8"))
        assert await node.evaluate(FOUND.replace("(document,", "('article',")) == []


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("/ns/n:\n  ros__parameters:\n    a: 1 # one\n    'b c': yes\n", {"a": "1", "b c": "true"}),
        ("ns:\n  n:\n    ros__parameters: \n      a.b: .5\n      c: {}\n", {"a.b": "0.5"}),
        (
            "/**:\n  ros__parameters:\n    a: -.inf\n    b: +007.\n    c: 1e3\n",
            {"a": '"-Infinity"', "b": "7.0", "c": "1e3"},
        ),
        (
            "/*/n:\n  ros__parameters:\n    a:\n    - 1.0\n    - x\n    b: [1,\n      2]\n",
            {"a": '[1.0,"x"]', "b": "[1,2]"},
        ),
        ("/other:\n  ros__parameters: {}\n", {}),
        ("/other:\n  ros__parameters:\n    a: 1\n", {}),
        (
            "/**:\n  ros__parameters:\n    a: 1\nn:\n/ns/n:\n  ros__parameters:\n    a: it's # 1\n",
            {"a": '"it\'s"'},
        ),
        (
            '/ns/n:\n  ros__parameters:\n    a: "x # y"\n    b: http://c:80/#d\n',
            {"a": '"x # y"', "b": '"http://c:80/#d"'},
        ),
        (
            "/ns/n:\n  ros__parameters:\n    a: 'it''s'\n    b: 9007199254740993\n",
            {"a": '"it\'s"', "b": "9007199254740993"},
        ),
        ("/ns/n:\n\tros__parameters:\n", "line 2 begins with a tab"),
        ("/ns/n:\n  ros__parameters:\n    a: {b: 1}\n", "begins with {"),
        ("/ns/n:\n  ros__parameters:\n    a: &x 1\n", "line 3 cannot be read"),
        ("/ns/n:\n  ros__parameters:\n    a: [1, 2\n", "its list has no end"),
        ("/ns/n:\n    ros__parameters:\n  a: 1\n", "fits no line above"),
        ("just text", "no name before a colon"),
        ("", {}),
    ],
)
async def test_files_of_parameters_are_read_as_ros_does(evaluate, text, found):
    read = """async (text) => {
        const { read } = await import("/debug/parameters/yaml.js");
        try {
            return Object.fromEntries(read(text, "/ns/n"));
        } catch (error) {
            return error.message;
        }
    }"""
    got = await evaluate(read, text)
    assert found in got if isinstance(found, str) else got == found


@pytest.mark.parametrize(
    ("text", "choices"),
    [
        ("one of: fast, slow", ["fast", "slow"]),
        ("Must be one of ['A', \"B\"].", ["A", "B"]),
        ("one_of<>: [[1, 2, 3]]", ["1", "2", "3"]),
        ("Allowed values are x | y", ["x", "y"]),
        ('["a", "b"]', ["a", "b"]),
        ("must be positive", []),
        ("one of: " + ", ".join(map(str, range(200))), []),
    ],
)
async def test_choices_are_found_in_the_words_of_a_node(evaluate, text, choices):
    script = """async (text) => {
        const { choicesOf } = await import("/debug/parameters/choices.js");
        return choicesOf(text);
    }"""
    assert await evaluate(script, text) == choices


async def test_the_parameters_of_all_nodes_by_keyboard(demo, open_page):
    async with open_page(page_address(demo) + "#card=parameters+0+/") as page:
        node = page.locator("article summary:text-is('/simulated_robot')")
        await node.press("Enter")
        switch = page.get_by_label("use_sim_time", exact=True)
        await switch.press(" ")
        await until(page, "() => cards.innerText.includes('use_sim_time is set')")
        await page.get_by_role("button", name="undo use_sim_time").press("Enter")
        await until(page, "() => document.querySelector('.parameter.changed') === null")
