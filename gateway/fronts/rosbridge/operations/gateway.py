# SPDX-License-Identifier: Apache-2.0
"""Operations on the gateway itself: levels, clocks, types, the graph."""

from typing import Annotated, Any, Final, Literal

from pydantic import Field, ValidationInfo, field_validator

from gateway.core import requests
from gateway.fronts.rosbridge.operations.base import Operation
from gateway.fronts.rosbridge.own_requests import (
    AuthRequest,
    HelpRequest,
    LogRequest,
    SetLevelRequest,
)
from schemas.assembly_name import EXPECTATION, is_assembly_name

# Ten times what a large package has: half a second of a thread.
MAX_GENERATED_TYPES: Final = 300
MAX_URI: Final = 4096  # characters, as many as a path of Linux has bytes


class SetLevel(Operation):
    """Choose the least severe `status` frames that this client wants."""

    op = "set_level"
    makes = SetLevelRequest
    level: Literal["none", "error", "warning", "info"]


class Hello(Operation):
    """Ask for the server's identity and limits."""

    op = "hello"
    makes = requests.Hello


class Help(Operation):
    """Ask for lines to try. The plain text ``help`` also asks for them."""

    op = "help"
    makes = HelpRequest


class Ping(Operation):
    """Ask for the clocks. The answer repeats the value unchanged.

    ``clock_offset_ms`` is what the client adds to its clock to get the gateway's.
    """

    op = "ping"
    makes = requests.Ping
    value: Any = None
    clock_offset_ms: Annotated[float, Field(ge=-1e15, le=1e15)] | None = None  # 30,000 years


class Describe(Operation):
    """Ask for the schema, the definition, the hash and an example of a type.

    *type* names a message, service or action type, or a topic, service or action that has one.
    """

    op = "describe"
    makes = requests.Describe
    type: str | int


class Generate(Operation):
    """Ask for clients' code of some types, as the files of ``ros2-gateway generate --output``.

    *types* are full names. *asmdef* names an assembly of Unity, for C# alone.
    """

    op = "generate"
    makes = requests.Generate
    language: Literal["csharp", "typescript", "python", "json-schema"]
    types: Annotated[
        tuple[str, ...], Field(strict=False, min_length=1, max_length=MAX_GENERATED_TYPES)
    ]
    asmdef: str | None = None

    @field_validator("asmdef")
    @classmethod
    def _check_asmdef(cls, asmdef: str | None, info: ValidationInfo) -> str | None:
        if asmdef is not None and not is_assembly_name(asmdef):
            raise ValueError(f"expected {EXPECTATION}")
        if asmdef is not None and info.data.get("language", "csharp") != "csharp":
            raise ValueError("it is only for csharp")
        return asmdef


class FetchAsset(Operation):
    """Ask for a part of a mesh or a texture of an installed package, from an offset in bytes."""

    op = "fetch_asset"
    makes = requests.FetchAsset
    uri: Annotated[str, Field(max_length=MAX_URI)]
    offset: Annotated[int, Field(ge=0)] = 0


class GraphRequest(Operation):
    """Ask for topics, services, actions and nodes.

    Once or, with ``watch: true``, with all later changes. ``watch: false`` ends these.
    """

    op = "graph"
    makes = requests.GraphRequest
    watch: bool | None = None


class Events(Operation):
    """Ask for what happens on the topics that clients use: publishers gone, deadlines missed ...

    With ``watch: false`` no more of it.
    """

    op = "events"
    makes = requests.Events
    watch: bool = True


class Log(Operation):
    """Ask for the last lines of ``/rosout``, also from before this client connected."""

    op = "log"
    makes = LogRequest


class Auth(Operation):
    """Show a token: the first frame of a client that cannot send a header.

    Of rosbridge's own fields (`mac`, `client`, ...) none is used: its shared secret authenticates
    nobody in particular.
    """

    op = "auth"
    makes = AuthRequest
    token: str | None = None
