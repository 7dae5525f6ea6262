# SPDX-License-Identifier: Apache-2.0
"""The way in: options, starting and ending."""

import asyncio
import contextlib
import errno
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from rclpy.node import Node

from gateway.errors import RosMissingError
from gateway.sources.actions import GoalRequest
from gateway.sources.graph import Graph, ServerInfo
from gateway.sources.rclpy import RosOptions, open_ros
from gateway.sources.rclpy.graph import read_actions, read_all_services
from gateway.sources.rclpy.port import RclpyRos
from gateway.sources.rclpy.rclpy_private.readiness import ReadyCallbacks
from gateway.sources.services import ServiceRequest
from gateway.sources.source import Qos, Ros, RosError, Sample
from tests.client import TIMEOUT_S, eventually
from tests.e2e.faults.processes import segments_of
from tests.sources.outside import Outside
from tests.sources.rclpy.test_samples import CDR, Flood

INT32 = "std_msgs/msg/Int32"
SET_BOOL = "std_srvs/srv/SetBool"
FIBONACCI = "test_msgs/action/Fibonacci"
LOG = "rcl_interfaces/msg/Log"


def ignore(*_: object) -> None: ...


async def hears_itself(ros: Ros) -> None:
    received: list[Sample] = []
    subscription = ros.subscribe("/echo", INT32, Qos(), received.extend, ignore)
    publisher = ros.advertise("/echo", INT32, Qos(), lambda _: None)

    def arrived() -> bool:
        publisher.publish(CDR)
        return bool(received)

    await eventually(arrived)
    subscription.close()
    publisher.close()


async def leave_calls_open(ros: Ros) -> list[asyncio.Future[object]]:
    """Leave a call, a waiting call, a goal and a waiting goal under way."""
    requests: list[object] = []
    ros.services.serve("/left_open", SET_BOOL, requests.append)
    ros.actions.serve_action("/left_open", FIBONACCI, requests.append, ignore)
    left: list[asyncio.Future[object]] = [
        asyncio.ensure_future(ros.services.client(name, SET_BOOL).call(b"\0\1\0\0\1"))
        for name in ("/left_open", "/nobody")
    ]
    left.append(
        asyncio.ensure_future(
            ros.actions.action_client("/nobody", FIBONACCI).send_goal(CDR, ignore)
        )
    )
    goal = await ros.actions.action_client("/left_open", FIBONACCI).send_goal(CDR, ignore)
    left.append(asyncio.ensure_future(goal.result()))
    await eventually(lambda: len(requests) == 2)
    return left


def resources() -> tuple[int, int]:
    """Count open file descriptors and threads."""
    return len(list(Path("/proc/self/fd").iterdir())), len(list(Path("/proc/self/task").iterdir()))


async def test_repeated_starts_leave_no_descriptor_and_no_thread() -> None:
    baseline = (0, 0)
    for number in range(6):
        async with open_ros() as ros:
            await hears_itself(ros)
            ros.watch_graph(ignore)
            ros.subscribe("/left_open", INT32, Qos(), ignore, ignore)
            ros.advertise("/left_open", INT32, Qos(), lambda _: None)
            left = await leave_calls_open(ros)
        for failed in left:
            with pytest.raises(RosError, match="is closed"):
                await failed
        if number == 1:  # the first time leaves what the process keeps, such as rcl's log file
            baseline = resources()
    await eventually(lambda: resources() <= baseline)


async def test_nested_starts_are_independent() -> None:
    async with open_ros(RosOptions(node_prefix="outer")) as outer:
        async with open_ros(RosOptions(node_prefix="inner")) as inner:
            await hears_itself(inner)
            await eventually(lambda: "/outer_debug" in inner.graph().nodes)
        await hears_itself(outer)
        await eventually(lambda: "/inner_debug" not in outer.graph().nodes)


async def test_ending_in_the_middle_of_a_flood_is_clean(outside: Outside) -> None:
    problems: list[object] = []
    asyncio.get_running_loop().set_exception_handler(lambda _, context: problems.append(context))
    flood = Flood(outside.add_publisher("/flood", INT32))
    try:
        for _ in range(3):
            received: list[Sample] = []
            async with open_ros() as ros:
                ros.subscribe("/flood", INT32, Qos(), received.extend, ignore)
                await eventually(lambda: len(received) > 200)  # noqa: B023
            seen = len(received)
            for _ in range(10):
                await asyncio.sleep(0)
            assert len(received) == seen
    finally:
        flood.close()
    assert problems == []


async def test_ending_from_within_a_callback_is_clean(outside: Outside) -> None:
    context = open_ros()
    ros = await context.__aenter__()
    done = asyncio.Event()
    tasks: list[asyncio.Task[object]] = []

    def on_samples(_: Sequence[Sample]) -> None:
        if not tasks:
            tasks.append(asyncio.ensure_future(context.__aexit__(None, None, None)))
            tasks[0].add_done_callback(lambda _: done.set())

    ros.subscribe("/flood", INT32, Qos(), on_samples, ignore)
    flood = Flood(outside.add_publisher("/flood", INT32))
    try:
        async with asyncio.timeout(TIMEOUT_S):
            await done.wait()
        await tasks[0]
    finally:
        flood.close()


async def test_ros_leaves_signals_to_the_loop() -> None:
    stop = asyncio.Event()
    asyncio.get_running_loop().add_signal_handler(signal.SIGTERM, stop.set)
    async with open_ros() as ros:
        os.kill(os.getpid(), signal.SIGTERM)
        async with asyncio.timeout(TIMEOUT_S):
            await stop.wait()
        await hears_itself(ros)  # rclpy's own handler would have ended the context


async def test_nodes_carry_prefix_and_namespace() -> None:
    async with open_ros(RosOptions(node_prefix="xr", namespace="/robot1")) as ros:
        await eventually(lambda: len(ros.graph().nodes) == 4)
        assert ros.graph().nodes == (
            "/robot1/xr_debug",
            "/robot1/xr_publishers",
            "/robot1/xr_services",
            "/robot1/xr_subscriptions",
        )


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (RosOptions(node_prefix="a b"), "Invalid node name"),
        (RosOptions(namespace="a b"), "Invalid namespace"),
        (RosOptions(domain_id=233), "domain id 233, at most 232"),
        (RosOptions(arguments=("--ros-args", "-r")), "starting ROS"),
    ],
)
async def test_options_that_ros_refuses_are_a_ros_error(options: RosOptions, words: str) -> None:
    with pytest.raises(RosError, match=words):
        async with open_ros(options):
            pass


async def test_commands_have_a_participant_without_shared_memory() -> None:
    """A gateway that is killed may keep the mutex of a port there, and the robot would wait."""
    outside = Outside()
    ours = segments_of(os.getpid())

    def participants(topic: str) -> set[bytes]:
        infos = outside.node.get_publishers_info_by_topic(topic)
        return {bytes(each.endpoint_gid)[:12] for each in infos}

    try:
        async with open_ros() as ros:
            for topic in ("/cmd_vel", "/others"):
                ros.advertise(topic, "geometry_msgs/msg/Twist", Qos(), lambda _: None)
                await eventually(lambda topic=topic: len(participants(topic)) == 1)
            assert participants("/cmd_vel") != participants("/others")
            assert len(segments_of(os.getpid()) - ours) == 1
    finally:
        outside.close()


async def test_only_the_debug_node_has_parameter_services() -> None:
    async with open_ros(RosOptions(node_prefix="xr")) as ros:
        await eventually(lambda: len(ros.graph().nodes) == 4)
        own = [each for each in ros.graph().services if each.name.startswith("/xr_")]
        assert "/xr_debug/get_parameters" in [each.name for each in own]
        assert {node for each in own for node in each.nodes} == {"/xr_debug"}


@pytest.mark.parametrize(
    ("remapping", "subject", "attempts"),
    [
        ("/t:=/other", "topic /t", ["advertise", "subscribe"]),
        ("/s:=/other", "service /s", ["client", "serve"]),
        ("/a/_action/send_goal:=/other/_action/send_goal", "action /a", ["goals", "serve goals"]),
        ("/a/_action/feedback:=/other/_action/feedback", "action /a", ["goals", "serve goals"]),
        # which a client does without
        ("/a/_action/status:=/other/_action/status", "action /a", ["serve goals"]),
    ],
)
async def test_a_remapped_name_is_refused(remapping, subject, attempts) -> None:
    async with open_ros(RosOptions(arguments=("--ros-args", "-r", remapping))) as ros:
        ways: dict[str, Callable[[], object]] = {
            "advertise": lambda: ros.advertise("/t", INT32, Qos(), lambda _: None),
            "subscribe": lambda: ros.subscribe("/t", INT32, Qos(), ignore, ignore),
            "client": lambda: ros.services.client("/s", SET_BOOL),
            "serve": lambda: ros.services.serve("/s", SET_BOOL, ignore),
            "goals": lambda: ros.actions.action_client("/a", FIBONACCI),
            "serve goals": lambda: ros.actions.serve_action("/a", FIBONACCI, ignore, ignore),
        }
        for attempt in attempts:
            with pytest.raises(RosError, match=f"{subject} is remapped to /other here") as caught:
                ways[attempt]()
            assert caught.value.code == "bad_name"
        assert ros.entity_count() == 0
        await eventually(lambda: not (ros.topic_types("/other") or ros.service_types("/other")))


async def test_topics_that_do_not_exist_are_not_remembered(outside: Outside) -> None:
    async with open_ros(RosOptions()) as ros:
        outside.add_publisher("/count", INT32)
        await eventually(lambda: ros.topic_types("/count") == (INT32,))
        assert not any(ros.topic_types(f"/none{number}") for number in range(10))
        assert set(ros._known._types) == {"/count"}  # type: ignore[attr-defined]  # its memory


async def test_entities_are_limited() -> None:
    async with open_ros(RosOptions(max_entities=2, reserved_entities=0)) as ros:
        first = ros.advertise("/a", INT32, Qos(), lambda _: None)
        ros.subscribe("/b", INT32, Qos(), ignore, ignore)
        others: list[Callable[[], object]] = [
            lambda: ros.services.client("/c", SET_BOOL),
            lambda: ros.services.serve("/c", SET_BOOL, ignore),
            lambda: ros.actions.action_client("/c", FIBONACCI),
            lambda: ros.actions.serve_action("/c", FIBONACCI, ignore, ignore),
        ]
        with pytest.raises(RosError, match="at most 2 ROS entities") as caught:
            ros.advertise("/c", INT32, Qos(), lambda _: None)
        assert caught.value.code == "limit_exceeded"
        for attempt in others:
            with pytest.raises(RosError, match="at most 2 ROS entities"):
                attempt()
        first.close()
        ros.advertise("/c", INT32, Qos(), lambda _: None)


async def test_a_lack_of_descriptors_is_a_ros_error_and_leaves_nothing(monkeypatch):
    def none_left(*_: object) -> int:
        raise OSError(errno.EMFILE, os.strerror(errno.EMFILE))

    async with open_ros() as ros:
        with monkeypatch.context() as patch:
            patch.setattr("os.eventfd", none_left)
            with pytest.raises(RosError, match="Too many open files") as caught:
                ros.subscribe("/count", INT32, Qos(), ignore, ignore)
        assert caught.value.code == "internal"
        assert ros.entity_count() == 0
        assert ros.topic_types("/count") == ()
        ros.subscribe("/count", INT32, Qos(), ignore, ignore)


async def test_simulated_time_follows_the_clock_topic_and_tells_if_it_goes_back(
    outside: Outside,
) -> None:
    clock = outside.add_publisher("/clock", "rosgraph_msgs/msg/Clock")
    jumps: list[int] = []
    async with open_ros(RosOptions(use_sim_time=True)) as ros:
        assert ros.now_ns() == 0  # nobody has told the time yet
        watch = ros.watch_jumps_back(lambda: jumps.append(ros.now_ns()))

        async def tell(milliseconds: int) -> None:
            seconds, rest = divmod(milliseconds, 1000)
            stamp = seconds.to_bytes(4, "little") + (rest * 1_000_000).to_bytes(4, "little")

            def has_arrived() -> bool:
                clock.publish(b"\0\1\0\0" + stamp)
                return ros.now_ns() == milliseconds * 1_000_000

            await eventually(has_arrived)

        for milliseconds in (1000, 1500, 3000):
            await tell(milliseconds)
        assert jumps == []
        await tell(2999)
        await eventually(lambda: jumps == [2_999_000_000])
        watch.close()
        watch.close()
        await tell(100)
        await tell(200)
        assert len(jumps) == 1


async def test_the_log_reaches_rosout_with_its_levels_and_not_the_terminal(outside, capfd) -> None:
    texts = {"traced": "debug", "done": "info", "strange": "warning", "broken": "error"}
    levels: dict[str, int] = {}

    def on_samples(samples: Sequence[Sample]) -> None:
        for sample in samples:
            levels.update({text: sample.cdr[12] for text in texts if text.encode() in sample.cdr})
            assert b"xr_debug" in sample.cdr

    outside.add_subscription("/rosout", LOG, on_samples, Qos(depth=100))
    async with open_ros(RosOptions(node_prefix="xr")) as ros:

        def arrived() -> bool:
            for text, level in texts.items():
                ros.log(level, text)
            return len(levels) == 3

        await eventually(arrived)
    assert levels == {"done": 20, "strange": 30, "broken": 40}  # nobody asked for debug
    ros.log("error", "after the end")
    assert "after the end" not in capfd.readouterr().err


async def test_without_rclpy_both_ways_to_get_it_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "rclpy", None)
    with pytest.raises(RosMissingError, match="pip install"):
        async with open_ros():
            pass


async def test_an_own_service_is_in_the_graph_before_dds_has_found_it(monkeypatch):
    nothing = Graph((), (), (), ())
    monkeypatch.setattr("gateway.sources.rclpy.known_graph.read_graph", lambda *_: nothing)
    for read in ("read_all_services", "read_actions"):
        monkeypatch.setattr(f"gateway.sources.rclpy.known_graph.{read}", lambda *_: ())
    async with open_ros() as ros:
        ros.services.serve("/arm", SET_BOOL, ignore)
        action = ros.actions.serve_action("/count", FIBONACCI, ignore, ignore)
        node = "/ros2_gateway_services"
        assert ros.graph().services == (ServerInfo("/arm", (SET_BOOL,), (node,)),)
        assert ros.graph().actions == (ServerInfo("/count", (FIBONACCI,), (node,)),)
        assert (ros.service_types("/arm"), ros.action_types("/count")) == (
            (SET_BOOL,),
            (FIBONACCI,),
        )
        action.close()
        assert (ros.graph().actions, ros.action_types("/count")) == ((), ())


async def test_there_are_few_threads() -> None:
    threads = ["ros_executor", "ros_graph", "ros_graph"]
    before = set(threading.enumerate())
    async with open_ros():
        assert sorted(each.name for each in set(threading.enumerate()) - before) == threads
    assert set(threading.enumerate()) == before


async def test_a_middleware_without_callbacks_is_refused_at_the_start(monkeypatch):
    unsupported = 3  # RMW_RET_UNSUPPORTED

    def refuse(self: ReadyCallbacks, kind: object, entity: object, *_: object) -> None:
        raise RuntimeError(f"rcl returned {unsupported}")

    monkeypatch.setattr(ReadyCallbacks, "_call", refuse)
    with pytest.raises(RosError, match=r"does not report arrivals \(rcl returned 3\): use RMW_"):
        async with open_ros():
            pass


@pytest.mark.long
async def test_fifty_rounds_of_each_kind_leave_nothing() -> None:
    requests: list[ServiceRequest] = []
    goals: list[GoalRequest] = []
    ros = RclpyRos(RosOptions())
    nodes: list[Node] = [
        *(ros.services._endpoints.node, ros._publishers._node),
        ros._subscriptions._node,
    ]

    def entities() -> list[int]:
        return [
            len(list(kind))
            for node in nodes
            for kind in (node.clients, node.services, node.publishers, node.subscriptions)
        ]

    async def round_of_each() -> None:
        service = ros.services.serve("/arm", SET_BOOL, requests.append)
        action = ros.actions.serve_action("/dock", FIBONACCI, goals.append, ignore)
        client = ros.services.client("/arm", SET_BOOL)
        action_client = ros.actions.action_client("/dock", FIBONACCI)
        tasks = [
            asyncio.ensure_future(client.call(b"\0\1\0\0\1")),
            asyncio.ensure_future(action_client.send_goal(CDR, ignore)),
        ]
        await asyncio.sleep(0)
        for each in (client, action_client, service, action):
            each.close()
        for task in tasks:
            with pytest.raises(RosError, match="is closed"):
                await task

    async def destroyed() -> None:
        """Wait for an action that had just answered: it is destroyed a little later."""
        await eventually(lambda: not ros._deferred._deferred)

    try:
        await round_of_each()
        await destroyed()
        before = (entities(), resources())
        for _ in range(50):
            await round_of_each()
        assert ros.entity_count() == 0
        await destroyed()
        assert entities() == before[0]
        await eventually(lambda: resources() <= before[1])
    finally:
        ros.close()


async def test_own_entities_enter_and_leave_the_graph_at_once() -> None:
    async with open_ros() as ros:

        def names() -> set[str]:
            graph = ros.graph()
            return {each.name for each in (*graph.topics, *graph.services, *graph.actions)}

        names()  # keeps it
        opened = [
            ros.advertise("/own_topic", "std_msgs/msg/String", Qos(), lambda _: None),
            ros.services.serve("/own_service", "std_srvs/srv/Trigger", lambda request: None),
            ros.actions.serve_action(
                "/own_action", "test_msgs/action/Fibonacci", lambda goal: None, lambda goal: None
            ),
        ]
        assert {"/own_topic", "/own_service", "/own_action"} <= names()
        for each in opened:
            each.close()
        assert not {"/own_topic", "/own_service", "/own_action"} & names()


async def test_the_services_behind_an_action_can_be_called_by_who_knows_them() -> None:
    async with open_ros() as ros:
        ros.actions.serve_action(
            "/own_action", "test_msgs/action/Fibonacci", lambda goal: None, lambda goal: None
        )
        cancel = "/own_action/_action/cancel_goal"
        await eventually(lambda: ros.service_types(cancel) == ("action_msgs/srv/CancelGoal",))
        assert cancel not in [service.name for service in ros.graph().services]


async def test_a_new_entity_is_known_before_the_thread_of_the_graph_reports_it(outside):
    async with open_ros() as ros:
        assert isinstance(ros, RclpyRos)
        assert ros.service_types("/new") == ros.action_types("/new") == ()
        outside.add_service("/new", SET_BOOL, ignore)
        outside.add_action_server("/new", FIBONACCI, ignore, ignore)
        deadline = time.monotonic() + TIMEOUT_S
        # without giving the loop a turn, in which it might hear of the change
        while not (
            {each.name for each in read_actions(ros._debug)} >= {"/new"}
            and {each.name for each in read_all_services(ros._debug)} >= {"/new"}
        ):
            assert time.monotonic() < deadline
            time.sleep(0.01)  # noqa: ASYNC251
        assert ros.service_types("/new") == (SET_BOOL,)
        assert ros.action_types("/new") == (FIBONACCI,)


async def test_nodes_that_share_their_name_hide_nothing_of_each_other(outside: Outside) -> None:
    with contextlib.closing(Outside("outside")) as twin:
        async with open_ros() as ros:
            for each, name in ((outside, "/first"), (twin, "/second")):
                each.add_service(name, SET_BOOL, ignore)
                each.add_action_server(name, FIBONACCI, ignore, ignore)
            for name in ("/first", "/second"):
                await eventually(lambda name=name: ros.service_types(name) == (SET_BOOL,))
                await eventually(lambda name=name: ros.action_types(name) == (FIBONACCI,))
            assert {"/first", "/second"} <= {each.name for each in ros.graph().services}
            assert {"/first", "/second"} <= {each.name for each in ros.graph().actions}


async def test_a_service_that_only_a_client_has_named_is_not_there(outside: Outside) -> None:
    async with open_ros() as ros:
        client = outside.add_client("/wanted", SET_BOOL)
        assert isinstance(ros, RclpyRos)
        names = ros._debug.get_service_names_and_types
        await eventually(lambda: "/wanted" in [name for name, _ in names()])
        assert ros.service_types("/wanted") == ()
        client.close()


async def test_ros_that_has_shut_down_below_the_gateway_is_a_fault_that_only_a_restart_mends():
    async with open_ros(RosOptions(node_prefix="fallen")) as ros:
        assert isinstance(ros, RclpyRos)
        assert list(ros.faults()) == []
        ros._debug.context.try_shutdown()
        (fault,) = ros.faults()
        assert (fault.severity, fault.text.partition(":")[0]) == (
            "dead",
            "ROS has shut down below the gateway",
        )


async def test_a_graph_that_nobody_follows_is_a_fault():
    async with open_ros(RosOptions(node_prefix="blind")) as ros:
        assert isinstance(ros, RclpyRos)
        changes = ros._changes[-1]
        changes._stopping.set()
        changes._wait_set.wake()
        changes._thread.join()
        assert [fault.text for fault in ros.faults()] == [
            "the thread that follows the ROS graph has ended"
        ]
