# SPDX-License-Identifier: Apache-2.0
"""Services, actions and types of a robot that relays use through its uplink."""

import logging

import pytest

from gateway.codec.types import Types
from gateway.sources.actions import CANCELED, SUCCEEDED
from gateway.sources.source import RosError
from gateway.uplink import calls
from schemas.installed import InstalledDefinitions
from tests.client import eventually
from tests.sources.test_contract import INT32
from tests.sources.test_contract_actions import FIBONACCI, Provider, goal, sequence, values_of
from tests.sources.test_contract_services import SET_BOOL, echo, request, soon, text_of
from tests.sources.zenoh.outside import client, hash_of
from tests.uplink.conftest import Fleet

SET_PARAMETERS = "rcl_interfaces/srv/SetParameters"
STATUS = "diagnostic_msgs/msg/DiagnosticStatus"
DESCRIBE = "type_description_interfaces/srv/GetTypeDescription"


async def test_a_service_of_the_robot_answers_through_a_relay(fleet: Fleet):
    fleet.bench.ros.add_service("/arm", SET_BOOL, echo)
    await fleet.offered()
    relay = fleet.relay()
    await eventually(lambda: relay.service_types("/arm") == (SET_BOOL,))
    calling = relay.services.client("/arm", SET_BOOL)
    assert text_of(await soon(calling.call(request(True)))) == "got True"


async def test_a_call_that_the_role_may_not_make_gets_the_reason(fleet: Fleet):
    fleet.bench.ros.add_service("/node/set_parameters", SET_PARAMETERS, echo)
    await fleet.offered()
    relay = fleet.relay()
    await eventually(lambda: relay.service_types("/node/set_parameters") == (SET_PARAMETERS,))
    calling = relay.services.client("/node/set_parameters", SET_PARAMETERS)
    empty = fleet.bench.types.service(SET_PARAMETERS).request.encode({}, 0)
    with pytest.raises(RosError, match="requires role admin, and this client is operator"):
        await soon(calling.call(empty))


async def test_an_action_of_the_robot_is_used_through_a_relay(fleet: Fleet):
    provider = Provider()
    fleet.bench.ros.add_action_server("/count", FIBONACCI, *provider.callbacks)
    await fleet.offered()
    relay = fleet.relay()
    await eventually(lambda: relay.action_types("/count") == (FIBONACCI,))
    heard: list[bytes] = []
    sending = relay.actions.action_client("/count", FIBONACCI)
    sent = await soon(sending.send_goal(goal(3), heard.append))
    await eventually(lambda: len(provider.goals) == 1)
    provider.goals[0].feedback(sequence(1, 2))
    await eventually(lambda: [values_of(each) for each in heard] == [[1, 2]])
    provider.goals[0].finish(SUCCEEDED, sequence(1, 2, 3))
    result = await soon(sent.result())
    assert (result.status, values_of(result.cdr)) == (SUCCEEDED, [1, 2, 3])
    other = await soon(sending.send_goal(goal(9), heard.append))
    await eventually(lambda: len(provider.goals) == 2)
    other.cancel()
    await eventually(lambda: provider.cancels == provider.goals[1:])
    provider.goals[1].finish(CANCELED, sequence())
    assert (await soon(other.result())).status == CANCELED


async def test_the_goals_of_relays_end_with_the_uplink(fleet: Fleet):
    provider = Provider()
    fleet.bench.ros.add_action_server("/count", FIBONACCI, *provider.callbacks)
    await fleet.offered()
    relay = fleet.relay()
    await eventually(lambda: relay.action_types("/count") == (FIBONACCI,))
    sending = relay.actions.action_client("/count", FIBONACCI)
    await soon(sending.send_goal(goal(3), lambda _: None))
    await eventually(lambda: len(provider.goals) == 1)
    await fleet.restart_router()
    await eventually(lambda: provider.cancels == provider.goals)


async def test_relays_learn_types_from_the_uplink_whatever_the_nodes_know(fleet: Fleet):
    text = "float64 weight\nstd_msgs/Header header\n"
    fleet.bench.ros.add_described_publisher("/crate", "our_msgs/msg/Crate", text)
    await fleet.offered()
    relay = fleet.relay()
    await eventually(lambda: relay.topic_types("/crate") == ("our_msgs/msg/Crate",))
    learned = await soon(relay.definitions("our_msgs/msg/Crate"))
    assert learned is not None
    crate = learned["our_msgs/msg/Crate"]
    assert [each.name for each in crate.fields] == ["weight", "header"]
    asking = Types(InstalledDefinitions()).service(DESCRIBE)
    calling = relay.services.client("/outside/get_type_description", DESCRIBE)
    for name, reason in [("our_msgs/msg/None", "None"), (INT32, "another definition")]:
        asked = {"type_name": name, "type_hash": "RIHS01_00", "include_type_sources": False}
        answer = asking.response.decode(await soon(calling.call(asking.request.encode(asked, 0))))
        assert not answer["successful"]
        assert reason in answer["failure_reason"]
    asked = {"type_name": STATUS, "type_hash": hash_of(STATUS), "include_type_sources": True}
    answer = asking.response.decode(await soon(calling.call(asking.request.encode(asked, 0))))
    sources = {each["type_name"]: each["raw_file_contents"] for each in answer["type_sources"]}
    assert "byte STALE=3" in sources[STATUS]


async def test_requests_that_cannot_be_read_are_left_out(
    fleet: Fleet, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
):
    assert calls.MAX_NAMED_REQUESTS == 8
    monkeypatch.setattr(calls, "MAX_NAMED_REQUESTS", 2)
    fleet.bench.ros.add_service("/arm", SET_BOOL, echo)
    uplink = await fleet.offered()
    relay, stranger = fleet.relay(), client(fleet.router.address)
    fleet.stack.callback(stranger.close)
    await eventually(lambda: relay.service_types("/arm") == (SET_BOOL,))
    calling = relay.services.client("/arm", SET_BOOL)
    key = calling.requester._key.text
    caplog.set_level(logging.WARNING)
    for selector in ("0/**", "0/nothing", "0/%/$/x/y", key, key):
        stranger.get(f"gw/r1/{selector}".replace("$", "S"), lambda _: None, payload=b"x")
    assert uplink.link is not None
    remote = uplink.link.calls
    await eventually(lambda: remote.left_out == 5)
    assert caplog.text.count("a request of a relay is left out") == 2
    with pytest.raises(RosError, match="need"):
        await soon(calling.requester.send(b"\0\1\0\0"))
    assert text_of(await soon(calling.call(request(False)))) == "got False"
