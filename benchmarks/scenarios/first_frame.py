# SPDX-License-Identifier: Apache-2.0
"""The time to a client's first frame, whether the publisher or the client comes first.

The floor is a bare rclpy subscriber in the same place. At 50 Hz half a period, 10 ms, passes on
average before there is anything to receive.
"""

import statistics
import time
from typing import Final

from benchmarks.actors.connection import RawConnection
from benchmarks.figures import Figure
from benchmarks.plan import Plan
from benchmarks.processes import acting, wait_until
from benchmarks.receivers import Floor, Receiver, ReceivingClient, publishing
from benchmarks.samples import SAMPLES, topic
from benchmarks.servers import MeasuredServer

_SCENARIO: Final = "first-frame"
_SAMPLE: Final = "odometry"
_RATE_HZ: Final = 50.0
_SETTLED_S: Final = 3.0
_SUBSCRIPTIONS: Final = 20
_LATE_PUBLISHERS: Final = 5
_PAUSE_S: Final = 0.3  # between subscriptions
_TIMEOUT_S: Final = 20.0


def measure(plan: Plan) -> list[Figure]:
    """Print a table and return the figures."""
    print(f"first frame of {_SAMPLE} at {_RATE_HZ:g} Hz, ms")
    print(f"  {'':28}{'':16}{'median':>8}{'least':>8}{'most':>8}")
    figures: list[Figure] = []
    with publishing(_SAMPLE, _RATE_HZ):
        time.sleep(_SETTLED_S)
        figures += _row("publisher first", "floor", _floor_subscribes())
        for server in plan.servers:
            figures += _row("publisher first", server.name, _client_subscribes(server))
    receivers: list[Receiver] = [Floor(), *(ReceivingClient(server) for server in plan.servers)]
    for receiver in receivers:
        waits_ms = [_late_publisher(receiver) for _ in range(_LATE_PUBLISHERS)]
        figures += _row("subscriber first", receiver.name, waits_ms)
    return figures


def _floor_subscribes() -> list[float]:
    waits_ms = []
    with acting("first_floor", _SAMPLE) as subscriber:
        subscriber.answer()
        time.sleep(_SETTLED_S)  # the participants have discovered each other, as a server's have
        for number in range(_SUBSCRIPTIONS):
            subscriber.ask("subscribe")
            asked_ns, came_ns = subscriber.answer(_TIMEOUT_S)
            waits_ms.append((came_ns - asked_ns) / 1e6)
            time.sleep(_pause_s(number))
    return waits_ms


def _client_subscribes(server: MeasuredServer) -> list[float]:
    waits_ms = []
    pattern = SAMPLES[_SAMPLE].clockwork.pattern
    with server.running() as (url, _):
        time.sleep(_SETTLED_S)
        for number in range(_SUBSCRIPTIONS):
            with RawConnection(url) as connection:
                connection.limit(_TIMEOUT_S)
                asked_s = time.perf_counter()
                connection.send({"op": "subscribe", "topic": topic(_SAMPLE)})
                while not any(map(pattern.search, connection.receive())):
                    pass
                waits_ms.append((time.perf_counter() - asked_s) * 1e3)
            time.sleep(_pause_s(number))
    return waits_ms


def _pause_s(number: int) -> float:
    """Return a pause that spreads the subscriptions evenly over the period.

    Each ends with a frame, so after equal pauses all would begin at the same time before a frame.
    """
    return _PAUSE_S + number / _SUBSCRIPTIONS / _RATE_HZ


def _late_publisher(receiver: Receiver) -> float:
    """Return the time from the first call of publish() to the first message, in ms."""
    with (
        receiver.receiving(_SAMPLE) as reception,
        acting("publisher", _SAMPLE, 1, "0/1", "late") as publisher,
    ):
        publisher.answer()
        time.sleep(_SETTLED_S)  # the participants have discovered each other
        published_ns = publisher.ask("go", _RATE_HZ)
        wait_until(lambda: reception.count() > 1, f"{receiver.name} gets a first message")
        return (int(reception.report()["first_ns"]) - int(published_ns)) / 1e6


def _row(case: str, who: str, waits_ms: list[float]) -> list[Figure]:
    median_ms = statistics.median(waits_ms)
    print(
        f"  {case:28}{who:16}{median_ms:8.1f}{min(waits_ms):8.1f}{max(waits_ms):8.1f}", flush=True
    )
    return [Figure(_SCENARIO, f"{who}, {case}", median_ms, "ms")]
