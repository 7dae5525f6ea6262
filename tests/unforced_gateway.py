# SPDX-License-Identifier: Apache-2.0
"""The gateway, which nothing forces to end, and which reports what its end costs.

A busy machine takes longer for an orderly end than the gateway waits for one, but as much CPU time.
"""

import contextlib
import sys
import time
from collections.abc import Callable, Iterator

from gateway import app
from gateway.cli.main import main


@contextlib.contextmanager
def reported_end() -> Iterator[Callable[[], None]]:
    began_s: list[float] = []
    yield lambda: began_s.append(time.process_time())
    took_s = time.process_time() - began_s[0]
    sys.stderr.write(f"ended within {took_s:.3f} s of CPU\n")


if __name__ == "__main__":
    app._forced_end = reported_end
    sys.exit(main())
