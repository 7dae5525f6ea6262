# SPDX-License-Identifier: Apache-2.0
"""The one place that uses rclpy and rcl beyond their documented API, beside that of made types.

A change of rclpy that breaks the gateway most likely breaks something in this list.
``tests/ros/test_rclpy_private.py`` checks each item against the rclpy that is installed and runs
before all other tests. All of it is so in rclpy 7.1 and rcl 9.2 (Jazzy).

Handles: the objects of the extension module ``rclpy._rclpy_pybind11`` behind rclpy's classes. As
context managers they keep rcl's object alive, and ``pointer`` is its address in C.

``Subscription.handle.take_message(type, raw)``
    Returns ``None`` or ``(bytes, {"received_timestamp": nanoseconds, "source_timestamp": ...,
    "publication_sequence_number": ...})``. rclpy's own way to a sample is an executor. Without it:
    no subscriptions.
``Publisher.handle.publish_raw(bytes)``
    `rclpy.publisher.Publisher.publish` takes bytes, too, after checks in Python.
``Client.handle.send_request(request)``
    Returns the request's number. Without it, or without one of the next three: no services, no
    actions, no parameters. rclpy's own way needs an executor (see `gateway.ros.endpoints`).
``Client.handle.take_response(type)``
    Returns ``(info, response)`` with ``info.request_id.sequence_number``, or ``(None, None)``, also
    for a response that cannot be read.
``Service.handle.service_take_request(type)``
    Returns ``(request, info)`` with ``info.request_id``, or ``(None, None)``, as above.
``Service.handle.service_send_response(response, request_id)``
    Warns with the text `RESPONSE_TIMED_OUT` where rmw has waited for the client in vain.
``rclpy.impl.implementation_singleton.rclpy_implementation.EventHandle(handle, kind)``
    With ``take_event()``, which returns what rcl has counted, and the change since the last call,
    and ``destroy_when_not_in_use()``; raises ``UnsupportedEventTypeError`` where the middleware
    lacks a kind. rclpy's own way needs an executor. Without it: nobody hears of missed deadlines
    and lost messages (`gateway.ros.qos_events`).
``Clock.handle.get_now().nanoseconds``
    `rclpy.clock.Clock.now` returns the same, wrapped in a ``Time``.
``RCLError`` and ``InvalidHandle`` are RuntimeErrors
    Handles raise them. Otherwise they pass for errors of the gateway (see `gateway.ros.errors`).

Functions of ``librcl.so``, by ctypes; each takes the address of an entity:

``rcl_subscription_set_on_new_message_callback``, ``rcl_client_set_on_new_response_callback``,
``rcl_service_set_on_new_request_callback``
    Take ``(entity, callback, user_data)`` and call ``callback(user_data, count)`` on a thread of
    DDS; since Humble. Without one of them, or where the middleware does not support them:
    `gateway.ros.wait_set_events.WaitSetReadyEvents`.
``rcl_node_get_graph_guard_condition``, ``rcl_wait_set_add_guard_condition``
    Without one of them: `gateway.ros.graph.GraphChanges` looks twice a second.

Wait sets: ``rclpy.impl.implementation_singleton.rclpy_implementation.WaitSet``, with six counts and
a context; ``clear_entities``, ``add_guard_condition``, ``pointer``, ``wait`` and
``destroy_when_not_in_use``. With them ``GuardCondition.handle``, ``Node.handle`` and
``Context.handle``. Without them: as without ``rcl_wait_set_add_guard_condition``.
``add_subscription``, ``add_client``, ``add_service``, which return a number, ``is_ready(kind,
number)``, and ``InvalidHandle``, raised on entering the handle of what is destroyed. Without them:
no ``RosOptions(taking="wait_set")``.

``rclpy.experimental.events_executor.EventsExecutor``
    Since Jazzy. Without it: ``SingleThreadedExecutor``, which looks at every entity at each turn.
"""

import contextlib
import ctypes
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Final, Literal, Protocol

from rclpy.client import Client
from rclpy.clock import Clock
from rclpy.context import Context
from rclpy.executors import Executor
from rclpy.guard_condition import GuardCondition
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.service import Service
from rclpy.subscription import Subscription

Kind = Literal["subscription", "client", "service"]

READY_CALLBACK_SETTERS: Final[dict[Kind, str]] = {
    "subscription": "rcl_subscription_set_on_new_message_callback",
    "client": "rcl_client_set_on_new_response_callback",
    "service": "rcl_service_set_on_new_request_callback",
}
GRAPH_FUNCTIONS: Final = ("rcl_node_get_graph_guard_condition", "rcl_wait_set_add_guard_condition")

# how the RuntimeWarning begins
RESPONSE_TIMED_OUT: Final = "failed to send response"
# `spin()` of the EventsExecutor in rclpy 7.1 has an overflow in its infinite deadline: it turns
# without pause and delivers nothing. A deadline of eleven days works.
SPIN_S: Final = 1e6


class RequestId(Protocol):
    """The id of a request, as rmw has it."""

    @property
    def sequence_number(self) -> int:
        """The number that sending the request returned."""


class ServiceInfo(Protocol):
    """The metadata of a request or a response."""

    @property
    def request_id(self) -> RequestId:
        """The id of the request, or of the request that the response is to."""


class MissingFunctionError(Exception):
    """Raised when librcl or libc is not there or lacks a function."""


# Each of these returns the method of a handle itself, to be called for every message without
# another call of Python in between.


def message_taker(
    subscription: Subscription,
) -> Callable[[type, bool], tuple[bytes, Mapping[str, int]] | None]:
    """Return the function that takes one sample: of its class, and raw if the second is true."""
    return _handle(subscription).take_message  # type: ignore[no-any-return]  # of pybind11


def raw_publisher(publisher: Publisher) -> Callable[[bytes], None]:
    """Return the function that publishes CDR, encapsulation header included."""
    return _handle(publisher).publish_raw  # type: ignore[no-any-return]  # of pybind11


def request_sender(client: Client) -> Callable[[Any], int]:
    """Return the function that sends a request and returns its number, server or no server."""
    return _handle(client).send_request  # type: ignore[no-any-return]  # of pybind11


def response_taker(client: Client) -> Callable[[type], tuple[ServiceInfo | None, Any]]:
    """Return the function that takes one response of a class."""
    return _handle(client).take_response  # type: ignore[no-any-return]  # of pybind11


def request_taker(service: Service) -> Callable[[type], tuple[Any, ServiceInfo | None]]:
    """Return the function that takes one request of a class."""
    return _handle(service).service_take_request  # type: ignore[no-any-return]  # of pybind11


def response_sender(service: Service) -> Callable[[Any, RequestId], None]:
    """Return the function that sends a response to the request with an id."""
    return _handle(service).service_send_response  # type: ignore[no-any-return]  # of pybind11


def clock_reader(clock: Clock) -> Callable[[], int]:
    """Return a function that returns a clock's time in nanoseconds."""
    handle = _handle(clock)

    def read() -> int:
        with handle:
            return int(handle.get_now().nanoseconds)

    return read


SubscriptionCount = Literal["deadline_missed", "liveliness_lost", "messages_lost"]


def subscription_count(
    subscription: Subscription, kind: SubscriptionCount
) -> tuple[Callable[[], int], Callable[[], None]]:
    """Return a function that takes what was counted since its last call, and one that ends it.

    End it before the subscription.
    """
    kinds = rclpy_implementation.rcl_subscription_event_type_t
    match kind:
        case "deadline_missed":
            event, change = kinds.RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED, "total_count_change"
        case "liveliness_lost":
            event, change = kinds.RCL_SUBSCRIPTION_LIVELINESS_CHANGED, "not_alive_count_change"
        case "messages_lost":
            event, change = kinds.RCL_SUBSCRIPTION_MESSAGE_LOST, "total_count_change"
    return _event_count(subscription, event, change)


def missed_deadlines(publisher: Publisher) -> tuple[Callable[[], int], Callable[[], None]]:
    """Return what `subscription_count` does, for the deadlines that a publisher has missed."""
    kinds = rclpy_implementation.rcl_publisher_event_type_t
    event = kinds.RCL_PUBLISHER_OFFERED_DEADLINE_MISSED
    return _event_count(publisher, event, "total_count_change")


def _event_count(
    entity: Any, kind: Any, change: str
) -> tuple[Callable[[], int], Callable[[], None]]:
    parent = _handle(entity)
    try:
        with parent:
            event = rclpy_implementation.EventHandle(parent, kind)
    except rclpy_implementation.UnsupportedEventTypeError:  # not every middleware has all of them
        return _count_nothing, _nothing

    def take() -> int:
        with event:
            taken = event.take_event()
        return max(0, getattr(taken, change)) if taken is not None else 0

    return take, event.destroy_when_not_in_use


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
            kind: _rcl_function(name, ctypes.c_int, argument_count=3)
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
        """Stop counting; once this returns no thread writes the eventfd any more."""
        self._call(kind, entity, None, None)

    def _call(self, kind: Kind, entity: Any, function: object, user_data: int | None) -> None:
        handle = _handle(entity)
        with handle:
            code = self._set[kind](handle.pointer, function, user_data)
        if code != 0:
            raise RuntimeError(f"{READY_CALLBACK_SETTERS[kind]} returned {code}")


class GraphWaitSet:
    """A wait set of rcl with a node's graph guard condition in it, and one to wake it."""

    def __init__(self, node: Node, graph_condition: int, add: Callable[..., int]) -> None:
        self._node = _handle(node)
        self._context = _handle(node.context)
        self._graph_condition = graph_condition
        self._add = add
        self._wake = GuardCondition(_nothing, None, context=node.context)

    @classmethod
    def create(cls, node: Node) -> "GraphWaitSet | None":
        """Return one, or ``None`` if rcl lacks a function."""
        find_name, add_name = GRAPH_FUNCTIONS
        try:
            find = _rcl_function(find_name, ctypes.c_void_p, argument_count=1)
            add = _rcl_function(add_name, ctypes.c_int, argument_count=3)
        except MissingFunctionError:
            return None
        handle = _handle(node)
        with handle:
            condition = find(handle.pointer)
        return cls(node, condition, add) if condition else None

    def wake(self) -> None:
        """End the wait that is going on, or the next one; from any thread."""
        self._wake.trigger()

    def close(self) -> None:
        """Destroy it, once nobody waits."""
        self._wake.destroy()

    @contextlib.contextmanager
    def opened(self) -> Iterator[Callable[..., None]]:
        """Yield a function that waits for a change; its default is without time limit."""
        wake = _handle(self._wake)
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
        self._context = _handle(context)
        self._wake = GuardCondition(_nothing, None, context=context)

    def wake(self) -> None:
        """End the wait that is going on, or the next one; from any thread."""
        self._wake.trigger()

    def close(self) -> None:
        """Destroy the condition, once nobody waits."""
        self._wake.destroy()

    def wait(self, entities: Sequence[tuple[Kind, Any]]) -> Sequence[int]:
        """Wait until some are ready, or for `wake`; return the indices of those that are ready.

        What is destroyed by another thread is left out, or destroyed once the wait has ended.
        """
        kinds = Counter(kind for kind, _ in entities)
        wake = _handle(self._wake)
        with self._context, wake, contextlib.ExitStack() as used:
            wait_set = rclpy_implementation.WaitSet(
                kinds["subscription"], 1, 0, kinds["client"], kinds["service"], 0, self._context
            )
            with wait_set:
                wait_set.clear_entities()
                wait_set.add_guard_condition(wake)
                places = []
                for index, (kind, entity) in enumerate(entities):
                    handle = _handle(entity)
                    with contextlib.suppress(rclpy_implementation.InvalidHandle):
                        used.enter_context(handle)
                        add = getattr(wait_set, f"add_{kind}")
                        places.append((index, kind, add(handle)))
                wait_set.wait(-1)
                ready = [index for index, kind, place in places if wait_set.is_ready(kind, place)]
            wait_set.destroy_when_not_in_use()
        return ready


def events_executor(context: Context) -> Executor | None:
    """Return an executor that wakes only for what is ready; ``None`` before Jazzy.

    Spin it with `SPIN_S`.
    """
    try:
        from rclpy.experimental.events_executor import EventsExecutor
    except ImportError:
        return None
    return EventsExecutor(context=context)


def _handle(entity: Any) -> Any:
    return entity.handle


def _rcl_function(name: str, result: type, *, argument_count: int) -> Callable[..., Any]:
    """Find a function of rcl whose arguments are addresses.

    Raises:
        MissingFunctionError: rcl lacks it.
    """
    try:
        function = getattr(ctypes.CDLL("librcl.so"), name)
    except (OSError, AttributeError) as error:
        raise MissingFunctionError(str(error)) from error
    function.argtypes = [ctypes.c_void_p] * argument_count
    function.restype = result
    return function  # type: ignore[no-any-return]  # of ctypes


def _nothing() -> None:
    """Serve as a callback where nothing is to be done."""


def _count_nothing() -> int:
    return 0
