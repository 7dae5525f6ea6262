# SPDX-License-Identifier: Apache-2.0
"""A client of actions, with their packages or without, which sees all that comes."""

from types import MappingProxyType

from action_msgs.msg import GoalStatusArray
from action_msgs.srv import CancelGoal
from rclpy.qos import QoSProfile, qos_profile_action_status_default

from gateway.codec.cdr import compile_decoder, compile_encoder
from gateway.sources.goal_ids import without_goal_id
from gateway_sim.goal_server import MAX_WAITING
from schemas.folders import SHIPPED
from schemas.installed import InstalledDefinitions

DEFINITIONS = InstalledDefinitions(folders=[SHIPPED])


class Asking:
    """A client of an action whose server is also in this process. *poll* lets that answer."""

    def __init__(self, watcher, type_name, form, name, poll):
        self.watcher = watcher
        self.form = form
        self.poll = poll
        parts = DEFINITIONS.interface(type_name, "action").parts
        self._encode_goal = compile_encoder(parts["goal"], DEFINITIONS)
        self._decode_feedback = compile_decoder(parts["feedback"], DEFINITIONS)
        node = watcher.node
        part = f"{name}/_action/"
        self._goals = node.create_client(self.form.send_goal, f"{part}send_goal")
        self._results = node.create_client(
            self.form.get_result,
            f"{part}get_result",
            qos_profile=QoSProfile(depth=2 * MAX_WAITING),
        )
        self._cancels = node.create_client(CancelGoal, f"{part}cancel_goal")
        self.statuses = watcher.subscribe(
            GoalStatusArray, f"{part}status", qos_profile_action_status_default
        )
        self._feedback = watcher.subscribe(self.form.feedback, f"{part}feedback", raw=True)
        for each in (self._goals, self._results, self._cancels):
            watcher.until(each.service_is_ready, what="the action")

    def until(self, condition):
        self.watcher.until(condition, self.poll)

    def ask(self, client, request):
        future = client.call_async(request)
        self.until(future.done)
        return future.result()

    def goal(self, number, values=MappingProxyType({})):
        """Send a goal. Return whether it was accepted."""
        return self.is_accepted(
            self.form.to_goal_request(goal_id(number), self._encode_goal(dict(values), 0))
        )

    def is_accepted(self, request):
        return self.form.is_accepted(self.ask(self._goals, request))

    def ask_result(self, number):
        return self._results.call_async(self.form.to_result_request(goal_id(number)))

    def result(self, number):
        """Return the status that comes with a result."""
        future = self.ask_result(number)
        self.until(future.done)
        return self.form.read_result_response(future.result())[0]

    def cancel(self, wanted, nanoseconds=0):
        request = CancelGoal.Request()
        request.goal_info.goal_id.uuid = list(wanted)
        stamp = request.goal_info.stamp
        stamp.sec, stamp.nanosec = divmod(nanoseconds, 10**9)
        return self.ask(self._cancels, request)

    def feedback(self):
        return [
            (bytes(each[4:20]), self._decode_feedback(without_goal_id(each)))
            for each in self._feedback
        ]

    def status(self, number):
        """Return the status that was published last for a goal, ``None`` if it is forgotten."""
        last = self.statuses[-1].status_list if self.statuses else []
        known = {bytes(each.goal_info.goal_id.uuid): each for each in last}
        found = known.get(goal_id(number))
        return None if found is None else found.status


def goal_id(number):
    return number.to_bytes(16, "big")
