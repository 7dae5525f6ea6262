# SPDX-License-Identifier: Apache-2.0
"""Classes for types that are not installed. tests/e2e/test_types_not_installed.py uses them."""

import asyncio
import os
import re
import subprocess
import sys
import time
from pathlib import Path

import pytest
from std_msgs.msg import String
from std_srvs.srv import SetBool
from test_msgs.action import Fibonacci

from gateway.sources.rclpy import message_classes
from gateway.sources.rclpy.made_types import classes as made_types
from gateway.sources.rclpy.message_classes import MessageClasses, why_types_cannot_be_made
from gateway.sources.source import RosError
from schemas.installed import InstalledDefinitions
from schemas.type_hash import type_hash
from tests.client import TIMEOUT_S, eventually

LAMP = "my_msgs/msg/Lamp"
USE = "my_msgs/srv/Use"
ACT = "my_msgs/action/Use"
NOT_INSTALLED = "no ROS package my_msgs is installed here (my_msgs/msg/Lamp)"


@pytest.fixture
def definitions(tmp_path: Path) -> InstalledDefinitions:
    folder = tmp_path / "my_msgs" / "msg"
    folder.mkdir(parents=True)
    for name, text in {"Lamp": "bool on\n", "Bulb": "Lamp lamp\n", "Odd": "Nobody x\n"}.items():
        (folder / f"{name}.msg").write_text(text)
    for kind, text in {"srv": "Lamp a\n---\n", "action": "---\nLamp a\n---\n"}.items():
        (tmp_path / "my_msgs" / kind).mkdir()
        (tmp_path / "my_msgs" / kind / f"Use.{kind}").write_text(text)
        (tmp_path / "my_msgs" / kind / f"Odd.{kind}").write_text(f"{text}Nobody x\n")
    return InstalledDefinitions(None, [tmp_path])


def making(definitions: InstalledDefinitions, why_not: str | None = None) -> MessageClasses:
    classes = MessageClasses(definitions)
    classes.allow_made_types(why_not)
    return classes


def test_the_class_of_an_installed_package_comes_first(definitions: InstalledDefinitions):
    assert making(definitions).get("std_msgs/msg/String") is String


def test_a_class_is_made_once_for_each_type(definitions: InstalledDefinitions):
    classes = making(definitions)
    lamp, bulb = classes.get(LAMP), classes.get("my_msgs/msg/Bulb")
    assert (lamp.__name__, lamp.__module__) == ("Lamp", "my_msgs.msg")
    assert classes.get(LAMP) is lamp is not bulb


def test_a_service_and_an_action_are_made_once(definitions: InstalledDefinitions):
    classes = making(definitions)
    service = classes.service(USE).service_class
    assert service.Request.__name__ == "Use_Request"
    assert classes.service(USE).service_class is service
    action = classes.action(ACT)
    assert action.send_goal.Request.__name__ == "Use_SendGoal_Request"
    assert action.get_result.Response.__name__ == "Use_GetResult_Response"
    assert action.feedback.__name__ == "Use_FeedbackMessage"
    assert classes.action(ACT).send_goal is action.send_goal


@pytest.mark.parametrize("name", ["Odd", "Unknown"])
def test_services_and_actions_that_cannot_be_made_are_not_installed(name, definitions):
    for classes in (making(definitions), MessageClasses(definitions)):
        for get, kind in ((classes.service, "srv"), (classes.action, "action")):
            with pytest.raises(RosError, match="no ROS package my_msgs is installed") as caught:
                get(f"my_msgs/{kind}/{name}")
            assert caught.value.code == "bad_type"


def test_if_no_service_can_be_made_the_error_gives_the_reason(definitions: InstalledDefinitions):
    classes = making(definitions, "none can be made here")
    for get, name in ((classes.service, USE), (classes.action, ACT)):
        with pytest.raises(RosError, match=r"my_msgs.*, and none can be made here"):
            get(name)


def test_services_and_actions_of_packages_are_made_too_where_that_is_possible(
    definitions: InstalledDefinitions, monkeypatch
):
    def is_of_package(classes: MessageClasses) -> set[bool]:
        set_bool = classes.service("std_srvs/srv/SetBool").service_class
        fibonacci = classes.action("test_msgs/action/Fibonacci").feedback
        return {set_bool is SetBool, fibonacci is Fibonacci.Impl.FeedbackMessage}

    assert is_of_package(making(definitions)) == {False}
    assert is_of_package(MessageClasses(definitions)) == {True}
    assert is_of_package(making(definitions, "none can be made here")) == {True}
    monkeypatch.setattr(made_types, "MAX_MADE", 0)
    assert is_of_package(making(definitions)) == {True}


@pytest.mark.parametrize("name", [LAMP, "my_msgs/msg/Unknown"])
def test_unless_types_are_made_they_are_not_installed(name: str, definitions: InstalledDefinitions):
    for classes in (MessageClasses(), MessageClasses(definitions)):
        with pytest.raises(RosError, match="no ROS package my_msgs is installed here"):
            classes.get(name)


def test_the_hash_of_a_type_is_that_of_its_definition(definitions: InstalledDefinitions):
    installed = definitions.get("std_msgs/msg/String").type_hash
    classes = MessageClasses(definitions)
    assert classes.hash_of("std_msgs/msg/String") == installed is not None
    assert classes.hash_of(LAMP) == type_hash(definitions.get(LAMP), definitions)
    of_part = definitions.get("std_srvs/srv/SetBool_Request").type_hash
    assert classes.hash_of("std_srvs/srv/SetBool_Request") == of_part is not None
    assert str(classes.hash_of("my_msgs/action/Use_SendGoal_Request")).startswith("RIHS01_")
    assert classes.hash_of("my_msgs/srv/Odd_Response") is classes.hash_of(f"{USE}_No") is None
    for name in ("", "x", "std_msgs/Int32", "a/srv/b/c"):
        assert classes.hash_of(name) is None
    assert classes.hash_of("my_msgs/msg/Odd") is classes.hash_of("my_msgs/msg/Unknown") is None
    assert MessageClasses().hash_of(LAMP) is None


def test_a_type_with_a_key_is_refused_in_words_where_dds_would_not_match_it(tmp_path, monkeypatch):
    folder = tmp_path / "my_msgs" / "msg"
    folder.mkdir(parents=True)
    members = "@key long number;"
    text = f"module my_msgs {{ module msg {{ struct Keyed {{ {members} }}; }}; }};"
    (folder / "Keyed.idl").write_text(text)
    classes = making(InstalledDefinitions(None, [tmp_path]))
    monkeypatch.setattr(made_types.fast_dds, "is_second", lambda: False)
    with pytest.raises(RosError, match=r"my_msgs/msg/Keyed has a @key: .* install my_msgs"):
        classes.get("my_msgs/msg/Keyed")
    monkeypatch.setattr(made_types.fast_dds, "is_second", lambda: True)
    assert classes.get("my_msgs/msg/Keyed").__name__ == "Keyed"


def test_a_type_that_nests_an_unknown_one_is_not_installed(definitions: InstalledDefinitions):
    with pytest.raises(RosError, match="no ROS package my_msgs is installed here"):
        making(definitions).get("my_msgs/msg/Odd")


def test_if_no_type_can_be_made_the_error_gives_the_reason(definitions: InstalledDefinitions):
    classes = making(definitions, "none can be made here")
    with pytest.raises(RosError) as caught:
        classes.get(LAMP)
    text = f"{NOT_INSTALLED}, and none can be made here"
    assert (caught.value.code, str(caught.value)) == ("bad_type", text)


def test_the_number_of_made_types_is_bounded(definitions: InstalledDefinitions, monkeypatch):
    classes = making(definitions)
    classes._made._made.update({(f"my_msgs/msg/Other{each}", ""): None for each in range(1023)})
    classes.get(LAMP)
    with pytest.raises(RosError, match="at most 1024 types that are not installed") as caught:
        classes.get("my_msgs/msg/Bulb")
    assert caught.value.code == "limit_exceeded"
    for get, name in ((classes.service, USE), (classes.action, ACT)):
        with pytest.raises(RosError, match="at most 1024 types that are not installed"):
            get(name)
    assert classes.get(LAMP)


def test_another_middleware_is_refused_by_name(monkeypatch):
    monkeypatch.setattr(made_types, "get_rmw_implementation_identifier", lambda: "rmw_other")
    with pytest.raises(RosError, match="need rmw_fastrtps_cpp, this is rmw_other"):
        made_types.check_middleware()


async def test_this_ros_takes_made_types():
    assert await why_types_cannot_be_made(asyncio.get_running_loop()) is None


@pytest.mark.parametrize(
    ("script", "words"),
    [
        ("print('no, and why'); raise SystemExit(1)", "no, and why"),
        (
            "import os; os.kill(os.getpid(), 11)",
            "a test whether others can be made ended with -11",
        ),
        ("raise SystemExit(3)", "a test whether others can be made ended with 3"),
        ("import time; time.sleep(600)", "a test whether others can be made took over 60 s"),
    ],
)
async def test_a_process_that_fails_or_crashes_is_told_of(monkeypatch, script: str, words: str):
    monkeypatch.setattr(message_classes, "_CHECK", ("-c", script))
    if "sleep" in script:  # a minute is a tenth of a second
        wait = subprocess.Popen.communicate
        monkeypatch.setattr(
            subprocess.Popen, "communicate", lambda self, timeout: wait(self, timeout=timeout / 600)
        )
    assert await why_types_cannot_be_made(asyncio.get_running_loop()) == words


@pytest.mark.parametrize(
    ("structure", "order", "words"),
    [
        # which of them depends on the version of rmw
        (
            "MessageCallbacks",
            "[0, 1, 3, 2, 4, 5, 6, 7]",
            r"made types: failed to send request|ended with -(7|11)",
        ),
        ("MessageCallbacks", "[6, 0, 1, 2, 3, 4, 5, 7]", "ended with -(7|11)"),
        ("ServiceCallbacks", "[0, 1, 3, 2, 4]", "made types: failed to create service"),
        ("ServiceSupport", "[0, 1, 2, 4, 3, 5, 6, 7, 8, 9, 10]", "made services have no hashes"),
    ],
)
async def test_a_ros_that_is_laid_out_otherwise_is_noticed(monkeypatch, structure, order, words):
    script = (
        "import ctypes",
        "from gateway.sources.rclpy.made_types import check, classes, type_supports",
        f"fields = type_supports.{structure}._fields_",
        f"others = {{'_fields_': [fields[place] for place in {order}]}}",
        f"classes.{structure} = type('Other', (ctypes.Structure,), others)",
        "check._WITHIN_S = 3",
        "raise SystemExit(check.main())",
    )
    monkeypatch.setattr(message_classes, "_CHECK", ("-c", "\n".join(script)))
    assert re.search(words, str(await why_types_cannot_be_made(asyncio.get_running_loop())))


async def test_a_process_that_cannot_start_is_told_of(monkeypatch):
    monkeypatch.setattr(sys, "executable", "/nowhere/python")
    words = "a test whether others can be made did not start: no such file or directory"
    assert await why_types_cannot_be_made(asyncio.get_running_loop()) == words


async def test_a_trial_runs_while_the_loop_is_blocked(monkeypatch, tmp_path: Path):
    file = tmp_path / "tried"
    monkeypatch.setattr(message_classes, "_CHECK", ("-c", f"open({str(file)!r}, 'w')"))
    classes = MessageClasses()
    trying = classes.begin_trial()
    end_s = time.monotonic() + TIMEOUT_S
    while not file.exists() and time.monotonic() < end_s:
        time.sleep(0.01)  # noqa: ASYNC251  # the loop is blocked
    assert file.exists()
    await classes.make_types()
    assert classes.begin_trial() is trying


async def test_a_start_that_is_given_up_leaves_no_process(monkeypatch, tmp_path: Path):
    file = tmp_path / "pid"
    script = (
        "import os, sys, time",
        f"with open({str(file)!r}, 'w') as file: print(os.getpid(), file=file)",
        "time.sleep(600)",
    )
    monkeypatch.setattr(message_classes, "_CHECK", ("-c", "\n".join(script)))
    trying = why_types_cannot_be_made(asyncio.get_running_loop())
    await eventually(lambda: file.exists() and file.read_text().endswith("\n"))
    trying.cancel()
    with pytest.raises(asyncio.CancelledError):
        await trying
    with pytest.raises(ProcessLookupError):
        os.kill(int(file.read_text()), 0)
