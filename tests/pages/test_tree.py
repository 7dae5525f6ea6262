# SPDX-License-Identifier: Apache-2.0
"""The view of fields: what has the focus keeps it, whatever comes."""

import pytest
import pytest_asyncio

from tests.pages.conftest import page_address

pytestmark = pytest.mark.asyncio(loop_scope="package")

TREE = """async () => {
    const { TreeView } = await import("/views/tree.js");
    window.plotted = [];
    window.asked = [];
    const subscribe = () => asked.push(view.options.fields);
    const sortedFields = async () => ({ small: ["header", "width"], large: ["data", "more.data"] });
    window.view = new TreeView({ plot: (path) => plotted.push(path), subscribe, sortedFields });
    document.getElementById("cards").append(view.element);
    window.items = (count) => ({ data: Array.from({ length: count }, (_, n) => n), name: "it" });
}"""
TEXT = "() => view.element.innerText.replaceAll(/\\s+/g, ' ').trim()"
FOCUSED = "() => document.activeElement.ariaLabel"


@pytest_asyncio.fixture(loop_scope="package")
async def tree(open_page, served):
    async with open_page(f"{page_address(served)}#card=none") as page:
        await page.wait_for_selector("#cards > .empty")
        await page.evaluate(TREE)
        yield page


@pytest.mark.parametrize("label", ["plot data.3", "more of data"])
async def test_a_button_stays_while_a_list_changes_its_length(tree, label):
    await tree.evaluate("() => view.show(items(300))")
    await tree.evaluate(
        "label => view.element.querySelector(`[aria-label$='${label}']`).focus()", label
    )
    for count in (299, 20, 300):
        await tree.evaluate("count => view.show(items(count))", count)
        assert (await tree.evaluate(FOCUSED)).endswith(label)
        assert f"11: 11 plot {count - 12} more name:" in await tree.evaluate(TEXT)
    await tree.evaluate("() => view.show(items(5))")
    assert (await tree.evaluate(TEXT)).endswith('4: 4 plot name: "it"')
    assert await tree.evaluate(FOCUSED) == ("plot data.3" if "plot" in label else None)
    await tree.evaluate("() => view.show(items(6))")
    assert (await tree.evaluate(TEXT)).endswith('5: 5 plot name: "it"')


@pytest.mark.parametrize("strange", ["NaN", "Infinity", "-Infinity"])
async def test_a_number_that_is_missing_for_a_while_can_be_plotted_all_along(tree, strange):
    for value in (strange, 1.5, strange):
        await tree.evaluate("data => view.show({ data })", value)
        assert await tree.evaluate(TEXT) == f"data: {value} plot"
        await tree.evaluate("() => view.element.querySelector('button').focus()")
        assert await tree.evaluate(FOCUSED) == "plot data"
    await tree.evaluate("() => document.activeElement.click()")
    assert await tree.evaluate("() => plotted") == ["data"]


async def test_a_text_that_says_nan_is_not_a_number(tree):
    for text in ("hello", "NaN"):
        await tree.evaluate("text => view.show({ data: text })", text)
        assert await tree.evaluate(TEXT) == f'data: "{text}"'


async def test_a_message_without_fields_says_so(tree):
    await tree.evaluate("() => view.show({})")
    assert await tree.evaluate(TEXT) == "no fields"
    await tree.evaluate("() => view.show({ stamp: {}, list: [] })")
    assert await tree.evaluate(TEXT) == "stamp: no fields list: []"


async def test_a_value_may_become_a_group(tree):
    for value, text in (("[]", "[]"), ("[1]", "0: 1 plot"), ("[]", "[]"), ("[2]", "0: 2 plot")):
        await tree.evaluate(f"() => view.show({{ list: {value} }})")
        assert await tree.evaluate(TEXT) == f"list: {text}"


async def test_an_orientation_and_a_stamp_are_also_said_in_words(tree):
    stamp = {"sec": 1_700_000_000, "nanosec": 5}
    turned = {"x": 0, "y": 0, "z": 1, "w": 1}
    await tree.evaluate("message => view.show(message)", {"stamp": stamp, "q": turned})
    text = await tree.evaluate(TEXT)
    day = await tree.evaluate("() => new Date(1.7e12).toLocaleString()")
    assert text.startswith(f"stamp: {day.replace(chr(0x202F), ' ')} sec: 1700000000 plot")
    assert "q: roll 0.0°, pitch 0.0°, yaw 90.0° x: 0 plot" in text
    zero = dict.fromkeys("xyzw", 0)
    for unsaid in (zero, {"sec": 5, "nanosec": 0}, zero | {"w": "NaN"}, [1, 2]):
        await tree.evaluate("q => view.show({ q })", unsaid)
        assert "yaw" not in await tree.evaluate(TEXT)
        assert await tree.locator(".row > .quiet").count() == 0


async def test_arrays_of_a_large_message_are_fetched_on_demand(tree):
    await tree.evaluate("() => view.show(items(5), ' '.repeat(100_000))")
    await tree.evaluate("() => view.show(items(5), new ArrayBuffer(100_001))")
    small = ["header", "width"]
    assert await tree.evaluate("() => asked") == [small]
    await tree.evaluate("() => view.show({ width: 3 }, '')")
    fetch = "Left out, because the message is large: Fetch data Fetch more.data"
    text = (await tree.evaluate(TEXT)).replace("dataFetch", "data Fetch")
    assert text == f"width: 3 plot {fetch}"
    for path in ("data", "more.data"):
        await tree.click(f"button[aria-label='fetch {path}']")
    assert await tree.evaluate("() => asked") == [
        small, [*small, "data"], [*small, "data", "more.data"]
    ]  # fmt: skip
    assert "Left out" not in await tree.evaluate(TEXT)
    await tree.evaluate("() => view.show(items(5), ' '.repeat(200_000))")
    assert await tree.evaluate("() => asked.length") == 3, "it was asked for"


async def test_a_value_turns_no_text_around_it(tree):
    await tree.evaluate("message => view.show(message)", {"n\u202ee": "it is\u202e so"})
    apart = "() => [...document.querySelectorAll('.tree bdi')].map((each) => each.textContent)"
    assert await tree.evaluate(apart) == ["n\u202ee", '"it is\u202e so"']


async def test_a_view_that_was_closed_while_it_asked_subscribes_to_nothing(tree):
    await tree.evaluate("() => { view.show(items(5), ' '.repeat(100_001)); view.close(); }")
    await tree.evaluate("() => new Promise((done) => setTimeout(done))")
    assert await tree.evaluate("() => asked") == []
