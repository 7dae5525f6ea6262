# SPDX-License-Identifier: Apache-2.0
"""Operations on the gateway itself: levels, clocks, types, the graph."""

from typing import Any, Literal

from gateway.protocol.operations.base import Operation


class SetLevel(Operation):
    """Choose the least severe `status` frames that this client wants."""

    op = "set_level"
    level: Literal["none", "error", "warning", "info"]


class Hello(Operation):
    """Ask for the server's identity and limits."""

    op = "hello"


class Help(Operation):
    """Ask for lines to try; the text ``help``, which is not JSON, asks for them, too."""

    op = "help"


class Ping(Operation):
    """Ask for the clocks; the answer repeats the value unchanged."""

    op = "ping"
    value: Any = None


class Describe(Operation):
    """Ask for the schema, the definition, the hash and an example of a type.

    *type* names a message, service or action type, or a topic, service or action that has one.
    """

    op = "describe"
    type: str | int


class GraphRequest(Operation):
    """Ask for topics, services, actions and nodes.

    Once or, with ``watch: true``, with all later changes; ``watch: false`` ends these.
    """

    op = "graph"
    watch: bool | None = None


class Events(Operation):
    """Ask for what happens on the topics that clients use: publishers gone, deadlines missed ...

    With ``watch: false`` no more of it.
    """

    op = "events"
    watch: bool = True


class Auth(Operation):
    """Show a token; the first frame of clients that can send no header.

    Of rosbridge's own fields (`mac`, `client`, ...) none is used: its shared secret authenticates
    nobody in particular.
    """

    op = "auth"
    token: str | None = None
