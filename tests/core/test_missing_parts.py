# SPDX-License-Identifier: Apache-2.0
"""Operations that need a part of the source, if the source lacks it."""

from collections.abc import AsyncIterator
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace
from typing import Any

import pytest

from gateway.codec.types import Types
from gateway.core.missing_parts import complete
from gateway.core.router import Router
from schemas.folders import SHIPPED
from schemas.installed import InstalledDefinitions
from schemas.table import Table
from tests.core.conftest import LIMITS, STRING, TWIST, Bench, Socketless
from tests.sources.fake import FakeRos
from tests.sources.fake_guard import FakeGuard

LOOKUP = "tf2_msgs/action/LookupTransform"
PARTS = ("publishing", "services", "actions", "diagnosis")


class Lacking(FakeRos):
    """A robot in memory without some parts."""

    def __init__(self, *missing: str, types: Types) -> None:
        self.missing = missing
        super().__init__(types=types)

    def __getattribute__(self, name: str) -> Any:
        """Look it up."""
        missing = super().__getattribute__("missing") if name in PARTS else ()
        if name in missing:
            return None
        if name == "publishing" and "guard" in missing:
            own = {each: getattr(self, each) for each in ("advertise", "advertise_own", "readers")}
            return SimpleNamespace(guard=None, **own)
        return super().__getattribute__(name)


@pytest.fixture
async def lacking(request: pytest.FixtureRequest) -> AsyncIterator[Bench]:
    types = Types(InstalledDefinitions(folders=[SHIPPED]))
    ros = Lacking(*request.param, types=types)
    with ThreadPoolExecutor(1) as workers:
        table, shared = Table.load(), {"workers": workers, "version": "test"}
        router = Router(complete(ros), types, table, limits=LIMITS, **shared)
        yield Bench(ros, router, types)
        router.close()


def refused(client: Socketless, op: str, **fields: Any) -> str:
    """Send an operation, and return the text of its normal answer, which must be a refusal."""
    client.send(op=op, id="x", **fields)
    answers = {"call_service": "service_response", "send_action_goal": "action_result"}
    (answer,) = (each for each in client.frames if each["op"] == answers.get(op, "status"))
    client.frames.clear()
    if op in answers:
        assert answer["result"] is False
        text = answer["values"]
        return str(text["reason"] if isinstance(text, dict) else text)
    assert answer["code"] == "not_found"
    return str(answer["msg"])


@pytest.mark.parametrize("lacking", [PARTS], indirect=True)
async def test_an_operation_that_needs_a_missing_part_gets_one_sentence(lacking: Bench) -> None:
    client = lacking.client()
    refusals = {
        "publishing": [
            ("advertise", {"topic": "/a", "type": STRING}),
            ("publish", {"topic": "/a", "type": STRING, "msg": {}}),
            ("publish", {"topic": "/cmd_vel", "type": TWIST, "msg": {}}),
            ("acquire_control", {"topic": "/cmd_vel"}),
        ],
        "services": [
            ("call_service", {"service": "/add"}),
            ("advertise_service", {"service": "/add", "type": "std_srvs/srv/Trigger"}),
        ],
        "actions": [
            (
                "send_action_goal",
                {"action": "/go", "action_type": "tf2_msgs/action/LookupTransform"},
            ),
            ("advertise_action", {"action": "/go", "type": "tf2_msgs/action/LookupTransform"}),
        ],
    }
    for part, operations in refusals.items():
        for op, fields in operations:
            text = refused(client, op, **fields)
            assert text.startswith(f"this source has no {part}: "), (op, text)
            assert ": connect to" in text


@pytest.mark.parametrize("lacking", [PARTS], indirect=True)
async def test_topics_the_graph_and_health_need_no_optional_part(lacking: Bench) -> None:
    client = lacking.client()
    lacking.ros.add_publisher("/a", STRING)
    client.send(op="subscribe", topic="/a")
    await lacking.settle()
    lacking.ros.publish("/a", lacking.cdr(STRING, data="hi"))
    await client.sees(1)
    client.send(op="call_service", service="/rosapi/topics")
    (answer,) = await client.sees(1, "service_response")
    assert answer["result"]
    assert "/a" in answer["values"]["topics"]
    assert lacking.router.counts()["ros_entities"] == 0
    assert list(lacking.router.ros.diagnosis.shared_names()) == []


@pytest.mark.parametrize("lacking", [["guard"]], indirect=True)
async def test_without_a_guard_nobody_drives(lacking: Bench) -> None:
    heard: list[object] = []
    lacking.ros.add_subscription("/cmd_vel", TWIST, heard.extend)
    await lacking.settle()  # the gateway has seen the robot
    client = lacking.client()
    for op, fields in (
        ("publish", {"msg": {"linear": {"x": 0.1}}}),
        ("publish", {"type": TWIST, "msg": {}}),
        ("advertise", {"type": TWIST}),
        ("acquire_control", {}),
    ):
        for _ in range(2):  # also the second time
            text = refused(client, op, topic="/cmd_vel", **fields)
            assert text.startswith("this source has no guard: "), (op, text)
    client.send(op="stop", id="s")
    assert client.of("stop") == [{"op": "stop", "id": "s", "topics": []}]
    await lacking.settle()
    assert heard == []
    assert lacking.router.control() == ((), False, 0)
    client.send(op="publish", topic="/other", type=STRING, msg={"data": "a"})  # which moves nothing
    assert [each.topic for each in lacking.ros.publishers] == ["/other"]


async def test_a_source_with_a_guard_is_driven(bench: Bench) -> None:
    client = bench.sender(op="publish", topic="/cmd_vel", type=TWIST, msg={})
    assert client.of("status") == []
    assert isinstance(bench.ros.guard, FakeGuard)
    assert bench.ros.guard.verbs == ["open"]
