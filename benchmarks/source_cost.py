# SPDX-License-Identifier: Apache-2.0
"""``python -m benchmarks.source_cost zenoh|rclpy``: CPU time of a source for each sample.

A process publishes odometry. This process subscribes through the source alone, without clients, and
measures the CPU time of all its threads.
"""

import argparse
import asyncio
import contextlib
import os
import subprocess
import sys
import time
from collections.abc import AsyncIterator, Callable, Iterator, Sequence
from typing import Any, Final

from gateway.codec.types import Types
from gateway.sources.options import RosOptions
from gateway.sources.source import Qos, Sample, Source, TopicEvent
from schemas.installed import InstalledDefinitions
from schemas.type_hash import type_hash

TOPIC: Final = "/odom"
TYPE: Final = "nav_msgs/msg/Odometry"
DOMAIN: Final = 117
WARM_UP_SAMPLES: Final = 500


async def measure(kind: str, hz: float, samples: int, port: int) -> float:
    """Return the microseconds of CPU time for each sample."""
    address = f"tcp/127.0.0.1:{port}"
    async with contextlib.AsyncExitStack() as stack:
        if kind == "zenoh":
            stack.enter_context(_running("router", address, hz))
        source = await stack.enter_async_context(_opened(kind, address))
        stack.enter_context(_running(f"publish-{kind}", address, hz))
        seen = 0
        warm, done = asyncio.Event(), asyncio.Event()

        def count(new: Sequence[Sample]) -> None:
            nonlocal seen
            seen += len(new)
            if seen >= WARM_UP_SAMPLES:
                warm.set()
            if seen >= WARM_UP_SAMPLES + samples:
                done.set()

        source.subscribe(TOPIC, TYPE, Qos(), count, _nobody)
        await warm.wait()
        first, began = seen, time.process_time_ns()
        await done.wait()
        return (time.process_time_ns() - began) / 1000 / (seen - first)


@contextlib.asynccontextmanager
async def _opened(kind: str, address: str) -> AsyncIterator[Source]:
    definitions = InstalledDefinitions()
    options = RosOptions(domain_id=DOMAIN)
    if kind == "rclpy":
        from gateway.sources.rclpy import open_ros

        async with open_ros(options, definitions) as ros:
            yield ros
        return
    from gateway.sources.zenoh.options import ZenohOptions
    from gateway.sources.zenoh.port import ZenohSource
    from gateway.sources.zenoh.session import open_session

    session = await asyncio.to_thread(open_session, ZenohOptions(address))
    with contextlib.closing(ZenohSource(session, options, definitions)) as source:
        yield source


@contextlib.contextmanager
def _running(role: str, address: str, hz: float) -> Iterator[None]:
    command = (sys.executable, "-m", "benchmarks.source_cost", role, "--address", address)
    process = subprocess.Popen((*command, "--hz", str(hz)), stdout=subprocess.PIPE)
    try:
        assert process.stdout is not None
        process.stdout.readline()
        yield
    finally:
        process.terminate()
        process.wait()


def _router(address: str) -> None:
    import json

    import zenoh

    config = zenoh.Config()
    config.insert_json5("mode", '"router"')
    config.insert_json5("listen/endpoints", json.dumps([address]))
    config.insert_json5("scouting/multicast/enabled", "false")
    session: Any = zenoh.open(config)
    print("ready", flush=True)
    time.sleep(3600)
    del session


def _zenoh_publisher(address: str) -> Callable[[bytes], None]:
    import itertools

    from gateway.sources.zenoh.attachment import Attachment
    from gateway.sources.zenoh.keys import DataKey
    from gateway.sources.zenoh.options import ZenohOptions
    from gateway.sources.zenoh.session import ZenohSession, open_session
    from gateway.sources.zenoh.tokens import gid_of

    definitions = InstalledDefinitions()
    session = ZenohSession(open_session(ZenohOptions(address)), DOMAIN)
    session.add_node("/robot")
    key = DataKey(DOMAIN, TOPIC, TYPE, type_hash(definitions.get(TYPE), definitions))
    gid = gid_of(session.add_endpoint("/robot", "MP", key, Qos("reliable", "volatile", depth=10)))
    publisher, numbers = session.zenoh.declare_publisher(key.text), itertools.count(1)

    # with the session as a default: without a reference to it, Zenoh closes it
    def publish(cdr: bytes, _: ZenohSession = session) -> None:
        attachment = Attachment(next(numbers), time.time_ns(), gid).packed
        publisher.put(cdr, attachment=attachment)

    return publish


def _rclpy_publisher() -> Callable[[bytes], None]:
    import rclpy
    from nav_msgs.msg import Odometry

    rclpy.init(domain_id=DOMAIN)
    publisher = rclpy.create_node("robot").create_publisher(Odometry, TOPIC, 10)
    publish: Callable[[bytes], None] = publisher.publish
    return publish


def _publish(publish: Callable[[bytes], None], hz: float) -> None:
    cdr = Types(InstalledDefinitions()).get(TYPE).encode({"child_frame_id": "base_link"}, 0)
    print("ready", flush=True)
    next_s = time.monotonic()
    while True:
        publish(cdr)
        next_s += 1 / hz
        time.sleep(max(0.0, next_s - time.monotonic()))


def _nobody(_: TopicEvent) -> None:
    """Hear of events."""


def main() -> None:
    """Measure, or be one of the processes next to it."""
    roles = ("zenoh", "rclpy", "router", "publish-zenoh", "publish-rclpy")
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("role", choices=roles)
    parser.add_argument("--hz", type=float, default=1000.0)
    parser.add_argument("--samples", type=int, default=5000)
    parser.add_argument("--port", type=int, default=21750)
    parser.add_argument("--address", default="")
    options = parser.parse_args()
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    if options.role == "router":
        _router(options.address)
    elif options.role == "publish-zenoh":
        _publish(_zenoh_publisher(options.address), options.hz)
    elif options.role == "publish-rclpy":
        _publish(_rclpy_publisher(), options.hz)
    else:
        cost = asyncio.run(measure(options.role, options.hz, options.samples, options.port))
        print(f"{options.role}: {cost:.0f} us of CPU time for each sample at {options.hz:g} Hz")


if __name__ == "__main__":
    main()
