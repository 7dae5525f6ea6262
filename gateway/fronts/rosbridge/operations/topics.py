# SPDX-License-Identifier: Apache-2.0
"""Topics: advertise, publish, subscribe."""

from typing import Annotated, Any, Literal

from pydantic import Field, GetPydanticSchema, model_validator
from pydantic_core import core_schema

from gateway.codec.cloud import (
    MAX_CLOUD_FIELDS,
    MAX_CLOUD_POINTS,
    MAX_VOXEL_M,
    MIN_VOXEL_M,
    CloudOptions,
)
from gateway.codec.nonfinite import NonFinite
from gateway.core import requests
from gateway.core.requests import IMAGE_FORMATS, MIN_RATE_HZ, AnyRequest
from gateway.fronts.rosbridge.framing import RosbridgeFraming
from gateway.fronts.rosbridge.operations.base import (
    FragmentSize,
    Operation,
    OperationPart,
    Seconds,
)
from gateway.sources.source import Qos

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

    def request(self) -> Qos:
        """Return it for the core, where best available is as good as left out."""
        return Qos(
            reliability=None if self.reliability == "best_available" else self.reliability,
            durability=None if self.durability == "best_available" else self.durability,
            history=self.history,
            depth=self.depth,
            deadline_ns=_nanoseconds(self.deadline),
            lifespan_ns=_nanoseconds(self.lifespan),
        )


def _nanoseconds(duration: Duration) -> int | None:
    match duration:
        case None | "infinite" | 0:  # 0 is rmw's unspecified duration: no limit
            return None
        case SecsNsecs():
            return duration.secs * 1_000_000_000 + duration.nsecs or None
    return round(duration * 1e9)


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

    def request(self) -> requests.ImageRequest:
        """Return it for the core. Pictures of a given quality adapt only if that is asked for."""
        given = self.model_fields_set
        return requests.ImageRequest(
            format=self.format,
            quality=self.quality,
            max_width=self.max_width,
            max_height=self.max_height,
            max_fps=self.max_fps,
            depth_range_m=self.depth_range_m,
            asks_for_picture=bool(self.adapt) or not given <= {"max_fps", "adapt"},
            adapts="quality" not in given if self.adapt is None else self.adapt,
        )

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


class CloudRequest(OperationPart):
    """The options of a subscription to a PointCloud2, which comes with fewer points."""

    max_points: Annotated[int, Field(ge=1, le=MAX_CLOUD_POINTS)] | None = None
    voxel_m: Annotated[float, Field(ge=MIN_VOXEL_M, le=MAX_VOXEL_M)] | None = None
    fields: Annotated[
        tuple[str, ...],
        Field(strict=False, max_length=MAX_CLOUD_FIELDS, description="in addition to x, y, z"),
    ] = ()

    def request(self) -> CloudOptions:
        """Return it for the core."""
        return CloudOptions(self.max_points, self.voxel_m, self.fields)


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
    makes = requests.Advertise
    type: str | int
    image: PublishedImage | None = None

    def request(self) -> requests.Advertise:
        """Return it for the core."""
        return requests.Advertise(
            id=self.id,
            topic=self.topic,
            type=self.type,
            latch=self.latch,
            queue_size=self.queue_size,
            qos=None if self.qos is None else self.qos.request(),
            has_pictures=self.image is not None and self.image.format != "raw",
        )


class Unadvertise(Operation):
    """Withdraw one advertisement, or without an id all of this client's on the topic."""

    op = "unadvertise"
    makes = requests.Unadvertise
    topic: str


class Publish(_Publisher):
    """Publish one message. Advertise the topic first if the type is given or known.

    ``monotonic_ms`` is for command topics: a clock of the client that never goes back.
    """

    op = "publish"
    makes = requests.Publish
    msg: Any
    type: str | int | None = None
    monotonic_ms: Annotated[float, Field(ge=0, le=1e15)] | None = None  # 30,000 years

    def request(self) -> AnyRequest:
        """Return it for the core."""
        request = object.__new__(requests.Publish)
        members = request.__dict__
        members.update(self.__dict__)
        if members["qos"] is not None:
            members["qos"] = members["qos"].request()
        return request


class Subscribe(Operation):
    """Ask for the messages of a topic."""

    op = "subscribe"
    makes = requests.Subscribe
    topic: str
    type: str | int | None = None
    throttle_rate: Milliseconds | None = None
    queue_length: Annotated[int, Field(ge=0)] | None = None
    compression: str | None = None
    fragment_size: FragmentSize = None
    qos: QosRequest | None = None
    fields: Annotated[tuple[str, ...], Field(strict=False, max_length=64)] | None = None
    image: ImageRequest | None = None
    cloud: CloudRequest | None = None
    meta: bool = False
    nonfinite: NonFinite | None = None
    # below, an ordinary hiccup of WiFi or of a busy robot would be reported
    stale_after_ms: Annotated[float, Field(ge=100, le=3_600_000)] | None = None

    def request(self) -> requests.Subscribe:
        """Return it for the core."""
        return requests.Subscribe(
            id=self.id,
            topic=self.topic,
            type=self.type,
            throttle_ms=self.throttle_rate or 0,
            queue_length=self.queue_length,
            framing=RosbridgeFraming.of(self.compression, self.fragment_size, self.nonfinite),
            qos=None if self.qos is None else self.qos.request(),
            fields=self.fields,
            image=None if self.image is None else self.image.request(),
            cloud=None if self.cloud is None else self.cloud.request(),
            meta=self.meta,
            stale_after_ms=self.stale_after_ms,
        )


class Unsubscribe(Operation):
    """End one subscription, or without an id all of this client's on the topic."""

    op = "unsubscribe"
    makes = requests.Unsubscribe
    topic: str
