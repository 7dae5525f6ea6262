# SPDX-License-Identifier: Apache-2.0
"""Transforms between frames."""

from typing import Annotated, Final

from pydantic import Field, model_validator

from gateway.core import requests
from gateway.core.requests import MIN_RATE_HZ
from gateway.fronts.rosbridge.operations.base import Id, Operation, OperationPart
from gateway.tf.buffer import MAX_FRAME_CHARACTERS
from schemas.json_forms import duration

MAX_RATE_HZ: Final = 200  # twice the frame rate of a headset
# A robot takes as long to start. To wait longer, a client asks again, or periodically.
MAX_TIMEOUT_S: Final = 60

FrameId = Annotated[str, Field(max_length=MAX_FRAME_CHARACTERS)]


class StampRequest(OperationPart):
    """A ROS time, in the names of either ROS."""

    sec: Annotated[int, Field(ge=0, lt=2**31)] = 0
    nanosec: Annotated[int, Field(ge=0, lt=1_000_000_000)] = 0

    @model_validator(mode="before")
    @classmethod
    def _take_names_of_ros_1(cls, value: object) -> object:
        return duration(value)


class LookupTransform(Operation):
    """Ask for the transform of a frame in another, once or, with a rate, periodically."""

    op = "lookup_transform"
    makes = requests.LookupTransform
    target_frame: FrameId
    source_frame: FrameId
    time: StampRequest | None = None  # None: the newest time at which both frames are known
    timeout: Annotated[float, Field(ge=0, le=MAX_TIMEOUT_S)] | None = None
    rate: Annotated[float, Field(ge=MIN_RATE_HZ, le=MAX_RATE_HZ)] | None = None

    def request(self) -> requests.LookupTransform:
        """Return it for the core."""
        time = self.time
        return requests.LookupTransform(
            id=self.id,
            target_frame=self.target_frame,
            source_frame=self.source_frame,
            stamp_ns=None if time is None else time.sec * 1_000_000_000 + time.nanosec,
            timeout=self.timeout,
            rate=self.rate,
        )


class CancelTransform(Operation):
    """End a periodic lookup by its id."""

    op = "cancel_transform"
    makes = requests.CancelTransform
    id: Id
