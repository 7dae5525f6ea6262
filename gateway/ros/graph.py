# SPDX-License-Identifier: Apache-2.0
"""What discovery knows, and word of its changes.

rcl has a guard condition that it triggers when discovery learns something. Waiting for it costs
nothing while nothing happens and wakes within a millisecond. rclpy does not expose it, two
functions of rcl's C API do; where they lack, a thread looks twice a second.
"""

import asyncio
import contextlib
import ctypes
import logging
import threading
from collections import defaultdict
from collections.abc import Callable, Container, Iterable, Iterator
from time import perf_counter
from typing import Any, Final

from rclpy.action.graph import get_action_server_names_and_types_by_node
from rclpy.guard_condition import GuardCondition
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node

from gateway.ports import Graph, ServerInfo, TopicInfo
from gateway.ros.errors import REFUSALS
from gateway.ros.profile import endpoint_node, full_name, to_offer
from gateway.ros.qos import Offer

# A new node is dozens of changes within a few milliseconds: look once they are over. Far below
# the 100 ms in which a subscription is to follow its publishers.
SETTLE_S: Final = 0.02
# Handling a change takes the loop time for every subscription: followed like this, a client that
# advertises and unadvertises without pause gets a tenth of the loop at most.
SETTLES_PER_HANDLING: Final = 10
# 1000 subscriptions take about a quarter of it; more is a machine that stood still
MAX_SETTLE_S: Final = 1.0
# 100 topics take about 1.5 ms to look at: 0.3 % of a core
POLL_S: Final = 0.5

_BEHIND_ACTION: Final = "/_action/"  # what an action is made of

_logger = logging.getLogger(__name__)


def read_graph(node: Node) -> Graph:
    """Return the whole graph; 40 us a topic and direction, so keep it until it changes."""
    topics = tuple(
        TopicInfo(
            name,
            tuple(sorted(types)),
            publishers=_nodes(node.get_publishers_info_by_topic(name)),
            subscribers=_nodes(node.get_subscriptions_info_by_topic(name)),
        )
        for name, types in sorted(node.get_topic_names_and_types())
        if _BEHIND_ACTION not in name
    )
    nodes = (full_name(namespace, name) for name, namespace in node.get_node_names_and_namespaces())
    return Graph(topics, tuple(sorted(nodes)), read_services(node), read_actions(node))


def read_services(node: Node) -> tuple[ServerInfo, ...]:
    """Return the services that nodes provide, those behind actions left out; 7 us a node.

    The list without nodes has those as well that only a client has named.
    """
    return tuple(each for each in read_all_services(node) if _BEHIND_ACTION not in each.name)


def read_all_services(node: Node) -> tuple[ServerInfo, ...]:
    """Return the services that nodes provide, those behind actions as well."""
    return _provided(node, lambda *each: node.get_service_names_and_types_by_node(*each))


def read_actions(node: Node) -> tuple[ServerInfo, ...]:
    """Return the actions that nodes provide; 3 us a node."""
    return _provided(node, lambda *each: get_action_server_names_and_types_by_node(node, *each))


def read_types(node: Node, topic: str, own_nodes: Container[str]) -> tuple[str, ...]:
    """Return the types of a topic as `gateway.ports.Ros.topic_types` describes it."""
    endpoints = node.get_publishers_info_by_topic(topic)
    if not endpoints:
        subscribers = node.get_subscriptions_info_by_topic(topic)
        others = [each for each in subscribers if endpoint_node(each) not in own_nodes]
        endpoints = others or subscribers
    return tuple(sorted({endpoint.topic_type for endpoint in endpoints}))


def read_offers(node: Node, topic: str) -> list[Offer]:
    """Return what the publishers of a topic offer, of whatever type."""
    return [to_offer(publisher) for publisher in node.get_publishers_info_by_topic(topic)]


class GraphChanges:
    """A thread that calls *on_change* on the loop's thread soon after the graph has changed.

    Changes within `SETTLE_S` are one call, or within `SETTLES_PER_HANDLING` times what the last
    call took. With *polling*, or where rcl lacks what waiting needs, it looks every `POLL_S`
    instead.
    """

    def __init__(
        self,
        node: Node,
        loop: asyncio.AbstractEventLoop,
        on_change: Callable[[], None],
        *,
        polling: bool = False,
    ) -> None:
        self._node = node
        self._loop = loop
        self._on_change = on_change
        self._settle_s = SETTLE_S
        self._is_reported = False
        self._stopping = threading.Event()
        self._wait_set = None if polling else _GraphWaitSet.create(node)
        self._thread = threading.Thread(target=self._look, name="ros_graph", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End the thread; no call comes after."""
        self._on_change = _nothing
        self._stopping.set()
        if self._wait_set is not None:
            self._wait_set.wake()
        self._thread.join()
        if self._wait_set is not None:
            self._wait_set.close()

    def _look(self) -> None:
        if self._wait_set is not None:
            try:
                self._wait(self._wait_set)
            except REFUSALS:
                _logger.exception("waiting for graph changes failed, looking every %g s", POLL_S)
                self._report()  # what has changed before the first look
            else:
                return
        self._poll()

    def _wait(self, wait_set: "_GraphWaitSet") -> None:
        with wait_set.opened() as wait:
            wait()
            while not self._stopping.wait(self._settle_s):
                wait(timeout_ns=0)  # what came meanwhile is part of this change
                # That may have been the last wake as well: close() sets the event before.
                if self._stopping.is_set():
                    return
                self._report()
                wait()

    def _poll(self) -> None:
        known = _fingerprint(self._node)
        while not self._stopping.wait(max(POLL_S, self._settle_s)):
            found = _fingerprint(self._node)
            if found != known:
                known = found
                self._report()

    def _report(self) -> None:
        if not self._is_reported:  # a busy loop has one call waiting, not one for each change
            self._is_reported = True
            self._loop.call_soon_threadsafe(self._handle)

    def _handle(self) -> None:
        self._is_reported = False
        began = perf_counter()
        self._on_change()  # through self: a call on its way finds out that this was closed
        took = perf_counter() - began
        self._settle_s = min(max(SETTLE_S, SETTLES_PER_HANDLING * took), MAX_SETTLE_S)


class _GraphWaitSet:
    """A wait set of rcl's with a node's graph guard condition in it, and one of our own."""

    def __init__(self, node: Node, graph_condition: int, add: Any) -> None:
        self._node = node
        self._context: Any = node.context  # annotated as perhaps without a handle
        self._graph_condition = graph_condition
        self._add = add
        self._wake = GuardCondition(_nothing, None, context=node.context)

    @classmethod
    def create(cls, node: Node) -> "_GraphWaitSet | None":
        """Return one, or ``None`` where rcl does not let us."""
        try:
            rcl = ctypes.CDLL("librcl.so")
            find = rcl.rcl_node_get_graph_guard_condition
            add = rcl.rcl_wait_set_add_guard_condition
        except (OSError, AttributeError):
            return None
        find.argtypes = [ctypes.c_void_p]
        find.restype = ctypes.c_void_p
        add.argtypes = [ctypes.c_void_p] * 3
        add.restype = ctypes.c_int
        with node.handle:
            condition = find(node.handle.pointer)
        return cls(node, condition, add) if condition else None

    def wake(self) -> None:
        """End the wait that is going on, or the next one; from any thread."""
        self._wake.trigger()

    def close(self) -> None:
        self._wake.destroy()

    @contextlib.contextmanager
    def opened(self) -> Iterator[Callable[..., None]]:
        """Yield a function that waits for a change; its default is without time limit."""
        with self._node.handle, self._context.handle, self._wake.handle:
            wait_set = rclpy_implementation.WaitSet(0, 2, 0, 0, 0, 0, self._context.handle)
            with wait_set:

                def wait(timeout_ns: int = -1) -> None:
                    wait_set.clear_entities()
                    wait_set.add_guard_condition(self._wake.handle)
                    code = self._add(wait_set.pointer, self._graph_condition, None)
                    if code != 0:
                        raise RuntimeError(f"rcl_wait_set_add_guard_condition returned {code}")
                    wait_set.wait(timeout_ns)

                yield wait
            wait_set.destroy_when_not_in_use()


def _nodes(endpoints: list[Any]) -> tuple[str, ...]:
    return tuple(sorted(endpoint_node(endpoint) for endpoint in endpoints))


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


def _fingerprint(node: Node) -> object:
    topics = node.get_topic_names_and_types()
    return (
        topics,
        sorted(node.get_node_names_and_namespaces()),
        [(node.count_publishers(name), node.count_subscribers(name)) for name, _ in topics],
        read_services(node),
    )


def _nothing() -> None:
    """Stand in for a callback that is not wanted any more."""
