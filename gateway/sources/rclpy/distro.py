# SPDX-License-Identifier: Apache-2.0
"""The distribution of ROS that this is."""

import os
from importlib import metadata
from typing import Final

# by the first number of rclpy's version (REP 2000 lists what belongs to a distribution)
_OF_RCLPY: Final = {"7": "jazzy", "9": "kilted"}


def distro() -> str:
    """Return its name: that of the sourced installation, otherwise that of the wheels.

    ``unknown`` if neither says.
    """
    sourced = os.environ.get("ROS_DISTRO")
    if sourced:
        return sourced
    try:
        version = metadata.version("rclpy")
    except metadata.PackageNotFoundError:
        return "unknown"
    return _OF_RCLPY.get(version.partition(".")[0], "unknown")
