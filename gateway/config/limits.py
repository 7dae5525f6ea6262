# SPDX-License-Identifier: Apache-2.0
"""The bounds of clients and their connections: set by the operator, read by all parts."""

from typing import Annotated, Final

from pydantic import Field

from gateway.config.section import Section

# The messages of a topic that may wait, in DDS or for a client: 10 s at 100 Hz, 1 s at 1 kHz.
MAX_QUEUE_DEPTH: Final = 1024

Count = Annotated[int, Field(ge=1)]
Share = Annotated[float, Field(ge=0.01, le=1, allow_inf_nan=False)]
Rate = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Seconds = Annotated[float, Field(gt=0, le=3600, allow_inf_nan=False)]


class Limits(Section):
    """The limits of clients; a robot's computer must survive a runaway client.

    A field that `hello` reports has its name on the wire as `serialization_alias`.
    """

    max_clients: Count = Field(
        128,  # a class of 100; each costs 40 KB, 2 ms to connect, and what waits for it
        description="connections at once; one more is turned away with close code 1013",
    )
    max_clients_per_address: Count = Field(
        128,
        description="connections at once from one IP address; all of them by default, as a class"
        " behind one router, or behind a proxy that `trusted_proxies` does not name, shares its"
        " address; one more is turned away with close code 1013",
    )
    open_timeout_s: Seconds = Field(
        5, description="seconds a client may take for its handshake before it is disconnected"
    )
    max_message_bytes: Annotated[int, Field(ge=1024, le=16 * 1024**2)] = Field(
        10 * 1024**2,
        serialization_alias="message_bytes",
        description="bytes of the largest frame a client may send, as much as rosbridge takes;"
        " a larger one ends its connection with code 1009; JSON that would take longer to read than"
        " 13 MB of text is refused: a byte counts thrice where one is not ASCII, a character"
        " outside of strings five times, a string as 80 and a backslash as 28",
    )
    client_time_share: Share = Field(
        0.25,
        serialization_alias="client_time_share",
        description="the share of the event loop's time that the operations of one client may"
        " take, averaged over a second; beyond, nothing is refused, but the client is read more"
        " slowly; 1 for no limit",
    )
    address_time_share: Share = Field(
        0.5,
        serialization_alias="address_time_share",
        description="the same of all clients of one IP address together, also of those that"
        " disconnect and return; a client that drives does not wait for the others",
    )
    frames_per_s: Rate = Field(
        20_000,  # twenty joint topics at 500 Hz, twice
        serialization_alias="frames_per_s",
        description="frames a second a client may send on average, operations, pings and"
        " pongs alike; beyond, its connection is ended; 0 for no limit",
    )
    frame_burst: Count = Field(
        20_000,
        serialization_alias="frames_burst",
        description="frames a client may send at once, 1 s of `frames_per_s` caught up",
    )
    # a recorder on a robot of 300 topics; each costs 180 KB, 2 ms to open, and 15 us with every
    # change of the ROS graph
    max_subscriptions: Count = Field(
        320,
        serialization_alias="subscriptions",
        description="subscriptions a client may hold; one more is refused as `limit_exceeded`",
    )
    max_advertisements: Count = Field(
        320,  # what such a recorder plays; each costs 55 KB and 2 ms to open
        serialization_alias="advertisements",
        description="topics a client may advertise, and as many services and actions;"
        " one more is refused as `limit_exceeded`",
    )
    max_pending_calls: Count = Field(
        16,
        serialization_alias="pending_calls",
        description="service calls of a client that are under way at once; 256 more wait for"
        " their turn, and one more is refused as `limit_exceeded`",
    )
    max_goals: Count = Field(
        16,  # a goal may take minutes, so they do not count as calls
        serialization_alias="goals",
        description="action goals a client may pursue at once; one more is refused",
    )
    max_transforms: Count = Field(
        16,  # head, two hands, and the robot's main frames
        serialization_alias="transforms",
        description="repeated transform lookups a client may hold, and as many arrays of"
        " frames from `/tf2_web_republisher`; one more is refused",
    )
    service_timeout_s: Seconds = Field(
        5,  # what rosbridge has
        serialization_alias="service_timeout_s",
        description="seconds a service has to answer, of ROS where a call does not say and of"
        " a client in any case; then the caller is told so",
    )
    # 320 for each client; all of them cost 230 MB here, 4 MB in every node of the system, and 20 ms
    # of the event loop with every change of the ROS graph
    max_ros_entities: Count = Field(
        1280,
        description="ROS subscriptions, publishers, services and actions of all clients together,"
        " each of which costs every node of the system discovery traffic; one more is refused as"
        " `limit_exceeded`, and so is what exceeds a quarter of them for one client or half for"
        " one address",
    )
    reserved_ros_entities: Annotated[int, Field(ge=0)] = Field(
        16,  # an operator with a few topics to drive by, and as many who take over
        description="of `max_ros_entities` those that are kept for publishers of command topics,"
        " so that whoever uses up the others cannot keep an operator from stopping the robot",
    )
    max_name_characters: Annotated[int, Field(ge=1, le=250)] = Field(
        200,
        serialization_alias="name_characters",
        description="characters of a name; DDS ends them at 255 with its own prefix",
    )
    max_json_depth: Annotated[int, Field(ge=1, le=250)] = Field(
        32,
        serialization_alias="json_depth",
        description="levels of nesting in a client's JSON; ROS messages nest 8 at most",
    )
    max_json_items: Count = Field(
        100_000,
        serialization_alias="json_items",
        description="values in one JSON frame of a client, as each costs time and memory; of these"
        " 20,000 objects and arrays; strings, names included, are 60,000 at most; an array of"
        " numbers alone whose text is longer than 16 KiB counts as one value, as do base64 and"
        " the typed arrays of CBOR",
    )
    max_queue_length: Annotated[int, Field(ge=1, le=100_000)] = Field(
        MAX_QUEUE_DEPTH,
        serialization_alias="queue_length",
        description="the largest `queue_length` a client gets: 10 s at 100 Hz",
    )
    send_queue_bytes: Annotated[int, Field(ge=64 * 1024)] = Field(
        8 * 1024**2,  # or five point clouds of 1.2 MB
        serialization_alias="send_queue_bytes",
        description="bytes that may wait for one client (3 s of VGA JPEG), messages as ROS"
        " serialises them and the oldest answer aside; the oldest of its messages are dropped"
        " beyond, and answers beyond close it with code 4503",
    )
    slow_consumer_s: Seconds = Field(
        30,
        description="seconds a client may stay over half of `send_queue_bytes` before it is"
        " closed with code 4503",
    )
    send_deadline_s: Seconds = Field(
        30,
        description="seconds a client may take nothing of what waits for it, before its connection"
        " is cut; 10 if its computer does not answer, either",
    )
    ping_interval_s: Seconds = Field(
        5,
        description="seconds between the WebSocket pings that measure the round trip; a client"
        " need not answer them",
    )
    close_timeout_s: Annotated[float, Field(gt=0, le=2, allow_inf_nan=False)] = Field(
        1, description="seconds for the closing handshake; the whole shutdown has 2"
    )

    def for_hello(self) -> dict[str, float]:
        """Return the limits that `hello` reports, by their names on the wire."""
        return {
            field.serialization_alias: getattr(self, name)
            for name, field in type(self).model_fields.items()
            if field.serialization_alias is not None
        }
