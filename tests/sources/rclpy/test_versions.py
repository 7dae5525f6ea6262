# SPDX-License-Identifier: Apache-2.0
"""Services and actions that others have another definition of, over real DDS."""

import contextlib
import logging
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Any

import pytest

from gateway.sources.rclpy import RosOptions
from gateway.sources.rclpy.made_types import type_supports
from gateway.sources.rclpy.port import RclpyRos
from gateway.sources.services import ServiceRequest
from gateway.sources.source import RosError
from schemas.installed import InstalledDefinitions, installed_prefixes
from tests.client import eventually
from tests.sources.conftest import MadeClasses, known_to
from tests.sources.outside import Outside
from tests.sources.outside_services import until_known
from tests.sources.test_contract_actions import FIBONACCI, goal, ignore
from tests.sources.test_contract_services import (
    SET_BOOL,
    answered,
    echo,
    request,
    response,
    soon,
    text_of,
)

REMEDY = "bring its package, or the folder in types.paths, to the same version everywhere"
SAME = "bool data\n---\nbool success\nstring message\n"

# called by a test to get a gateway with other definitions
Gateway = Callable[[str], RclpyRos]


@pytest.fixture
async def gateway(tmp_path: Path, outside: Outside) -> AsyncIterator[Gateway]:
    with contextlib.ExitStack() as undo:

        def open_one(text: str) -> RclpyRos:
            package, name = (
                ("test_msgs", "Fibonacci") if text.count("---") > 1 else ("std_srvs", "SetBool")
            )
            kind = "action" if package == "test_msgs" else "srv"
            folder = tmp_path / "share" / package / kind
            folder.mkdir(parents=True)
            (folder / f"{name}.{kind}").write_text(text)
            definitions = InstalledDefinitions([tmp_path, *installed_prefixes()])
            ros = RclpyRos(RosOptions(), MadeClasses(definitions))
            undo.callback(ros.close)
            outside.is_known = lambda service: known_to(ros, service)
            return ros

        yield open_one


@pytest.mark.parametrize(
    "text",
    [
        "bool data\nbool more\n---\nbool success\nstring message\n",
        "bool data\n---\nbool success\nstring<=80 message\n",
    ],
)
async def test_a_server_with_another_definition_is_not_called(text, gateway, outside, caplog):
    ros = gateway(text)
    asked: list[Any] = []

    def answer(each: ServiceRequest) -> None:
        asked.append(each)
        echo(each)

    outside.add_service("/arm", SET_BOOL, answer)
    client = ros.services.client("/arm", SET_BOOL)
    while not caplog.records:  # until the name of the node is known
        with pytest.raises(RosError) as caught:
            await soon(client.call(request(True)))
    with pytest.raises(RosError, match="another definition"):
        await soon(client.call(request(True)))
    problem = (
        f"has another definition of {SET_BOOL} than this gateway, so it is not called; {REMEDY}"
    )
    assert (caught.value.code, str(caught.value)) == (
        "type_conflict",
        f"service /arm: its server {problem}",
    )
    assert [each.getMessage() for each in caplog.records] == [f"service /arm: /outside {problem}"]
    assert asked == []


async def test_the_same_definition_is_not_a_conflict(gateway, outside, caplog):
    ros = gateway(f"# words\n{SAME}")
    outside.add_service("/arm", SET_BOOL, echo)
    ros.services.serve("/leg", SET_BOOL, echo)
    assert (
        text_of(await soon(ros.services.client("/arm", SET_BOOL).call(request(True)))) == "got True"
    )
    client = outside.add_client("/leg", SET_BOOL)
    assert text_of(await soon(client.call(request(True)))) == "got True"
    assert caplog.records == []


async def test_a_server_that_reports_no_hash_is_called(gateway, outside, monkeypatch):
    ros = gateway("uint8 data\n---\nbool success\nstring message\n")
    with monkeypatch.context() as older:  # as ROS before Iron announces itself
        older.setattr(type_supports, "_HASH_VERSION", 0)
        found = MadeClasses().service(SET_BOOL).service_class

    def execute(message: Any, _: Any) -> Any:
        until_known(outside.node, "/arm")
        return found.Response(response("got it"))

    outside.node.create_service(found, "/arm", execute)
    assert (
        text_of(await soon(ros.services.client("/arm", SET_BOOL).call(request(True)))) == "got it"
    )


async def test_a_server_that_comes_with_the_right_definition_is_called(gateway, outside):
    ros = gateway("int8 data\n---\nbool success\nstring message\n")
    wrong = outside.add_service("/arm", SET_BOOL, echo)
    client = ros.services.client("/arm", SET_BOOL)
    with pytest.raises(RosError, match="another definition"):
        await soon(client.call(request(True)))
    wrong.close()
    await eventually(lambda: not client._requester.is_ready)
    ros.services.serve("/arm", SET_BOOL, echo)
    assert text_of(await answered(client, request(True))) == "got True"


async def test_a_caller_with_another_definition_is_told_of_in_the_log(gateway, outside, caplog):
    caplog.set_level(logging.WARNING)
    ros = gateway("bool data\n---\nbool success\n")
    ros.services.serve("/arm", SET_BOOL, echo)
    outside.add_client("/arm", SET_BOOL)
    await eventually(lambda: bool(caplog.records))
    ros.services.follow_graph()
    problem = f"another definition of {SET_BOOL} than this gateway, so its calls are misread"
    (record,) = caplog.records
    assert record.getMessage() == f"service /arm: /outside has {problem}; {REMEDY}"


@pytest.mark.parametrize(
    "text",
    [
        "int64 order\n---\nint32[] sequence\n---\nint32[] sequence\n",
        "int32 order\n---\nint64[] sequence\n---\nint32[] sequence\n",
        "int32 order\n---\nint32[] sequence\n---\nint64[] sequence\n",
    ],
)
async def test_an_action_of_which_any_part_is_another_gets_no_goals(text, gateway, outside, caplog):
    ros = gateway(text)
    asked: list[Any] = []
    outside.add_action_server("/dock", FIBONACCI, asked.append, ignore)
    client = ros.actions.action_client("/dock", FIBONACCI)
    with pytest.raises(RosError, match="action /dock: its server has another definition") as caught:
        await soon(client.send_goal(goal(3), ignore))
    assert caught.value.code == "type_conflict"
    ros.actions.serve_action("/other", FIBONACCI, ignore, ignore)
    caplog.clear()
    outside.add_action_client("/other", FIBONACCI)
    await eventually(lambda: "action /other: /outside has another" in caplog.text)
    assert asked == []
