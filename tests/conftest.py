# SPDX-License-Identifier: Apache-2.0
"""Keeps the tests' ROS apart from everybody else's, before anything imports rclpy."""

import os
import signal

from tests import interfaces

# Also where the developer's shell is set up for a real robot: no test may ever move it.
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ["ROS_DOMAIN_ID"] = str(1 + os.getpid() % 100)  # above 101 its ports are others', too
for variable in [name for name in os.environ if name.startswith("ROS2_GATEWAY_")]:
    del os.environ[variable]
interfaces.use()

# A shell ignores it for what it starts in the background, and so would every process that a test
# starts and means to end by it.
signal.signal(signal.SIGINT, signal.default_int_handler)
