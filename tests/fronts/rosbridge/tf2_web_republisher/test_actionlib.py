# SPDX-License-Identifier: Apache-2.0
"""The topics of tf2_web_republisher's action in ROS 1, as roslib's TFClient uses them."""

from typing import Any

import pytest

from gateway.access.permissions import Identity, Policy
from gateway.config.access import AccessConfig, ViewerConfig
from tests.core.conftest import Bench, Socketless
from tests.core.transforms.asking import ACTION, request, xs
from tests.core.transforms.conftest import Robot

FEEDBACK = f"{ACTION}/feedback"


def begin(client: Socketless) -> None:
    """Do what roslib does for a new client of transforms."""
    package = "tf2_web_republisher/TFSubscriptionAction"
    client.send(op="advertise", id="a", topic=f"{ACTION}/goal", type=f"{package}Goal")
    client.send(op="advertise", id="b", topic=f"{ACTION}/cancel", type="actionlib_msgs/GoalID")
    client.send(op="subscribe", id="c", topic=FEEDBACK, type=f"{package}Feedback")


def end(client: Socketless) -> None:
    """Do what roslib does when such a client is disposed of."""
    client.send(op="unadvertise", id="a", topic=f"{ACTION}/goal")
    client.send(op="unadvertise", id="b", topic=f"{ACTION}/cancel")
    client.send(op="unsubscribe", id="c", topic=FEEDBACK)


def send(client: Socketless, goal_id: str = "g", **more: Any) -> None:
    stamp = {"secs": 0, "nsecs": 0}
    message = {"goal_id": {"stamp": stamp, "id": goal_id}, "goal": request(**more)}
    client.send(op="publish", id="p", topic=f"{ACTION}/goal", msg=message)


def cancel(client: Socketless, **message: Any) -> None:
    client.send(op="publish", id="p", topic=f"{ACTION}/cancel", msg=message)


def count(robot: Robot) -> int:
    return robot.bench.router.counts()["transforms"]


async def test_the_transforms_are_on_the_feedback_topic_with_the_id_of_the_goal(
    robot: Robot, client: Socketless
):
    begin(client)
    send(client)
    await robot.drives(1, 2.0)
    [frame] = await client.sees(1)
    assert (frame["op"], frame["topic"]) == ("publish", FEEDBACK)
    message = frame["msg"]
    assert set(message) == {"header", "status", "feedback"}
    assert message["header"]["frame_id"] == ""
    assert message["header"]["stamp"]["sec"] == robot.bench.ros.now // 1_000_000_000
    assert message["status"] == {
        "goal_id": {"stamp": {"sec": 0, "nanosec": 0}, "id": "g"},
        "status": 1,
        "text": "",
    }
    assert xs([message["feedback"]["transforms"]]) == [{"base_link": 2.0, "laser": 3.0}]
    assert client.statuses == []
    counts = robot.bench.router.counts()
    assert (counts["publishers"], counts["subscriptions"]) == (0, 0)


async def test_a_goal_ends_when_it_is_cancelled(robot: Robot, client: Socketless):
    begin(client)
    for goal in ("a", "b", "c"):
        send(client, goal)
    cancel(client, id="a", stamp={"secs": 0, "nsecs": 0})
    assert count(robot) == 2
    cancel(client, id="a")
    assert client.statuses == [("not_found", "msg.id: no goal 'a' is under way")]
    cancel(client)  # as in actionlib: all of them
    assert count(robot) == 0
    send(client, "a")
    assert count(robot) == 1


async def test_goals_end_with_the_last_subscription_to_their_feedback(
    robot: Robot, client: Socketless
):
    begin(client)
    client.send(op="subscribe", id="d", topic=FEEDBACK)
    send(client)
    end(client)
    assert count(robot) == 1
    client.send(op="unsubscribe", topic=FEEDBACK)
    assert count(robot) == 0
    assert client.statuses == []
    client.send(op="unsubscribe", topic=FEEDBACK)
    assert client.statuses == [("not_found", f"not subscribed to {FEEDBACK}")]


async def test_a_subscription_after_the_goal_gets_all_frames(robot: Robot, client: Socketless):
    send(client)
    other = robot.bench.client()
    begin(other)
    send(other)
    await robot.drives(1, 2.0)
    await other.sees(1)
    assert client.messages == []
    begin(client)
    await client.sees(1)
    assert client.messages[0]["feedback"] == other.messages[0]["feedback"]


@pytest.mark.parametrize(
    ("message", "words"),
    [
        ({"goal": request()}, "msg.goal_id: missing"),
        ({"goal_id": {}}, "msg.goal: missing"),
        ({"goal_id": {"id": 7}, "goal": request()}, "msg.goal_id.id: expected a string, got 7"),
        ({"goal_id": {"id": "x" * 257}, "goal": request()}, "msg.goal_id.id: expected at most 256"),
        ({"goal_id": {}, "goal": request(rate=900)}, "msg.goal.rate: expected at most 200, got"),
        ({"goal_id": {}, "goal": 7}, "msg.goal: expected an object"),
        (7, "msg: expected an object"),
        ({"goal_id": {"id": "g"}, "goal": request()}, "msg.goal_id.id: 'g' is already in use"),
    ],
)
async def test_a_goal_that_does_not_fit_is_refused_in_words(
    robot: Robot, client: Socketless, message: Any, words: str
):
    begin(client)
    send(client, "g")
    client.send(op="publish", id="p", topic=f"{ACTION}/goal", msg=message)
    [(_, text)] = client.statuses
    assert text.startswith(words)
    assert count(robot) == 1


async def test_when_a_client_leaves_its_goals_end_and_another_s_go_on(
    robot: Robot, client: Socketless
):
    other = robot.bench.client()
    for each in (client, other):
        begin(each)
        send(each)
    robot.bench.router.leave(other.session)
    assert count(robot) == 1
    await robot.drives(1, 2.0)
    await client.sees(1)
    assert other.messages == []


async def test_a_topic_of_ros_for_goals_is_used(bench: Bench, client: Socketless):
    bench.ros.add_subscription(f"{ACTION}/goal", "std_msgs/msg/String", lambda _: None)
    client.send(op="publish", topic=f"{ACTION}/goal", msg={"data": "x"})
    client.send(op="subscribe", topic=FEEDBACK, type="std_msgs/msg/String")
    assert client.statuses == []
    counts = bench.router.counts()
    assert (counts["publishers"], counts["subscriptions"]) == (1, 1)


async def test_a_goal_that_began_goes_on_when_such_a_topic_appears(
    robot: Robot, client: Socketless
):
    begin(client)
    send(client)
    robot.bench.ros.add_subscription(f"{ACTION}/goal", "std_msgs/msg/String", lambda _: None)
    cancel(client, id="g")
    assert count(robot) == 0
    end(client)
    assert client.statuses == []


async def test_a_viewer_may_follow_transforms_so_unless_they_are_denied(robot: Robot):
    client = viewer(robot.bench)
    begin(client)
    send(client)
    await robot.drives(1, 2.0)
    await client.sees(1)
    cancel(client, id="g")
    end(client)
    assert client.statuses == []
    denied = viewer(robot.bench, deny_subscribe=("/tf_static",))
    begin(denied)
    send(denied)
    assert {code for code, _ in denied.statuses} == {"not_found"}
    assert count(robot) == 0


def viewer(bench: Bench, **config: Any) -> Socketless:
    policy = Policy(AccessConfig(viewer=ViewerConfig(**config)))
    return bench.client(identity=Identity("tablet", policy.of("viewer")))
