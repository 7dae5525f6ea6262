# SPDX-License-Identifier: Apache-2.0
"""Settings of access: tokens, roles, the audit log, and TLS."""

from typing import Annotated, Final, Literal

from pydantic import Field, StringConstraints

from gateway.config.section import Section

Role = Literal["viewer", "operator", "admin"]  # by default each may do more than the one before
ROLES: Final[tuple[Role, ...]] = ("viewer", "operator", "admin")
AnyRole = Role | Literal["page"]  # pages of another local server have it, but no token

# `**`, or a path of segments, in which `*` stands for any characters
GLOB: Final = r"^(\*\*|(/(\*\*|[A-Za-z0-9_*]+))+)$"
Glob = Annotated[str, StringConstraints(pattern=GLOB)]
Globs = Annotated[
    tuple[Glob, ...],
    Field(
        max_length=256,
        json_schema_extra={"expected": "globs such as /camera/**, /*/odom or **"},
    ),
]
FileName = Annotated[
    str,
    StringConstraints(min_length=1),
    Field(json_schema_extra={"expected": "the name of a file"}),
]

_SUBSCRIBE: Final = "Topics that the role may subscribe to. It sees these names in the graph."
_PUBLISH: Final = "Topics that the role may publish. Services and actions that it may provide."
_CALL: Final = "Services that the role may call. Actions that it may send goals to."
_NOT_CALL: Final = "Exceptions from `call`."
_RECORD: Final = "Whether the role may start, stop, and mark recordings."


class RoleConfig(Section):
    """The role `admin`. By default it may do everything."""

    subscribe: Globs = Field(("**",), description=_SUBSCRIBE)
    publish: Globs = Field(("**",), description=_PUBLISH)
    call: Globs = Field(("**",), description=_CALL)
    record: bool = Field(True, description=_RECORD)
    deny_subscribe: Globs = Field((), description="Exceptions from `subscribe`.")
    deny_publish: Globs = Field((), description="Exceptions from `publish`.")
    deny_call: Globs = Field((), description=_NOT_CALL)


class ViewerConfig(RoleConfig):
    """The role `viewer`. By default it sees everything and changes nothing."""

    publish: Globs = Field((), description=_PUBLISH)
    call: Globs = Field(
        (
            "/rosapi/**",
            "/**/list_parameters",
            "/**/get_parameters",
            "/**/describe_parameters",
        ),
        description=_CALL,
    )
    record: bool = Field(False, description=_RECORD)


class OperatorConfig(RoleConfig):
    """The role `operator`. By default it may do everything except set parameters."""

    deny_call: Globs = Field(
        ("/**/set_parameters", "/**/set_parameters_atomically"), description=_NOT_CALL
    )


class PageConfig(RoleConfig):
    """The role of web pages of other servers on this machine.

    By default these pages may watch and call services. They may not drive, send goals, or set
    parameters.
    """

    publish: Globs = Field((), description=_PUBLISH)
    record: bool = Field(False, description=_RECORD)
    deny_call: Globs = Field(
        ("/**/_action/send_goal", "/**/set_parameters", "/**/set_parameters_atomically"),
        description="Exceptions from `call`. `/**/_action/send_goal` covers all goals.",
    )


class AccessConfig(Section):
    """Tokens, and the permissions of each role."""

    authentication: Literal["auto", "token", "none"] = Field(
        "auto",
        description="`auto`: clients need a token if other machines can connect."
        " `token`: always. `none`: never.",
    )
    anonymous_role: Role | None = Field(
        None,
        description="Role of clients that need no token. Unset: `admin` if only this machine can"
        " connect, otherwise `viewer`.",
    )
    token_file: FileName | None = Field(
        None,
        description="File with the hashes of the tokens. Unset: `ros2-gateway/tokens.json` in"
        " `XDG_CONFIG_HOME` or `~/.config`.",
    )
    max_unauthenticated: Annotated[int, Field(ge=1)] = Field(
        16,
        description="Maximum number of connections that have not sent their token. A further one"
        " replaces the oldest of the address that has most.",
    )
    auth_timeout_s: Annotated[float, Field(gt=0, le=3600, allow_inf_nan=False)] = Field(
        5, description="Time for a client to send its token. Then it gets close code 4401."
    )
    unauthenticated_message_bytes: Annotated[int, Field(ge=1024, le=1024**2)] = Field(
        4096,
        description="Maximum size of a frame before the token is known. A larger frame ends the"
        " connection with code 1009.",
    )
    viewer: ViewerConfig = ViewerConfig()
    page: PageConfig = PageConfig()
    operator: OperatorConfig = OperatorConfig()
    admin: RoleConfig = RoleConfig()

    def rules(self, role: AnyRole) -> RoleConfig:
        """Return the rules of a role."""
        rules: RoleConfig = getattr(self, role)
        return rules


class AuditConfig(Section):
    """The record of connections, refusals, changes of control, and stops."""

    file: FileName | None = Field(
        None,
        description="File that gets one JSON line for each event. Unset: events are only in the"
        " log.",
    )
    max_bytes: Annotated[int, Field(ge=64 * 1024)] = Field(
        10 * 1024**2,
        description="Maximum size of the file, about 60,000 events. The full file is renamed to"
        " FILE.1 and replaces the older one.",
    )


class TlsConfig(Section):
    """Encryption with a certificate."""

    cert: FileName | None = Field(
        None,
        description="Certificate chain in PEM. Clients then need `wss://`, except if `tls.port` is"
        " set.",
    )
    key: FileName | None = Field(
        None, description="Private key in PEM. Unset: the file of the certificate has the key."
    )
    port: Annotated[int, Field(ge=0, le=65535)] | None = Field(
        None,
        description="TCP port with TLS, next to the plain one. 0 selects a free port. Without a"
        " certificate, this machine signs its own.",
    )
