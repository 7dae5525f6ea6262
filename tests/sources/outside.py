# SPDX-License-Identifier: Apache-2.0
"""The rest of the robot: a node with a separate context in this process, by plain rclpy."""

from collections.abc import Callable, Sequence
from typing import Any

from rclpy.context import Context
from rclpy.node import Node

from gateway.sources.actions import GoalRequest
from gateway.sources.qos import adopt, complete_offer
from gateway.sources.rclpy.executor import ExecutorThread
from gateway.sources.rclpy.interfaces import message_class
from gateway.sources.rclpy.made_types.classes import MadeTypes
from gateway.sources.rclpy.profile import to_profile
from gateway.sources.services import ServiceRequest
from gateway.sources.source import Qos, Sample
from schemas.definition_text import parse_definition
from schemas.installed import InstalledDefinitions
from tests.sources.nodes import open_node
from tests.sources.outside_actions import (
    ACTION_SERVICES,
    OutsideActionClient,
    OutsideActionServer,
)
from tests.sources.outside_services import OutsideClient, OutsideService


class OutsidePublisher:
    """A publisher that the gateway does not know of but through discovery."""

    def __init__(self, node: Node, topic: str, type_name: str, qos: Qos) -> None:
        self._node = node
        found = message_class(type_name)
        self._publisher = node.create_publisher(found, topic, to_profile(complete_offer(qos)))

    @property
    def subscribers(self) -> int:
        """The number of subscriptions that it is matched with: a volatile sample goes to these."""
        return int(self._publisher.get_subscription_count())

    def publish(self, cdr: bytes) -> None:
        self._publisher.publish(cdr)

    def close(self) -> None:
        self._node.destroy_publisher(self._publisher)


class Outside:
    """One participant with one spun node, ``/outside`` unless named. Some never answer."""

    def __init__(self, name: str = "outside", *, answers: bool = True) -> None:
        self.context = Context()
        self.context.init(args=["--ros-args", "--disable-stdout-logs"])
        self.node = open_node(name, self.context, start_parameter_services=False)
        # The standard one: that of the product must not vouch for itself.
        self._executor = ExecutorThread(self.context, standard=True)
        if answers:
            self._executor.add_node(self.node)
        # triggered, it has the executor look at everything once more
        self._guard = self.node.create_guard_condition(lambda: None)
        self._actions: list[OutsideActionClient | OutsideActionServer] = []
        # whether a server has discovered the clients of a service. The process that has the server
        # can tell
        self.is_known: Callable[[str], bool] = lambda service: True

    def add_publisher(self, topic: str, type_name: str, qos: Qos | None = None) -> OutsidePublisher:
        return OutsidePublisher(self.node, topic, type_name, qos or Qos())

    def add_described_publisher(self, topic: str, type_name: str, text: str) -> Any:
        """Publish a type that no other process has a file of. Its node has the definition."""
        told = {type_name: parse_definition(type_name, text)}
        definitions = InstalledDefinitions().with_told(told)
        made = MadeTypes().get(told[type_name], definitions)
        return self.node.create_publisher(made, topic, 10)

    def add_subscription(
        self,
        topic: str,
        type_name: str,
        on_samples: Callable[[Sequence[Sample]], None],
        qos: Qos | None = None,
    ) -> Any:
        def arrive(cdr: Any) -> None:
            on_samples([Sample(cdr, 0)])

        return self.node.create_subscription(
            message_class(type_name),
            topic,
            arrive,
            to_profile(adopt(qos or Qos(), ())),
            raw=True,
        )

    def remove_subscription(self, subscription: Any) -> None:
        self.node.destroy_subscription(subscription)
        self._guard.trigger()  # else it lasts as long as the wait of the executor

    def add_client(self, name: str, type_name: str) -> OutsideClient:
        return OutsideClient(self.node, name, type_name, lambda: self.is_known(name))

    def add_service(
        self,
        name: str,
        type_name: str,
        on_request: Callable[[ServiceRequest], None],
        depth: int = 10,  # that of ROS
    ) -> OutsideService:
        return OutsideService(self.node, self._guard.trigger, name, type_name, on_request, depth)

    def add_action_client(self, name: str, type_name: str) -> OutsideActionClient:
        services = [f"{name}/_action/{one}" for one in ACTION_SERVICES]
        client = OutsideActionClient(
            self.node, name, type_name, lambda: all(map(self.is_known, services))
        )
        self._actions.append(client)
        return client

    def add_action_server(
        self,
        name: str,
        type_name: str,
        on_goal: Callable[[GoalRequest], None],
        on_cancel: Callable[[GoalRequest], None],
        accepts: Callable[[bytes], bool] = lambda goal: True,
    ) -> OutsideActionServer:
        server = OutsideActionServer(
            self.node, self._guard.trigger, name, type_name, on_goal, on_cancel, accepts
        )
        self._actions.append(server)
        return server

    def close(self) -> None:
        self._executor.close()
        for each in self._actions:  # a node does not take these along
            each.close()
        self.node.destroy_node()
        self.context.try_shutdown()
        self.context.destroy()
