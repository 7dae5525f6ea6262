# SPDX-License-Identifier: Apache-2.0
"""A router with access control, which says nothing to those that it refuses."""

import contextlib
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from gateway.sources.source import Qos, RosError
from gateway.sources.zenoh import refusals
from gateway.sources.zenoh.options import ZenohOptions
from gateway.sources.zenoh.port import ZenohSource
from gateway.sources.zenoh.refusals import BACK_S, CHECK_S, LOOK_S, MAX_TRIED
from gateway.sources.zenoh.session import open_session
from schemas.installed import InstalledDefinitions
from tests.client import eventually
from tests.sources.test_contract import INT32, Received, number
from tests.sources.test_contract_services import SET_BOOL, echo, request, soon
from tests.sources.zenoh.conftest import OPTIONS
from tests.sources.zenoh.outside import free_port, session
from tests.sources.zenoh.test_session import subscribe
from tests.sources.zenoh.world import ZenohWorld

TOKENS = "@ros2_lv/**"
BOTH_WAYS = ["ingress", "egress"]


def user(name: str) -> dict[str, str]:
    before = "transport/auth/usrpwd"
    return {f"{before}/user": name, f"{before}/password": "secret"}


@pytest.fixture
def refusing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.setattr(refusals, "CHECK_S", 0.3)
    return partial(refusing_router, tmp_path)


@contextlib.contextmanager
def refusing_router(
    tmp_path: Path, *messages: str, keys: str = "**", flows: Any = BOTH_WAYS
) -> Iterator[tuple[ZenohSource, ZenohWorld]]:
    """Open a source next to a robot, on a router that refuses it some kinds of messages."""
    users, address = tmp_path / "users", f"tcp/127.0.0.1:{free_port()}"
    users.write_text("gateway:secret\nrobot:secret\n")
    rule = {"id": "refused", "permission": "deny", "key_exprs": [keys]}
    rule |= {"messages": list(messages), "flows": flows}
    control = {
        "enabled": bool(messages),
        "default_permission": "allow",
        "rules": [rule] if messages else [],
        "subjects": [{"id": "gateway", "usernames": ["gateway"]}],
        "policies": [{"rules": ["refused"], "subjects": ["gateway"]}] if messages else [],
    }
    settings = {"listen/endpoints": [address], "access_control": control, **user("router")}
    settings["transport/auth/usrpwd/dictionary_file"] = str(users)
    overrides = ";".join(f'{key}="{value}"' for key, value in user("gateway").items())
    options = ZenohOptions(address, overrides)
    with contextlib.ExitStack() as stack:
        stack.enter_context(contextlib.closing(session(mode="router", **settings)))
        world = stack.enter_context(contextlib.closing(ZenohWorld(address, **user("robot"))))
        opened = open_session(options)
        source = ZenohSource(
            opened, OPTIONS, InstalledDefinitions(), None, lambda: open_session(options)
        )
        yield stack.enter_context(contextlib.closing(source)), world


def faults(source: ZenohSource) -> str:
    return " ".join(f"{each.severity}: {each.text}" for each in source.faults())


async def test_nothing_is_reported_if_the_router_refuses_nothing(refusing):
    assert (CHECK_S, BACK_S, LOOK_S, MAX_TRIED) == (10.0, 2.0, 0.02, 64)
    with refusing() as (source, world):
        world.add_publisher("/count", INT32)  # which is silent
        world.add_subscription("/number", INT32, lambda _: None)
        subscribe(source, "/count")
        source.publishing.advertise("/number", INT32, Qos(), lambda _: None)
        await eventually(lambda: len(source._refusals._passed) == 2)
        assert faults(source) == ""


@pytest.mark.parametrize(
    ("messages", "flows"),
    [
        (("liveliness_token",), ["ingress"]),
        (("liveliness_token",), ["egress"]),
        (("declare_liveliness_subscriber",), BOTH_WAYS),
    ],
)
async def test_hidden_tokens_are_a_fault(refusing, messages, flows):
    with refusing(*messages, keys=TOKENS, flows=flows) as (source, _):
        await eventually(lambda: "degraded: the Zenoh router hides the nodes" in faults(source))
        assert "allow the gateway to declare and watch tokens below @ros2_lv" in faults(source)


async def test_a_refused_subscription_is_a_fault_until_it_is_closed(refusing, caplog):
    with refusing("declare_subscriber", flows=["ingress"]) as (source, world):
        world.add_publisher("/count", INT32)
        received = Received()
        opened = source.subscribe("/count", INT32, Qos(), received.on_samples, received.on_event)
        await eventually(lambda: "messages of topics from passing (1)" in faults(source))
        await eventually(lambda: "refuses the subscription to /count" in caplog.text)
        opened.close()
        assert faults(source) == ""


async def test_subscriptions_that_the_gateway_may_not_hear_of_are_a_fault(refusing, caplog):
    with refusing("declare_subscriber", flows=["egress"]) as (source, world):
        world.add_subscription("/count", INT32, lambda _: None)
        publisher = source.publishing.advertise("/count", INT32, Qos(), lambda _: None)
        await eventually(lambda: "messages of topics from passing (1)" in faults(source))
        await eventually(lambda: "refuses the publisher of /count" in caplog.text)
        publisher.publish(number(1))
        publisher.close()
        assert faults(source) == ""


@pytest.mark.parametrize("message", ["query", "reply"])
async def test_a_refused_call_has_the_true_cause(refusing, message):
    with refusing(message) as (source, world):
        world.add_service("/arm", SET_BOOL, echo)
        client = source.services.client("/arm", SET_BOOL)
        with pytest.raises(RosError, match=r"no answer comes.*access control of the Zenoh router"):
            await soon(client.call(request(True)))
