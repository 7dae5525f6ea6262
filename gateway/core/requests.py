# SPDX-License-Identifier: Apache-2.0
"""The requests of clients, as the core carries them out: frozen, and without a wire format.

A front makes them from what its clients send. A name is as the client wrote it, because some
clients match answers by it. A `form` is the front's: the answer brings it back.
"""

from dataclasses import dataclass
from typing import Any, ClassVar, Final, Literal, TypeAlias

from gateway.codec.cloud import CloudOptions
from gateway.codec.picture_formats import PICTURE_FORMATS
from gateway.core.frames import Framing
from gateway.sources.source import Qos

RequestId: TypeAlias = str | int | None

# A quarter of an hour: the time between two at a smaller rate could be infinite.
MIN_RATE_HZ: Final = 0.001

IMAGE_FORMATS: Final = (*PICTURE_FORMATS, "raw")  # raw is the plain message
ImageFormat: TypeAlias = str
"""One of `IMAGE_FORMATS`."""


@dataclass(frozen=True, kw_only=True)
class Request:
    """The base of all requests, also of those of a front: an id that answers carry back."""

    kind: ClassVar[str]  # for people: logs, the audit, refusals
    # False if every client may do it, or if it is checked later. For all others
    # `permission_checks` knows the permission, or refuses them to roles that have limits
    needs_permission: ClassVar[bool] = True

    id: RequestId = None


@dataclass(frozen=True, kw_only=True)
class ImageRequest:
    """The picture options of a subscription to an Image, a CompressedImage or an OccupancyGrid."""

    format: ImageFormat | None = None  # that of the connection
    quality: int = 80
    max_width: int | None = None
    max_height: int | None = None
    max_fps: float | None = None
    depth_range_m: tuple[float, float] | None = None
    asks_for_picture: bool = False  # for anything but a rate
    adapts: bool = True  # pictures may be smaller than asked for on a slow link


@dataclass(frozen=True, kw_only=True)
class PublisherOptions(Request):
    """The options of a publisher, in `Advertise` or in the `Publish` that opens it."""

    topic: str
    latch: bool | None = None
    queue_size: int | None = None
    qos: Qos | None = None


@dataclass(frozen=True, kw_only=True)
class Advertise(PublisherOptions):
    """Announce that messages will be published on a topic."""

    kind = "advertise"
    type: str | int
    has_pictures: bool = False  # compressed, which ROS gets as pixels


@dataclass(frozen=True, kw_only=True)
class Unadvertise(Request):
    """Withdraw one advertisement, or without an id all of this client's on the topic."""

    kind = "unadvertise"
    needs_permission = False
    topic: str


@dataclass(frozen=True, kw_only=True)
class Publish(PublisherOptions):
    """Publish one message. Advertise the topic first if the type is given or known.

    ``monotonic_ms`` is for command topics: a clock of the client that never goes back.
    """

    kind = "publish"
    msg: Any
    type: str | int | None = None
    monotonic_ms: float | None = None


@dataclass(frozen=True, kw_only=True)
class Subscribe(Request):
    """Ask for the messages of a topic."""

    kind = "subscribe"
    topic: str
    type: str | int | None = None
    throttle_ms: float = 0
    queue_length: int | None = None
    framing: Framing
    qos: Qos | None = None
    fields: tuple[str, ...] | None = None
    image: ImageRequest | None = None
    cloud: CloudOptions | None = None
    meta: bool = False
    stale_after_ms: float | None = None


@dataclass(frozen=True, kw_only=True)
class Unsubscribe(Request):
    """End one subscription, or without an id all of this client's on the topic."""

    kind = "unsubscribe"
    needs_permission = False
    topic: str


@dataclass(frozen=True, kw_only=True)
class CallService(Request):
    """Call a service. The client gets a response, whatever happens."""

    kind = "call_service"
    service: str
    args: Any = None  # an object, or the values of the fields in order
    type: str | None = None
    timeout: float | None = None  # seconds
    form: object = None


@dataclass(frozen=True, kw_only=True)
class AdvertiseService(Request):
    """Provide a service: calls go to the client, which answers by `ServiceResponse`."""

    kind = "advertise_service"
    service: str
    type: str


@dataclass(frozen=True, kw_only=True)
class UnadvertiseService(Request):
    """Stop providing a service."""

    kind = "unadvertise_service"
    needs_permission = False
    service: str


@dataclass(frozen=True, kw_only=True)
class ServiceResponse(Request):
    """Answer a call that the gateway passed on. *id* is the call's."""

    kind = "service_response"
    needs_permission = False
    service: str
    values: Any = None
    result: bool = True


@dataclass(frozen=True, kw_only=True)
class SendActionGoal(Request):
    """Send a goal. The client gets a result, whatever happens."""

    kind = "send_action_goal"
    action: str
    action_type: str | None = None
    args: Any = None  # an object, or the values of the fields in order
    feedback: bool = False
    keep: bool = False  # do not cancel the goal when this client leaves
    form: object = None


@dataclass(frozen=True, kw_only=True)
class CancelActionGoal(Request):
    """Ask to cancel a goal by its id. Its result reports whether it was cancelled."""

    kind = "cancel_action_goal"
    needs_permission = False
    action: str


@dataclass(frozen=True, kw_only=True)
class AdvertiseAction(Request):
    """Provide an action: the client gets the goals, and what is to be cancelled."""

    kind = "advertise_action"
    action: str
    type: str


@dataclass(frozen=True, kw_only=True)
class UnadvertiseAction(Request):
    """Stop providing an action. Its goals are aborted."""

    kind = "unadvertise_action"
    needs_permission = False
    action: str


@dataclass(frozen=True, kw_only=True)
class ActionFeedback(Request):
    """Report the progress of a goal. *id* is the goal's."""

    kind = "action_feedback"
    needs_permission = False
    action: str
    values: Any = None


@dataclass(frozen=True, kw_only=True)
class ActionResult(Request):
    """End a goal. *id* is the goal's."""

    kind = "action_result"
    needs_permission = False
    action: str
    values: Any = None
    status: int | None = None  # of action_msgs/msg/GoalStatus
    result: bool = True


@dataclass(frozen=True, kw_only=True)
class ParameterRequest(Request):
    """Ask a node about its parameters."""

    needs_permission = False  # checked where the node is known
    node: str
    timeout: float | None = None  # seconds


@dataclass(frozen=True, kw_only=True)
class ListParameters(ParameterRequest):
    """Ask for the names of a node's parameters, or of those below some prefixes."""

    kind = "list_parameters"
    prefixes: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class GetParameters(ParameterRequest):
    """Ask for the named values, or for all values of the node."""

    kind = "get_parameters"
    names: tuple[str, ...] | None = None


@dataclass(frozen=True, kw_only=True)
class SetParameters(ParameterRequest):
    """Set values. ``None`` deletes a parameter."""

    kind = "set_parameters"
    values: dict[str, Any]


@dataclass(frozen=True, kw_only=True)
class DescribeParameters(ParameterRequest):
    """Ask for types, ranges and descriptions of the named parameters, or of all."""

    kind = "describe_parameters"
    names: tuple[str, ...] | None = None


@dataclass(frozen=True, kw_only=True)
class LookupTransform(Request):
    """Ask for the transform of a frame in another, once or, with a rate in Hz, periodically."""

    kind = "lookup_transform"
    target_frame: str
    source_frame: str
    stamp_ns: int | None = None  # None: the newest time at which both frames are known
    timeout: float | None = None  # seconds
    rate: float | None = None


@dataclass(frozen=True, kw_only=True)
class CancelTransform(Request):
    """End a periodic lookup by its id."""

    kind = "cancel_transform"
    needs_permission = False


@dataclass(frozen=True, kw_only=True)
class Stop(Request):
    """Stop one command topic, or without a name all of them. Any client may."""

    kind = "stop"
    needs_permission = False  # every client may stop a robot
    topic: str | None = None


@dataclass(frozen=True, kw_only=True)
class AcquireControl(Request):
    """Take control of a command topic, also from another client. It is stopped first."""

    kind = "acquire_control"
    needs_permission = False  # checked where the topic is known
    topic: str | None = None


@dataclass(frozen=True, kw_only=True)
class ReleaseControl(Request):
    """Give control back. A robot that moves is stopped."""

    kind = "release_control"
    needs_permission = False
    topic: str | None = None


@dataclass(frozen=True, kw_only=True)
class Control(Request):
    """Ask for the state of a command topic, once or with all later changes."""

    kind = "control"
    needs_permission = False  # checked where the topic is known
    topic: str | None = None
    watch: bool | None = None  # False ends the changes


@dataclass(frozen=True, kw_only=True)
class Hello(Request):
    """Ask for the server's identity and limits."""

    kind = "hello"
    needs_permission = False


@dataclass(frozen=True, kw_only=True)
class Ping(Request):
    """Ask for the clocks. The answer repeats the value unchanged.

    ``clock_offset_ms`` is what the client adds to its clock to get the gateway's.
    """

    kind = "ping"
    needs_permission = False
    value: Any = None
    clock_offset_ms: float | None = None


@dataclass(frozen=True, kw_only=True)
class Describe(Request):
    """Ask for the schema, the definition, the hash and an example of a type.

    *type* names a message, service or action type, or a topic, service or action that has one.
    """

    kind = "describe"
    needs_permission = False
    type: str | int


@dataclass(frozen=True, kw_only=True)
class Generate(Request):
    """Ask for clients' code of some types, as the files of ``ros2-gateway generate --output``.

    *types* are full names. *asmdef* names an assembly of Unity, for C# alone.
    """

    kind = "generate"
    needs_permission = False
    language: Literal["csharp", "typescript", "python", "json-schema"]
    types: tuple[str, ...]
    asmdef: str | None = None


@dataclass(frozen=True, kw_only=True)
class FetchAsset(Request):
    """Ask for a part of a mesh or a texture of an installed package, from an offset in bytes."""

    kind = "fetch_asset"
    needs_permission = False  # a mesh tells nothing of what the robot does
    uri: str
    offset: int = 0


@dataclass(frozen=True, kw_only=True)
class GraphRequest(Request):
    """Ask for topics, services, actions and nodes, once or with all later changes."""

    kind = "graph"
    needs_permission = False
    watch: bool | None = None  # False ends the changes


@dataclass(frozen=True, kw_only=True)
class Events(Request):
    """Ask for what happens on the topics that clients use, or for no more of it."""

    kind = "events"
    needs_permission = False
    watch: bool = True


@dataclass(frozen=True, kw_only=True)
class Record(Request):
    """Start or stop a recording, mark something in it, or ask for its state."""

    kind = "record"
    needs_permission = False  # checked for what changes a recording
    action: Literal["start", "stop", "mark", "status"] = "status"
    topics: tuple[str, ...] | None = None  # globs
    images: Literal["raw", "jpeg"] = "raw"
    task: str | None = None
    operator: str | None = None
    text: str | None = None
    episode: Literal["start", "end"] | None = None
    success: bool | None = None  # of the episode that ends
    watch: bool | None = None  # False ends the changes


AnyRequest: TypeAlias = (
    Advertise
    | Unadvertise
    | Publish
    | Subscribe
    | Unsubscribe
    | CallService
    | AdvertiseService
    | UnadvertiseService
    | ServiceResponse
    | SendActionGoal
    | CancelActionGoal
    | AdvertiseAction
    | UnadvertiseAction
    | ActionFeedback
    | ActionResult
    | ListParameters
    | GetParameters
    | SetParameters
    | DescribeParameters
    | LookupTransform
    | CancelTransform
    | Stop
    | AcquireControl
    | ReleaseControl
    | Control
    | Hello
    | Ping
    | Describe
    | Generate
    | FetchAsset
    | GraphRequest
    | Events
    | Record
)
"""The requests that the core carries out. A front may have others, which it carries out itself."""
