# SPDX-License-Identifier: Apache-2.0
"""The undocumented parts of rclpy and rcl that the gateway uses: runs before all other tests.

A failure here says what has changed in rclpy, and explains the failures of other tests.
"""

import ast
import contextlib
import ctypes
import importlib.metadata
import os
import re
import threading
import time
import warnings
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from rclpy.context import Context
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.subscription import Subscription
from rclpy.time import Time

import gateway.sources.rclpy
import gateway_sim
from gateway.sources.rclpy import fast_dds
from gateway.sources.rclpy.executor import ExecutorThread
from gateway.sources.rclpy.interfaces import message_class, service_class
from gateway.sources.rclpy.rclpy_private import takes
from gateway.sources.rclpy.rclpy_private.handles import (
    RESPONSE_TIMED_OUT,
    clock_reader,
    events_executor,
    raw_publisher,
    request_sender,
    request_taker,
    response_sender,
    response_taker,
)
from gateway.sources.rclpy.rclpy_private.readiness import (
    READY_CALLBACK_SETTERS,
    GraphWaitSet,
    ReadyCallbacks,
)
from gateway.sources.rclpy.rclpy_private.takes import HANDED_OVER_BYTES, sample_taker
from gateway.sources.source import Sample
from tests.client import TIMEOUT_S
from tests.sources.nodes import open_node

RCLPY = f"rclpy {importlib.metadata.version('rclpy')}"
INT32 = message_class("std_msgs/msg/Int32")
SET_BOOL = service_class("std_srvs/srv/SetBool")
STRING = message_class("std_msgs/msg/String")
CDR = b"\0\1\0\0\7\0\0\0"
S = 10**9


@pytest.fixture(scope="module")
def context() -> Iterator[Context]:
    context = Context()
    context.init(args=["--ros-args", "--disable-stdout-logs"])
    yield context
    context.try_shutdown()
    context.destroy()


@pytest.fixture
def node(context: Context) -> Iterator[Node]:
    node = open_node("private", context, start_parameter_services=False)
    yield node
    node.destroy_node()


def wait_until(condition: Callable[[], Any], otherwise: str) -> None:
    """Look until a condition holds. Fail with what it means that it does not."""
    end = time.monotonic() + TIMEOUT_S
    while not condition():
        assert time.monotonic() < end, f"{RCLPY} has changed: {otherwise}"
        time.sleep(0.01)


def take_when_there(take: Callable[[], Any], is_there: Callable[[Any], bool], what: str) -> Any:
    """Take until there is something, and return that."""
    taken: list[Any] = []

    def has_taken() -> bool:
        taken.append(take())
        return is_there(taken[-1])

    wait_until(has_taken, f"no {what} is taken")
    return taken[-1]


def two_subscriptions(node: Node, message: type) -> list[Subscription]:
    """Return one for rcl's way to take samples, and one for rclpy's."""
    nothing = SubscriptionEventCallbacks(use_default_callbacks=False)
    return [
        node.create_subscription(
            message, "/count", lambda _: None, 10, raw=True, event_callbacks=nothing
        )
        for _ in range(2)
    ]


def test_rcl_and_rclpy_take_the_same_samples_with_their_times(node: Node) -> None:
    by_rcl, by_rclpy = sample_taker(), takes._take_by_rclpy
    assert by_rcl is not by_rclpy, "rcl has changed: a function is missing"
    before_ns = time.time_ns()
    first, second = two_subscriptions(node, INT32)
    for take, subscription in ((by_rcl, first), (by_rclpy, second)):
        assert take(subscription, INT32) is None, f"{RCLPY} has changed: takes what is not there"
    publisher = node.create_publisher(INT32, "/count", 10)
    wait_until(
        lambda: publisher.get_subscription_count() == 2, "a publisher does not see subscriptions"
    )
    for _ in range(3):
        raw_publisher(publisher)(CDR)
    taken: dict[str, list[Sample]] = {"rcl": [], "rclpy": []}

    def have_all() -> bool:
        for way, sample in (("rcl", by_rcl(first, INT32)), ("rclpy", by_rclpy(second, INT32))):
            if sample is not None:
                taken[way].append(sample)
        return all(len(samples) == 3 for samples in taken.values())

    wait_until(have_all, f"taken are {taken}")
    for samples in taken.values():
        changed = f"{RCLPY} has changed: taken are {samples!r}"
        assert [sample.cdr for sample in samples] == [CDR] * 3, changed
        assert all(type(sample.cdr) is bytes for sample in samples), changed
        assert [sample.number for sample in samples] == [1, 2, 3], changed
        for sample in samples:  # not in other units
            assert before_ns - S <= sample.source_ns <= sample.received_ns, changed
            assert sample.received_ns <= time.time_ns() + S, changed
    [published] = node.get_publishers_info_by_topic("/count")
    ids = {sample.publisher for sample in taken["rcl"]}
    assert ids == {bytes(published.endpoint_gid[:16])}, f"rmw has changed: publishers are {ids}"
    sources = [[sample.source_ns for sample in samples] for samples in taken.values()]
    assert sources[0] == sources[1], f"{RCLPY} has changed: other times by rcl: {sources}"


@pytest.mark.parametrize("extra", [-1, 0, 1])
def test_a_large_sample_is_a_view_that_outlives_all_else(node: Node, extra: int) -> None:
    [subscription] = two_subscriptions(node, STRING)[:1]
    publisher = node.create_publisher(STRING, "/count", 10)
    wait_until(publisher.get_subscription_count, "a publisher does not see its subscription")
    length = HANDED_OVER_BYTES + extra - 8
    sent = [
        b"\0\1\0\0" + length.to_bytes(4, "little") + bytes([char]) * (length - 1) + b"\0"
        for char in b"abc"
    ]
    taken = []
    for cdr in sent:
        raw_publisher(publisher)(cdr)
        take = partial(sample_taker(), subscription, STRING)
        sample = take_when_there(take, bool, "large sample")
        taken.append(sample.cdr[8:])
        del take, sample
    assert [type(each) for each in taken] == [bytes if extra < 0 else memoryview] * 3
    assert [bytes(each) for each in taken] == [cdr[8:] for cdr in sent]
    if extra >= 0:
        with pytest.raises(TypeError, match="read-only"):
            taken[0][0] = 0  # type: ignore[index]


def test_the_memory_of_a_large_sample_is_freed_with_its_last_view(node, monkeypatch):
    freed: list[int] = []
    free = takes._Block.__del__

    def note(block: takes._Block) -> None:
        freed.append(block.__array_interface__["shape"][0])
        free(block)

    monkeypatch.setattr(takes._Block, "__del__", note)
    [subscription] = two_subscriptions(node, STRING)[:1]
    publisher = node.create_publisher(STRING, "/count", 10)
    wait_until(publisher.get_subscription_count, "a publisher does not see its subscription")
    take = sample_taker()
    cdr = b"\0\1\0\0" + (2**20).to_bytes(4, "little") + b"a" * (2**20 - 1) + b"\0"
    before_kb = resident_kb()
    for _ in range(100):
        raw_publisher(publisher)(cdr)
        sample = take_when_there(lambda: take(subscription, STRING), bool, "large sample")
    view = sample.cdr[8:16]
    del sample
    assert len(freed) == 99
    assert bytes(view) == b"a" * 8
    del view
    assert freed == [len(cdr)] * 100
    assert resident_kb() - before_kb < 50 * 1024  # of a hundred megabytes


def resident_kb() -> int:
    status = Path("/proc/self/status").read_text()
    return int(re.search(r"VmRSS:\s+(\d+)", status)[1])  # type: ignore[index]


class NotASubscription(contextlib.nullcontext[None]):
    """The handle of an invalid subscription: 4 KiB of zeros."""

    _zeros = ctypes.create_string_buffer(4096)
    pointer = ctypes.addressof(_zeros)


def test_a_refusal_of_rcl_has_its_text(node: Node, monkeypatch: pytest.MonkeyPatch) -> None:
    take = sample_taker()
    [subscription] = two_subscriptions(node, INT32)[:1]
    monkeypatch.setattr(takes, "handle_of", lambda _: NotASubscription())
    with pytest.raises(RuntimeError, match=r"rcl_take_serialized_message returned \d+: \S"):
        take(subscription, INT32)
    monkeypatch.undo()
    assert take(subscription, INT32) is None


def test_a_subscription_that_is_destroyed_gives_nothing(node: Node) -> None:
    [subscription] = two_subscriptions(node, INT32)[:1]
    node.destroy_subscription(subscription)
    with pytest.raises(RuntimeError):
        sample_taker()(subscription, INT32)


def test_without_a_function_of_rcl_rclpy_takes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(takes, "_TAKE", "rcl_take_nothing")
    assert sample_taker() is takes._take_by_rclpy


def test_a_request_and_its_response_carry_the_number_that_sending_returned(node: Node) -> None:
    service = node.create_service(SET_BOOL, "/arm", lambda *_: None)
    client = node.create_client(SET_BOOL, "/arm")
    take_request = request_taker(service)
    take_response = response_taker(client)
    nothing = (None, None)
    assert take_request(SET_BOOL.Request) == nothing, f"{RCLPY} has changed: service_take_request"
    assert take_response(SET_BOOL.Response) == nothing, f"{RCLPY} has changed: take_response"
    wait_until(client.service_is_ready, "a client does not see its service")
    number = request_sender(client)(SET_BOOL.Request(data=True))
    assert isinstance(number, int), f"{RCLPY} has changed: send_request returns {number!r}"

    def is_there(taken: Any) -> bool:
        return bool(taken != nothing)

    taken = take_when_there(lambda: take_request(SET_BOOL.Request), is_there, "request")
    changed = f"{RCLPY} has changed: service_take_request returns {taken!r}"
    request, info = taken
    assert request == SET_BOOL.Request(data=True), changed
    assert info.request_id.sequence_number == number, changed
    response = SET_BOOL.Response(message="done")
    response_sender(service)(response, info.request_id)
    taken = take_when_there(lambda: take_response(SET_BOOL.Response), is_there, "response")
    changed = f"{RCLPY} has changed: take_response returns {taken!r}"
    info, found = taken
    assert found == response, changed
    assert info.request_id.sequence_number == number, changed


def test_a_response_that_its_client_cannot_get_warns(node: Node) -> None:
    service = node.create_service(SET_BOOL, "/arm", lambda *_: None)
    profile = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    deaf = node.create_client(SET_BOOL, "/arm", qos_profile=profile)
    heard = node.create_client(SET_BOOL, "/arm")
    wait_until(heard.service_is_ready, "a client does not see its service")
    take_request = request_taker(service)
    request_sender(deaf)(SET_BOOL.Request())

    def info_of_request() -> Any:
        return take_request(SET_BOOL.Request)[1]

    info = take_when_there(info_of_request, lambda info: info is not None, "request")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        response_sender(service)(SET_BOOL.Response(), info.request_id)
    texts = [str(each.message) for each in caught if each.category is RuntimeWarning]
    assert any(text.startswith(RESPONSE_TIMED_OUT) for text in texts), (
        f"{RCLPY} has changed: service_send_response warns {texts}"
    )


def test_a_clock_is_read_in_nanoseconds(node: Node) -> None:
    clock = node.get_clock()
    read = clock_reader(clock)
    before, now_ns, after = clock.now(), read(), clock.now()
    assert type(now_ns) is int, f"{RCLPY} has changed: get_now().nanoseconds is {now_ns!r}"
    now = Time(nanoseconds=now_ns, clock_type=clock.clock_type)
    assert before <= now <= after, f"{RCLPY} has changed: get_now() is not the clock's now()"


def test_arrivals_are_counted_in_an_eventfd_until_that_is_stopped(node: Node) -> None:
    subscription = node.create_subscription(INT32, "/count", lambda _: None, 10, raw=True)
    publisher = node.create_publisher(INT32, "/count", 10)
    wait_until(publisher.get_subscription_count, "a publisher does not see its subscription")
    take = sample_taker()
    callbacks = ReadyCallbacks()
    fd = os.eventfd(0, os.EFD_NONBLOCK)
    counted = 0

    def count_is(count: int) -> bool:
        nonlocal counted
        with contextlib.suppress(BlockingIOError):
            counted += os.eventfd_read(fd)
        return counted == count

    try:
        callbacks.count("subscription", subscription, fd)
        for _ in range(3):
            publisher.publish(CDR)
        setter = READY_CALLBACK_SETTERS["subscription"]
        wait_until(lambda: count_is(3), f"{setter} does not count each arrival")
        callbacks.stop("subscription", subscription)
        for _ in range(3):
            take_when_there(lambda: take(subscription, INT32), bool, "sample")
        publisher.publish(CDR)
        take_when_there(lambda: take(subscription, INT32), bool, "sample")
        assert count_is(3), f"rcl has changed: {setter} counts after it was told to stop"
    finally:
        os.close(fd)


def test_a_change_of_the_graph_and_a_wake_each_end_the_wait(node: Node) -> None:
    wait_set = GraphWaitSet(node)
    waits = 0
    ended = threading.Event()
    is_over = False

    def wait_on() -> None:
        nonlocal waits
        with wait_set.opened() as wait:
            while not is_over:
                wait()
                waits += 1
        ended.set()

    thread = threading.Thread(target=wait_on, daemon=True)
    thread.start()
    try:
        node.create_publisher(INT32, "/new", 10)
        wait_until(lambda: waits, "a change of the graph does not end a wait for it")
    finally:
        is_over = True
        wait_set.wake()
    assert ended.wait(TIMEOUT_S / 2), f"{RCLPY} has changed: a guard condition ends no wait"
    thread.join()
    wait_set.close()


def test_the_events_executor_delivers(context: Context) -> None:
    executor = events_executor(context)
    assert executor is not None, f"{RCLPY} has changed: there is no EventsExecutor"
    executor.shutdown()
    node = open_node("spun", context, start_parameter_services=False)
    delivered = threading.Event()
    node.create_timer(0.001, delivered.set)
    thread = ExecutorThread(context)
    thread.add_node(node)
    try:
        assert delivered.wait(TIMEOUT_S), f"{RCLPY} has changed: the EventsExecutor runs no timer"
    finally:
        thread.close()
        node.destroy_node()


def private_uses(source: str) -> list[str]:
    """Find in Python code what belongs to `rclpy_private`."""
    return [
        f"line {each.lineno}: {name}"  # type: ignore[attr-defined]  # only nodes with a line give
        for each in ast.walk(ast.parse(source))
        for name in private_names(each)
    ]


def private_names(node: ast.AST) -> list[str]:
    match node:
        case ast.Import(names):
            return [each.name for each in names if is_private(each.name)]
        case ast.ImportFrom(module=str(module), names=names):
            full_names = [f"{module}.{each.name}" for each in names]
            return [each for each in full_names if is_private(each)]
        case ast.Attribute(attr="handle" | "pointer" as attribute):
            return [f".{attribute}"]
        # names that begin with _ are private
        case ast.Attribute(value=ast.Name(owner), attr=attribute) if owner not in {
            "self",
            "cls",
        } and re.match(r"_(?!_)", attribute):
            return [f"{owner}.{attribute}"]
        case ast.Attribute(value=ast.Name("rclpy"), attr="impl" | "experimental" as attribute):
            return [f"rclpy.{attribute}"]
        case _:
            return []


def is_private(full_name: str) -> bool:
    package, *parts = full_name.split(".")
    if package == "rclpy":
        return any(part in {"impl", "experimental"} or part.startswith("_") for part in parts)
    return package == "ctypes"


@pytest.mark.parametrize(
    "source",
    [
        "import ctypes",
        "from ctypes import CDLL",
        "import rclpy.impl.implementation_singleton",
        "from rclpy.impl.implementation_singleton import rclpy_implementation",
        "from rclpy import impl",
        "from rclpy import _rclpy_pybind11",
        "from rclpy.experimental.events_executor import EventsExecutor",
        "rclpy.impl.implementation_singleton",
        "take = self._subscription.handle.take_message",
        "node.context.handle",
        "wait_set.pointer",
        "node._parameters",
    ],
)
def test_the_search_finds_private_parts(source: str) -> None:
    assert private_uses(source)


SOURCES = [
    path
    for folder in (Path(gateway.sources.rclpy.__file__).parent, Path(gateway_sim.__file__).parent)
    for path in sorted(folder.rglob("*.py"))
    if path.parent.name not in {"rclpy_private", "made_types"} and path != Path(fast_dds.__file__)
]


def test_only_these_modules_use_private_parts() -> None:
    found = {str(path): private_uses(path.read_text()) for path in SOURCES}
    assert {path: uses for path, uses in found.items() if uses} == {}
