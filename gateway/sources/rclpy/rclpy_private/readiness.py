# SPDX-License-Identifier: Apache-2.0
"""Functions of C that count what becomes ready, and a wait set for changes of the graph."""

import contextlib
import ctypes
from collections.abc import Callable, Iterator
from typing import Any, Final, Literal

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

    def __init__(self, node: Node) -> None:
        """Find the functions, and the condition.

        Raises:
            MissingFunctionError: rcl lacks one.
        """
        find_name, add_name = GRAPH_FUNCTIONS
        find = rcl_function(find_name, ctypes.c_void_p, argument_count=1)
        self._add = rcl_function(add_name, ctypes.c_int, argument_count=3)
        self._node = handle_of(node)
        self._context = handle_of(node.context)
        with self._node:
            self._graph_condition = find(self._node.pointer)
        self._wake = GuardCondition(_nothing, None, context=node.context)

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


def _nothing() -> None:
    """Serve as a callback where nothing is to be done."""
