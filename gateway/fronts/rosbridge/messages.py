# SPDX-License-Identifier: Apache-2.0
"""The frames that the server sends, as JSON bytes."""

from collections.abc import Mapping
from typing import Any, Final

import orjson

from gateway.codec.json import dumps
from gateway.core.errors import Level, StatusCode


def status(
    level: Level,
    text: str,
    *,
    code: StatusCode | None = None,
    request: str | None = None,
    request_id: str | int | None = None,
) -> bytes:
    """Build a `status` frame. *request* is the operation it answers."""
    frame: dict[str, Any] = {"op": "status", "level": level, "msg": text}
    if request_id is not None:
        frame["id"] = request_id
    if code is not None:
        frame["code"] = code
    if request is not None:
        frame["request"] = request
    return orjson.dumps(frame)


def answer(op: str, request_id: str | int | None, **members: Any) -> bytes:
    """Build the answer to one of this gateway's own operations."""
    frame: dict[str, Any] = {"op": op}
    if request_id is not None:
        frame["id"] = request_id
    return dumps(frame | members)


def help_answer(
    request_id: str | int | None, text: str, frames: Mapping[str, Mapping[str, Any]], **others: Any
) -> bytes:
    """Build the answer to `help`. Each of *frames* has its own line, which can be copied."""
    lines = ",".join(
        f"{orjson.dumps(purpose).decode()}:\n{orjson.dumps(frame).decode()}\n"
        for purpose, frame in frames.items()
    )
    head = answer("help", request_id, msg=text)
    return b'%b,"try":{\n%b},%b' % (head[:-1], lines.encode(), dumps(others)[1:])


def description(
    request_id: str | int | None, example: Mapping[str, Any] | None, members: Mapping[str, Any]
) -> bytes:
    """Build the answer to `describe`. The example has its own line, so it can be copied."""
    if example is None:
        return answer("describe", request_id, **members)
    head = answer("describe", request_id)
    return b'%b,"example":\n%b\n,%b' % (head[:-1], orjson.dumps(example), dumps(members)[1:])


def publish_prefix(topic: str) -> bytes:
    """Return the beginning of every `publish` frame of a topic, up to the message.

    The topic is the name as requested: clients match frames by it.
    """
    return b'{"op":"publish","topic":' + orjson.dumps(topic) + b',"msg":'


def publish_meta_prefix(topic: str, meta: Mapping[str, object]) -> bytes:
    """Return the beginning of a `publish` frame with these members of ``meta: true``."""
    members = {"op": "publish", "topic": topic, **meta}
    return orjson.dumps(members)[:-1] + b',"msg":'


def service_response(
    service: str, request_id: str | int | None, values: object, *, result: bool
) -> bytes:
    """Build the answer to a `call_service`. After a failure, *values* is the reason.

    rosbridge clients read ``values`` and ``id`` without a check, so both are always present.
    """
    frame = {"op": "service_response", "service": service, "values": values, "result": result}
    return dumps(frame if request_id is None else frame | {"id": request_id})


def call_service(service: str, call_id: str, args: object) -> bytes:
    """Build a `call_service` for the client that provides the service."""
    return dumps({"op": "call_service", "id": call_id, "service": service, "args": args})


def send_action_goal(action: str, goal_id: str, action_type: str, args: object) -> bytes:
    """Build a `send_action_goal` for the client that provides the action."""
    frame = {"op": "send_action_goal", "id": goal_id, "action": action, "action_type": action_type}
    return dumps(frame | {"args": args, "feedback": True})


def cancel_action_goal(action: str, goal_id: str) -> bytes:
    """Build a `cancel_action_goal` for the client that provides the action."""
    return dumps({"op": "cancel_action_goal", "id": goal_id, "action": action})


def action_feedback(action: str, goal_id: str | int | None, values: object) -> bytes:
    """Build an `action_feedback` for the client that sent the goal."""
    frame = {"op": "action_feedback", "action": action, "values": values}
    return dumps(frame if goal_id is None else frame | {"id": goal_id})


def action_result(
    action: str, goal_id: str | int | None, values: object, *, status: int, result: bool
) -> bytes:
    """Build the answer to a `send_action_goal`. *status* is of action_msgs/msg/GoalStatus.

    As in rosbridge, *result* is also true for goals that were aborted or canceled. False means
    that there was no goal, and *values* is the reason.
    """
    frame = {"op": "action_result", "action": action, "values": values}
    frame |= {"status": status, "result": result}
    return dumps(frame if goal_id is None else frame | {"id": goal_id})


def transform(request_id: str | int | None, transform: bytes) -> bytes:
    """Build an answer to `lookup_transform` of JSON that several clients share."""
    identity = b"" if request_id is None else b',"id":' + orjson.dumps(request_id)
    return b'{"op":"lookup_transform"%b,"transform":%b}' % (identity, transform)


PUBLISH_SUFFIX: Final = b"}"
