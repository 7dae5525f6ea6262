# SPDX-License-Identifier: Apache-2.0
"""The source that ``serve --source MODULE:FUNCTION`` names."""

import argparse
from importlib import import_module
from typing import TYPE_CHECKING, cast

from gateway.cli.ros_environment import require_rclpy
from gateway.errors import UsageError

if TYPE_CHECKING:
    from gateway.app import OpenSource


def source_of(arguments: argparse.Namespace) -> "OpenSource | None":
    """Return the function that opens the source, or ``None`` for ROS 2.

    Raises:
        UsageError: the module cannot be imported, or does not have the function.
        RosMissingError: rclpy is needed and missing.
    """
    name = getattr(arguments, "source", None)  # the simulated robot has no other
    if name is None:
        require_rclpy()
        return None
    module_name, _, function = name.partition(":")
    try:
        found = getattr(import_module(module_name), function)
    except (ImportError, AttributeError, ValueError) as error:
        remedy = "name it as MODULE:FUNCTION, and its directory in PYTHONPATH"
        raise UsageError(f"--source: unknown source {name!r}, {error}: {remedy}") from error
    if not callable(found):
        raise UsageError(f"--source: {name} is not a function: name one that opens a source")
    return cast("OpenSource", found)
