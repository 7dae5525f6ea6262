# SPDX-License-Identifier: Apache-2.0
"""The token that a page asks for: what people paste, and what they do instead."""

import pytest
import pytest_asyncio

from tests.gateway_process import gateway_process
from tests.pages.conftest import page_address
from tests.pages.test_debug_page import new_token

pytestmark = pytest.mark.asyncio(loop_scope="package")

ASKS = "() => document.getElementById('token').open"
REFUSES = "() => document.getElementById('token-problem').textContent.includes('not a token')"


@pytest_asyncio.fixture(scope="module", loop_scope="package")
async def guarded(tmp_path_factory):
    """A gateway that asks for a token, with one."""
    file = tmp_path_factory.mktemp("tokens") / "tokens.json"
    token = await new_token(file)
    settings = ("--set", "access.authentication=token", "--set", f"access.token_file={file}")
    async with gateway_process("serve", *settings) as gateway:
        yield gateway, token


@pytest.mark.parametrize("how", ["typed", "in the address"])
async def test_a_token_may_be_pasted_with_the_name_of_its_scheme(guarded, open_page, how):
    gateway, token = guarded
    behind = f"#token=Bearer%20{token}" if how == "in the address" else ""
    async with open_page(f"{page_address(gateway)}drive{behind}") as page:
        if how == "typed":
            await page.wait_for_function(ASKS)
            await page.fill("#token-text", f" Bearer {token} ")
            await page.click("#token button")
        await page.wait_for_selector(".state[data-state=open]")
        await page.reload()
        await page.wait_for_selector(".state[data-state=open]")


@pytest.mark.parametrize("wrong", ["two words", "ключ", "a,b"])
async def test_an_invalid_token_is_refused_in_words_and_not_kept(guarded, open_page, wrong):
    gateway, token = guarded
    async with open_page(f"{page_address(gateway)}drive") as page:
        await page.wait_for_function(ASKS)
        await page.fill("#token-text", wrong)
        await page.click("#token button")
        await page.wait_for_function(REFUSES)
        assert await page.evaluate("() => sessionStorage.length") == 0
        await page.reload()
        await page.wait_for_function(ASKS)
        await page.fill("#token-text", token)
        await page.click("#token button")
        await page.wait_for_selector(".state[data-state=open]")


async def test_an_invalid_token_in_the_address_is_refused_in_words(guarded, open_page):
    gateway, _ = guarded
    async with open_page(f"{page_address(gateway)}drive#token=two%20words") as page:
        await page.wait_for_function(REFUSES)
        assert await page.evaluate("() => sessionStorage.length") == 0


async def test_the_question_for_a_token_can_be_left_and_asked_again(guarded, open_page):
    gateway, token = guarded
    async with open_page(f"{page_address(gateway)}drive") as page:
        await page.wait_for_function(ASKS)
        await page.focus("#token-text")
        await page.keyboard.press("Space")  # which is STOP elsewhere
        assert await page.evaluate("() => notice.hidden")
        assert await page.input_value("#token-text") == " "
        await page.keyboard.press("Escape")
        await page.wait_for_function(f"() => !({ASKS})()")
        await page.click("#ask-token")
        await page.wait_for_function(ASKS)
        await page.fill("#token-text", token)
        await page.click("#token button")
        await page.wait_for_selector(".state[data-state=open]")
        assert not await page.locator("#ask-token").is_visible()
