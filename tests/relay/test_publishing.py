# SPDX-License-Identifier: Apache-2.0
"""Publishing on topics of a robot through a relay: the router permits it, or the client is told."""

import contextlib
from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from gateway.config.model import Config
from gateway.relay import router as routers
from gateway.relay.robot_source import open_robot_source
from gateway.relay.router_file import checked
from gateway.sources.source import Qos, RosError
from gateway.sources.zenoh import publishing
from gateway.sources.zenoh.options import ZenohOptions
from gateway.sources.zenoh.port import ZenohSource
from schemas.installed import InstalledDefinitions
from tests.client import eventually
from tests.core.conftest import STRING, bench  # noqa: F401  # a fixture
from tests.sources.zenoh.outside import free_port
from tests.uplink.conftest import Fleet, fleet  # noqa: F401  # a fixture

PASSWORDS = {"r1": "password-of-r1", "west": "password-of-west"}


@contextlib.asynccontextmanager
async def relayed(
    fleet: Fleet,  # noqa: F811
    folder: Path,
    **given: object,
) -> AsyncIterator[ZenohSource]:
    """Offer the robot through a router with access control. Yield it as a relay has it."""
    secret = folder / "secret"
    secret.write_text(PASSWORDS["r1"])
    address = f"tcp/127.0.0.1:{free_port()}"
    users = {"robots": {"r1": PASSWORDS["r1"]}, "relays": {"west": PASSWORDS["west"]}}
    config = checked({"listen": [address], **users, **given}, "test")
    signs_in = {
        "transport/auth/usrpwd/user": "west",
        "transport/auth/usrpwd/password": PASSWORDS["west"],
    }
    fleet.stack.enter_context(routers.routing(config))
    await fleet.offered(endpoint=address, user="r1", user_file=str(secret))
    options = ZenohOptions(address, settings=signs_in)
    async with open_robot_source(options, Config(), InstalledDefinitions(), "r1") as source:
        await eventually(lambda: source.topic_types("/goal") == (STRING,))
        yield source


async def test_without_relays_publish_a_message_is_refused_with_the_setting(
    fleet: Fleet,  # noqa: F811
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
):
    assert publishing.LATE_S == 3
    monkeypatch.setattr(publishing, "LATE_S", 0.1)
    heard: list[object] = []
    fleet.bench.ros.add_subscription("/goal", STRING, heard.append)
    refused: list[RosError] = []
    async with relayed(fleet, tmp_path) as source:
        publisher = source.publishing.advertise("/goal", STRING, Qos(), lambda _: None)

        def is_refused() -> bool:
            try:
                publisher.publish(fleet.bench.cdr(STRING, data="x"))
            except RosError as error:
                refused.append(error)
            return bool(refused)

        await eventually(is_refused)
    assert refused[0].code == "forbidden"
    assert str(refused[0]) == (
        "topic /goal: the robot gets no message: set relays_publish = true in the file of the"
        " router, and let uplink.role of the robot publish"
    )
    assert heard == []


async def test_with_relays_publish_messages_reach_the_robot(
    fleet: Fleet,  # noqa: F811
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
):
    monkeypatch.setattr(publishing, "LATE_S", 60)  # this machine may be slow
    heard: list[object] = []
    fleet.bench.ros.add_subscription("/goal", STRING, heard.append)
    async with relayed(fleet, tmp_path, relays_publish=True) as source:
        publisher = source.publishing.advertise("/goal", STRING, Qos(), lambda _: None)

        def has_come() -> bool:
            publisher.publish(fleet.bench.cdr(STRING, data="x"))
            return bool(heard)

        await eventually(has_come)
