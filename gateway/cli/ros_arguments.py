# SPDX-License-Identifier: Apache-2.0
"""The arguments that `ros2 run` and `ros2 launch` pass to a node, as our own flags.

The form is that of `ROS 2 <https://design.ros2.org/articles/ros_command_line_arguments.html>`_:
``--ros-args``, arguments, and ``--`` or the end.
"""

from collections.abc import Iterator, Sequence
from typing import Final

from gateway.errors import UsageError

_BEGIN: Final = "--ros-args"
_LEVELS: Final = {"warn": "warning", "fatal": "error"}
_NAMES: Final = {"__ns": "--namespace", "__node": "--node-prefix", "__name": "--node-prefix"}


def without_ros_arguments(arguments: Sequence[str]) -> list[str]:
    """Return *arguments* with flags of ``ros2-gateway`` in place of those of ROS.

    Raises:
        UsageError: one has no such flag.
    """
    ours: list[str] = []
    rest = iter(arguments)
    for argument in rest:
        if argument == _BEGIN:
            ours.extend(_flags(rest))
        else:
            ours.append(argument)
    return ours


def _flags(arguments: Iterator[str]) -> Iterator[str]:
    for argument in arguments:
        if argument == "--":
            return
        value = next(arguments, "")
        name, _, given = value.partition(":=")
        match argument:
            case "-r" | "--remap" if name in _NAMES:
                yield f"{_NAMES[name]}={given}"
            case "-p" | "--param" if given:
                setting = "ros.use_sim_time" if name == "use_sim_time" else name
                yield f"--set={setting}={given}"
            case "--log-level" if not given:
                yield f"--log-level={_LEVELS.get(name.lower(), name.lower())}"
            case _:
                raise UsageError(
                    f"{_BEGIN} {argument} {value}".rstrip() + " is not available: give a namespace"
                    " (-r __ns:=/NAME), a setting (-p KEY:=VALUE) or a level (--log-level LEVEL)"
                )
