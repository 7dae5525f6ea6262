# SPDX-License-Identifier: Apache-2.0
"""A Zenoh router in a separate process, as ``ros2-gateway router`` opens one."""

import sys
import threading

from tests.sources.zenoh.outside import session

if __name__ == "__main__":
    router = session(mode="router", **{"listen/endpoints": [sys.argv[1]]})
    sys.stdout.write("ready\n")
    sys.stdout.flush()
    threading.Event().wait()
