# SPDX-License-Identifier: Apache-2.0
"""What can be configured: one frozen model, each field with its unit, its reason and its bounds.

Where the values come from is the business of `gateway.config.settings`.
"""

from typing import Annotated, ClassVar, Final, Literal

from pydantic import BaseModel, ConfigDict, Field, StringConstraints

from gateway.config.domain_id import MAX_DOMAIN_ID

_NAME_PART: Final = "[A-Za-z_][A-Za-z0-9_]*"  # rcl: a token of a name begins with no digit

Host = Annotated[
    str,
    StringConstraints(pattern=r"^[0-9A-Za-z.:_%-]+$"),
    Field(json_schema_extra={"expected": "a host name or an IP address"}),
]
UrlPath = Annotated[
    str,
    StringConstraints(pattern=r"^/[0-9A-Za-z._~/-]*$"),
    Field(json_schema_extra={"expected": "a path such as / or /ros"}),
]
Origin = Annotated[str, StringConstraints(pattern=r"^(\*|[a-z][a-z0-9+.-]*://[^\s/,]+)$")]
Origins = Annotated[
    tuple[Origin, ...],
    Field(json_schema_extra={"expected": "origins such as https://ui.example, or *"}),
]
RosToken = Annotated[
    str,
    StringConstraints(pattern=rf"^{_NAME_PART}$", max_length=100),
    Field(
        json_schema_extra={"expected": "letters, digits and underscores, beginning with no digit"}
    ),
]
RosNamespace = Annotated[
    str,
    StringConstraints(pattern=rf"^(/|(/{_NAME_PART})+)$", max_length=100),
    Field(json_schema_extra={"expected": "a namespace such as / or /robot1"}),
]
Count = Annotated[int, Field(ge=1)]
Rate = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Seconds = Annotated[float, Field(gt=0, le=3600, allow_inf_nan=False)]


class Section(BaseModel):
    """Fields that belong together."""

    model_config: ClassVar[ConfigDict] = ConfigDict(
        frozen=True, strict=True, extra="forbid", validate_default=True
    )


class LogConfig(Section):
    """The log on standard error."""

    level: Literal["debug", "info", "warning", "error"] = Field(
        "info", description="the least severe record that is written"
    )
    format: Literal["text", "json"] = Field(
        "text", description="text for people, or one JSON object a line for log collectors"
    )


class RosConfig(Section):
    """The gateway as seen from ROS."""

    node_prefix: RosToken = Field(
        "ros2_gateway", description="what the names of the gateway's nodes begin with"
    )
    namespace: RosNamespace = Field(
        "/", description="the namespace of the gateway's nodes; topics of clients do not move"
    )
    domain_id: Annotated[int, Field(ge=0, le=MAX_DOMAIN_ID)] | None = Field(
        None, description="the DDS domain; unset, the environment's ROS_DOMAIN_ID decides"
    )
    use_sim_time: bool = Field(
        False, description="whether ROS time comes from `/clock` (a simulator, a replayed bag)"
    )


class LimitsConfig(Section):
    """What clients may use up; a robot's computer must survive a client gone wild."""

    max_clients: Count = Field(
        32, description="connections at once; one more is turned away with close code 1013"
    )
    max_clients_per_address: Count = Field(
        16,
        description="connections at once from one IP address, so that one machine's leak of"
        " connections leaves room for the others; one more is turned away with close code 1013",
    )
    open_timeout_s: Seconds = Field(
        5, description="seconds a client may take for its handshake before it is disconnected"
    )
    max_message_bytes: Annotated[int, Field(ge=1024, le=16 * 1024**2)] = Field(
        256 * 1024,
        description="bytes of the largest frame a client may send, as parsing holds up"
        " all others (up to 50 ms for 256 KiB); a larger one ends its connection with code 1009",
    )
    frames_per_s: Rate = Field(
        2000,
        description="frames a second a client may send on average, operations, pings and"
        " pongs alike; beyond, its connection is ended; 0 for no limit",
    )
    frame_burst: Count = Field(
        4000, description="frames a client may send at once, 2 s of `frames_per_s` caught up"
    )
    operations_per_s: Rate = Field(
        200,
        description="operations a second a client may send on average (two hands at 60 Hz,"
        " and room for a page's start); beyond, they are refused as `rate_limited`; 0 for no limit",
    )
    operation_burst: Count = Field(
        400, description="operations a client may send at once, 2 s of `operations_per_s` caught up"
    )
    max_subscriptions: Count = Field(
        64, description="subscriptions a client may hold; one more is refused as `limit_exceeded`"
    )
    max_advertisements: Count = Field(
        32,
        description="topics a client may advertise, and as many services and actions;"
        " one more is refused as `limit_exceeded`",
    )
    max_pending_calls: Count = Field(
        16,
        description="service calls of a client that are under way at once; 256 more wait for"
        " their turn, and one more is refused as `limit_exceeded`",
    )
    max_goals: Count = Field(
        16, description="action goals a client may pursue at once; one more is refused"
    )
    max_transforms: Count = Field(
        16, description="repeated transform lookups a client may hold; one more is refused"
    )
    service_timeout_s: Seconds = Field(
        5,
        description="seconds a service has to answer, of ROS where a call does not say and of"
        " a client in any case; then the caller is told so",
    )
    max_ros_entities: Count = Field(
        256,
        description="ROS subscriptions, publishers, services and actions of all clients together,"
        " each of which costs every node of the system discovery traffic; one more is refused",
    )
    max_name_characters: Annotated[int, Field(ge=1, le=250)] = Field(
        200, description="characters of a name; DDS ends them at 255 with its own prefix"
    )
    max_json_depth: Annotated[int, Field(ge=1, le=250)] = Field(
        32, description="levels of nesting in a client's JSON; ROS messages nest 8 at most"
    )
    max_json_items: Count = Field(
        100_000, description="values in one JSON frame of a client, as each costs memory"
    )
    max_queue_length: Annotated[int, Field(ge=1, le=100_000)] = Field(
        1024, description="the largest `queue_length` a client gets: 10 s at 100 Hz"
    )
    send_queue_bytes: Annotated[int, Field(ge=64 * 1024)] = Field(
        8 * 1024**2,
        description="bytes that may wait for one client (3 s of VGA JPEG), messages as ROS"
        " serialises them and the oldest answer aside; the oldest of its messages are dropped"
        " beyond, and answers beyond close it with code 4503",
    )
    slow_consumer_s: Seconds = Field(
        5,
        description="seconds a client may stay over half of `send_queue_bytes` before it is"
        " closed with code 4503",
    )
    send_deadline_s: Seconds = Field(
        5, description="seconds a client may take nothing at all before its connection is cut"
    )
    ping_interval_s: Seconds = Field(
        5, description="seconds between the WebSocket pings that find dead connections"
    )
    ping_timeout_s: Seconds = Field(
        5, description="seconds a client may take to answer a ping before it is disconnected"
    )
    close_timeout_s: Annotated[float, Field(gt=0, le=2, allow_inf_nan=False)] = Field(
        1, description="seconds for the closing handshake; the whole shutdown has 2"
    )


class ImagesConfig(Section):
    """Encoding pictures as JPEG or PNG."""

    workers: Annotated[int, Field(ge=1, le=64)] = Field(
        2,
        description="threads that encode, beside the event loop; OpenCV lets them run in parallel",
    )


class Config(Section):
    """All that can be configured; without anything set it serves this machine alone."""

    host: Host = Field(
        "127.0.0.1",
        description="the address to listen on: `127.0.0.1` for this machine alone,"
        " `0.0.0.0` for all networks, where anyone who reaches the port may drive the robot",
    )
    port: Annotated[int, Field(ge=0, le=65535)] = Field(
        9090, description="the TCP port, by default rosbridge's; 0 for any free one"
    )
    path: UrlPath = Field("/", description="the path of the WebSocket")
    allowed_origins: Origins = Field(
        (),
        description="web sites whose pages may connect, beside pages of the same host; without"
        " this rule any web site could drive the robot of whoever visits it; `*` allows all",
    )
    log: LogConfig = LogConfig()
    ros: RosConfig = RosConfig()
    limits: LimitsConfig = LimitsConfig()
    images: ImagesConfig = ImagesConfig()
