# SPDX-License-Identifier: Apache-2.0
"""Goals for tf2_web_republisher, as roslib's ROS2TFClient sends them."""

import gc
from typing import Any

import pytest

from gateway.access.permissions import Identity, Policy
from gateway.config.access import AccessConfig, ViewerConfig
from gateway.fronts.rosbridge.operations.actions import SendActionGoal
from tests.client import eventually
from tests.core.conftest import Bench, Socketless
from tests.core.transforms.asking import ACTION, request, send_goal, transforms, xs
from tests.core.transforms.conftest import Robot


@pytest.mark.parametrize("action", ["/tf2_web_republisher", "tf2_web_republisher"])
@pytest.mark.parametrize(
    "action_type",
    [
        None,
        "tf2_web_republisher_interfaces/TFSubscription",  # of roslib
        "tf2_web_republisher_msgs/action/TFSubscription",
    ],
)
async def test_the_transforms_are_the_feedback_of_a_goal_until_it_is_cancelled(
    robot: Robot, client: Socketless, action: str, action_type: str | None
):
    about = {"id": "g", "action": action}
    client.send(
        op="send_action_goal", **about, action_type=action_type, feedback=True, args=request()
    )
    await robot.drives(1, 2.0)
    [frame] = await client.sees(1, "action_feedback")
    assert frame == {"op": "action_feedback", **about, "values": frame["values"]}
    assert xs([frame["values"]["transforms"]]) == [{"base_link": 2.0, "laser": 3.0}]
    client.send(op="cancel_action_goal", **about)
    assert client.of("action_result") == [
        {"op": "action_result", **about, "values": {}, "status": 4, "result": True}
    ]
    client.send(op="cancel_action_goal", **about)
    assert client.statuses == [
        ("not_found", "no goal of /tf2_web_republisher with id 'g' is under way")
    ]


async def test_a_goal_needs_no_id_and_several_go_on_at_once(robot: Robot, client: Socketless):
    send_goal(client, None)
    send_goal(client, "other", source_frames=["laser"])
    await robot.drives(1, 2.0)
    frames = await client.sees(2, "action_feedback")
    assert {frame.get("id") for frame in frames} == {None, "other"}


async def test_feedback_comes_in_fragments_to_those_who_ask_for_them(
    robot: Robot, client: Socketless
):
    client.send(
        op="send_action_goal", id=1, action=ACTION, feedback=True, args=request(), fragment_size=64
    )
    await robot.drives(1, 2.0)
    fragments = await client.sees(2, "fragment")
    assert all(len(fragment["data"]) <= 64 for fragment in fragments)


@pytest.mark.parametrize(
    ("about", "words"),
    [
        ({"args": None}, "args.source_frames: missing"),
        ({"args": 7}, "args: expected an object, or up to 6 values, got 7"),
        ({"args": [[], "odom", 1, 1, 1, {}, 7]}, "args: expected an object, or up to 6 values"),
        ({"args": request(source_frames=["a", 7])}, "args.source_frames.1: expected a string"),
        (
            {"args": request(source_frames=["a"] * 513)},
            "args.source_frames: expected at most 512 items, got 513",
        ),
        ({"args": request(target_frame="x" * 257)}, "args.target_frame: expected at most 256"),
        ({"args": request(rate=201)}, "args.rate: expected at most 200, got 201"),
        ({"args": request(rate=-1)}, "args.rate: expected at least 0, got -1"),
        ({"args": request(trans_thres=-1)}, "args.trans_thres: expected at least 0, got -1"),
        ({"args": request(angular_thres=-1)}, "args.angular_thres: expected at least 0, got -1"),
        ({"args": request(hz=3)}, "args.hz: unknown"),
        ({"feedback": False}, "feedback: expected true, because the transforms come as feedback"),
        (
            {"action_type": "test_msgs/action/Fibonacci"},
            "action /tf2_web_republisher has type tf2_web_republisher_msgs/action/TFSubscription, ",
        ),
        ({"id": "known"}, "id: 'known' is already in use by an unfinished goal"),
    ],
)
async def test_a_goal_that_does_not_fit_is_refused_in_words(
    robot: Robot, client: Socketless, about: dict[str, Any], words: str
):
    send_goal(client, "known")
    goal = {"op": "send_action_goal", "id": "g", "action": ACTION, "feedback": True}
    client.send(**{**goal, "args": request(), **about})
    [result] = client.of("action_result")
    assert result["values"].startswith(words)
    assert (result["result"], result["status"]) == (False, 0)
    assert robot.bench.router.counts()["transforms"] == 1


async def test_a_goal_under_way_does_not_keep_its_request(robot: Robot, client: Socketless):
    send_goal(client, "not kept")
    assert robot.bench.router.counts()["transforms"] == 1
    gc.collect()
    alive = [each for each in gc.get_objects() if isinstance(each, SendActionGoal)]
    assert "not kept" not in [each.id for each in alive]


async def test_the_values_of_a_goal_may_come_in_order(robot: Robot, client: Socketless):
    args = [["laser"], "base_link", 0.1, 0.1, 200]
    client.send(op="send_action_goal", id="g", action=ACTION, feedback=True, args=args)
    await eventually(lambda: xs(transforms(client)) == [{"laser": 1.0}])


async def test_a_node_that_provides_the_action_gets_the_goals(bench: Bench, client: Socketless):
    node = bench.ros.add_action_server(
        ACTION, "test_msgs/action/Fibonacci", lambda _: None, lambda _: None
    )
    send_goal(client)
    [result] = client.of("action_result")
    assert result["values"].startswith("args.source_frames: unknown field of the test_msgs")
    node.close()
    send_goal(client, "again")
    assert len(client.of("action_result")) == 1


async def test_a_client_does_not_see_the_goals_of_another(robot: Robot, client: Socketless):
    other = robot.bench.client()
    send_goal(client)
    other.send(op="cancel_action_goal", id="goal", action=ACTION)
    assert [code for code, _ in other.statuses] == ["not_found"]
    send_goal(other)
    robot.bench.router.leave(other.session)
    await robot.drives(1, 0.0)
    await client.sees(1, "action_feedback")
    assert other.of("action_feedback") == []


async def test_another_action_goes_its_way(bench: Bench, client: Socketless):
    client.send(op="send_action_goal", id=1, action="/tf2_web_republisher_2", feedback=True)
    [result] = client.of("action_result")
    assert result["values"] == "action /tf2_web_republisher_2 does not exist"


def viewer(bench: Bench, **config: Any) -> Socketless:
    policy = Policy(AccessConfig(viewer=ViewerConfig(**config)))
    return bench.client(identity=Identity("tablet", policy.of("viewer")))


async def test_a_role_with_transforms_may_send_a_goal(robot: Robot):
    client = viewer(robot.bench)
    send_goal(client)
    await robot.drives(1, 2.0)
    await client.sees(1, "action_feedback")


async def test_a_role_without_transforms_may_send_no_goal(robot: Robot):
    client = viewer(robot.bench, deny_subscribe=("/tf",))
    send_goal(client)
    [result] = client.of("action_result")
    assert result["values"] == "action /tf2_web_republisher does not exist"
    assert robot.subscriptions == []


async def test_a_client_without_its_token_may_send_no_goal(robot: Robot):
    client = robot.bench.client(identity=None)
    send_goal(client)
    [result] = client.of("action_result")
    assert result["values"].startswith("authenticate first")
    assert robot.subscriptions == []
