# SPDX-License-Identifier: Apache-2.0
"""Thinned clouds: whether a subscription brings them, or why it does not."""

from gateway.codec.cloud import CLOUD, CloudOptions
from gateway.codec.types import MessageType
from gateway.core.requests import Subscribe
from gateway.core.topics.subscription_options import SubscriptionOptions


def requested_cloud(message_type: MessageType, options: SubscriptionOptions) -> CloudOptions | None:
    """Return how clouds are thinned. ``None`` for plain messages."""
    return None if _obstacle(message_type.name, options) else options.cloud


def why_whole(request: Subscribe, options: SubscriptionOptions, type_name: str) -> str:
    """Say why a request for thinned clouds brings plain messages, or "".

    *options* are those of all requests, on a topic of type *type_name*.
    """
    why = _obstacle(type_name, options) if request.cloud is not None else ""
    return f"cloud: {why}, sending plain messages" if why else ""


def _obstacle(type_name: str, options: SubscriptionOptions) -> str:
    if type_name != CLOUD:
        return f"{type_name} cannot be thinned, only {CLOUD}"
    if options.framing.content == "cdr":
        return f"{options.framing.name} sends whole messages, use cbor"
    if options.fields is not None:
        return "with fields, thinned clouds are not available: name fields in cloud.fields"
    return ""
