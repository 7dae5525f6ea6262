# SPDX-License-Identifier: Apache-2.0
"""A `subscribe` request: the checks before anything is opened, and the report to its client."""

from dataclasses import replace

from gateway.codec.error_text import FieldError, did_you_mean, truncate
from gateway.codec.types import MessageType
from gateway.core.errors import ProtocolError
from gateway.core.requests import Subscribe
from gateway.core.session import Session
from gateway.core.topic_types import TypeAskedError
from gateway.core.topics.requested_clouds import why_whole
from gateway.core.topics.requested_pictures import why_plain
from gateway.core.topics.subscription import Feed, Subscription
from gateway.sources.graph import Graph
from gateway.sources.source import Ros


def with_bounded_queue(request: Subscribe, session: Session) -> Subscribe:
    """Return a request whose `queue_length` is allowed. Warn the client of a longer one."""
    longest = session.limits.max_queue_length
    if request.queue_length is None or request.queue_length <= longest:
        return request
    text = f"queue_length: {request.queue_length} is longer than allowed, {longest} messages wait"
    warning = ProtocolError("limit_exceeded", f"{text}: for more, raise limits.max_queue_length")
    session.warn(warning, request)
    return replace(request, queue_length=longest)


def check_content(request: Subscribe) -> None:
    """Refuse fields that cannot be told apart as a message travels, before its type is known."""
    if request.fields is not None and request.framing.content == "cdr":
        text = f"fields: {request.framing.name} sends whole messages, use cbor to select fields"
        raise ProtocolError("bad_request", text)


def check_fields(message_type: MessageType, fields: tuple[str, ...] | None) -> None:
    """Refuse fields that a message has not."""
    try:
        message_type.check_fields(fields)
    except FieldError as error:
        raise ProtocolError("bad_request", f"fields: {truncate(str(error))}") from error


def report(
    subscription: Subscription,
    request: Subscribe,
    source: Feed | None,
    asked: TypeAskedError | None,
    ros: Ros,
) -> None:
    """Tell a client what has become of its request."""
    session, name = subscription.session, subscription.topic_name
    if request.framing.warning:
        session.warn(ProtocolError("bad_request", request.framing.warning), request)
    if asked is not None:
        text = f"topic {name}: {asked.question}, waiting for it"
        session.inform(text, request)
    elif source is None:
        hint = topic_meant(name, ros.graph(), session)
        text = f"topic {name} is not known yet, waiting for it{hint}"
        session.warn(ProtocolError("not_found", text), request)
    else:
        type_name = source.topic.type_name
        is_plain = source.encoding.image is None
        if is_plain and (text := why_plain(request, subscription.options, type_name)):
            session.warn(ProtocolError("bad_request", text), request)
        if text := why_whole(request, subscription.options, type_name):
            session.warn(ProtocolError("bad_request", text), request)
        text = f"subscribed to {name} ({type_name})"
        session.inform(text, request)


def topic_meant(topic: str, graph: Graph, session: Session) -> str:
    """Return a hint at the topic that was probably meant, if the client sees it."""
    return did_you_mean(topic, (each.name for each in graph.topics if session.sees(each.name)))
