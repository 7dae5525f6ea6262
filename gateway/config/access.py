# SPDX-License-Identifier: Apache-2.0
"""The configuration of who may connect, and do what."""

from typing import Annotated, Final, Literal

from pydantic import Field, StringConstraints

from gateway.config.section import Section

Role = Literal["viewer", "operator", "admin"]  # each may more than the one before, by default
ROLES: Final[tuple[Role, ...]] = ("viewer", "operator", "admin")
AnyRole = Role | Literal["page"]  # which nobody is given: a page of another local server has it

# `**`, or a path of segments; within one, `*` stands for any characters
Glob = Annotated[str, StringConstraints(pattern=r"^(\*\*|(/(\*\*|[A-Za-z0-9_*]+))+)$")]
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


class RoleConfig(Section):
    """The names that a role may use, resolved ones: a deny beats every allow."""

    subscribe: Globs = Field(
        ("**",), description="topics it may subscribe to; it sees these names in the graph"
    )
    publish: Globs = Field(
        ("**",), description="topics it may publish, services and actions it may provide"
    )
    call: Globs = Field(
        ("**",),
        description="services it may call, actions it may send goals to; parameters of a node are"
        " services, such as `/base/set_parameters`",
    )
    deny_subscribe: Globs = Field((), description="exceptions from `subscribe`")
    deny_publish: Globs = Field((), description="exceptions from `publish`")
    deny_call: Globs = Field((), description="exceptions from `call`")


class ViewerConfig(RoleConfig):
    """By default it sees everything and changes nothing."""

    publish: Globs = Field(
        (), description="topics it may publish, services and actions it may provide"
    )
    call: Globs = Field(
        (
            "/rosapi/**",
            "/**/list_parameters",
            "/**/get_parameters",
            "/**/describe_parameters",
        ),
        description="services it may call, actions it may send goals to; parameters of a node are"
        " services, such as `/base/set_parameters`",
    )


class OperatorConfig(RoleConfig):
    """By default it does everything but change parameters, where the robot's own limits are."""

    deny_call: Globs = Field(
        ("/**/set_parameters", "/**/set_parameters_atomically"),
        description="exceptions from `call`",
    )


class PageConfig(RoleConfig):
    """By default it watches and calls, but drives nothing and changes no parameters."""

    publish: Globs = Field(
        (), description="topics it may publish, services and actions it may provide"
    )
    deny_call: Globs = Field(
        ("/**/_action/send_goal", "/**/set_parameters", "/**/set_parameters_atomically"),
        description="exceptions from `call`; `/**/_action/send_goal` are all goals",
    )


class AccessConfig(Section):
    """The rules of who may connect, and do what."""

    authentication: Literal["auto", "token", "none"] = Field(
        "auto",
        description="whether clients need a token; `auto`: unless only this machine can connect",
    )
    anonymous_role: Role | None = Field(
        None,
        description="the role of clients without a token, where none is needed; unset, `admin` if"
        " only this machine can connect, else `viewer`",
    )
    token_file: FileName | None = Field(
        None,
        description="the file with the hashes of the tokens; unset, `ros2-gateway/tokens.json`"
        " below XDG_CONFIG_HOME or ~/.config",
    )
    max_unauthenticated: Annotated[int, Field(ge=1)] = Field(
        16,
        description="connections at once that have yet to send their token; one more takes the"
        " place of the oldest of the address that has most of them",
    )
    auth_timeout_s: Annotated[float, Field(gt=0, le=3600, allow_inf_nan=False)] = Field(
        5, description="seconds a client may take to send its token; then close code 4401"
    )
    unauthenticated_message_bytes: Annotated[int, Field(ge=1024, le=1024**2)] = Field(
        4096,
        description="bytes of the largest frame a client may send before its token is known; a"
        " larger one ends its connection with code 1009",
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
    """The record of who connected, was refused, took control, and of every stop."""

    file: FileName | None = Field(
        None, description="the file that gets a JSON line for each event; unset, the log alone"
    )
    max_bytes: Annotated[int, Field(ge=64 * 1024)] = Field(
        10 * 1024**2,
        description="bytes of that file, some 60,000 events; then it becomes FILE.1, in place of"
        " the one before",
    )


class TlsConfig(Section):
    """Encryption, by a certificate."""

    cert: FileName | None = Field(
        None,
        description="the certificate and those that vouch for it, in PEM;"
        " then wss:// only, unless TLS has a port of its own",
    )
    key: FileName | None = Field(
        None, description="its private key, in PEM; unset, it is in the file of the certificate"
    )
    port: Annotated[int, Field(ge=0, le=65535)] | None = Field(
        None,
        description="TCP port with TLS beside the plain one, 0 for any free one; without a"
        " certificate this machine signs one itself",
    )
