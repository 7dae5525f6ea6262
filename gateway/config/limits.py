# SPDX-License-Identifier: Apache-2.0
"""Limits of clients and their connections."""

from typing import Annotated, Final

from pydantic import Field

from gateway.config.section import Section

# Messages of a topic that may wait, in DDS or for a client: 10 s at 100 Hz, 1 s at 1 kHz.
MAX_QUEUE_DEPTH: Final = 1024

Count = Annotated[int, Field(ge=1)]
Share = Annotated[float, Field(ge=0.01, le=1, allow_inf_nan=False)]
Rate = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Seconds = Annotated[float, Field(gt=0, le=3600, allow_inf_nan=False)]


class Limits(Section):
    """Limits for clients. They keep the robot's computer usable if a client misbehaves.

    The `serialization_alias` of a field is its name in `hello`.
    """

    max_clients: Count = Field(
        128,  # enough for a class of 100, at 40 KB, a queue, and 2 ms to connect each
        description="Maximum number of connections. Further clients are refused with close"
        " code 1013.",
    )
    max_clients_per_address: Count = Field(
        128,
        description="Maximum number of connections from one IP address. Further clients are"
        " refused with close code 1013.",
    )
    open_timeout_s: Seconds = Field(
        5,
        description="Time for a client to complete the WebSocket handshake. Then the"
        " gateway disconnects it.",
    )
    max_message_bytes: Annotated[int, Field(ge=1024, le=16 * 1024**2)] = Field(
        10 * 1024**2,
        serialization_alias="message_bytes",
        description="Maximum size of a frame from a client. A larger frame ends the"
        " connection with close code 1009.",
    )
    client_time_share: Share = Field(
        0.25,
        serialization_alias="client_time_share",
        description="Share of the event loop's time for one client. Beyond it, the gateway"
        " reads the client more slowly. 1 means no limit.",
    )
    address_time_share: Share = Field(
        0.5,
        serialization_alias="address_time_share",
        description="The same share for all clients of one IP address together. A client"
        " that drives does not wait for the others.",
    )
    frames_per_s: Rate = Field(
        20_000,  # twice the rate of twenty joint topics at 500 Hz
        serialization_alias="frames_per_s",
        description="Maximum average number of frames per second from a client. Beyond it,"
        " the connection ends with close code 1008. 0 means no limit.",
    )
    frame_burst: Count = Field(
        20_000,
        serialization_alias="frames_burst",
        description="Maximum number of frames that a client may send at once.",
    )
    # Enough to record a robot of 300 topics. Each costs 180 KB, 2 ms to open, and 15 us with every
    # change of the ROS graph.
    max_subscriptions: Count = Field(
        320,
        serialization_alias="subscriptions",
        description="Maximum number of subscriptions of a client. Further ones are refused"
        " with `limit_exceeded`.",
    )
    max_advertisements: Count = Field(
        320,  # enough to replay such a recording, at 55 KB and 2 ms to open each
        serialization_alias="advertisements",
        description="Maximum number of topics, of services, and of actions that a client"
        " may advertise. Further ones are refused with `limit_exceeded`.",
    )
    max_pending_calls: Count = Field(
        16,
        serialization_alias="pending_calls",
        description="Maximum number of calls of a client at the same time. 256 more wait."
        " Further calls are refused with `limit_exceeded`.",
    )
    max_goals: Count = Field(
        16,  # goals do not count as calls, because a goal may take minutes
        serialization_alias="goals",
        description="Maximum number of action goals of a client at the same time. Further"
        " goals are refused with `limit_exceeded`.",
    )
    max_transforms: Count = Field(
        16,  # enough for a head, two hands, and the main frames of a robot
        serialization_alias="transforms",
        description="Maximum number of repeated transform lookups of a client, and of"
        " arrays from `/tf2_web_republisher`. Further ones are refused with"
        " `limit_exceeded`.",
    )
    service_timeout_s: Seconds = Field(
        5,  # as in rosbridge
        serialization_alias="service_timeout_s",
        description="Time for a service to answer, if the call sets no timeout. Then the"
        " caller gets an error.",
    )
    # A client may have a quarter, 320. All of them cost 230 MB here, 4 MB in every node of the
    # system, and 20 ms of the event loop with every change of the ROS graph.
    max_ros_entities: Count = Field(
        1280,
        description="Maximum number of ROS subscriptions, publishers, services, and actions"
        " for all clients together. Further ones are refused with"
        " `limit_exceeded`.",
    )
    reserved_ros_entities: Annotated[int, Field(ge=0)] = Field(
        16,  # enough for a few command topics, for the current driver and for the next
        description="Part of `max_ros_entities` for publishers on command topics only, so"
        " that an operator can always stop the robot.",
    )
    max_name_characters: Annotated[int, Field(ge=1, le=250)] = Field(
        200,
        serialization_alias="name_characters",
        description="Maximum length of a name. DDS allows 255 characters with its own prefix.",
    )
    max_json_depth: Annotated[int, Field(ge=1, le=250)] = Field(
        32,
        serialization_alias="json_depth",
        description="Maximum number of nested levels in a client's JSON. ROS messages have"
        " at most 8.",
    )
    max_json_items: Count = Field(
        100_000,
        serialization_alias="json_items",
        description="Maximum number of values in one JSON or CBOR frame. A frame with more"
        " values is refused.",
    )
    max_queue_length: Annotated[int, Field(ge=1, le=100_000)] = Field(
        MAX_QUEUE_DEPTH,
        serialization_alias="queue_length",
        description="Largest `queue_length` that a client gets (10 s at 100 Hz).",
    )
    send_queue_bytes: Annotated[int, Field(ge=64 * 1024)] = Field(
        8 * 1024**2,  # or five point clouds of 1.2 MB
        serialization_alias="send_queue_bytes",
        description="Maximum size of the messages that wait for one client. Beyond it, the"
        " gateway drops the oldest.",
    )
    slow_consumer_s: Seconds = Field(
        30,
        description="Time that a client may use more than half of `send_queue_bytes`. Then"
        " it gets close code 4503.",
    )
    send_deadline_s: Seconds = Field(
        30,
        description="Time that a client may accept nothing while data waits for it. Then"
        " the gateway cuts the connection.",
    )
    ping_interval_s: Seconds = Field(
        5,
        description="Time between WebSocket pings, which measure the round-trip time."
        " Clients need not answer them.",
    )
    close_timeout_s: Annotated[float, Field(gt=0, le=2, allow_inf_nan=False)] = Field(
        1, description="Time for the closing handshake. The whole shutdown takes at most 2 s."
    )

    def for_hello(self) -> dict[str, float]:
        """Return the limits for `hello`, by their names on the wire."""
        return {
            field.serialization_alias: getattr(self, name)
            for name, field in type(self).model_fields.items()
            if field.serialization_alias is not None
        }
