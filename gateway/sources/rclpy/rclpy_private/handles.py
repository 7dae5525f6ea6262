# SPDX-License-Identifier: Apache-2.0
"""The handles of rclpy's entities, and the methods that rclpy keeps to itself."""

from collections.abc import Callable, Mapping
from typing import Any, Final, Literal, Protocol

from rclpy.client import Client
from rclpy.clock import Clock
from rclpy.context import Context
from rclpy.executors import Executor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.publisher import Publisher
from rclpy.service import Service
from rclpy.subscription import Subscription

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


def handle_of(entity: Any) -> Any:
    """Return the object of the extension module behind an entity of rclpy."""
    return entity.handle


# Each of these returns the method of a handle itself, to be called for every message without
# another call of Python in between.


def message_taker(
    subscription: Subscription,
) -> Callable[[type, bool], tuple[bytes, Mapping[str, int]] | None]:
    """Return the function that takes one sample: of its class, and raw if the second is true."""
    return handle_of(subscription).take_message  # type: ignore[no-any-return]  # of pybind11


def raw_publisher(publisher: Publisher) -> Callable[[bytes], None]:
    """Return the function that publishes CDR, encapsulation header included."""
    return handle_of(publisher).publish_raw  # type: ignore[no-any-return]  # of pybind11


def request_sender(client: Client) -> Callable[[Any], int]:
    """Return the function that sends a request and returns its number, server or no server."""
    return handle_of(client).send_request  # type: ignore[no-any-return]  # of pybind11


def response_taker(client: Client) -> Callable[[type], tuple[ServiceInfo | None, Any]]:
    """Return the function that takes one response of a class."""
    return handle_of(client).take_response  # type: ignore[no-any-return]  # of pybind11


def request_taker(service: Service) -> Callable[[type], tuple[Any, ServiceInfo | None]]:
    """Return the function that takes one request of a class."""
    return handle_of(service).service_take_request  # type: ignore[no-any-return]  # of pybind11


def response_sender(service: Service) -> Callable[[Any, RequestId], None]:
    """Return the function that sends a response to the request with an id."""
    return handle_of(service).service_send_response  # type: ignore[no-any-return]  # of pybind11


def clock_reader(clock: Clock) -> Callable[[], int]:
    """Return a function that returns a clock's time in nanoseconds."""
    handle = handle_of(clock)

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


def new_matches(publisher: Publisher) -> tuple[Callable[[], int], Callable[[], None]]:
    """Return what `subscription_count` does, for the subscriptions that a publisher has found."""
    kind = rclpy_implementation.rcl_publisher_event_type_t.RCL_PUBLISHER_MATCHED
    return _event_count(publisher, kind, "total_count_change")


def _event_count(
    entity: Any, kind: Any, change: str
) -> tuple[Callable[[], int], Callable[[], None]]:
    parent = handle_of(entity)
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


def events_executor(context: Context) -> Executor | None:
    """Return an executor that wakes only for what is ready. ``None`` before Jazzy.

    Spin it with `SPIN_S`.
    """
    try:
        from rclpy.experimental.events_executor import EventsExecutor
    except ImportError:
        return None
    return EventsExecutor(context=context)


def _nothing() -> None:
    """Serve as a callback where nothing is to be done."""


def _count_nothing() -> int:
    return 0
