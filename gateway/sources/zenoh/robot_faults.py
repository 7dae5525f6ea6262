# SPDX-License-Identifier: Apache-2.0
"""Faults of a robot's router, and of the graph that it lists."""

from collections.abc import Iterator

from gateway.faults import Fault
from gateway.sources.zenoh.heard_publishers import UnlistedPublishers
from gateway.sources.zenoh.session import ZenohSession
from gateway.sources.zenoh.token_changes import MAX_LEFT_OUT, MAX_TOKENS, TokenChanges
from gateway.sources.zenoh.token_graph import MAX_OF_NAME, TokenGraph


def robot_faults(
    session: ZenohSession, changes: TokenChanges, graph: TokenGraph, unlisted: UnlistedPublishers
) -> Iterator[Fault]:
    """Yield the faults that there are now. Ask every few seconds."""
    if not session.is_connected:
        text = "the Zenoh router of the robot does not answer: start it, or check the network"
        yield Fault("not ready", text)
    if unlisted.count():
        text = (
            "samples arrive from publishers that the Zenoh router does not list: start the"
            " robot's nodes again, and use the router of their own ROS distribution"
        )
        yield Fault("degraded", text)
    if changes.has_stopped:
        text = (
            f"the Zenoh router has listed more than {MAX_TOKENS + MAX_LEFT_OUT} nodes and"
            " endpoints, so the gateway follows no more changes: end the program that declares"
            " them, and restart the gateway"
        )
        yield Fault("degraded", text)
    elif changes.left_out:
        text = (
            f"the Zenoh router lists more than {MAX_TOKENS} nodes and endpoints, and the others"
            " are left out: divide them among several ROS domains"
        )
        yield Fault("degraded", text)
    if graph.has_too_many:
        text = (
            f"a topic or a service has more than {MAX_OF_NAME} publishers, subscriptions, servers,"
            " or clients, and the others are left out: end the program that opens them"
        )
        yield Fault("degraded", text)
