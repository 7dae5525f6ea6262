# SPDX-License-Identifier: Apache-2.0
"""Waits until the gateway has discovered what a test's robot offers: DDS takes its time."""

import asyncio

from tests.client import Client


async def until_discovered(client: Client, question: str, name: str) -> None:
    """Ask *question* until it knows *name*: a service of rosapi that answers nothing until then."""
    known: object = None
    while not known:
        await asyncio.sleep(0.02)
        await client.send(op="call_service", service=f"/rosapi/{question}", args=[name])
        frame = await client.receive(lambda frame: frame["op"] == "service_response")
        (known,) = frame["values"].values()
