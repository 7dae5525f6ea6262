# SPDX-License-Identifier: Apache-2.0
"""Actions, both ways, by the native interfaces of the libraries that have one.

roslib 1 and roslibpy 1 know the actions of ROS 1 alone. No version of roslibpy provides one.
"""

from typing import Any

import pytest
from action_msgs.msg import GoalStatus
from test_msgs.action import Fibonacci

from tests.client import eventually
from tests.clients.driver import ROSLIB_2, ROSLIBPY_2, ROSLIBPY_2_ASYNCIO, Connection
from tests.clients.robot import ENDLESS, Robot, result, until

FIBONACCI = "test_msgs/action/Fibonacci"

pytestmark = pytest.mark.asyncio(loop_scope="package")

senders = pytest.mark.parametrize(
    "library", [ROSLIBPY_2, ROSLIBPY_2_ASYNCIO, ROSLIB_2], ids=str, indirect=True
)
providers = pytest.mark.parametrize("library", [ROSLIB_2], ids=str, indirect=True)


async def provide(client: Connection, robot: Robot) -> str:
    """Let the robot provide the action, and wait until the gateway has discovered it."""
    action = client.own("fibonacci")
    robot.provide_fibonacci(action)

    async def is_listed() -> bool:
        return action in await client.ask("get_action_servers")

    await until(is_listed)
    return action


async def send(client: Connection, action: str, order: int, type_name: str = FIBONACCI) -> str:
    goal = {"order": order}
    return str(await client.send_goal(action, type_name, goal))


def sequence_of(client: Connection, value: Any) -> list[int]:
    """Return what a result holds: roslibpy hands out the status next to the values."""
    values = value if client.library.is_javascript else value["values"]
    return list(values["sequence"])


@senders
async def test_a_goal_gets_its_feedback_and_its_result(client: Connection, robot: Robot):
    action = await provide(client, robot)
    goal = await send(client, action, 5)
    assert (await client.next("feedback", goal))["sequence"] == [0, 1]
    found = await client.next("result", goal)
    assert sequence_of(client, found) == [0, 1, 1, 2, 3, 5]
    if not client.library.is_javascript:
        assert found["status"] == GoalStatus.STATUS_SUCCEEDED


@senders
async def test_the_type_may_be_written_in_two_parts(client: Connection, robot: Robot):
    action = await provide(client, robot)
    goal = await send(client, action, 2, "test_msgs/Fibonacci")
    assert sequence_of(client, await client.next("result", goal)) == [0, 1, 1]


@senders
async def test_a_goal_that_is_cancelled_ends_as_canceled(client: Connection, robot: Robot):
    action = await provide(client, robot)
    goal = await send(client, action, ENDLESS)
    await client.next("feedback", goal)
    await client.do("cancel_goal", action=action, goal_id=goal)
    if client.library.is_javascript:
        assert "Action was canceled" in await client.next("failure", goal)
    else:
        found = await client.next("result", goal)
        assert found["status"] == GoalStatus.STATUS_CANCELED


@senders
async def test_a_goal_that_is_aborted_ends_as_aborted(client: Connection, robot: Robot):
    action = await provide(client, robot)
    goal = await send(client, action, -1)
    if client.library.is_javascript:
        assert "Action was aborted" in await client.next("failure", goal)
    else:
        found = await client.next("result", goal)
        assert found["status"] == GoalStatus.STATUS_ABORTED


@senders
async def test_a_goal_that_is_rejected_fails(client: Connection, robot: Robot):
    action = await provide(client, robot)
    goal = await send(client, action, 0)
    reason = str(await client.next("failure", goal))
    assert "reject" in reason


@senders
async def test_several_goals_at_once_keep_apart(client: Connection, robot: Robot):
    action = await provide(client, robot)
    endless = await send(client, action, ENDLESS)
    goals = {order: await send(client, action, order) for order in (1, 2, 3, 4)}
    for order, goal in goals.items():
        assert len(sequence_of(client, await client.next("result", goal))) == order + 1
    await client.do("cancel_goal", action=action, goal_id=endless)
    kind = "failure" if client.library.is_javascript else "result"
    await client.next(kind, endless)


@providers
async def test_cancelling_all_goals_cancels_each(client: Connection, robot: Robot):
    action = await provide(client, robot)
    goals = [await send(client, action, ENDLESS) for _ in range(3)]
    for goal in goals:
        await client.next("feedback", goal)
    await client.do("cancel_all_goals", action=action, type_name=FIBONACCI)
    for goal in goals:
        assert "Action was canceled" in await client.next("failure", goal)
    # it names no id to answer to, and then complains about the lack of one
    assert client.driver.take("warning") in ([], ["Received service response without ID"])


@providers
async def test_a_robot_gets_feedback_and_result_from_a_client(client: Connection, robot: Robot):
    action = client.own("provided")
    await client.do("advertise_action", action=action, type_name=FIBONACCI)
    fed: list[Any] = []
    sender = await robot.action_client(action)
    sent = sender.send_goal_async(Fibonacci.Goal(order=2), lambda m: fed.append(m.feedback))
    goal = await client.next("goal", action)
    assert goal["goal"] == {"order": 2}
    accepted = await result(sent)
    assert accepted.accepted
    about = {"action": action, "goal_id": goal["id"]}
    await client.do("send_feedback", **about, values={"sequence": [0, 1]})
    await client.do("succeed", **about, values={"sequence": [0, 1, 1]})
    ended = await result(accepted.get_result_async())
    assert ended.status == GoalStatus.STATUS_SUCCEEDED
    assert ended.result == Fibonacci.Result(sequence=[0, 1, 1])
    await eventually(lambda: fed == [Fibonacci.Feedback(sequence=[0, 1])])


@providers
async def test_a_robot_cancels_a_goal_at_a_client(client: Connection, robot: Robot):
    action = client.own("provided")
    await client.do("advertise_action", action=action, type_name=FIBONACCI)
    sender = await robot.action_client(action)
    sent = sender.send_goal_async(Fibonacci.Goal(order=2))
    goal = await client.next("goal", action)
    accepted = await result(sent)
    canceling = accepted.cancel_goal_async()
    assert await client.next("cancel", action) == goal["id"]
    await client.do("end_as_canceled", action=action, goal_id=goal["id"], values={"sequence": [0]})
    ended = await result(accepted.get_result_async())
    assert ended.status == GoalStatus.STATUS_CANCELED
    assert ended.result == Fibonacci.Result(sequence=[0])
    assert len((await result(canceling)).goals_canceling) == 1


@providers
async def test_a_goal_that_fails_at_a_client_is_aborted(client: Connection, robot: Robot):
    action = client.own("provided")
    await client.do("advertise_action", action=action, type_name=FIBONACCI)
    sender = await robot.action_client(action)
    sent = sender.send_goal_async(Fibonacci.Goal(order=2))
    goal = await client.next("goal", action)
    await client.do("fail", action=action, goal_id=goal["id"])
    ended = await result((await result(sent)).get_result_async())
    assert ended.status == GoalStatus.STATUS_ABORTED


@providers
async def test_an_action_is_gone_from_the_graph_after_unadvertise(client: Connection, robot: Robot):
    action = client.own("provided")
    await client.do("advertise_action", action=action, type_name=FIBONACCI)
    sender = await robot.action_client(action)
    await client.do("unadvertise_action", action=action)
    await eventually(lambda: not sender.server_is_ready())
