# SPDX-License-Identifier: Apache-2.0
"""An action with one goal at a time, as other nodes find it, with or without its package."""

import pytest
from action_msgs.msg import GoalStatus
from action_msgs.srv import CancelGoal

from gateway_sim.any_types import AnyTypes
from gateway_sim.goal_server import MAX_KEPT, MAX_WAITING, GoalServer
from gateway_sim.navigator import NAVIGATE
from schemas.installed import InstalledDefinitions
from tests import interfaces
from tests.gateway_sim.asking import Asking, goal_id
from tests.gateway_sim.ros import Watcher

FOLLOW = "idl_msgs/action/Follow"
HAS_FOLLOW = bool(InstalledDefinitions().names(["idl_msgs"]))
SUCCEEDED, CANCELED, ABORTED = 4, 5, 6
NOTHING = bytes(16)


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(NAVIGATE, id="not installed"),
        pytest.param(
            FOLLOW,
            id="installed",
            marks=pytest.mark.skipif(not HAS_FOLLOW, reason=interfaces.HOW),
        ),
    ],
)
def type_name(request):
    return request.param


@pytest.fixture(scope="module")
def action(type_name):
    types = AnyTypes([type_name])
    while not types.poll():
        pass
    return types.action(type_name)


@pytest.fixture
def watcher():
    watcher = Watcher("asking")
    yield watcher
    watcher.close()


class Served(Asking):
    """The client, with the server."""

    def __init__(self, watcher, type_name, action):
        self.begun = []
        self.refusal = None
        node = watcher.node
        self.server = GoalServer(node.context, node, "act", action, self._begin, {})
        super().__init__(watcher, type_name, action.form, "act", self.server.poll)

    def _begin(self, goal):
        if self.refusal is not None:
            raise ValueError(self.refusal)
        self.begun.append(goal)


@pytest.fixture
def asking(watcher, type_name, action):
    served = Served(watcher, type_name, action)
    yield served
    served.server.close()


def test_a_goal_is_accepted_reports_and_succeeds(asking):
    assert not asking.server.is_executing
    assert asking.goal(1)
    assert len(asking.begun) == 1
    assert asking.server.is_executing
    result = asking.ask_result(1)
    asking.watcher.until(
        asking.feedback, lambda: (asking.server.poll(), asking.server.feed_back({})), "feedback"
    )
    assert asking.feedback()[0][0] == goal_id(1)
    assert not result.done()
    asking.server.finish(SUCCEEDED, {"no such field": 1})
    asking.until(result.done)
    assert asking.form.read_result_response(result.result())[0] == SUCCEEDED
    assert asking.result(1) == SUCCEEDED, "who asks late gets it, too"
    asking.until(lambda: asking.statuses and asking.status(1) == SUCCEEDED)
    assert not asking.server.is_executing


def test_a_goal_that_cannot_begin_is_rejected_and_the_one_before_goes_on(asking):
    assert asking.goal(1)
    asking.refusal = "for a reason"
    assert not asking.goal(2)
    assert asking.server.is_executing
    assert asking.result(2) == GoalStatus.STATUS_UNKNOWN
    asking.server.finish(SUCCEEDED, {})
    assert asking.result(1) == SUCCEEDED


def test_a_newer_goal_aborts_the_one_before(asking):
    assert asking.goal(1)
    first = asking.ask_result(1)
    assert asking.goal(2)
    asking.until(first.done)
    assert asking.form.read_result_response(first.result())[0] == ABORTED
    asking.server.finish(SUCCEEDED, {})
    assert asking.result(2) == SUCCEEDED


def test_an_id_is_taken_once(asking):
    assert asking.goal(1)
    assert not asking.goal(1)
    asking.server.finish(SUCCEEDED, {})
    assert not asking.goal(1)
    assert len(asking.begun) == 1


def test_a_goal_is_canceled_by_its_id(asking):
    assert asking.goal(1)
    unknown = asking.cancel(goal_id(7))
    assert unknown.return_code == CancelGoal.Response.ERROR_UNKNOWN_GOAL_ID
    assert not asking.server.is_canceling
    answer = asking.cancel(goal_id(1))
    assert answer.return_code == CancelGoal.Response.ERROR_NONE
    assert [bytes(each.goal_id.uuid) for each in answer.goals_canceling] == [goal_id(1)]
    assert asking.server.is_canceling
    asking.until(lambda: asking.status(1) == GoalStatus.STATUS_CANCELING)
    assert asking.cancel(goal_id(1)).goals_canceling == [], "it is canceling already"
    asking.server.finish(CANCELED, {})
    assert asking.result(1) == CANCELED
    ended = asking.cancel(goal_id(1))
    assert ended.return_code == CancelGoal.Response.ERROR_GOAL_TERMINATED


def test_goals_are_canceled_by_time_or_all_of_them(asking):
    assert asking.goal(1)
    assert asking.cancel(NOTHING, 1).goals_canceling == []
    assert asking.cancel(NOTHING, 2**31 * 10**9 - 1).goals_canceling
    asking.server.finish(CANCELED, {})
    assert asking.goal(2)
    assert asking.cancel(NOTHING).goals_canceling


def test_the_newest_results_are_kept(asking):
    for number in range(MAX_KEPT + 2):
        assert asking.goal(number + 1)
        asking.server.finish(SUCCEEDED, {})
    assert asking.result(1) == asking.result(2) == GoalStatus.STATUS_UNKNOWN
    assert asking.result(3) == SUCCEEDED
    asking.until(lambda: asking.statuses[-1].status_list[-1].goal_info.goal_id.uuid[-1] > MAX_KEPT)
    assert len(asking.statuses[-1].status_list) == MAX_KEPT


def test_so_many_wait_for_a_result_and_more_are_answered_at_once(asking):
    assert asking.goal(1)
    waiting = []
    for _ in range(MAX_WAITING):
        waiting.append(asking.ask_result(1))
        asking.result(99)  # so that it is taken
    assert asking.result(1) == GoalStatus.STATUS_UNKNOWN
    assert not [each for each in waiting if each.done()]
    asking.server.finish(SUCCEEDED, {})
    asking.until(lambda: all(each.done() for each in waiting))


def test_a_goal_that_cannot_be_read_is_rejected(asking, type_name):
    if type_name != NAVIGATE:
        pytest.skip("rclpy throws it away")
    request = asking.form.to_goal_request(goal_id(1), b"\0\1\0\0\1")
    assert not asking.is_accepted(request)
    short = asking.form.send_goal.Request(b"\0\1\0\0\1")
    assert not asking.is_accepted(short)
    assert not asking.server.is_executing
