# SPDX-License-Identifier: Apache-2.0
"""Topics: advertise, publish, subscribe."""

from typing import Annotated, Any, Final, Literal

from pydantic import Field, GetPydanticSchema, model_validator
from pydantic_core import core_schema

from gateway.codec.nonfinite import NonFinite
from gateway.codec.picture_formats import PICTURE_FORMATS
from gateway.fronts.rosbridge.operations.base import (
    MIN_RATE_HZ,
    FragmentSize,
    Operation,
    OperationPart,
    Seconds,
)

Milliseconds = Annotated[float, Field(ge=0, le=3_600_000)]


class SecsNsecs(OperationPart):
    """A duration in the form of ROS 1."""

    secs: Annotated[int, Field(ge=0, le=1_000_000_000)] = 0
    nsecs: Annotated[int, Field(ge=0, lt=1_000_000_000)] = 0


Duration = Seconds | SecsNsecs | Literal["infinite"] | None


class QosRequest(OperationPart):
    """The quality of service that a client asks for. Missing fields are adopted.

    Durations are seconds, ``{secs, nsecs}`` or ``"infinite"``, as in rosbridge.
    """

    reliability: Literal["reliable", "best_effort", "best_available"] | None = None
    durability: Literal["transient_local", "volatile", "best_available"] | None = None
    history: Literal["keep_last", "keep_all"] | None = None
    depth: Annotated[int, Field(ge=1)] | None = None  # ROS gets `MAX_QUEUE_DEPTH` at most
    deadline: Duration = None
    lifespan: Duration = None


IMAGE_FORMATS: Final = (*PICTURE_FORMATS, "raw")  # raw is the plain message

# a Literal of these names
ImageFormat = Annotated[
    str, GetPydanticSchema(lambda *_: core_schema.literal_schema(list(IMAGE_FORMATS)))
]


class ImageRequest(OperationPart):
    """The picture options of a subscription to an Image, a CompressedImage or an OccupancyGrid."""

    format: ImageFormat | None = None  # that of the connection
    quality: Annotated[int, Field(ge=1, le=100)] = 80
    max_width: Annotated[int, Field(ge=1, le=8192)] | None = None
    max_height: Annotated[int, Field(ge=1, le=8192)] | None = None
    max_fps: Annotated[float, Field(ge=MIN_RATE_HZ, le=1000)] | None = None
    adapt: bool | None = None  # None: unless a quality is asked for
    depth_range_m: (
        Annotated[tuple[float, float], Field(strict=False, description="nearest and farthest")]
        | None
    ) = None

    @property
    def asks_for_picture(self) -> bool:
        """Return whether anything but a rate is asked for."""
        return bool(self.adapt) or not self.model_fields_set <= {"max_fps", "adapt"}

    @property
    def adapts(self) -> bool:
        """Return whether pictures may be smaller than asked for on a slow link."""
        return "quality" not in self.model_fields_set if self.adapt is None else self.adapt

    @model_validator(mode="after")
    def _range_is_ordered(self) -> "ImageRequest":
        if (
            self.depth_range_m is not None
            and not 0 <= self.depth_range_m[0] < self.depth_range_m[1]
        ):
            raise ValueError(
                "image.depth_range_m: expected [nearest, farthest], in metres, the nearest first"
            )
        return self


class PublishedImage(OperationPart):
    """The form in which a client publishes a ``sensor_msgs/msg/Image``."""

    format: ImageFormat


class _Publisher(Operation):
    """The options of a publisher, in `advertise` or in the `publish` that opens it."""

    topic: str
    latch: bool | None = None
    queue_size: Annotated[int, Field(ge=0)] | None = None
    qos: QosRequest | None = None


class Advertise(_Publisher):
    """Announce that messages will be published on a topic."""

    op = "advertise"
    type: str | int
    image: PublishedImage | None = None

    @property
    def has_pictures(self) -> bool:
        """Return whether the messages are compressed pictures, which ROS gets as pixels."""
        return self.image is not None and self.image.format != "raw"


class Unadvertise(Operation):
    """Withdraw one advertisement, or without an id all of this client's on the topic."""

    op = "unadvertise"
    needs_permission = False
    topic: str


class Publish(_Publisher):
    """Publish one message. Advertise the topic first if the type is given or known.

    ``monotonic_ms`` is for command topics: a clock of the client that never goes back.
    """

    op = "publish"
    msg: Any
    type: str | int | None = None
    monotonic_ms: Annotated[float, Field(ge=0, le=1e15)] | None = None  # 30,000 years


class Subscribe(Operation):
    """Ask for the messages of a topic."""

    op = "subscribe"
    topic: str
    type: str | int | None = None
    throttle_rate: Milliseconds | None = None
    queue_length: Annotated[int, Field(ge=0)] | None = None
    compression: str | None = None
    fragment_size: FragmentSize = None
    qos: QosRequest | None = None
    fields: Annotated[tuple[str, ...], Field(strict=False, max_length=64)] | None = None
    image: ImageRequest | None = None
    meta: bool = False
    nonfinite: NonFinite | None = None
    # below, an ordinary hiccup of WiFi or of a busy robot would be reported
    stale_after_ms: Annotated[float, Field(ge=100, le=3_600_000)] | None = None


class Unsubscribe(Operation):
    """End one subscription, or without an id all of this client's on the topic."""

    op = "unsubscribe"
    needs_permission = False
    topic: str
