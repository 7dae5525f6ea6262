# SPDX-License-Identifier: Apache-2.0
"""The reports to systemd about this process: ready, alive, ending (sd_notify(3)).

systemd names a socket in the environment of a service of `Type=notify`. Without it, nothing is
reported. A service that stops to report that it is alive is killed, and started again.
"""

import asyncio
import contextlib
import os
import socket
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Final

PERIODS: Final = 3  # reports in the time after which systemd takes a service for dead


@contextmanager
def reporting_to_systemd(environment: Mapping[str, str]) -> Iterator[Callable[[], None]]:
    """Report that the running event loop is alive, and at the end that it ends.

    Yield a function that reports that the service is ready.
    """
    address = environment.get("NOTIFY_SOCKET", "")
    if not address:
        yield lambda: None
        return
    if address.startswith("@"):  # an abstract one
        address = "\0" + address[1:]
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK) as sender:

        def tell(state: str) -> None:
            with contextlib.suppress(OSError):  # a service manager that is gone needs no report
                sender.sendto(state.encode(), address)

        feeding = asyncio.create_task(_feed(tell, _watchdog_s(environment)))
        try:
            yield lambda: tell("READY=1")
        finally:
            tell("STOPPING=1")
            feeding.cancel()


async def _feed(tell: Callable[[str], None], watchdog_s: float) -> None:
    while watchdog_s:
        tell("WATCHDOG=1")
        await asyncio.sleep(watchdog_s / PERIODS)


def _watchdog_s(environment: Mapping[str, str]) -> float:
    """Return the time without a report after which systemd ends this process. 0 is never."""
    text = environment.get("WATCHDOG_USEC", "")
    is_ours = environment.get("WATCHDOG_PID", str(os.getpid())) == str(os.getpid())
    return int(text) / 1e6 if text.isdecimal() and is_ours else 0.0
