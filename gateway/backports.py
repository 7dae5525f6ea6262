# SPDX-License-Identifier: Apache-2.0
"""Newer names of the standard library for Python 3.10, which ROS 2 Humble has."""

import sys
from typing import Any

if sys.version_info >= (3, 11):
    from asyncio import Runner, TaskGroup, timeout, timeout_at
else:
    from taskgroup import Runner, TaskGroup, timeout, timeout_at


def tls_timeouts(handshake_s: float, shutdown_s: float) -> dict[str, Any]:
    """Return the times that ``loop.create_server`` takes. Before Python 3.11 there is no second."""
    later = {"ssl_shutdown_timeout": shutdown_s} if sys.version_info >= (3, 11) else {}
    return {"ssl_handshake_timeout": handshake_s, **later}


__all__ = ["Runner", "TaskGroup", "timeout", "timeout_at", "tls_timeouts"]
