# SPDX-License-Identifier: Apache-2.0
"""The command `record`."""

import argparse
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING

from gateway.cli.output import announce
from gateway.cli.report import EXIT_FAILURE, EXIT_OK
from gateway.cli.ros_environment import require_rclpy, use_ros
from gateway.errors import UsageError
from gateway.log_fields import counted

if TYPE_CHECKING:
    from gateway.config.settings import Loaded
    from gateway.recording.active_recording import RecordingStatus

_NODE_PREFIX = "ros2_gateway_record"  # next to a gateway that serves


def record(
    arguments: argparse.Namespace, loaded: "Loaded", was_interrupted: Callable[[], bool]
) -> int:
    """Record the topics of this ROS 2 system."""
    config = loaded.config
    if loaded.origins["ros.node_prefix"] == "default":
        ros = config.ros.model_copy(update={"node_prefix": _NODE_PREFIX})
        config = config.model_copy(update={"ros": ros})
    use_ros(config.ros.domain_id)
    require_rclpy()
    from gateway.record_app import record
    from gateway.recording.active_recording import RecordingPlan

    plan = RecordingPlan(topics=_checked(arguments.topic), images=arguments.images)
    progress = _Progress()
    status = record(config, plan, progress.show, was_interrupted)
    progress.end()
    announce("\n".join(_summary(status)))
    return EXIT_FAILURE if status.why else EXIT_OK


class _Progress:
    """Shows the place of the recording, and on a terminal how much it has."""

    def __init__(self) -> None:
        self._is_announced = False
        self._is_on_line = False

    def show(self, status: "RecordingStatus") -> None:
        """Show the state."""
        if status.state != "recording":
            return
        if not self._is_announced:
            self._is_announced = True
            announce(f"recording to {status.path}, press Ctrl-C to end")
        if sys.stderr.isatty():
            self._is_on_line = True
            sys.stderr.write(f"\r{_amount(status)}\x1b[K")
            sys.stderr.flush()

    def end(self) -> None:
        """Leave the line of the terminal."""
        if self._is_on_line:
            sys.stderr.write("\n")


def _checked(globs: list[str]) -> list[str]:
    from pydantic import TypeAdapter, ValidationError

    from gateway.config.access import Globs

    try:
        TypeAdapter(Globs).validate_python(tuple(globs))
    except ValidationError as error:
        raise UsageError(
            f"--topic: got {' '.join(globs)}, expected globs such as '/camera/**' or '/*/odom'"
        ) from error
    return globs


def _amount(status: "RecordingStatus") -> str:
    return (
        f"{counted(status.messages, 'message')} of {counted(status.topics, 'topic')},"
        f" {status.size / 1e6:.1f} MB in {status.duration_s:.0f} s"
    )


def _summary(status: "RecordingStatus") -> list[str]:
    lines = [f"recorded {_amount(status)}: {status.path}"]
    if status.why:
        lines.append(f"the recording has ended by itself: {status.why}")
    if status.dropped:
        text = f"{counted(status.dropped, 'message')} dropped, because the disk was too slow"
        lines.append(f"{text}: record fewer topics, or raise recording.queue_bytes")
    if status.lost:
        lines.append(f"{counted(status.lost, 'message')} lost before they could be recorded")
    lines += [f"not complete: {text}" for text in status.problems.values()]
    return lines
