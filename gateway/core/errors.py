# SPDX-License-Identifier: Apache-2.0
"""Clients' errors, as exceptions that become `status` frames."""

from collections.abc import Mapping
from typing import ClassVar, Final, Literal, NamedTuple

Level = Literal["none", "error", "warning", "info"]
SEVERITY: Final[Mapping[Level, int]] = {"none": 0, "error": 1, "warning": 2, "info": 3}

StatusCode = Literal[
    "bad_json",
    "bad_request",
    "unknown_op",
    "bad_name",
    "bad_type",
    "type_conflict",
    "not_found",
    "invalid_value",
    "forbidden",
    "limit_exceeded",
    "timeout",
    "internal",
    "tripped",
    "not_lease_holder",
    "stale_command",
    "already_provided",
    "qos_incompatible",
    "deadline_missed",
    "liveliness_lost",
    "messages_lost",
    "publisher_gone",
    "stale",
    "fresh",
]


class Explanation(NamedTuple):
    """The meaning, cause, and cure of a code, in Markdown for docs/reference/errors.md."""

    meaning: str
    cause: str
    cure: str


EXPLANATIONS: Final[Mapping[StatusCode, Explanation]] = {
    "bad_json": Explanation(
        "The frame is not valid JSON or CBOR.",
        "The text is not UTF-8, has a syntax error, has a key twice, or nests too deeply.",
        "Correct the frame. `msg` says what is wrong and at which offset.",
    ),
    "bad_request": Explanation(
        "The frame is JSON, but not a valid operation.",
        "A field is missing, has the wrong type, or is out of range. As a warning: a key is"
        " misspelled or has no effect.",
        "Change the field that `msg` names. The [protocol](protocol/index.md) lists the fields.",
    ),
    "unknown_op": Explanation(
        "The gateway does not know the operation in `op`.",
        "The name of the operation is misspelled.",
        'Use the name that `msg` suggests. To list all operations, send `{"op":"help"}`.',
    ),
    "bad_name": Explanation(
        "The name is not valid.",
        "It is too long, or has characters that ROS does not allow. In `fetch_asset`: the file is"
        " not a mesh or a texture inside a package.",
        "Use letters, digits, and underscores, separated by slashes. `msg` says what is allowed.",
    ),
    "bad_type": Explanation(
        "The gateway cannot use this type.",
        "The type is misspelled, or its package is not installed on the gateway's machine.",
        "Use the type that `msg` suggests, install the package, or"
        " [add a definition](../how-to/own-messages.md).",
    ),
    "type_conflict": Explanation(
        "Two types contradict each other.",
        "A topic, service, or action has another type than the one that you named, or several"
        " types. As a warning: a node uses another type or another definition of it.",
        "Use the type that `msg` names. If `msg` names several, choose one by `type`.",
    ),
    "not_found": Explanation(
        "The name does not exist.",
        "The name is misspelled, its node is not running, or what you want to end has already"
        " ended. A name that your role may not see does not exist for you.",
        "Use the name that `msg` suggests, or start the node that provides it.",
    ),
    "invalid_value": Explanation(
        "A message does not fit its type.",
        "A field is unknown, has the wrong type, or is out of range, or an image is damaged. As a"
        " warning: the gateway cannot read a message from ROS.",
        "Correct the field that `msg` names. [`describe`](protocol/introspection.md#describe)"
        " shows all fields of a type.",
    ),
    "forbidden": Explanation(
        "You do not have permission for this operation.",
        "You have not sent a token, your role lacks the permission, or your page comes from"
        " another origin.",
        "Send a token of a role that `msg` names. [Limit access](../how-to/limit-access.md) shows"
        " how to make one.",
    ),
    "limit_exceeded": Explanation(
        "A limit of the gateway is reached.",
        "You have too many subscriptions, calls, or goals open, there are too many clients, or a"
        " message is too large.",
        "End something, send less, or raise the setting that `msg` names. See"
        " [configuration](configuration.md).",
    ),
    "timeout": Explanation(
        "No answer came in time.",
        "A node is slow, hangs, or has just ended, or too many of your calls wait for an answer.",
        "Check the node. If it needs longer, add a longer `timeout` to the operation.",
    ),
    "internal": Explanation(
        "ROS, the gateway, or its machine has failed.",
        "A fault in the software, or a machine without free memory, disk, or file descriptors.",
        "Read the gateway's log, then try again.",
    ),
    "tripped": Explanation(
        "The robot was stopped, and the gateway refuses commands that move it.",
        "`msg` names the cause: commands stopped arriving, a client sent `stop`, the guard process"
        " is not ready, or others. See [driving](protocol/driving.md).",
        'Publish a zero command (`"msg":{}`), wait 250 ms, then send commands again.',
    ),
    "not_lease_holder": Explanation(
        "Another client drives the robot.",
        "Only one client drives at a time. Your commands began before that client let go.",
        "Let go, and wait until the other client is silent for 2 s. To drive at once, send"
        ' `{"op":"acquire_control"}`.',
    ),
    "stale_command": Explanation(
        "A command is too old to move the robot.",
        "It was over 250 ms late, waited that long in the gateway, or was overtaken by a `stop`.",
        "Send each command as soon as you make it, and send less on this connection.",
    ),
    "already_provided": Explanation(
        "A ROS node already provides this service or action.",
        "ROS delivers each request to both, and the caller takes the first answer. A node that was"
        " killed counts for about 20 s.",
        "Stop the node, or choose another name.",
    ),
    "qos_incompatible": Explanation(
        "A publisher and a subscriber of the topic do not match.",
        "One asks for a quality of service (QoS) that the other does not offer.",
        "Change `qos` as `msg` says, or leave it out. See"
        " [quality of service](protocol/topics.md#quality-of-service).",
    ),
    "deadline_missed": Explanation(
        "No message came within the `deadline` of the `qos`.",
        "The publisher is slower than this deadline, or has stopped.",
        "Check the publisher, or ask for a longer `deadline`.",
    ),
    "liveliness_lost": Explanation(
        "A publisher gave no sign of life within its lease.",
        "Its node hangs, or the network between the node and the gateway has failed.",
        "Check the node and the network.",
    ),
    "messages_lost": Explanation(
        "Messages were lost between the publisher and the gateway.",
        "The publisher sends faster than the gateway or the network can receive.",
        "Ask for a larger `depth` or for `reliable` in `qos`, as `msg` says, or publish less.",
    ),
    "publisher_gone": Explanation(
        "A node no longer publishes the topic.",
        "The node ended. A node that was killed is noticed after about 20 s.",
        "Start the node again. You do not need to subscribe again. To notice silence sooner, use"
        " [`stale_after_ms`](protocol/topics.md#silence).",
    ),
    "stale": Explanation(
        "The topic is silent.",
        "No message came for longer than the subscription's `stale_after_ms`.",
        "Check the publisher, and do not use the last message as current data.",
    ),
    "fresh": Explanation(
        "Messages arrive again after `stale`.",
        "The publisher is back, or another one has started.",
        "Use the data again.",
    ),
}


class ProtocolError(Exception):
    """A client's request cannot be carried out.

    ``code`` is for programs, the text for people: subject, value, limit, unit. The *level* is that
    of the `status` that answers the request.
    """

    level: ClassVar[Level] = "error"

    def __init__(self, code: StatusCode, reason: str) -> None:
        super().__init__(reason)
        self.code: StatusCode = code


def over_limit(limit: int, what: str, setting: str) -> ProtocolError:
    """Return the refusal of one more than a setting of `gateway.config.limits` allows."""
    text = f"at most {limit} {what}: end one, or raise limits.{setting}"
    return ProtocolError("limit_exceeded", text)


class NothingThereError(ProtocolError):
    """A client ends or answers what it does not have, or no longer.

    That is a warning, as in rosbridge's specification: who ends something twice is not wrong.
    """

    level = "warning"

    def __init__(self, reason: str) -> None:
        super().__init__("not_found", reason)


def unknown_topic(topic: str) -> str:
    """Return the reason for a topic that is absent or, which a client must not notice, hidden."""
    return f"topic {topic} is not known: name its type by `type`, or advertise it"
