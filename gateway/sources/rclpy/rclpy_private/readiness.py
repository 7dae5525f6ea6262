# SPDX-License-Identifier: Apache-2.0
"""Readiness of entities: functions of C that are called for it, and wait sets."""

import contextlib
import ctypes
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Final, Literal

from rclpy.context import Context
from rclpy.guard_condition import GuardCondition
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node

from gateway.sources.rclpy.rclpy_private.c_functions import MissingFunctionError, rcl_function
from gateway.sources.rclpy.rclpy_private.handles import handle_of

Kind = Literal["subscription", "client", "service"]

READY_CALLBACK_SETTERS: Final[dict[Kind, str]] = {
    "subscription": "rcl_subscription_set_on_new_message_callback",
    "client": "rcl_client_set_on_new_response_callback",
    "service": "rcl_service_set_on_new_request_callback",
}
GRAPH_FUNCTIONS: Final = ("rcl_node_get_graph_guard_condition", "rcl_wait_set_add_guard_condition")


class ReadyCallbacks:
    """The C functions that count in an eventfd what becomes ready to be taken.

    The callback ``(user_data, count)`` of rcl fits libc's ``eventfd_write(fd, count)``: neither
    Python nor its GIL is part of it.
    """

    def __init__(self) -> None:
        """Find them.

        Raises:
            MissingFunctionError: rcl or libc lacks one.
        """
        self._set = {
            kind: rcl_function(name, ctypes.c_int, argument_count=3)
            for kind, name in READY_CALLBACK_SETTERS.items()
        }
        try:
            self._write = ctypes.cast(ctypes.CDLL(None).eventfd_write, ctypes.c_void_p)
        except (TypeError, AttributeError) as error:  # TypeError: CDLL(None) on Windows
            raise MissingFunctionError(str(error)) from error

    def count(self, kind: Kind, entity: Any, fd: int) -> None:
        """Add each arrival to an eventfd from now on, and at once what has arrived before."""
        self._call(kind, entity, self._write, fd)

    def stop(self, kind: Kind, entity: Any) -> None:
        """Stop counting. Once this returns no thread writes the eventfd any more."""
        self._call(kind, entity, None, None)

    def _call(self, kind: Kind, entity: Any, function: object, user_data: int | None) -> None:
        handle = handle_of(entity)
        with handle:
            code = self._set[kind](handle.pointer, function, user_data)
        if code != 0:
            raise RuntimeError(f"{READY_CALLBACK_SETTERS[kind]} returned {code}")


class GraphWaitSet:
    """A wait set of rcl with a node's graph guard condition in it, and one to wake it."""

    def __init__(self, node: Node, graph_condition: int, add: Callable[..., int]) -> None:
        self._node = handle_of(node)
        self._context = handle_of(node.context)
        self._graph_condition = graph_condition
        self._add = add
        self._wake = GuardCondition(_nothing, None, context=node.context)

    @classmethod
    def create(cls, node: Node) -> "GraphWaitSet | None":
        """Return one, or ``None`` if rcl lacks a function."""
        find_name, add_name = GRAPH_FUNCTIONS
        try:
            find = rcl_function(find_name, ctypes.c_void_p, argument_count=1)
            add = rcl_function(add_name, ctypes.c_int, argument_count=3)
        except MissingFunctionError:
            return None
        handle = handle_of(node)
        with handle:
            condition = find(handle.pointer)
        return cls(node, condition, add) if condition else None

    def wake(self) -> None:
        """End the wait that is going on, or the next one. From any thread."""
        self._wake.trigger()

    def close(self) -> None:
        """Destroy it, once nobody waits."""
        self._wake.destroy()

    @contextlib.contextmanager
    def opened(self) -> Iterator[Callable[..., None]]:
        """Yield a function that waits for a change. Its default is without time limit."""
        wake = handle_of(self._wake)
        with self._node, self._context, wake:
            wait_set = rclpy_implementation.WaitSet(0, 2, 0, 0, 0, 0, self._context)
            with wait_set:

                def wait(timeout_ns: int = -1) -> None:
                    wait_set.clear_entities()
                    wait_set.add_guard_condition(wake)
                    code = self._add(wait_set.pointer, self._graph_condition, None)
                    if code != 0:
                        raise RuntimeError(f"{GRAPH_FUNCTIONS[1]} returned {code}")
                    wait_set.wait(timeout_ns)

                yield wait
            wait_set.destroy_when_not_in_use()


class EntityWaitSet:
    """Wait sets of rcl for subscriptions, clients and services, and a condition to wake them."""

    def __init__(self, context: Context) -> None:
        self._context = handle_of(context)
        self._wake = GuardCondition(_nothing, None, context=context)

    def wake(self) -> None:
        """End the wait that is going on, or the next one. From any thread."""
        self._wake.trigger()

    def close(self) -> None:
        """Destroy the condition, once nobody waits."""
        self._wake.destroy()

    def wait(self, entities: Sequence[tuple[Kind, Any]]) -> Sequence[int]:
        """Wait until some are ready, or for `wake`. Return the indices of those that are ready.

        Entities that another thread destroys are left out, or destroyed once the wait has ended.
        """
        kinds = Counter(kind for kind, _ in entities)
        wake = handle_of(self._wake)
        with self._context, wake, contextlib.ExitStack() as used:
            wait_set = rclpy_implementation.WaitSet(
                kinds["subscription"], 1, 0, kinds["client"], kinds["service"], 0, self._context
            )
            with wait_set:
                wait_set.clear_entities()
                wait_set.add_guard_condition(wake)
                places = []
                for index, (kind, entity) in enumerate(entities):
                    handle = handle_of(entity)
                    with contextlib.suppress(rclpy_implementation.InvalidHandle):
                        used.enter_context(handle)
                        add = getattr(wait_set, f"add_{kind}")
                        places.append((index, kind, add(handle)))
                wait_set.wait(-1)
                ready = [index for index, kind, place in places if wait_set.is_ready(kind, place)]
            wait_set.destroy_when_not_in_use()
        return ready


def _nothing() -> None:
    """Serve as a callback where nothing is to be done."""
