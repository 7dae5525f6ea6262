# SPDX-License-Identifier: Apache-2.0
"""The requests of clients of tf2_web_republisher, as frozen models.

The models take the place of its message types, which need not be installed. As in ROS, a number
that is left out is 0.
"""

from typing import Annotated, Any, Final, TypeVar

from pydantic import ConfigDict, Field, ValidationError, field_validator

from gateway.codec.error_text import kind
from gateway.core.errors import ProtocolError
from gateway.core.requests import MIN_RATE_HZ
from gateway.core.transforms.republications import ArrayKey
from gateway.fronts.rosbridge.explain import explain
from gateway.fronts.rosbridge.operations.base import MAX_ID_CHARACTERS, OperationPart
from gateway.fronts.rosbridge.operations.transforms import (
    MAX_RATE_HZ,
    MAX_TIMEOUT_S,
    FrameId,
    StampRequest,
)
from gateway.log_fields import counted
from gateway.tf.buffer import MAX_FRAMES

DEFAULT_RATE_HZ: Final = 10.0  # these two are what roslib and roslibpy ask for
DEFAULT_TIMEOUT_S: Final = 2.0

T = TypeVar("T", bound=OperationPart)
_Threshold = Annotated[float, Field(ge=0)]


class RepublishRequest(OperationPart):
    """The goal of its action, and the request of its service."""

    source_frames: Annotated[tuple[FrameId, ...], Field(strict=False, max_length=MAX_FRAMES)]
    target_frame: FrameId
    angular_thres: _Threshold = 0.0  # radians
    trans_thres: _Threshold = 0.0  # metres
    rate: Annotated[float, Field(ge=0, le=MAX_RATE_HZ)] = 0.0
    timeout: StampRequest = StampRequest()  # of the service alone

    @field_validator("timeout")
    @classmethod
    def _is_soon(cls, timeout: StampRequest) -> StampRequest:
        if timeout.sec > MAX_TIMEOUT_S:
            raise ValueError(f"timeout: expected at most {MAX_TIMEOUT_S} s, got {timeout.sec} s")
        return timeout

    @property
    def rate_hz(self) -> float:
        """The rate, or the usual one if none is given."""
        return max(self.rate, MIN_RATE_HZ) if self.rate else DEFAULT_RATE_HZ

    @property
    def timeout_s(self) -> float:
        """The seconds for which a topic without subscribers stays, or the usual ones."""
        return self.timeout.sec + self.timeout.nanosec / 1e9 or DEFAULT_TIMEOUT_S


class GoalId(OperationPart):
    """actionlib_msgs/GoalID of ROS 1. The stamp is not looked at."""

    model_config = ConfigDict(extra="ignore")

    id: Annotated[str, Field(max_length=MAX_ID_CHARACTERS)] = ""


class ActionGoal(OperationPart):
    """A goal as actionlib of ROS 1 publishes it. Its header is not looked at."""

    model_config = ConfigDict(extra="ignore")

    goal_id: Any
    goal: Any


def parse(model: type[T], values: object, where: str) -> T:
    """Return a request from its fields by name, or in order. *where* names them in errors.

    Raises:
        ProtocolError: ``invalid_value``: they do not fit.
    """
    fields = list(model.model_fields)
    if isinstance(values, list) and len(values) <= len(fields):
        values = dict(zip(fields, values, strict=False))
    if values is None:
        values = {}
    if not isinstance(values, dict):
        most = counted(len(fields), "value")
        text = f"{where}: expected an object, or up to {most}, got {kind(values)}"
        raise ProtocolError("invalid_value", text)
    try:
        return model.model_validate(values)
    except ValidationError as error:
        raise ProtocolError("invalid_value", f"{where}.{explain(error)}") from error


def array_key(request: RepublishRequest) -> ArrayKey:
    """Return the array of a request. As in tf2_web_republisher, a leading slash is dropped."""
    sources = dict.fromkeys(name.removeprefix("/") for name in request.source_frames)
    return ArrayKey(
        request.target_frame.removeprefix("/"),
        tuple(sources),
        request.rate_hz,
        request.angular_thres,
        request.trans_thres,
    )
