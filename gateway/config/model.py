# SPDX-License-Identifier: Apache-2.0
"""The configuration: one frozen model, each field with its unit, its reason and its bounds.

`gateway.config.settings` reads the values.
"""

import ipaddress
from typing import Annotated, Final, Literal

from pydantic import AfterValidator, Field, StringConstraints

from gateway.config.access import AccessConfig, AuditConfig, TlsConfig
from gateway.config.control import ControlConfig
from gateway.config.domain_id import MAX_DOMAIN_ID
from gateway.config.limits import Limits
from gateway.config.section import Section


def network(text: str) -> str:
    """Return an address or a network of addresses as it was given.

    Raises:
        ValueError: it is neither.
    """
    ipaddress.ip_network(text)
    return text


# the gateway answers these itself, so no WebSocket can begin there
TAKEN_PATHS: Final = (
    *("/healthz", "/healthz/live", "/healthz/ready", "/metrics", "/version"),
    *("/stream", "/stream_viewer", "/snapshot"),
)


def free_path(text: str) -> str:
    """Return a path as it was given.

    Raises:
        ValueError: it is one of `TAKEN_PATHS`.
    """
    if text in TAKEN_PATHS:
        raise ValueError("the gateway has something else there")
    return text


_NAME_PART: Final = "[A-Za-z_][A-Za-z0-9_]*"  # rcl: a token of a name begins with no digit

Host = Annotated[
    str,
    StringConstraints(pattern=r"^[0-9A-Za-z.:_%-]+$"),
    Field(json_schema_extra={"expected": "a host name or an IP address"}),
]
UrlPath = Annotated[
    str,
    StringConstraints(pattern=r"^/[0-9A-Za-z._~/-]*$"),
    AfterValidator(free_path),
    Field(
        json_schema_extra={
            "expected": f"a path such as / or /ros, and none of {', '.join(TAKEN_PATHS)}"
        }
    ),
]
Origin = Annotated[str, StringConstraints(pattern=r"^(\*|null|[a-z][a-z0-9+.-]*://[^\s/,]+)$")]
Origins = Annotated[
    tuple[Origin, ...],
    Field(json_schema_extra={"expected": "origins such as https://ui.example, null, or *"}),
]
HostNames = Annotated[
    tuple[Annotated[str, StringConstraints(pattern=r"^(\*|[0-9A-Za-z._-]+)$")], ...],
    Field(json_schema_extra={"expected": "host names such as robot.lan, or *"}),
]
Network = Annotated[str, AfterValidator(network)]
Networks = Annotated[
    tuple[Network, ...],
    Field(json_schema_extra={"expected": "addresses or networks such as 10.0.0.0/8"}),
]
RosToken = Annotated[
    str,
    StringConstraints(pattern=rf"^{_NAME_PART}$", max_length=100),
    Field(
        json_schema_extra={"expected": "letters, digits and underscores, beginning with no digit"}
    ),
]
RosNamespace = Annotated[
    str,
    StringConstraints(pattern=rf"^(/|(/{_NAME_PART})+)$", max_length=100),
    Field(json_schema_extra={"expected": "a namespace such as / or /robot1"}),
]


class LogConfig(Section):
    """The log on standard error."""

    level: Literal["debug", "info", "warning", "error"] = Field(
        "info", description="the least severe record that is written"
    )
    format: Literal["text", "json"] = Field(
        "text", description="text for people, or one JSON object a line for log collectors"
    )


class RosConfig(Section):
    """The gateway as seen from ROS."""

    node_prefix: RosToken = Field(
        "ros2_gateway", description="what the names of the gateway's nodes begin with"
    )
    namespace: RosNamespace = Field(
        "/",
        description="the namespace of the gateway's nodes, and of the robot of `ros2-gateway demo`;"
        " topics of clients do not move",
    )
    domain_id: Annotated[int, Field(ge=0, le=MAX_DOMAIN_ID)] | None = Field(
        None, description="the DDS domain; unset, the environment's ROS_DOMAIN_ID decides"
    )
    use_sim_time: bool = Field(
        False, description="whether ROS time comes from `/clock` (a simulator, a replayed bag)"
    )
    diagnostics: bool = Field(
        True, description="whether the gateway reports on itself on `/diagnostics`, once a second"
    )


class ImagesConfig(Section):
    """The pictures that clients get of images."""

    default_format: Literal["jpeg", "png", "raw"] = Field(
        "jpeg",
        description="the format of images for who asks for none; `raw` is the plain message, for"
        " clients of rosbridge that read `encoding`, `step` and `data`",
    )
    workers: Annotated[int, Field(ge=1, le=64)] = Field(
        2,
        description="threads that encode and decode, beside the event loop; OpenCV lets them run in"
        " parallel",
    )


class TypesConfig(Section):
    """The types of messages beside those of installed packages."""

    paths: tuple[str, ...] = Field(
        (),
        description="folders with definitions of packages that are not installed here, such as a"
        " workspace's `src` or `install`; topics, services and actions of their types can be"
        " used all the same",
        json_schema_extra={"expected": "folders such as ~/ws/src"},
    )
    ask_nodes: bool = Field(
        True,
        description="whether to ask the robot's nodes for the definitions of types that are not"
        " installed here",
    )


class Config(Section):
    """The whole configuration; with the defaults the gateway serves this machine alone."""

    host: Host = Field(
        "127.0.0.1",
        description="the address to listen on; unless set, this machine alone can connect, to"
        " `127.0.0.1` and `::1`; any address that other machines reach asks for tokens, as `lan`"
        " does",
    )
    lan: bool = Field(
        False,
        description="whether to listen on all networks, IPv4 and IPv6; then clients need a token",
    )
    port: Annotated[int, Field(ge=0, le=65535)] = Field(
        9090, description="the TCP port, by default rosbridge's; 0 for any free one"
    )
    path: UrlPath = Field("/", description="the path of the WebSocket")
    allowed_origins: Origins = Field(
        (),
        description="origins of web pages that may connect as a program may, in addition to the"
        " gateway's own pages; `null` allows pages on disk, and with them a page of any web site in"
        " a sandboxed frame; `*` allows all. Pages of other servers on this machine may watch and"
        " call without it (role `page`), if only this machine can connect",
    )
    trusted_proxies: Networks = Field(
        (),
        description="addresses or networks of reverse proxies whose `Forwarded` or"
        " `X-Forwarded-For` header is believed: then limits per address count the clients'"
        " own addresses",
    )
    allowed_hosts: HostNames = Field(
        (),
        description="names under which the gateway is reached, beside addresses, `localhost` and"
        " this machine's own name; `*` allows all",
    )
    discoverable: bool = Field(
        True,
        description="whether clients find this gateway on their network without its address, if it"
        " listens on all of them; `ros2-gateway find` is such a client",
    )
    qr: bool = Field(
        True,
        description="whether a terminal shows the address as a QR code, if other machines can"
        " connect",
    )
    access: AccessConfig = AccessConfig()
    audit: AuditConfig = AuditConfig()
    tls: TlsConfig = TlsConfig()
    log: LogConfig = LogConfig()
    ros: RosConfig = RosConfig()
    limits: Limits = Limits()
    control: ControlConfig = ControlConfig()
    images: ImagesConfig = ImagesConfig()
    types: TypesConfig = TypesConfig()
