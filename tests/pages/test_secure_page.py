# SPDX-License-Identifier: Apache-2.0
"""The pages by https, as a headset needs them, from a gateway that signs its own certificate."""

import pytest

from tests import dds_domain
from tests.client import client, eventually
from tests.gateway_process import gateway_process

pytestmark = pytest.mark.asyncio(loop_scope="module")


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
