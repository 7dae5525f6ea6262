# SPDX-License-Identifier: Apache-2.0
"""The orders of a program that sends.

``run RATE COUNT`` sends COUNT samples at that rate, and answers with the number and the time that
it took. ``go RATE`` sends until the end or until ``stop``, and answers with the time of the first.
``stop`` answers as ``run`` does. ``count`` answers with the number of samples so far.
"""

import math
import queue
import threading
import time
from collections.abc import Callable, Mapping

from benchmarks.actors.orders import obey, reply
from benchmarks.actors.pace import paced


def do_runs(
    send: Callable[[], object], further_orders: Mapping[str, Callable[..., object]] | None = None
) -> None:
    """Report readiness, and obey until the end of stdin, sending in this thread."""
    jobs: queue.SimpleQueue[tuple[float, float] | None] = queue.SimpleQueue()
    over, stopped = threading.Event(), threading.Event()
    sent = 0

    def send_one() -> None:
        nonlocal sent
        send()
        sent += 1

    def end() -> None:
        over.set()
        jobs.put(None)

    obey(
        {
            "run": lambda rate_hz, count: jobs.put((float(rate_hz), int(count))),
            "go": lambda rate_hz: jobs.put((float(rate_hz), math.inf)),
            "stop": stopped.set,
            "count": lambda: sent,
            **(further_orders or {}),
        },
        end,
    )
    reply("ready")
    while (job := jobs.get()) is not None:
        rate_hz, count = job
        before = sent
        stopped.clear()
        if math.isinf(count):
            reply(time.time_ns())
        seconds = paced(send_one, rate_hz, count, lambda: over.is_set() or stopped.is_set())
        if not over.is_set():
            reply({"sent": sent - before, "seconds": seconds})
