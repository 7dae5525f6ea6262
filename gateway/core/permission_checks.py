# SPDX-License-Identifier: Apache-2.0
"""Permission checks of requests, before anything is done or created.

This is the one place where a request is allowed or refused, on the resolved name. Parameters are
the exception: their node is known later, so `check_call` is asked there. A name that is hidden from
a client gets the answer that a name which does not exist would get.
"""

from typing import Final, NamedTuple

from gateway.access.permissions import SEND_GOAL, Action, Permissions
from gateway.core import requests
from gateway.core.errors import ProtocolError, unknown_topic
from gateway.core.names import resolve_action, resolve_service, resolve_topic
from gateway.core.requests import Request
from gateway.core.session import Session

_TRANSFORMS: Final = ("/tf", "/tf_static")
_TO_TRUST: Final = ": to let this page do more, add its origin to the setting allowed_origins"


class _Need(NamedTuple):
    """A permission that an request needs, and the answer if a name does not exist."""

    action: Action
    names: tuple[str, ...]
    doing: str
    absent: str | None  # None: a request that makes names is refused in any case,
    makes: bool = False  # as this one would be, of a name that is absent
    part: str = ""  # of what a name stands for: the service that takes an action's goals


def may_carry_out(session: Session, request: Request, *, is_of_tf: bool = False) -> bool:
    """Return whether to carry out an request. False if it was answered as for an absent name.

    Call it only for restricted sessions: the others may do everything. An request *is_of_tf* if
    the gateway answers it with transforms: whatever its name is, it takes what those take.

    Raises:
        ProtocolError: ``forbidden``, or as for a name that does not exist, or the name is invalid.
    """
    if session.identity is None:
        raise ProtocolError("forbidden", session.NOT_AUTHENTICATED)
    permissions = session.identity.permissions
    need = _need(request, session.limits.max_name_characters)
    if need is not None and is_of_tf:
        need = need._replace(
            action="subscribe", names=_TRANSFORMS, doing="subscribing to", makes=False, part=""
        )
    for name in need.names if need else ():
        assert need is not None  # noqa: S101  # else there are no names
        if need.absent is not None and not need.makes and not permissions.sees(name):
            absent = ProtocolError("not_found", need.absent)
            if isinstance(request, requests.Subscribe):  # which would wait for the topic
                if request.type is None:
                    session.warn(absent, request)
                return False
            raise absent
        _check(permissions, need.action, name, need.doing, need.part)
    return True


def check_call(permissions: Permissions, service: str) -> None:
    """Refuse a call of a service that the role may not make.

    Raises:
        ProtocolError: ``forbidden``, or ``not_found`` if the role does not see the name.
    """
    if not permissions.sees(service):
        raise ProtocolError("not_found", f"service {service} does not exist")
    _check(permissions, "call", service, "calling")


def check_publish(session: Session, topic: str) -> None:
    """Refuse to let a client drive who may not publish on a topic.

    Raises:
        ProtocolError: ``forbidden``.
    """
    if session.is_restricted and session.identity is not None:
        _check(session.identity.permissions, "publish", topic, "publishing on")


def check_subscribe(session: Session, topic: str) -> None:
    """Refuse to let a client have what was said on a topic that it may not subscribe to.

    Raises:
        ProtocolError: ``forbidden``, or ``not_found`` if the role does not see the name.
    """
    if session.is_restricted and session.identity is not None:
        permissions = session.identity.permissions
        if not permissions.sees(topic):
            raise ProtocolError("not_found", unknown_topic(topic))
        _check(permissions, "subscribe", topic, "subscribing to")


def may_record(session: Session) -> bool:
    """Return whether the role of a client may record."""
    identity = session.identity if session.is_restricted else None
    return identity is None or identity.permissions.rules.record


def check_record(session: Session) -> None:
    """Refuse to let a client record whose role may not.

    Raises:
        ProtocolError: ``forbidden``.
    """
    if session.identity is not None and not may_record(session):
        permissions = session.identity.permissions
        roles = permissions.roles_that_record()
        who = f"requires role {' or '.join(roles)}" if roles else "is not allowed for any role"
        raise ProtocolError("forbidden", f"recording {who}, and this client is {permissions.role}")


def _check(permissions: Permissions, action: Action, name: str, doing: str, part: str = "") -> None:
    if permissions.may(action, name + part):
        return
    roles = permissions.roles_that_may(action, name + part)
    who = f"requires role {' or '.join(roles)}" if roles else "is not allowed for any role"
    remedy = _TO_TRUST if roles and permissions.role == "page" else ""
    client = f"and this client is {permissions.role}"
    raise ProtocolError("forbidden", f"{doing} {name} {who}, {client}{remedy}")


def _need(request: Request, longest: int) -> _Need | None:
    if not request.needs_permission:
        return None
    match request:
        case requests.Subscribe():
            topic = resolve_topic(request.topic, longest)
            absent = f"topic {topic} is not known yet, waiting for it"
            return _Need("subscribe", (topic,), "subscribing to", absent)
        case requests.Publish() | requests.Advertise():
            topic = resolve_topic(request.topic, longest)
            makes = request.type is not None
            return _Need("publish", (topic,), "publishing on", unknown_topic(topic), makes)
        case requests.CallService():
            service = resolve_service(request.service, longest)
            return _Need("call", (service,), "calling", f"service {service} does not exist")
        case requests.SendActionGoal():
            action = resolve_action(request.action, longest)
            absent = f"action {action} does not exist"
            return _Need("call", (action,), "sending goals to", absent, part=SEND_GOAL)
        case requests.AdvertiseService():
            service = resolve_service(request.service, longest)
            return _Need("publish", (service,), "providing service", None)
        case requests.AdvertiseAction():
            action = resolve_action(request.action, longest)
            return _Need("publish", (action,), "providing action", None)
        case requests.LookupTransform():
            absent = f"frame {request.target_frame!r} is unknown"
            return _Need("subscribe", _TRANSFORMS, "subscribing to", absent)
        case _:
            raise ProtocolError("forbidden", f"{request.kind} requires a role without limits")
