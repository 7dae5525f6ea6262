# SPDX-License-Identifier: Apache-2.0
"""What pages read and write as JSON: integers of 64 bits keep their digits."""

import pytest

from tests.pages.conftest import page_address

pytestmark = pytest.mark.asyncio(loop_scope="module")

MOST, LEAST = 2**63 - 1, -(2**63)
READ_AND_WRITTEN = """async text => {
    const { json, parse } = await import("/shared/json.js");
    return json(parse(text));
}"""
KINDS = """async text => {
    const { parse } = await import("/shared/json.js");
    return JSON.stringify(parse(text), (_, value) => typeof value === "object" ? value : typeof value);
}"""


@pytest.mark.parametrize(
    "text",
    [
        f'{{"data":{MOST}}}',
        f"[{LEAST},{2**64 - 1},{2**53},{2**53 - 1},-1,0]",
        str(MOST),
        f'{{"name":"a:{MOST},\\"b","data":[{MOST},0.30000000000000004,1e+30,true,null]}}',
        '{"data":[0.30000000000000004,-1.5,3]}',
    ],
)
async def test_what_is_read_is_written_with_all_its_digits(demo, open_page, text):
    async with open_page(page_address(demo)) as page:
        assert await page.evaluate(READ_AND_WRITTEN, text) == text


async def test_what_a_number_holds_stays_a_number(demo, open_page):
    async with open_page(page_address(demo)) as page:
        text = f'[ {MOST},{2**53 - 1},1e17,1,"{MOST}"]'
        kinds = '["bigint","number","number","number","string"]'
        assert await page.evaluate(KINDS, text) == kinds
