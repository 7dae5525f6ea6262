# SPDX-License-Identifier: Apache-2.0
"""Goals that clients send to action servers."""

import json
from typing import Any

import pytest

from gateway.sources.actions import ABORTED, CANCELED, SUCCEEDED, GoalRequest
from tests.client import eventually
from tests.clock import StoppedClock
from tests.core.conftest import FIBONACCI, LIMITS, Bench, Socketless


class Fib:
    """A ROS action server ``/fib`` whose goals a test ends by hand."""

    def __init__(self, bench: Bench, **options: Any) -> None:
        self.bench = bench
        self.goals: list[GoalRequest] = []
        self.cancels: list[GoalRequest] = []
        self.server = bench.ros.add_action_server(
            "/fib", FIBONACCI, self.goals.append, self.cancels.append, **options
        )

    async def gets(self, count: int = 1) -> GoalRequest:
        await eventually(lambda: len(self.goals) >= count)
        return self.goals[count - 1]

    def feedback(self, goal: GoalRequest, *sequence: int) -> None:
        goal.feedback(self.bench.cdr(f"{FIBONACCI}_Feedback", sequence=list(sequence)))

    def finish(self, goal: GoalRequest, status: Any, *sequence: int) -> None:
        goal.finish(status, self.bench.cdr(f"{FIBONACCI}_Result", sequence=list(sequence)))


async def sent(bench: Bench, **more: bool) -> tuple[Fib, Socketless, GoalRequest]:
    """Return an action server, a client, and the goal that it has sent."""
    fib = Fib(bench)
    goal = {"id": "g", "action": "/fib", "args": [3]}
    client = bench.sender(op="send_action_goal", **goal, **more)
    return fib, client, await fib.gets()


async def test_a_goal_brings_feedback_and_a_result(bench: Bench) -> None:
    fib = Fib(bench)
    client = bench.client()
    client.send(op="send_action_goal", id="g", action="fib", args={"order": 3}, feedback=True)
    goal = await fib.gets()
    assert bench.types.get(f"{FIBONACCI}_Goal").decode(goal.cdr) == {"order": 3}
    fib.feedback(goal, 0, 1)
    assert await client.sees(1, "action_feedback") == [
        {"op": "action_feedback", "action": "fib", "values": {"sequence": [0, 1]}, "id": "g"}
    ]
    fib.finish(goal, SUCCEEDED, 0, 1, 1)
    (result,) = await client.sees(1, "action_result")
    assert result == {
        "op": "action_result",
        "action": "fib",
        "values": {"sequence": [0, 1, 1]},
        "status": 4,
        "result": True,
        "id": "g",
    }
    await eventually(lambda: bench.router.counts()["goals"] == 0)


async def test_feedback_comes_only_where_it_is_wanted(bench: Bench) -> None:
    fib, client, goal = await sent(bench)
    fib.feedback(goal, 0, 1)
    fib.finish(goal, ABORTED)
    (result,) = await client.sees(1, "action_result")
    assert (result["status"], result["result"]) == (ABORTED, True)
    assert not client.of("action_feedback")


async def test_a_client_that_reads_slowly_gets_the_newest_feedback(bench: Bench) -> None:
    fib, client, goal = await sent(bench, feedback=True)
    client.is_paused = True
    for number in range(100):
        fib.feedback(goal, number)
    await bench.settle()
    client.resume()
    last = [frame["values"]["sequence"] for frame in client.of("action_feedback")]
    assert last == [[number] for number in range(84, 100)]


async def test_of_long_feedback_256_kib_wait_for_a_client(bench: Bench) -> None:
    fib, client, goal = await sent(bench, feedback=True)
    client.is_paused = True
    for number in range(8):
        fib.feedback(goal, *[number] * 21_000)  # 82 KiB
    await bench.settle()
    client.resume()
    firsts = [frame["values"]["sequence"][0] for frame in client.of("action_feedback")]
    assert firsts == [5, 6, 7]


async def test_a_goal_is_cancelled_by_its_id(bench: Bench) -> None:
    fib = Fib(bench)
    client = bench.client()
    for name in ("one", "two"):
        client.send(op="send_action_goal", id=name, action="/fib", args=[3])
    await fib.gets(2)
    await bench.settle()
    client.send(op="cancel_action_goal", id="two", action="fib")
    await eventually(lambda: bool(fib.cancels))
    assert fib.cancels == [fib.goals[1]]
    fib.finish(fib.goals[1], CANCELED, 5)
    (result,) = await client.sees(1, "action_result")
    assert (result["id"], result["status"], result["result"]) == ("two", CANCELED, True)
    fib.finish(fib.goals[0], SUCCEEDED)
    await client.sees(2, "action_result")


async def test_a_goal_that_is_cancelled_at_once_is_cancelled_when_it_is_accepted(
    bench: Bench,
) -> None:
    fib = Fib(bench)
    client = bench.sender(op="send_action_goal", id="g", action="/fib", args=[3])
    client.send(op="cancel_action_goal", id="g", action="/fib")
    await eventually(lambda: bool(fib.cancels))
    assert not client.frames


async def test_a_rejected_goal_is_answered(bench: Bench) -> None:
    Fib(bench, accepts=lambda goal: False)
    client = bench.sender(op="send_action_goal", id="g", action="/fib", args=[3])
    (result,) = await client.sees(1, "action_result")
    assert (result["id"], result["status"], result["result"]) == ("g", 0, False)
    assert "rejected" in result["values"]


async def test_a_goal_whose_server_dies_is_answered(bench: Bench) -> None:
    fib, client, _ = await sent(bench)
    fib.server.close()
    (result,) = await client.sees(1, "action_result")
    assert (result["status"], result["result"]) == (0, False)
    assert "/fib has gone" in result["values"]


@pytest.mark.parametrize(
    ("goal", "words"),
    [
        ({"action": "/fob"}, "action /fob does not exist; did you mean /fib?"),
        ({"action": "/a b"}, "is not a valid action name"),
        (
            {"action": "/fib", "action_type": "test_msgs/NestedMessage"},
            "not test_msgs/action/N",
        ),
        ({"action": "/fib", "args": {"order": "3"}}, "args.order: expected an integer"),
        ({"action": "/fib", "feedback": 1}, "feedback: expected true or false"),
    ],
)
async def test_a_goal_that_cannot_be_sent_is_answered_with_the_reason(
    bench: Bench, goal: dict[str, Any], words: str
) -> None:
    Fib(bench)
    client = bench.sender(op="send_action_goal", id="g", **goal)
    (result,) = await client.sees(1, "action_result")
    assert (result["id"], result["action"]) == ("g", goal["action"])
    assert (result["status"], result["result"]) == (0, False)
    assert words in result["values"]


async def test_goals_of_one_client_have_different_ids_and_a_limit(bench: Bench) -> None:
    Fib(bench)
    client = bench.client()
    for number in [0, *range(LIMITS.max_goals + 1)]:
        client.send(op="send_action_goal", id=number, action="/fib", args=[3])
    refused = client.of("action_result")
    assert [frame["id"] for frame in refused] == [0, LIMITS.max_goals]
    assert "already in use" in refused[0]["values"]
    assert f"at most {LIMITS.max_goals} unfinished goals" in refused[1]["values"]


async def test_cancelling_an_unknown_goal_is_refused(bench: Bench) -> None:
    Fib(bench)
    client = bench.sender(op="cancel_action_goal", id="g", action="/fib")
    assert client.statuses == [("not_found", "no goal of /fib with id 'g' is under way")]


async def test_a_client_that_leaves_cancels_its_goals(bench: Bench) -> None:
    fib, client, _ = await sent(bench)
    await bench.settle()
    client.send(op="send_action_goal", id="h", action="/fib", args=[3])
    bench.router.leave(client.session)  # before the second is sent
    await eventually(lambda: bench.router.counts()["goals"] == 0)
    await bench.settle()
    assert fib.cancels == fib.goals
    assert len(fib.goals) == 1


async def test_a_goal_that_is_accepted_after_its_client_has_left_is_cancelled(
    bench: Bench,
) -> None:
    fib = Fib(bench)
    client = bench.sender(op="send_action_goal", id="g", action="/fib", args=[3])
    await fib.gets()  # it is sent, but the answer is not back
    bench.router.leave(client.session)
    await eventually(lambda: fib.cancels == fib.goals)
    await eventually(lambda: bench.router.counts()["goals"] == 0)


async def test_a_client_that_leaves_keeps_the_goals_that_it_said_to(bench: Bench) -> None:
    fib, client, _ = await sent(bench, keep=True)
    await bench.settle()
    bench.router.leave(client.session)
    await eventually(lambda: bench.router.counts()["goals"] == 0)
    await bench.settle()
    assert not fib.cancels
    assert fib.server.goals


async def test_feedback_that_waits_comes_before_the_result_and_is_not_lost(bench: Bench) -> None:
    fib, client, goal = await sent(bench, feedback=True)
    await bench.settle()
    client.is_paused = True
    for number in range(3):
        fib.feedback(goal, number)
    fib.finish(goal, SUCCEEDED, 9)
    await eventually(lambda: bench.router.counts()["goals"] == 0)
    client.resume()
    ops = [frame["op"] for frame in client.frames]
    assert ops == ["action_feedback"] * 3 + ["action_result"]


async def test_a_goal_leaves_nothing_in_the_outbox(bench: Bench) -> None:
    fib = Fib(bench)
    client = bench.client()
    before = len(client.session.outbox._queues)
    client.send(op="send_action_goal", id="g", action="/fib", args=[3], feedback=True)
    fib.finish(await fib.gets(), SUCCEEDED)
    await client.sees(1, "action_result")
    await eventually(lambda: bench.router.counts()["goals"] == 0)
    assert len(client.session.outbox._queues) == before


async def test_long_feedback_and_results_come_in_the_pieces_that_were_asked_for(
    bench: Bench,
) -> None:
    fib = Fib(bench)
    client = bench.client()
    options = {"feedback": True, "fragment_size": 64}
    client.send(op="send_action_goal", id="g", action="/fib", args=[3], **options)
    goal = await fib.gets()
    fib.feedback(goal, *range(40))
    await client.sees(2, "fragment")
    fib.finish(goal, SUCCEEDED, *range(40))
    await eventually(lambda: bench.router.counts()["goals"] == 0)
    wholes: dict[str, str] = {}
    for piece in client.of("fragment"):
        wholes[piece["id"]] = wholes.get(piece["id"], "") + piece["data"]
    ops = [json.loads(whole)["op"] for whole in wholes.values()]
    assert ops == ["action_feedback", "action_result"]


async def test_a_server_that_does_not_answer_a_goal_is_waited_for_a_while(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = StoppedClock(monkeypatch)
    fib = Fib(bench)
    fib.server.arrive = lambda goal: None
    client = bench.sender(op="send_action_goal", id="g", action="/fib", args=[3])
    await bench.settle()
    await clock.advance(4.99)
    assert not client.of("action_result")
    await clock.advance(0.02)
    (result,) = client.of("action_result")
    assert (result["status"], result["result"]) == (0, False)
    assert "has not answered the goal within 5 s" in result["values"]


async def test_a_goal_is_not_cancelled_by_the_name_of_another_action(bench: Bench) -> None:
    fib, client, _ = await sent(bench)
    await bench.settle()
    client.send(op="cancel_action_goal", id="g", action="/fob")
    await bench.settle()
    assert client.of("status")[0]["code"] == "not_found"
    assert not fib.cancels
