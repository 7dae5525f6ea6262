# SPDX-License-Identifier: Apache-2.0
"""Pages read and write JSON so that integers of 64 bits keep their digits."""

import cbor2
import pytest

pytestmark = pytest.mark.asyncio(loop_scope="package")

MOST, LEAST = 2**63 - 1, -(2**63)
READ_AND_WRITTEN = """async text => {
    const { json, parse } = await import("/shared/json.js");
    return json(parse(text));
}"""
KINDS = """async text => {
    const { parse } = await import("/shared/json.js");
    return parse(text).map((each) => typeof each).join(" ");
}"""
FROM_CBOR = """async frame => {
    const { decode } = await import("/shared/cbor.js");
    const { json } = await import("/shared/json.js");
    return json(decode(new Uint8Array(frame).buffer));
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
async def test_json_is_written_with_all_the_digits_that_were_read(evaluate, text):
    assert await evaluate(READ_AND_WRITTEN, text) == text


async def test_an_integer_that_fits_a_number_stays_a_number(evaluate):
    text = f'[ {MOST},{2**53 - 1},1e17,1,"{MOST}"]'
    kinds = "bigint number number number string"
    assert await evaluate(KINDS, text) == kinds


async def test_long_integers_of_cbor_keep_their_digits(evaluate):
    typed = cbor2.CBORTag(79, MOST.to_bytes(8, "little") + (1).to_bytes(8, "little"))
    unsigned = cbor2.CBORTag(71, (2**64 - 1).to_bytes(8, "little"))
    value = [MOST, LEAST, 2**64 - 1, typed, unsigned]
    written = f"[{MOST},{LEAST},{2**64 - 1},[{MOST},1],[{2**64 - 1}]]"
    assert await evaluate(FROM_CBOR, list(cbor2.dumps(value))) == written
