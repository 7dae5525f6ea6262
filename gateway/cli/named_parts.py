# SPDX-License-Identifier: Apache-2.0
"""The source and the front that ``serve --source`` and ``--front MODULE:FUNCTION`` name."""

import argparse
from importlib import import_module
from typing import TYPE_CHECKING, Any, cast

from gateway.cli.ros_environment import require_rclpy
from gateway.errors import UsageError

if TYPE_CHECKING:
    from gateway.app import OpenFront, OpenSource


def source_of(arguments: argparse.Namespace) -> "OpenSource | None":
    """Return the function that opens the source, or ``None`` for ROS 2.

    Raises:
        UsageError: the module cannot be imported, or does not have the function.
        RosMissingError: rclpy is needed and missing.
    """
    found = _named(arguments, "source")
    if found is None:
        require_rclpy()
    return cast("OpenSource | None", found)


def front_of(arguments: argparse.Namespace) -> "OpenFront | None":
    """Return the function that makes the front, or ``None`` for rosbridge.

    Raises:
        UsageError: the module cannot be imported, or does not have the function.
    """
    return cast("OpenFront | None", _named(arguments, "front"))


def _named(arguments: argparse.Namespace, part: str) -> Any:
    name = getattr(arguments, part, None)  # the simulated robot has no other
    if name is None:
        return None
    module_name, _, function = name.partition(":")
    try:
        found = getattr(import_module(module_name), function)
    except (ImportError, AttributeError, ValueError) as error:
        remedy = "name it as MODULE:FUNCTION, and its directory in PYTHONPATH"
        raise UsageError(f"--{part}: unknown {part} {name!r}, {error}: {remedy}") from error
    if not callable(found):
        raise UsageError(f"--{part}: {name} is not a function: name one that opens a {part}")
    return found
