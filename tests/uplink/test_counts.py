# SPDX-License-Identifier: Apache-2.0
"""A robot counts in health and metrics what no relay sends, as a process with a real router."""

import contextlib
import json
import urllib.request

from tests.client import TIMEOUT_S, eventually
from tests.gateway_process import gateway_process
from tests.sources.zenoh.outside import Router, client


def read(url: str) -> str:
    with urllib.request.urlopen(url, timeout=TIMEOUT_S) as response:  # noqa: S310  # ours
        return str(response.read().decode())


async def test_malformed_messages_of_relays_are_in_health_and_metrics():
    with contextlib.closing(Router()) as router:
        robot = ("--no-browser", "--recorded", "--uplink", router.address, "--robot-name", "r1")
        async with gateway_process("demo", *robot) as gateway:
            stranger = client(router.address, namespace="gw/r1")
            publisher = stranger.declare_publisher("cmd/a1/x")
            await eventually(lambda: bool(publisher.matching_status.matching))
            publisher.put(b"malformed")
            url = f"http{gateway.url.removeprefix('ws').rstrip('/')}"
            await eventually(lambda: bool(json.loads(read(f"{url}/healthz"))["relayed_malformed"]))
            assert "\nros2_gateway_relayed_malformed_total 1.0\n" in read(f"{url}/metrics")
            stranger.close()
