# SPDX-License-Identifier: Apache-2.0
"""The pages by https, as a headset needs them, and with a token."""

import asyncio
import signal
import subprocess
import sys

import pytest

from tests import dds_domain
from tests.client import client, eventually
from tests.gateway_process import gateway_process
from tests.pages.conftest import page_address
from tests.pages.test_debug_page import new_token

NOT_CONNECTED = "Not connected. Enter a token."

pytestmark = pytest.mark.asyncio(loop_scope="package")


async def test_by_https_the_pages_show_what_comes_and_may_use_a_headset(open_page, tmp_path):
    options = ("--tls-port", "0", "--domain-id", str(dds_domain.claim()))
    before = ("env", f"XDG_CONFIG_HOME={tmp_path}")  # for the certificate
    async with (
        gateway_process("serve", *options, before=before) as gateway,
        client(gateway.url) as speaker,
    ):
        await speaker.send(op="advertise", topic="/text", type="std_msgs/String", latch=True)
        await speaker.send(op="publish", topic="/text", msg={"data": "by TLS"})
        addresses: list[str] = []

        def is_told() -> bool:
            words = " ".join(gateway.output).split()
            addresses[:] = [each for each in words if each.startswith("https://")]
            return bool(addresses)

        await eventually(is_told)
        address, trusting = addresses[0], {"ignore_https_errors": True}
        async with open_page(f"{address}#card=tree+0+/text", **trusting) as page:
            await page.wait_for_selector(".tree:has-text('by TLS')")
            assert await page.evaluate("() => isSecureContext")
        async with open_page(f"{address}lab", **trusting) as page:
            await page.wait_for_selector(".state[data-state=open]")
            await page.wait_for_function("() => document.getElementById('vr-note').textContent")
            note = await page.inner_text("#vr-note")
            assert note == "No headset is connected to this browser."


@pytest.mark.parametrize("name", ["", "drive", "lab"])
async def test_a_page_whose_token_is_revoked_asks_for_another(open_page, tmp_path, name):
    file = tmp_path / "tokens.json"
    settings = ("--set", "access.authentication=token", "--set", f"access.token_file={file}")
    token = await new_token(file)
    async with (
        gateway_process("serve", *settings) as gateway,
        open_page(f"{page_address(gateway)}{name}") as page,
    ):
        asks = "() => document.getElementById('token').open"
        await page.wait_for_function(asks)
        await page.fill("#token-text", token)
        await page.click("#token button")
        await page.wait_for_selector(".state[data-state=open]")
        revoke = ("token", "--file", str(file), "revoke", "tablet")
        command = [sys.executable, "-m", "gateway", *revoke]
        await asyncio.to_thread(subprocess.run, command, check=True, capture_output=True)
        gateway.process.send_signal(signal.SIGHUP)
        await page.wait_for_function(asks)
        assert "revoked" in await page.inner_text("#token-problem")
        if name == "drive":  # and not that it drives
            assert await page.inner_text("#control") == NOT_CONNECTED
