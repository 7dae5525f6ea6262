# SPDX-License-Identifier: Apache-2.0
"""Keeps the tests' ROS apart from everybody else's, before anything imports rclpy.

Each worker of pytest-xdist is a separate process, and imports this.
"""

import asyncio
import os
import signal
import sys
import typing

import pytest
import typing_extensions
from hypothesis import HealthCheck, settings

from gateway import backports
from tests import dds_domain, interfaces

# The tests are written for newer Pythons. The product finds these names by itself.
if sys.version_info < (3, 11):
    for name in ("Runner", "TaskGroup", "timeout", "timeout_at"):
        setattr(asyncio, name, getattr(backports, name))
    for name in ("Never", "Self", "assert_never"):
        setattr(typing, name, getattr(typing_extensions, name))

    from taskgroup.tasks import task_factory

    class _Policy(asyncio.DefaultEventLoopPolicy):
        """Loops whose tasks know `uncancel` from the start.

        A TaskGroup moves the coroutine of another task into such a task until it is left. A fixture
        that yields in a TaskGroup ends its coroutine before that, and the first task runs it again.
        """

        def new_event_loop(self) -> asyncio.AbstractEventLoop:
            loop = super().new_event_loop()
            loop.set_task_factory(task_factory)
            return loop

    asyncio.set_event_loop_policy(_Policy())

# Also where the developer's shell is set up for a real robot: no test may ever move it.
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ["ROS_DOMAIN_ID"] = str(dds_domain.claim())
for variable in [name for name in os.environ if name.startswith("ROS2_GATEWAY_")]:
    del os.environ[variable]
interfaces.use()

# A shell ignores it for what it starts in the background, and so would every process that a test
# starts and means to end by it.
signal.signal(signal.SIGINT, signal.default_int_handler)

WORKERS_PER_CORE = 2  # tests wait half of their time: for DDS, processes, a robot that drives
MAX_WORKERS = 8  # more collect tests for longer than they run them


def pytest_configure(config: pytest.Config) -> None:
    """Let asyncio of Python 3.10 forget a failed handshake without closing its transport."""
    if sys.version_info < (3, 11):
        unclosed = "ignore:unclosed transport <asyncio.sslproto:ResourceWarning"
        config.addinivalue_line("filterwarnings", unclosed)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """Say how many workers ``-n auto`` starts."""
    return min(WORKERS_PER_CORE * len(os.sched_getaffinity(0)), MAX_WORKERS)


# A whole system is many processes, a browser, a robot that drives: most of the suite's time.
WHOLE_SYSTEMS = ("tests/e2e/", "tests/pages/")


@pytest.hookimpl(tryfirst=True)  # before pytest leaves out what `-m` says
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark as ``long`` what tries a whole system, except for one of each kind, marked ``brief``."""
    for item in items:
        if item.nodeid.startswith(WHOLE_SYSTEMS) and item.get_closest_marker("brief") is None:
            item.add_marker("long")


# How fast an example is made or tested says more about the machine than about the code.
_UNTIMED = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
# The same examples each time: a failure is that of the change at hand, and comes again.
settings.register_profile("ci", _UNTIMED, max_examples=50, derandomize=True, database=None)
settings.register_profile("deep", _UNTIMED, max_examples=2000)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "ci"))
