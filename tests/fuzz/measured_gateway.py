# SPDX-License-Identifier: Apache-2.0
"""The gateway on a loop that reports what holds it for too long. Its tests send SIGRTMIN to begin.

The time is that of the loop's thread on a CPU, so other programs do not matter, and a callback that
waits for the GIL is not blamed. A record of the log is a fault for the conversations. It
has the time of garbage collection, and the number of page faults.
"""

import asyncio
import gc
import logging
import os
import resource
import signal
import sys
import time
from collections.abc import Callable
from functools import partial
from typing import Any, Final

# An operation may take 20 ms. A callback may also take the slice of operations before it. If
# others share the caches and the cores' threads, CPU time grows by half. Then raise the bar.
BAR_S: Final = float(os.environ.get("FUZZ_BAR_MS", "24")) / 1e3

logger = logging.getLogger("gateway.measured")


class MeasuredLoop(asyncio.SelectorEventLoop):
    """Measures each callback, the steps of tasks among them."""

    longest_s = 0.0
    collecting_s = 0.0
    is_measuring = False

    def call_soon(self, callback: Callable[..., Any], *args: Any, **more: Any) -> Any:
        return super().call_soon(self._measured(callback), *args, **more)

    def call_soon_threadsafe(self, callback: Callable[..., Any], *args: Any, **more: Any) -> Any:
        return super().call_soon_threadsafe(self._measured(callback), *args, **more)

    def call_at(self, when: float, callback: Callable[..., Any], *args: Any, **more: Any) -> Any:
        return super().call_at(when, self._measured(callback), *args, **more)

    def _add_reader(self, fd: Any, callback: Callable[..., Any], *args: Any) -> Any:
        return super()._add_reader(fd, self._measured(callback), *args)

    def _add_writer(self, fd: Any, callback: Callable[..., Any], *args: Any) -> Any:
        return super()._add_writer(fd, self._measured(callback), *args)

    def _measured(self, callback: Callable[..., Any]) -> Callable[..., Any]:
        return partial(self._call, callback)

    def _call(self, callback: Callable[..., Any], *args: Any) -> Any:
        collecting_s, page_faults = MeasuredLoop.collecting_s, _page_faults()
        started_s = time.thread_time()
        try:
            return callback(*args)
        finally:
            took_s = time.thread_time() - started_s
            if MeasuredLoop.is_measuring:
                MeasuredLoop.longest_s = max(MeasuredLoop.longest_s, took_s)
                if took_s > BAR_S:
                    logger.error(
                        "held the loop for %.1f ms, with %.1f of garbage and %d page faults: %r",
                        took_s * 1e3,
                        (MeasuredLoop.collecting_s - collecting_s) * 1e3,
                        _page_faults() - page_faults,
                        callback,
                    )


def _page_faults() -> int:
    usage = resource.getrusage(resource.RUSAGE_THREAD)
    return usage.ru_minflt + usage.ru_majflt


def _count_collection(phase: str, _: object) -> None:
    """Add up the time of collections in any thread, because each holds the GIL."""
    now_s = time.thread_time()
    MeasuredLoop.collecting_s += -now_s if phase == "start" else now_s


def begin(*_: Any) -> None:
    MeasuredLoop.is_measuring = True


def run() -> None:
    from gateway import app
    from gateway.cli.main import main

    app.loop_factory = lambda: MeasuredLoop
    signal.signal(signal.SIGRTMIN, begin)
    gc.callbacks.append(_count_collection)
    code = main()
    print(f"longest: {MeasuredLoop.longest_s * 1e3:.1f} ms", file=sys.stderr, flush=True)
    os._exit(code)


if __name__ == "__main__":
    run()
