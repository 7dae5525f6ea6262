# SPDX-License-Identifier: Apache-2.0
"""Everything that can be measured, by the names of the command line."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final

from benchmarks import unity
from benchmarks.figures import Figure
from benchmarks.plan import Plan
from benchmarks.samples import OFFERED_IMAGE, SAMPLES
from benchmarks.scenarios import (
    beside_floor,
    bursts,
    codec,
    fan_out,
    first_frame,
    floods,
    giant,
    growth,
    hostile,
    idle,
    inbound,
    links,
    many_topics,
    one_more,
    peers,
    playing,
    recording,
    robot,
    slow_client,
    start_up,
    starved,
    steps,
    turns,
)


@dataclass(frozen=True)
class Scenario:
    """Something to measure."""

    about: str
    takes: str
    """The duration, as a text, with the usual rounds and seconds."""
    measure: Callable[[Plan], Sequence[Figure]]


def _unity(_: Plan) -> list[Figure]:
    unity.main()
    return []


SCENARIOS: Final[dict[str, Scenario]] = {
    name: Scenario(
        f"at {sample.rate_hz:g} Hz next to a bare rclpy subscriber, and the highest rates held",
        "3 min",
        partial(beside_floor.measure, name),
    )
    for name, sample in SAMPLES.items()
    if name != OFFERED_IMAGE
} | {
    "fan-out": Scenario("one topic to 1 ... 200 clients", "3 min", fan_out.measure),
    "many-topics": Scenario("60 topics to 5 clients", "30 s", many_topics.measure),
    "robot": Scenario("a robot of 20 topics to 10 clients", "1 min", robot.measure),
    "starved": Scenario("the same robot next to eight busy loops", "1 min", starved.measure),
    "bursts": Scenario("500 messages back to back to one client", "2 min", bursts.measure),
    "inbound": Scenario("from a client into ROS", "2 min", inbound.measure),
    "first-frame": Scenario("from subscribe to the first frame", "1 min", first_frame.measure),
    "slow-client": Scenario(
        "one client that reads nothing, or slowly, next to 3 that read",
        "2.5 min",
        slow_client.measure,
    ),
    "links": Scenario("slow links: how old is what arrives", "11 min", links.measure),
    "giant": Scenario("Odometry next to messages of 16 MB", "3 min", giant.measure),
    "start-up": Scenario(
        "from start to the first handshake, and from SIGKILL to all clients",
        "1 min",
        start_up.measure,
    ),
    "idle": Scenario("60 subscriptions to silent topics", "40 s", idle.measure),
    "one-more": Scenario(
        "one more subscription, advertisement and connection", "1 min", one_more.measure
    ),
    "peers": Scenario(
        "next to a server of foxglove-sdk, to 1 ... 200 clients", "25 min", peers.measure
    ),
    "play": Scenario(
        "a recording of 20 topics at 1 and 10 times its speed, of cameras, and jumps in 1 GB",
        "1 min",
        playing.measure,
    ),
    "record": Scenario(
        "the same robot to 10 clients, not recorded, and recorded with raw images and JPEGs",
        "2 min",
        recording.measure,
    ),
    "growth": Scenario("cost by rate, clients, idle topics and uptime", "5 min", growth.measure),
    "floods": Scenario("a driver and a stop next to 8 clients that flood", "2 min", floods.measure),
    "hostile": Scenario("the frames that hold the event loop longest", "1 min", hostile.measure),
    "turns": Scenario("the longest turn of the loop for large frames", "1 min", turns.measure),
    "steps": Scenario("the cost of each step, for Odometry and Image", "8 min", steps.measure),
    "codec": Scenario(
        "CDR to JSON and to CBOR, and deflated, without a network", "20 s", codec.measure
    ),
    "unity": Scenario("the Unity client under Mono", "1 min", _unity),
}

# the default of a comparison: a few minutes, every kind of ratio, no large messages
COMPARED: Final = (
    *("string", "twist", "odometry", "laser-scan", "compressed-image"),
    *("inbound", "fan-out"),
)
