# SPDX-License-Identifier: Apache-2.0
"""About the gateway itself and what it knows: levels, clocks, types, the graph."""

from typing import Any, Literal

from gateway.protocol.operations.base import Operation


class SetLevel(Operation):
    """Choose the least severe `status` frames that this client wants."""

    op = "set_level"
    level: Literal["none", "error", "warning", "info"]


class Hello(Operation):
    """Ask who the server is and what it allows."""

    op = "hello"


class Ping(Operation):
    """Ask for the clocks; the value comes back untouched."""

    op = "ping"
    value: Any = None


class Describe(Operation):
    """Ask for the schema, the definition and the hash of a message, service or action type."""

    op = "describe"
    type: str | int


class GraphRequest(Operation):
    """Ask for topics, services, actions and nodes.

    Once or, with ``watch: true``, with all later changes; ``watch: false`` ends these.
    """

    op = "graph"
    watch: bool | None = None


class Auth(Operation):
    """Accepted for old clients' sake; this server asks nobody for a password."""

    op = "auth"
