# SPDX-License-Identifier: Apache-2.0
"""A recording with episodes whose every value is known."""

from pathlib import Path
from typing import Any, Final

import cv2
import numpy as np

from gateway.codec.types import Types
from gateway.core.rosapi.typedefs import full_text
from gateway.definitions import known_definitions
from gateway.recording.entries import RecordedMessage, RecordedNote, RecordedTopic
from gateway.recording.mcap_file import RecordingFile
from schemas.type_hash import type_hash

START_NS: Final = 1_700_000_000_000_000_000
MS: Final = 1_000_000
MAPPING: Final = """
fps = 10
robot_type = "tested"
task = "wait"

[[state]]
topic = "/odom"
fields = { x = "pose.pose.position.x", first = "pose.covariance[0]" }

[[action]]
topic = "/cmd_vel"
fields = { speed = "linear.x" }
max_age_s = 0.25
default = 0.0

[[image]]
name = "front"
topic = "/camera/compressed"

[[image]]
name = "wrist"
topic = "/wrist"
"""

_TYPES: Final = Types(known_definitions([], "test"))


class Recording:
    """A file that is being written. Times are milliseconds from its start."""

    def __init__(self, folder: Path) -> None:
        folder.mkdir()
        self.folder = folder
        self._file = RecordingFile(folder / "a_0.mcap", "test")
        self._topics: dict[str, RecordedTopic] = {}

    def note(self, name: str, at_ms: int, **values: str) -> None:
        time = {"time_ns": str(START_NS + at_ms * MS)}
        self._file.note(RecordedNote(f"episode/{name}", {**values, **time}))

    def episode(self, number: int, at_ms: int, end_ms: int, success: str, task: str = "") -> None:
        self.note(f"{number}/start", at_ms, task=task, operator="")
        self.note(f"{number}/end", end_ms, success=success)

    def add(self, at_ms: int, topic: str, type_name: str, **values: Any) -> None:
        message_type = _TYPES.get(type_name)
        if topic not in self._topics:
            hash_text = type_hash(message_type.definition, _TYPES.definitions)
            text = full_text(type_name, _TYPES.definitions)
            self._topics[topic] = RecordedTopic(topic, type_name, text, hash_text, "")
        at_ns = START_NS + at_ms * MS
        cdr = message_type.encode(values, 0)
        self._file.add(RecordedMessage(at_ns, at_ns, self._topics[topic], cdr))

    def odometry(self, at_ms: int, x: float) -> None:
        pose = {"position": {"x": x}, "orientation": {"w": 1}}
        pose_with_covariance = {"pose": pose, "covariance": [x * 2] + [0.0] * 35}
        self.add(at_ms, "/odom", "nav_msgs/msg/Odometry", pose=pose_with_covariance)

    def command(self, at_ms: int, x: float) -> None:
        self.add(at_ms, "/cmd_vel", "geometry_msgs/msg/Twist", linear={"x": x})

    def images(self, at_ms: int, grey: int, *, width: int = 64) -> None:
        """Add a JPEG, whose red differs, and a raw image with odd sides."""
        pixels = np.full((48, width, 3), (grey, grey, 255 - grey), np.uint8)
        jpeg = cv2.imencode(".jpg", pixels)[1].tobytes()
        type_name = "sensor_msgs/msg/CompressedImage"
        self.add(at_ms, "/camera/compressed", type_name, format="jpeg", data=list(jpeg))
        self.add(
            *(at_ms, "/wrist", "sensor_msgs/msg/Image"),
            height=17,
            width=33,
            encoding="mono8",
            step=33,
            data=[grey] * (17 * 33),
        )

    def finish(self) -> Path:
        self._file.finish()
        return self.folder
