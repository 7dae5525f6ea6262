# SPDX-License-Identifier: Apache-2.0
"""Actions that clients provide."""

from typing import Any

import pytest

from gateway.sources.actions import ABORTED, CANCELED, SUCCEEDED
from tests.client import Frame, eventually
from tests.core.conftest import FIBONACCI, LIMITS, Bench, Socketless
from tests.sources.fake_actions import FakeGoal


class Person:
    """A ROS node that sends goals to ``/fib``."""

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        self.client = bench.ros.add_action_client("/fib", FIBONACCI)
        self.feedback: list[Any] = []

    async def sends(self, order: int = 3) -> FakeGoal:
        goal = await self.client.send_goal(
            self.bench.cdr(f"{FIBONACCI}_Goal", order=order), self.feedback.append
        )
        assert goal is not None
        return goal

    async def result(self, goal: FakeGoal) -> tuple[int, list[int]]:
        status, cdr = await goal.result()
        return status, list(self.bench.types.get(f"{FIBONACCI}_Result").decode(cdr)["sequence"])


def provider(bench: Bench) -> Socketless:
    client = bench.sender(op="advertise_action", action="fib", type="test_msgs/Fibonacci")
    assert not client.statuses
    return client


async def goal_of(client: Socketless, count: int = 1) -> Frame:
    return (await client.sees(count, "send_action_goal"))[count - 1]


async def asked(bench: Bench) -> tuple[Socketless, Person, FakeGoal, Frame]:
    """Return a provider that has got the goal of a person."""
    client, person = provider(bench), Person(bench)
    goal = await person.sends()
    return client, person, goal, await goal_of(client)


async def test_a_goal_goes_to_the_client_and_feedback_and_result_back(bench: Bench) -> None:
    client, person, goal, frame = await asked(bench)
    assert frame["id"].startswith("action_goal:/fib:")
    assert frame == {
        "op": "send_action_goal",
        "id": frame["id"],
        "action": "fib",
        "action_type": "test_msgs/Fibonacci",
        "args": {"order": 3},
        "feedback": True,
    }
    values = {"sequence": [0, 1]}
    client.send(op="action_feedback", id=frame["id"], action="fib", values=values)
    await eventually(lambda: bool(person.feedback))
    decode = bench.types.get(f"{FIBONACCI}_Feedback").decode
    assert list(decode(person.feedback[0])["sequence"]) == [0, 1]
    values = {"sequence": [0, 1, 1]}
    client.send(
        op="action_result", id=frame["id"], action="fib", values=values, status=4, result=True
    )
    assert await person.result(goal) == (SUCCEEDED, [0, 1, 1])
    await eventually(lambda: bench.router.counts()["goals"] == 0)


@pytest.mark.parametrize(
    ("end", "outcome"),
    [
        ({"values": {"sequence": [1]}, "result": True}, (SUCCEEDED, [1])),
        ({"values": {"sequence": [1]}, "result": False}, (ABORTED, [1])),
        ({"values": {"sequence": [1]}, "status": 6, "result": True}, (ABORTED, [1])),
        ({"result": False}, (ABORTED, [])),
        ({"values": "the arm is jammed", "result": False}, (ABORTED, [])),
        ({"values": {"sequence": [1]}, "status": 5}, (ABORTED, [1])),  # nobody wanted to cancel
    ],
)
async def test_a_result_may_leave_out_what_old_clients_leave_out(
    bench: Bench, end: dict[str, Any], outcome: tuple[int, list[int]]
) -> None:
    client, person, goal, frame = await asked(bench)
    client.send(op="action_result", id=frame["id"], action="fib", **end)
    assert await person.result(goal) == outcome


async def test_cancelling_reaches_the_client_which_says_when(bench: Bench) -> None:
    client, person = provider(bench), Person(bench)
    await person.sends()
    goal = await person.sends()
    frame = await goal_of(client, 2)
    goal.cancel()
    assert await client.sees(1, "cancel_action_goal") == [
        {"op": "cancel_action_goal", "id": frame["id"], "action": "fib"}
    ]
    client.send(op="action_result", id=frame["id"], action="fib", values={}, status=5)
    assert await person.result(goal) == (CANCELED, [])
    (provided,) = bench.router._actions._provided.values()
    assert len(provided.goals) == 1
    assert not provided.canceling


async def test_a_result_that_does_not_fit_is_refused_and_aborts_the_goal(bench: Bench) -> None:
    client, person, goal, frame = await asked(bench)
    client.send(op="action_result", id=frame["id"], action="fib", values={"sequence": ["1"]})
    assert client.of("status")[0]["code"] == "invalid_value"
    assert await person.result(goal) == (ABORTED, [])


@pytest.mark.parametrize(
    ("operation", "code", "words"),
    [
        ({"op": "action_result", "id": "x"}, "not_found", "no goal of /fib with id 'x'"),
        ({"op": "action_feedback", "id": "x"}, "not_found", "no goal of /fib with id 'x'"),
        ({"op": "action_result", "status": 2}, "bad_request", "expected 4 (succeeded), 5"),
        ({"op": "action_feedback", "values": {"x": 1}}, "invalid_value", "values.x: unknown"),
        ({"op": "action_feedback", "values": {}, "action": "/fob"}, "not_found", "not provided"),
    ],
)
async def test_mistakes_of_a_provider_are_answered_and_harm_nothing(
    bench: Bench, operation: dict[str, Any], code: str, words: str
) -> None:
    client, person, goal, frame = await asked(bench)
    client.send(**{"id": frame["id"], "action": "fib", **operation})
    assert client.statuses[0][0] == code
    assert words in client.statuses[0][1]
    client.send(op="action_result", id=frame["id"], action="fib", values={}, status=4)
    assert await person.result(goal) == (SUCCEEDED, [])


async def test_a_provider_that_leaves_aborts_its_goals(bench: Bench) -> None:
    client, person = provider(bench), Person(bench)
    goal = await person.sends()
    await goal_of(client)
    bench.router.leave(client.session)
    assert await person.result(goal) == (ABORTED, [])
    assert bench.ros.entity_count() == 0


async def test_the_newest_provider_wins_and_the_former_is_told(bench: Bench) -> None:
    former, person = provider(bench), Person(bench)
    goal = await person.sends()
    newest = provider(bench)
    assert await person.result(goal) == (ABORTED, [])
    assert "another client now" in former.of("status")[0]["msg"]
    await person.sends()
    await goal_of(newest)
    former.send(op="unadvertise_action", action="fib")
    assert former.of("status")[-1]["code"] == "not_found"
    newest.send(op="unadvertise_action", action="fib")
    assert bench.ros.entity_count() == 0


async def test_a_client_provides_so_many_actions_and_no_more(bench: Bench) -> None:
    client = bench.client()
    for number in range(LIMITS.max_advertisements + 1):
        client.send(op="advertise_action", action=f"/fib{number}", type="test_msgs/Fibonacci")
    assert [code for code, _ in client.statuses] == ["limit_exceeded"]


async def test_a_take_over_by_another_type_is_refused_and_the_action_stays(bench: Bench) -> None:
    former, other, person = provider(bench), bench.client(), Person(bench)
    other.send(op="advertise_action", action="/fib", type="test_msgs/NestedMessage")
    assert other.of("status")[0]["code"] == "type_conflict"
    await person.sends()
    await goal_of(former)


async def test_a_goal_that_does_not_fit_its_type_is_aborted(bench: Bench) -> None:
    client, person = provider(bench), Person(bench)
    goal = await person.client.send_goal(b"\0\1\0\0", person.feedback.append)
    assert goal is not None
    assert await person.result(goal) == (ABORTED, [])
    assert not client.of("send_action_goal")


@pytest.mark.parametrize(
    ("is_cancelled", "result", "why"),
    [
        (False, True, "nobody asked to cancel the goal"),
        (False, False, "nobody asked to cancel the goal"),
        (True, False, "result is false"),
    ],
)
async def test_a_status_that_is_not_honoured_is_told(
    bench: Bench, is_cancelled: bool, result: bool, why: str
) -> None:
    client, person, goal, frame = await asked(bench)
    if is_cancelled:
        goal.cancel()
        await client.sees(1, "cancel_action_goal")
    end = {"op": "action_result", "id": frame["id"], "action": "fib", "status": 5}
    client.send(**end, values={"sequence": [1]}, result=result)
    assert await person.result(goal) == (ABORTED, [1])
    text = f"status: {why}, so it ends as aborted (6), not canceled (5)"
    assert client.statuses == [("bad_request", text)]


async def test_a_goal_that_was_to_be_cancelled_ends_so_without_a_word(bench: Bench) -> None:
    client, person, goal, frame = await asked(bench)
    goal.cancel()
    await client.sees(1, "cancel_action_goal")
    end = {"op": "action_result", "id": frame["id"], "action": "fib", "status": 5}
    client.send(**end, values={"sequence": [1]}, result=True)
    assert await person.result(goal) == (CANCELED, [1])
    assert client.statuses == []


async def test_an_action_that_a_node_provides_gets_a_warning_and_is_provided(bench: Bench) -> None:
    bench.ros.add_action_server(
        "/fib", FIBONACCI, lambda goal: None, lambda goal: None, node="/robot"
    )
    client = bench.sender(op="advertise_action", action="fib", type=FIBONACCI)
    ((code, text),) = client.statuses
    assert code == "already_provided"
    assert text.startswith("action /fib is also provided by /robot, ")
    assert bench.router.counts()["action_servers"] == 1


async def test_an_action_that_is_taken_over_gets_no_such_warning(bench: Bench) -> None:
    provider(bench)
    provider(bench)
