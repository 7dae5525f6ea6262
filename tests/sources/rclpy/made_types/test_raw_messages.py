# SPDX-License-Identifier: Apache-2.0
"""Messages that are nothing but CDR, between nodes of plain rclpy and the gateway's classes."""

import gc
import subprocess
import sys
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Any

import pytest
from rclpy.serialization import deserialize_message, serialize_message
from std_srvs.srv import SetBool

from gateway.codec.error_text import CodecError
from gateway.codec.types import Types
from gateway.sources.rclpy import RosOptions
from gateway.sources.rclpy.made_types.raw_messages import RawMessage
from gateway.sources.rclpy.port import RclpyRos
from gateway.sources.services import ServiceRequest
from gateway.sources.source import RosError
from schemas.installed import InstalledDefinitions
from tests.client import eventually
from tests.sources.conftest import MadeClasses, known_to
from tests.sources.outside import Outside
from tests.sources.outside_services import arrived, until_known
from tests.sources.test_contract_actions import FIBONACCI, ignore
from tests.sources.test_contract_services import SET_BOOL, echo, request, soon, text_of

HEADER = b"\0\1\0\0"
DEFINITIONS = InstalledDefinitions()
PAGE = 4096


@pytest.fixture
def classes() -> MadeClasses:
    return MadeClasses()


@pytest.fixture
async def ros(classes: MadeClasses, outside: Outside) -> AsyncIterator[RclpyRos]:
    ros = RclpyRos(RosOptions(), classes)
    outside.is_known = lambda service: known_to(ros, service)
    yield ros
    ros.close()


def live(classes: MadeClasses) -> int:
    """Return how many messages there are in C."""
    messages = classes._made._messages
    return 0 if messages is None else len(messages)


@pytest.mark.parametrize("length", [0, 1, 2, 3, 4, 5, 1001, 1 << 20])
def test_rmw_writes_and_reads_what_is_given(length: int, classes: MadeClasses):
    made = classes.get("std_msgs/msg/String")
    cdr = HEADER + bytes(range(256)) * (length // 256) + bytes(range(length % 256))
    assert serialize_message(made(cdr)) == cdr
    assert deserialize_message(cdr, made).cdr == cdr
    assert live(classes) == 0


def test_a_received_message_keeps_its_byte_order(classes: MadeClasses):
    cdr = b"\0\0\0\0" + b"\0\0\0\2a\0"
    assert deserialize_message(cdr, classes.get("std_msgs/msg/String")).cdr == cdr


@pytest.mark.parametrize("cdr", [b"", b"\0\0\0\0\0", b"\0\1\0", b"\0\7\0\0abc"])
def test_only_little_endian_cdr_is_sent(cdr: bytes):
    with pytest.raises(ValueError, match=r"encapsulation 0x\w*, only 0x0001 can be sent"):
        RawMessage(cdr)


async def test_thousands_of_calls_leave_nothing_behind(ros, classes, outside):
    ros.services.serve("/arm", SET_BOOL, lambda each: each.answer(answer))
    client = ros.services.client("/arm", SET_BOOL)
    text = "x" * 50_000
    answer = serialize_message(SetBool.Response(success=True, message=text))
    grown: list[int] = []
    for _ in range(3):
        before = resident()
        for _ in range(1000):
            assert text_of(await soon(client.call(request(True)))) == text
        grown.append(resident() - before)
    assert live(classes) == 0
    assert min(grown) < 5_000_000  # and not 50 MB each time


def test_no_garbage_is_collected_while_rmw_writes(classes, monkeypatch):
    made = classes.get("std_msgs/msg/String")
    messages = classes._made._messages
    write, were_enabled = messages._fast_cdr.write, []

    def watched(cdr: int, **rest: Any) -> int:
        were_enabled.append(gc.isenabled())
        return write(cdr, **rest)

    monkeypatch.setattr(messages._fast_cdr, "write", watched)
    assert serialize_message(made(HEADER + b"abc")) == HEADER + b"abc"
    assert (were_enabled, gc.isenabled()) == ([False], True)


def resident() -> int:
    return int(Path("/proc/self/statm").read_text().split()[1]) * PAGE


def served(outside: Outside, found: Any, answer: Callable[[Any], Any]) -> None:
    """Serve /arm outside by a class."""

    def execute(message: Any, _: Any) -> Any:
        until_known(outside.node, "/arm")
        return answer(message)

    outside.node.create_service(found, "/arm", execute)


@pytest.mark.parametrize("wrong", [b"", b"\1", b"\1\0\0\0\xff\xff\xff\xff", b"\xff" * 64])
async def test_a_wrong_response_arrives_as_it_is_and_is_refused_by_the_codec(
    wrong: bytes, ros: RclpyRos, classes: MadeClasses, outside: Outside
):
    made = classes.service(SET_BOOL).service_class
    served(outside, made, lambda _: made.Response(HEADER + wrong))
    got = await soon(ros.services.client("/arm", SET_BOOL).call(request(True)))
    assert got[4:].rstrip(b"\0") == wrong.rstrip(b"\0")
    with pytest.raises(CodecError):
        Types(DEFINITIONS).get(f"{SET_BOOL}_Response").decode(got[: 4 + len(wrong)])


async def test_a_response_that_cannot_be_sent_is_refused_and_the_request_stays_open(ros: RclpyRos):
    refusals: list[str] = []

    def answer(each: ServiceRequest) -> None:
        try:
            each.answer(b"\0\0\0\0\1")
        except RosError as error:
            refusals.append(str(error))
        echo(each)

    ros.services.serve("/arm", SET_BOOL, answer)
    client = ros.services.client("/arm", SET_BOOL)
    words = "service /arm: encapsulation 0x0000, only 0x0001 can be sent"
    with pytest.raises(RosError, match=words) as caught:
        await soon(client.call(b"\0\0\0\0\1"))
    assert caught.value.code == "internal"
    assert text_of(await soon(client.call(request(True)))) == "got True"
    assert refusals == [words]


async def test_padding_behind_a_message_is_not_part_of_it(ros: RclpyRos, outside: Outside):
    decode = Types(DEFINITIONS).get(f"{SET_BOOL}_Response").decode
    texts = ["", "a", "ab", "abc", "abcd"]
    served(outside, SetBool, lambda _: SetBool.Response(message=texts[0]))
    client = ros.services.client("/arm", SET_BOOL)
    while texts:
        assert decode(await soon(client.call(request(True))))["message"] == texts[0]
        texts.pop(0)


async def test_goals_without_a_whole_id_are_rejected(ros, classes, outside):
    goals: list[Any] = []
    server = ros.actions.serve_action("/dock", FIBONACCI, goals.append, ignore)
    form = classes.action(FIBONACCI)
    sending = outside.node.create_client(form.send_goal, "/dock/_action/send_goal")
    asking = outside.node.create_client(form.get_result, "/dock/_action/get_result")
    for client, name in ((sending, "send_goal"), (asking, "get_result")):
        await eventually(client.service_is_ready)
        await eventually(lambda name=name: known_to(ros, f"/dock/_action/{name}"))  # type: ignore[misc]
    response = await soon(arrived(sending.call_async(form.send_goal.Request(HEADER + b"abc"))))
    assert (form.is_accepted(response), goals) == (False, [])
    response = await soon(arrived(asking.call_async(form.get_result.Request(HEADER + b"abc"))))
    assert form.read_result_response(response)[0] == 0
    server.close()


@pytest.mark.parametrize("what", ["send", "create"])
def test_no_thread_waits_for_what_a_made_type_holds(what: str):
    beside = [sys.executable, "-m", "tests.sources.rclpy.beside_entities", what]
    ended = subprocess.run(beside, capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert int(ended.stdout.rpartition(" ")[2]) > 0
