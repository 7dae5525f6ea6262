# SPDX-License-Identifier: Apache-2.0
"""The ROS graph as discovery knows it, and notice of its changes.

rcl has a guard condition that it triggers when discovery learns something. Waiting for it costs
nothing while nothing happens and wakes within a millisecond. rclpy does not expose it,
`gateway.sources.rclpy.GraphWaitSet` does.
"""

import asyncio
import contextlib
import logging
import threading
from collections import defaultdict
from collections.abc import Callable, Container, Iterable, Iterator, Mapping
from time import perf_counter
from typing import Any, Final

from rclpy.action.graph import get_action_server_names_and_types_by_node
from rclpy.node import Node

from gateway.sources.graph import Graph, ServerInfo, TopicInfo
from gateway.sources.node_definitions import TypeHolder
from gateway.sources.qos import UNKNOWN_NODE, Endpoint, is_latched, is_matched
from gateway.sources.rclpy.errors import REFUSALS
from gateway.sources.rclpy.profile import endpoint_node, full_name, to_endpoint
from gateway.sources.rclpy.rclpy_private.readiness import GraphWaitSet
from gateway.sources.rclpy.rclpy_private.takes import GUID_BYTES
from gateway.sources.source import Qos

# A new node causes dozens of changes within a few milliseconds: look once they are over. Far below
# the 100 ms in which a subscription is to follow its publishers.
SETTLE_S: Final = 0.02
# Handling a change costs loop time for every subscription. Because of this pause a client that
# advertises and unadvertises all the time takes a tenth of the loop at most.
SETTLES_PER_HANDLING: Final = 10
# 1000 subscriptions need about a quarter of it. A longer time means that the machine stood still
MAX_SETTLE_S: Final = 1.0
AGAIN_S: Final = 1.0  # after an error of rcl: it must not fill the log

_PARTICIPANT_DIGITS: Final = 24
_BEHIND_ACTION: Final = "/_action/"  # in the names of an action's topics and services
_SEND_GOAL: Final = f"{_BEHIND_ACTION}send_goal"  # behind the name of an action, and of its type
_SEND_GOAL_TYPE: Final = "_SendGoal"

_logger = logging.getLogger(__name__)


def read_graph(node: Node, hidden: Mapping[str, str]) -> Graph:
    """Return the whole graph. 40 us a topic and direction, so keep it until it changes.

    The nodes *hidden* are left out. Each has a node that has its publishers instead, or none.
    """
    topics = tuple(
        TopicInfo(
            name,
            tuple(sorted(types)),
            publishers=_shown(publishers, hidden),
            subscribers=_nodes(node.get_subscriptions_info_by_topic(name)),
            is_latched=is_latched(list(map(to_endpoint, publishers))),
        )
        for name, types, publishers in _published(node)
    )
    shown = tuple(sorted(each for each in read_nodes(node) if each not in hidden))
    return Graph(topics, shown, read_services(node), read_actions(node))


def _published(node: Node) -> Iterator[tuple[str, list[str], list[Any]]]:
    """Yield the topics with their types and publishers, except those of actions."""
    for name, types in sorted(node.get_topic_names_and_types()):
        if _BEHIND_ACTION not in name:
            yield name, types, node.get_publishers_info_by_topic(name)


def read_nodes(node: Node) -> list[str]:
    """Return the full names of all nodes. A name that several have is there as often."""
    found = node.get_node_names_and_namespaces()
    return [full_name(namespace, name) for name, namespace in found]


def read_services(node: Node) -> tuple[ServerInfo, ...]:
    """Return the services that nodes provide, except those of actions. 7 us a node."""
    return tuple(each for each in read_all_services(node) if _BEHIND_ACTION not in each.name)


def read_all_services(node: Node) -> tuple[ServerInfo, ...]:
    """Return the services that nodes provide, including those of actions.

    Of nodes that share their name rcl lists those of one alone, and one that was killed may be that
    one. The services of the others are in rcl's list of all services. That has no nodes, but also
    names that only a client uses, so their servers are counted.
    """
    listed = _provided(node, lambda *each: node.get_service_names_and_types_by_node(*each))
    found = {each.name: each for each in listed}
    for name, types in node.get_service_names_and_types():
        if name not in found and node.count_services(name):
            found[name] = ServerInfo(name, tuple(sorted(types)), ())
    return tuple(found[name] for name in sorted(found))


def read_actions(node: Node) -> tuple[ServerInfo, ...]:
    """Return the actions that nodes provide. 3 us a node, and what the list of services takes."""
    listed = _provided(node, lambda *each: get_action_server_names_and_types_by_node(node, *each))
    found = {each.name: each for each in listed}
    for service in read_all_services(node):
        name = service.name.removesuffix(_SEND_GOAL)
        if name != service.name and name not in found:
            types = tuple(each.removesuffix(_SEND_GOAL_TYPE) for each in service.types)
            found[name] = ServerInfo(name, types, service.nodes)
    return tuple(found[name] for name in sorted(found))


def read_types(
    node: Node, topic: str, own_nodes: Container[str], hidden: str, publishing: Node
) -> tuple[str, ...]:
    """Return the types of a topic as `gateway.sources.source.Source.topic_types` describes it.

    The node *hidden* does not count. *publishing* has the gateway's own publishers of the topic.
    """
    publishers = publishing.get_publishers_info_by_topic(topic)
    endpoints = [each for each in publishers if endpoint_node(each) != hidden]
    if not endpoints:
        subscribers = node.get_subscriptions_info_by_topic(topic)
        others = [each for each in subscribers if endpoint_node(each) not in own_nodes]
        endpoints = others or subscribers
    return tuple(sorted({endpoint.topic_type for endpoint in endpoints}))


def read_offers(node: Node, topic: str) -> list[Endpoint]:
    """Return what the publishers of a topic offer, of any type."""
    return [to_endpoint(publisher) for publisher in node.get_publishers_info_by_topic(topic)]


def read_repairing(node: Node, topic: str, qos: Qos) -> frozenset[bytes]:
    """Return the ids of the publishers that send again what a reader of this profile has lost.

    The ids are as samples have them.
    """
    if qos.reliability != "reliable":
        return frozenset()
    infos = node.get_publishers_info_by_topic(topic)
    return frozenset(
        bytes(each.endpoint_gid[:GUID_BYTES])  # Humble's are longer
        for each in infos
        if is_matched(qos, to_endpoint(each))
    )


def read_participants(node: Node, nodes: Container[str]) -> frozenset[str]:
    """Return the beginning that the ids of all endpoints of some nodes have in common.

    By it they are known before their names are, where discovery has just begun.
    """
    infos = node.get_publishers_info_by_topic("/parameter_events")  # which each node has
    found = (_id(each) for each in infos if endpoint_node(each) in nodes)
    return frozenset(each[:_PARTICIPANT_DIGITS] for each in found)


def read_readers(
    node: Node,
    topic: str,
    own_nodes: Container[str] = (),
    own_participants: Container[str] = (),
) -> frozenset[str]:
    """Return the ids of the subscriptions to a topic, except the gateway's own."""
    return frozenset(
        _id(each)
        for each in node.get_subscriptions_info_by_topic(topic)
        if endpoint_node(each) not in own_nodes
        and _id(each)[:_PARTICIPANT_DIGITS] not in own_participants
    )


def read_requests(node: Node, topic: str) -> list[Endpoint]:
    """Return what the subscriptions to a topic ask for, of any type."""
    return [to_endpoint(each) for each in node.get_subscriptions_info_by_topic(topic)]


def read_holders(
    node: Node, topic: str, type_name: str, own_nodes: Container[str]
) -> tuple[TypeHolder, ...]:
    """Return the nodes that have a type, publishers first, without those that show no hash."""
    endpoints = [*read_offers(node, topic), *read_requests(node, topic)]
    return tuple(
        dict.fromkeys(
            TypeHolder("" if each.node == UNKNOWN_NODE else each.node, each.type_hash)
            for each in endpoints
            if each.type_name == type_name and each.type_hash and each.node not in own_nodes
        )
    )


class GraphChanges:
    """A thread that calls *on_change* on the loop's thread soon after the graph has changed.

    Changes within `SETTLE_S`, or within `SETTLES_PER_HANDLING` times what the last call took, are
    one call.
    """

    def __init__(
        self, node: Node, loop: asyncio.AbstractEventLoop, on_change: Callable[[], None]
    ) -> None:
        self._context = node.context
        self._loop = loop
        self._on_change = on_change
        self._settle_s = SETTLE_S
        self._is_reported = False
        self._stopping = threading.Event()
        self._wait_set = GraphWaitSet(node)
        self._thread = threading.Thread(target=self._look, name="ros_graph", daemon=True)
        self._thread.start()

    @property
    def is_alive(self) -> bool:
        """True until the thread ends."""
        return self._thread.is_alive()

    def close(self) -> None:
        """End the thread. No call comes after."""
        self._on_change = _nothing
        self._stopping.set()
        self._wait_set.wake()
        self._thread.join()
        self._wait_set.close()

    def _look(self) -> None:
        while not self._stopping.is_set():
            try:
                self._wait()
            except REFUSALS:
                _logger.exception("waiting for graph changes failed, trying again in %g s", AGAIN_S)
                if not self._context.ok():  # nothing changes any more. The port says so
                    return
                self._stopping.wait(AGAIN_S)
                self._report()  # changes from before the next wait

    def _wait(self) -> None:
        with self._wait_set.opened() as wait:
            wait()
            while not self._stopping.wait(self._settle_s):
                wait(timeout_ns=0)  # later events are part of this change
                # This wake may have been that of close(), which sets the event before.
                if self._stopping.is_set():
                    return
                self._report()
                wait()

    def _report(self) -> None:
        if not self._is_reported:  # on a busy loop one call waits, not one for each change
            self._is_reported = True
            self._loop.call_soon_threadsafe(self._handle)

    def _handle(self) -> None:
        self._is_reported = False
        began = perf_counter()
        self._on_change()  # through self: after close() a call that is scheduled does nothing
        took = perf_counter() - began
        self._settle_s = min(max(SETTLE_S, SETTLES_PER_HANDLING * took), MAX_SETTLE_S)


def _nodes(endpoints: list[Any]) -> tuple[str, ...]:
    return tuple(sorted(endpoint_node(endpoint) for endpoint in endpoints))


def _shown(publishers: list[Any], hidden: Mapping[str, str]) -> tuple[str, ...]:
    return tuple(sorted(filter(None, (hidden.get(each, each) for each in _nodes(publishers)))))


def _id(endpoint: Any) -> str:
    return bytes(endpoint.endpoint_gid).hex()


def _provided(
    node: Node, read: Callable[[str, str], Iterable[tuple[str, list[str]]]]
) -> tuple[ServerInfo, ...]:
    types: dict[str, set[str]] = defaultdict(set)
    nodes: dict[str, list[str]] = defaultdict(list)
    for name, namespace in node.get_node_names_and_namespaces():
        with contextlib.suppress(RuntimeError):  # the node has gone since, or has no name yet
            for each, its_types in read(name, namespace):
                types[each].update(its_types)
                nodes[each].append(full_name(namespace, name))
    return tuple(
        ServerInfo(each, tuple(sorted(types[each])), tuple(sorted(nodes[each])))
        for each in sorted(types)
    )


def _nothing() -> None:
    """Replace the callback after closing."""
