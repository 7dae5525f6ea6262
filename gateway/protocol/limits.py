# SPDX-License-Identifier: Apache-2.0
"""What one client may use up."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Limits:
    """The bounds of one session; a rate of 0 switches that limit off."""

    message_bytes: int = 256 * 1024  # a 15 MB JSON bomb holds the interpreter for seconds
    json_depth: int = 32  # the deepest installed message type nests 8 levels
    json_items: int = 100_000  # more than any picture-free message of 256 KiB holds
    name_characters: int = 200  # DDS topic names end at 255, prefixes and suffixes included
    frames_per_s: float = 2000
    frames_burst: int = 4000
    operations_per_s: float = 200  # two hands on joysticks at 60 Hz, and room for a page's start
    operations_burst: int = 400
    subscriptions: int = 64
    advertisements: int = 32  # of topics, of services and of actions
    pending_calls: int = 16  # under way at once; as many more as `MAX_WAITING_CALLS` wait
    goals: int = 16  # a goal may take minutes, so they do not count as calls
    transforms: int = 16  # repeated lookups: head, two hands, and the robot's main frames
    service_timeout_s: float = 5  # where a call does not say; what rosbridge has
    send_queue_bytes: int = 8 * 1024 * 1024  # five 1.2 MB point clouds, or 3 s of VGA JPEG
    queue_length: int = 1024  # what a client may ask for: 10 s at 100 Hz


MAX_WAITING_CALLS = 256  # a page that asks for all parameters of a robot when it starts

DEFAULT_QUEUE_LENGTH = 100  # 1 s at 100 Hz: rides out a WiFi hiccup without losing odometry
DEFAULT_QUEUE_BYTES = 256 * 1024  # but of big messages only the newest few: pictures stay fresh
