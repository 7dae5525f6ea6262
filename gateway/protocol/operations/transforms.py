# SPDX-License-Identifier: Apache-2.0
"""Transforms between frames."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from gateway.protocol.operations.base import Id, Operation, Seconds

MAX_RATE_HZ = 200  # what a headset draws, twice


class StampRequest(BaseModel):
    """A ROS time."""

    model_config = ConfigDict(strict=True, frozen=True, extra="forbid")

    sec: Annotated[int, Field(ge=0, lt=2**31)]
    nanosec: Annotated[int, Field(ge=0, lt=1_000_000_000)] = 0


class LookupTransform(Operation):
    """Ask where a frame is in another, once or, with a rate, again and again."""

    op = "lookup_transform"
    target_frame: str
    source_frame: str
    time: StampRequest | None = None  # None: the newest that both frames have
    timeout: Seconds | None = None
    rate: Annotated[float, Field(gt=0, le=MAX_RATE_HZ)] | None = None


class CancelTransform(Operation):
    """End a repeated lookup by its id."""

    op = "cancel_transform"
    id: Id
