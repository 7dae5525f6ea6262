# SPDX-License-Identifier: Apache-2.0
"""The gateway, which nothing forces to end, and which reports what its end costs.

A busy machine takes longer for an orderly end than the gateway waits for one. So this counts the
CPU time, and the time in which no process of the machine waited for a core: whatever passes then,
the gateway itself has waited for.
"""

import contextlib
import re
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from gateway import app
from gateway.cli.main import main

_PRESSURE = Path("/proc/pressure/cpu")  # not in every container


def idle_s() -> float:
    """Return the seconds in which nobody had to wait for a core; 0 where that is not known."""
    try:
        text = _PRESSURE.read_text()
    except OSError:
        return 0
    return time.monotonic() - int(re.findall(r"some .*total=(\d+)", text)[0]) / 1e6


@contextlib.contextmanager
def reported_end() -> Iterator[Callable[[], None]]:
    began_s: list[float] = []
    yield lambda: began_s.extend((time.process_time(), idle_s()))
    cpu_s, quiet_s = time.process_time() - began_s[0], idle_s() - began_s[1]
    sys.stderr.write(f"ended within {max(cpu_s, quiet_s):.3f} s of its own\n")


if __name__ == "__main__":
    app._forced_end = reported_end
    sys.exit(main())
