# SPDX-License-Identifier: Apache-2.0
"""The operations that each role may carry out."""

import json
import logging
from dataclasses import MISSING, fields
from typing import Any, get_args

import pytest

from gateway.access.permissions import Identity, Policy
from gateway.config.access import (
    AccessConfig,
    AnyRole,
    OperatorConfig,
    Role,
    RoleConfig,
    ViewerConfig,
)
from gateway.core import requests
from gateway.core.errors import ProtocolError
from gateway.core.peer import Peer
from gateway.core.permission_checks import may_carry_out
from gateway.core.requests import Request
from gateway.fronts.rosbridge.operations import ClientOperation
from tests.client import eventually
from tests.core.conftest import FIBONACCI, STRING, TRIGGER, Bench, Socketless
from tests.core.rosapi.scripted import ScriptedNodes
from tests.fronts.lines import LineFront

HIDING = AccessConfig(
    viewer=ViewerConfig(
        deny_subscribe=("/secret/**",), deny_call=("/secret/**",), call=("/rosapi/**",)
    ),
    operator=OperatorConfig(deny_subscribe=("/tf",), deny_publish=("/estop", "/secret/**")),
)


def identity(role: AnyRole, config: AccessConfig | None = None) -> Identity:
    return Identity("tablet", Policy(config or AccessConfig()).of(role))


def viewer(bench: Bench, config: AccessConfig | None = None) -> Socketless:
    return bench.client(identity=identity("viewer", config))


def operator(bench: Bench, config: AccessConfig | None = None) -> Socketless:
    return bench.client(identity=identity("operator", config))


async def test_a_viewer_gets_samples(bench: Bench) -> None:
    publisher = bench.ros.add_publisher("/chatter", STRING)
    client = viewer(bench)
    client.send(op="subscribe", topic="chatter")
    publisher.publish(bench.cdr(STRING, data="x"))
    await client.sees(1)
    assert client.messages == [{"data": "x"}]


@pytest.mark.parametrize(
    ("operation", "text"),
    [
        (
            {"op": "publish", "topic": "cmd_vel", "type": STRING, "msg": {}},
            "publishing on /cmd_vel requires role operator or admin, and this client is viewer",
        ),
        (
            {"op": "advertise", "topic": "/cmd_vel", "type": STRING},
            "publishing on /cmd_vel requires role operator or admin, and this client is viewer",
        ),
        (
            {"op": "advertise_service", "service": "arm", "type": TRIGGER},
            "providing service /arm requires role operator or admin, and this client is viewer",
        ),
        (
            {"op": "advertise_action", "action": "/dock", "type": FIBONACCI},
            "providing action /dock requires role operator or admin, and this client is viewer",
        ),
    ],
)
async def test_a_viewer_puts_nothing_into_ros(bench: Bench, operation: Any, text: str) -> None:
    client = viewer(bench)
    client.send(**operation)
    assert client.statuses == [("forbidden", text)]
    assert bench.ros.entity_count() == 0


async def test_a_viewer_calls_no_service_of_ros_and_sends_no_goal(bench: Bench) -> None:
    bench.ros.add_service("/reset", TRIGGER, lambda request: pytest.fail("called"))
    client = viewer(bench)
    client.send(op="call_service", id=1, service="reset")
    client.send(op="call_service", id=2, service="/dock/_action/send_goal")
    client.send(op="send_action_goal", id=3, action="dock", action_type=FIBONACCI)
    client.send(op="call_service", id=4, service="/rosapi/topics")
    forbidden = "requires role operator or admin, and this client is viewer"
    assert [frame.get("values") for frame in client.frames[:3]] == [
        f"calling /reset {forbidden}",
        f"calling /dock/_action/send_goal {forbidden}",
        f"sending goals to /dock {forbidden}",
    ]
    assert [frame["result"] for frame in client.frames] == [False, False, False, True]


async def test_a_local_page_watches_and_calls_but_does_not_drive(bench: Bench) -> None:
    publisher, called = bench.ros.add_publisher("/chatter", STRING), []
    bench.ros.add_service("/reset", TRIGGER, called.append)
    bench.ros.add_action_server("/go", FIBONACCI, lambda _: None, lambda _: None)
    page = bench.client(identity=identity("page"))
    page.send(op="subscribe", topic="/chatter")
    page.send(op="call_service", id=0, service="/reset")
    publisher.publish(bench.cdr(STRING, data="x"))
    await page.sees(1)
    await eventually(lambda: len(called) == 1)
    page.send(op="send_action_goal", id=1, action="go", action_type=FIBONACCI)
    page.send(op="call_service", id=2, service="/go/_action/send_goal")
    page.send(op="publish", id=3, topic="/cmd_vel", type="geometry_msgs/msg/Twist", msg={})
    forbidden = (
        "requires role operator or admin, and this client is page:"
        " to let this page do more, add its origin to the setting allowed_origins"
    )
    refused = {frame["id"]: frame for frame in page.frames if "id" in frame}
    assert refused[1]["values"] == f"sending goals to /go {forbidden}"
    assert refused[2]["values"] == f"calling /go/_action/send_goal {forbidden}"
    assert refused[3]["msg"] == f"publishing on /cmd_vel {forbidden}"


@pytest.mark.parametrize("name", ["estop", "/estop"])
async def test_a_deny_holds_for_every_way_to_write_a_name(bench: Bench, name: str) -> None:
    client = operator(bench, HIDING)
    client.send(op="publish", topic=name, type=STRING, msg={"data": "x"})
    (status,) = client.statuses
    assert status[0] == "forbidden"
    assert "requires role admin" in status[1]
    client.send(op="publish", topic="/other", type=STRING, msg={"data": "x"})
    assert len(client.statuses) == 1


@pytest.mark.parametrize("name", ["/estop\0x", "//estop", "/est~op", "{node}/estop"])
async def test_a_name_is_validated_before_it_is_judged(bench: Bench, name: str) -> None:
    client = operator(bench, HIDING)
    client.send(op="publish", topic=name, type=STRING, msg={})
    assert client.statuses[0][0] == "bad_name"


async def test_an_operation_that_no_role_may_do_is_refused_as_such(bench: Bench) -> None:
    nobody = AccessConfig(
        operator=OperatorConfig(deny_publish=("/estop",)), admin=RoleConfig(publish=())
    )
    client = operator(bench, nobody)
    client.send(op="publish", topic="/estop", type=STRING, msg={})
    assert "publishing on /estop is not allowed for any role" in client.statuses[0][1]


class Secrets:
    """Hidden things in the graph, or the same graph without them."""

    def __init__(self, bench: Bench, *, exist: bool) -> None:
        bench.ros.add_publisher("/open", STRING, node="/secret/arm")
        if exist:
            bench.ros.add_publisher("/secret/pose", STRING, node="/secret/arm")
            bench.ros.add_service("/secret/reset", TRIGGER, lambda _: None, node="/secret/arm")
            bench.ros.add_action_server(
                "/secret/dock", FIBONACCI, lambda _: None, lambda _: None, node="/secret/arm"
            )


async def answers(bench: Bench, *, exist: bool) -> list[Any]:
    """Ask for hidden names in every way, and return everything that comes back."""
    Secrets(bench, exist=exist)
    await bench.settle()
    client = viewer(bench, HIDING)
    hidden = "/secret/pose"
    for number, operation in enumerate(
        [
            {"op": "subscribe", "topic": hidden},
            {"op": "subscribe", "topic": hidden, "type": STRING},
            {"op": "subscribe", "topic": hidden, "type": "std_msgs/msg/Bool"},
            {"op": "subscribe", "topic": "/secret/pos"},
            {"op": "unsubscribe", "topic": hidden},
            {"op": "publish", "topic": hidden, "msg": {}},
            {"op": "advertise", "topic": hidden, "type": "std_msgs/msg/Bool"},
            {"op": "call_service", "service": "/secret/reset"},
            {"op": "call_service", "service": "/secret/resett"},
            {"op": "advertise_service", "service": "/secret/reset", "type": TRIGGER},
            {"op": "send_action_goal", "action": "/secret/dock", "action_type": FIBONACCI},
            {"op": "get_parameters", "node": "/secret/arm"},
            {"op": "call_service", "service": "/rosapi/topics"},
            {"op": "call_service", "service": "/rosapi/topic_type", "args": [hidden]},
            {"op": "call_service", "service": "/rosapi/publishers", "args": ["/open"]},
            {"op": "call_service", "service": "/rosapi/services"},
            {"op": "call_service", "service": "/rosapi/service_type", "args": ["/secret/reset"]},
            {"op": "call_service", "service": "/rosapi/service_node", "args": ["/secret/reset"]},
            {"op": "call_service", "service": "/rosapi/services_for_type", "args": [TRIGGER]},
            {"op": "call_service", "service": "/rosapi/service_providers", "args": [TRIGGER]},
            {"op": "call_service", "service": "/rosapi/nodes"},
            {"op": "call_service", "service": "/rosapi/node_details", "args": ["/secret/arm"]},
            {"op": "call_service", "service": "/rosapi/action_servers"},
            {"op": "call_service", "service": "/rosapi/topics_and_raw_types"},
            {"op": "graph"},
        ]
    ):
        client.send(id=number, **operation)
        if operation["op"] == "subscribe" and "type" in operation:  # it waits, and says nothing
            client.send(op="ping", id=number)
        await client.sees_id(number)
    return [frame for frame in client.frames if frame["op"] != "pong"]


async def test_a_hidden_name_gets_the_answer_of_an_unknown_one(bench: Bench, empty: Bench) -> None:
    there = await answers(bench, exist=True)
    assert there == await answers(empty, exist=False)
    # a name that was asked for comes back. Nothing else of the hidden ones does
    listed = [frame for frame in there if frame["op"] == "graph" or "rosapi" in str(frame)]
    assert "secret" not in json.dumps(listed)
    assert "/open" in json.dumps(listed)


async def test_a_hidden_subscription_is_refused_in_the_words_for_an_absent_topic(
    bench: Bench,
) -> None:
    hidden, absent = viewer(bench, HIDING), viewer(bench)
    for client in (hidden, absent):
        client.send(op="subscribe", id=1, topic="/secret/pose")
    assert hidden.frames == absent.frames
    assert hidden.frames[0]["code"] == "not_found"
    bench.ros.add_publisher("/secret/pose", STRING)
    await bench.settle()
    assert bench.ros.entity_count() == 1  # of the client that may see it


@pytest.mark.parametrize("op", ["subscribe", "publish", "advertise"])
async def test_with_a_type_a_hidden_name_answers_as_one_that_nobody_has(
    bench: Bench, op: str
) -> None:
    client = viewer(bench, HIDING)
    answers = []
    for name in ("/secret/nobody", "/plain/nobody"):
        message = {"msg": {}} if op == "publish" else {}
        client.send(op=op, id=name, topic=name, type=STRING, **message)
        client.send(op="ping", id=f"{name} is done")
        await client.sees_id(f"{name} is done")
        answers.append([frame["code"] for frame in client.frames if frame.get("id") == name])
    assert answers[0] == answers[1] == ([] if op == "subscribe" else ["forbidden"])


async def test_a_proposal_never_names_what_is_hidden(bench: Bench) -> None:
    bench.ros.add_publisher("/secret/pose", STRING)
    bench.ros.add_service("/secret/reset", TRIGGER, lambda _: None)
    await bench.settle()
    client = operator(bench, AccessConfig(operator=OperatorConfig(
        deny_subscribe=("/secret/**",), deny_publish=("/secret/**",), deny_call=("/secret/**",)
    )))  # fmt: skip
    for name in ("/secretpose", "/secre/pose"):
        client.send(op="subscribe", topic=name)
    client.send(op="call_service", service="/secretreset")
    assert len(client.frames) == 3
    assert "secret/" not in json.dumps([frame.get("msg") for frame in client.frames])
    assert "did you mean" not in json.dumps(client.frames)


async def test_a_watcher_of_the_graph_hears_only_of_what_it_sees(bench: Bench) -> None:
    watcher, everybody = viewer(bench, HIDING), bench.client()
    for client in (watcher, everybody):
        client.send(op="graph", watch=True)
    bench.ros.add_publisher("/secret/pose", STRING, node="/secret/arm")
    await everybody.sees(2, "graph")
    bench.ros.add_publisher("/open", STRING, node="/secret/arm")
    frames = await watcher.sees(2, "graph")
    await everybody.sees(3, "graph")
    assert len(watcher.of("graph")) == 2
    (topic,) = frames[1]["changes"]["topics"]
    assert (topic["name"], topic["publishers"]) == ("/open", [])


@pytest.mark.parametrize(
    ("role", "may_get", "may_set"),
    [("viewer", True, False), ("operator", True, False), ("admin", True, True)],
)
async def test_parameters_are_services_of_their_node_however_they_are_asked_for(
    bench: Bench, caplog, role: Role, may_get: bool, may_set: bool
) -> None:
    caplog.set_level(logging.DEBUG, "gateway.audit")
    ScriptedNodes(bench.ros).add("/base", "max_speed")
    await bench.settle()
    client = bench.client(identity=identity(role))
    client.send(op="get_parameters", id=1, node="base", names=["max_speed"])
    client.send(op="set_parameters", id=2, node="base", values={"max_speed": 9.0})
    by_rosapi = {"name": "/base:max_speed", "value": "9.0"}
    client.send(op="call_service", id=3, service="/rosapi/set_param", args=by_rosapi)
    client.send(op="call_service", id=4, service="/base/set_parameters")
    for number in (1, 2, 3, 4):
        await client.sees_id(number)
    by_id = {frame["id"]: frame for frame in client.frames}
    assert ("values" in by_id[1]) is may_get
    assert ("results" in by_id[2]) is may_set
    assert by_id[3]["values"].get("successful") is may_set
    assert by_id[4]["result"] is may_set
    if not may_set:
        assert by_id[2]["code"] == "forbidden"
        assert "/base/set_parameters requires role admin" in by_id[2]["msg"]
        assert "/base/set_parameters requires role admin" in by_id[3]["values"]["reason"]
    audited = [json.loads(record.getMessage()) for record in caplog.records]
    refused = [] if may_set else ["set_parameters", "call_service"]
    assert sorted(each["op"] for each in audited) == sorted(refused)


async def test_parameters_of_a_hidden_node_are_those_of_a_node_that_does_not_exist(
    bench: Bench,
) -> None:
    nodes = ScriptedNodes(bench.ros)
    nodes.add("/secret/arm", "max_speed")
    nodes.add("/base", "max_speed")
    await bench.settle()
    client = viewer(bench)
    hiding = viewer(bench, AccessConfig(viewer=ViewerConfig(
        deny_subscribe=("/secret/**",), deny_call=("/secret/**",)
    )))  # fmt: skip
    for each in (client, hiding):
        each.send(op="get_parameters", id=1, node="/secret/arm")
        each.send(op="call_service", id=2, service="/rosapi/get_param_names")
        await each.sees_id(1)
        await each.sees_id(2)
    (status,) = hiding.statuses
    assert status == ("not_found", "node /secret/arm does not exist")
    assert client.statuses == []
    names = [each.of("service_response")[0]["values"]["names"] for each in (client, hiding)]
    assert names == [["/base:max_speed", "/secret/arm:max_speed"], ["/base:max_speed"]]


async def test_a_role_without_tf_cannot_look_up_transforms(bench: Bench) -> None:
    client = operator(bench, HIDING)
    client.send(op="lookup_transform", id=1, target_frame="map", source_frame="odom")
    code, text = client.statuses[0]
    assert code == "forbidden"
    assert "subscribing to /tf requires role viewer or admin" in text
    nothing = AccessConfig(viewer=ViewerConfig(subscribe=("/odom",)))
    client = viewer(bench, nothing)
    client.send(op="lookup_transform", id=1, target_frame="map", source_frame="odom")
    assert client.statuses == [("not_found", "frame 'map' is unknown")]
    assert bench.ros.entity_count() == 0


async def test_a_client_that_has_not_authenticated_may_do_nothing(bench: Bench) -> None:
    client = bench.client(identity=None)
    for operation in ("ping", "hello", "graph"):
        client.send(op=operation)
    client.send(op="subscribe", topic="/a", type=STRING)
    client.send(op="fragment", id="f", num=0, total=2, data="x" * 1000)
    assert [code for code, _ in client.statuses] == ["forbidden"] * 5
    assert "authenticate first" in client.statuses[0][1]
    client.send(op="call_service", id="c", service="/rosapi/topics")
    (response,) = client.of("service_response")
    assert (response["id"], response["result"]) == ("c", False)
    assert not client.session._assembly
    assert bench.ros.entity_count() == 0


async def test_auth_goes_to_who_knows_the_tokens_and_is_ignored_where_nobody_does(
    bench: Bench,
) -> None:
    asked = []
    client = bench.client(identity=None, authenticate=lambda token, _: asked.append(token))
    client.send(op="auth", token="r2g_x")  # noqa: S106  # none of ours
    client.send(op="auth", mac="x")
    assert asked == ["r2g_x", None]
    other = bench.client()
    other.send(op="auth", token="x")  # noqa: S106
    assert other.frames == []


async def test_hello_says_the_role(bench: Bench) -> None:
    for client, role in ((viewer(bench), "viewer"), (bench.client(), "admin")):
        client.send(op="hello")
        assert client.of("hello")[0]["role"] == role


async def test_a_forbidden_operation_is_recorded_without_the_payload(bench: Bench, caplog) -> None:
    client = viewer(bench)
    with caplog.at_level(logging.DEBUG, "gateway.audit"):
        client.send(op="publish", topic="/cmd_vel", type=STRING, msg={"data": "payload"})
    (record,) = caplog.records
    event = json.loads(record.getMessage())
    assert (event["event"], event["name"], event["role"]) == ("forbidden", "tablet", "viewer")
    assert event["op"] == "publish"
    assert "payload" not in record.getMessage()


async def test_a_refusal_of_any_front_is_counted_and_recorded(bench: Bench, caplog) -> None:
    front = LineFront(bench.router)
    session = front.open(Peer(wake=lambda: None, identity=identity("viewer")))
    caplog.set_level(logging.DEBUG, "gateway.audit")
    request = requests.Publish(topic="/cmd_vel", type=STRING, msg={})
    bench.router.carry_out(session, request)
    (event,) = [json.loads(record.getMessage()) for record in caplog.records]
    assert (event["event"], event["op"], session.refused) == ("forbidden", "publish", 1)


def test_these_operations_are_for_everybody_alone_or_checked_later():
    made = [model.makes for model in get_args(ClientOperation)]
    assert {request.kind for request in made if not request.needs_permission} == {
        *("unsubscribe", "unadvertise", "unadvertise_service", "service_response"),
        *("cancel_action_goal", "unadvertise_action", "action_feedback", "action_result"),
        *("cancel_transform", "stop", "acquire_control", "release_control", "control"),
        *("list_parameters", "get_parameters", "set_parameters", "describe_parameters"),
        *("ping", "hello", "help", "describe", "generate", "fetch_asset", "graph", "events"),
        *("set_level", "auth", "record", "log"),
    }


@pytest.mark.parametrize("model", get_args(ClientOperation), ids=lambda model: model.op)
async def test_of_every_operation_it_is_known_what_it_needs(bench: Bench, model: Any) -> None:
    known = {each.name: "x" for each in fields(model.makes) if each.default is MISSING}
    session = bench.client(identity=identity("admin")).session
    may_carry_out(session, model.makes(**known))


async def test_an_operation_of_which_nobody_says_what_it_needs_is_forbidden(bench: Bench) -> None:
    class New(Request):
        kind = "new"

    with pytest.raises(ProtocolError, match="new requires a role without limits"):
        may_carry_out(viewer(bench).session, New())
