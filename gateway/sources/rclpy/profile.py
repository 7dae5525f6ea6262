# SPDX-License-Identifier: Apache-2.0
"""Conversion between the port's quality of service and rclpy's."""

from typing import Final

from rclpy.duration import Duration
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
)
from rclpy.topic_endpoint_info import TopicEndpointInfo

from gateway.sources.qos import MAX_PERIOD_NS, Endpoint
from gateway.sources.source import Qos


def to_profile(qos: Qos) -> QoSProfile:
    """Convert a quality of service that leaves nothing open."""
    return QoSProfile(
        reliability=ReliabilityPolicy.RELIABLE
        if qos.reliability == "reliable"
        else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL
        if qos.durability == "transient_local"
        else DurabilityPolicy.VOLATILE,
        history=HistoryPolicy.KEEP_ALL if qos.history == "keep_all" else HistoryPolicy.KEEP_LAST,
        depth=qos.depth,
        deadline=_duration(qos.deadline_ns),
        lifespan=_duration(qos.lifespan_ns),
        liveliness=LivelinessPolicy.AUTOMATIC,
        liveliness_lease_duration=_duration(qos.lease_ns),
    )


_HASHED: Final = "RIHS"  # REP-2011: how a hash begins, of any version


def to_endpoint(info: TopicEndpointInfo) -> Endpoint:
    """Convert what discovery knows of a publisher or a subscription.

    A policy that discovery leaves unknown counts as the weaker one, which any offer matches.
    """
    profile = info.qos_profile
    return Endpoint(
        node=endpoint_node(info),
        type_name=info.topic_type,
        reliability="reliable"
        if profile.reliability == ReliabilityPolicy.RELIABLE
        else "best_effort",
        durability="transient_local"
        if profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
        else "volatile",
        depth=profile.depth or None,
        deadline_ns=_nanoseconds(profile.deadline),
        lifespan_ns=_nanoseconds(profile.lifespan),
        lease_ns=_nanoseconds(profile.liveliness_lease_duration),
        is_manual=profile.liveliness == LivelinessPolicy.MANUAL_BY_TOPIC,
        type_hash=type_hash(info),
    )


def type_hash(info: TopicEndpointInfo) -> str | None:
    """Return the hash of an endpoint's type. ``None`` if it reports none, as before Iron."""
    text = str(getattr(info, "topic_type_hash", ""))
    return text if text.startswith(_HASHED) else None  # else it is INVALID


def endpoint_node(endpoint: TopicEndpointInfo) -> str:
    """Return the full name of the node that has an endpoint."""
    return full_name(endpoint.node_namespace, endpoint.node_name)


def full_name(namespace: str, name: str) -> str:
    """Join a namespace and a node name. rmw's placeholders, which have no namespace, stay bare."""
    return f"{namespace.rstrip('/')}/{name}" if namespace.startswith("/") else name


def _nanoseconds(duration: Duration) -> int | None:
    return duration.nanoseconds if 0 < duration.nanoseconds < MAX_PERIOD_NS else None


def _duration(nanoseconds: int | None) -> Duration:
    return Duration(nanoseconds=MAX_PERIOD_NS if nanoseconds is None else nanoseconds)
