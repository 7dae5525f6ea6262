# SPDX-License-Identifier: Apache-2.0
"""The configuration: one frozen model with a description and bounds for each field.

`gateway.config.settings` reads the values.
"""

import ipaddress
from typing import Annotated, Final, Literal

from pydantic import AfterValidator, Field, StringConstraints

from gateway.config.access import AccessConfig, AuditConfig, TlsConfig
from gateway.config.control import ControlConfig
from gateway.config.domain_id import MAX_DOMAIN_ID
from gateway.config.limits import Limits
from gateway.config.recording import RecordingConfig
from gateway.config.section import Section
from gateway.config.zenoh import RelayConfig, UplinkConfig


def network(text: str) -> str:
    """Return an address or a network of addresses as it was given.

    Raises:
        ValueError: the text is neither.
    """
    ipaddress.ip_network(text)
    return text


# the gateway answers these itself, so the WebSocket cannot use them
TAKEN_PATHS: Final = (
    *("/healthz", "/healthz/live", "/healthz/ready", "/metrics", "/version"),
    *("/stream", "/stream_viewer", "/snapshot"),
)


def free_path(text: str) -> str:
    """Return a path as it was given.

    Raises:
        ValueError: the path is one of `TAKEN_PATHS`.
    """
    if text in TAKEN_PATHS:
        raise ValueError("the gateway uses this path itself")
    return text


_NAME_PART: Final = "[A-Za-z_][A-Za-z0-9_]*"  # in rcl, a part of a name cannot begin with a digit

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
        json_schema_extra={"expected": f"a path such as / or /ros, except {', '.join(TAKEN_PATHS)}"}
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
    Field(json_schema_extra={"expected": "letters, digits, and underscores, not a digit first"}),
]
RosNamespace = Annotated[
    str,
    StringConstraints(pattern=rf"^(/|(/{_NAME_PART})+)$", max_length=100),
    Field(json_schema_extra={"expected": "a namespace such as / or /robot1"}),
]


class LogConfig(Section):
    """The log on standard error."""

    level: Literal["debug", "info", "warning", "error"] = Field(
        "info", description="Least severe level in the log."
    )
    format: Literal["text", "json"] = Field(
        "text", description="`text` for people, `json` for log collectors (one object per line)."
    )


class RosConfig(Section):
    """The gateway's nodes in the ROS graph."""

    node_prefix: RosToken = Field(
        "ros2_gateway", description="First part of the names of the gateway's nodes."
    )
    namespace: RosNamespace = Field(
        "/",
        description="Namespace of the gateway's nodes, and of the robot of `ros2-gateway"
        " demo`. It does not change topics of clients.",
    )
    domain_id: Annotated[int, Field(ge=0, le=MAX_DOMAIN_ID)] | None = Field(
        None, description="DDS domain. Unset: `ROS_DOMAIN_ID` decides."
    )
    use_sim_time: bool = Field(
        False, description="Take ROS time from `/clock`, for a simulator or a replayed bag."
    )
    diagnostics: bool = Field(
        True, description="Publish the gateway's own state on `/diagnostics` once a second."
    )


class ImagesConfig(Section):
    """Images for clients."""

    default_format: Literal["jpeg", "png", "raw"] = Field(
        "jpeg",
        description="Format of images for clients that ask for none. `raw` is the plain"
        " message, as with rosbridge.",
    )
    workers: Annotated[int, Field(ge=1, le=64)] = Field(
        2,
        description="Number of threads that encode and decode images.",
    )


class TypesConfig(Section):
    """Message types that are not installed on the gateway's machine."""

    paths: tuple[str, ...] = Field(
        (),
        description="Directories with definitions of packages that are not installed, such"
        " as the `src` of a workspace.",
        json_schema_extra={"expected": "directories such as ~/ws/src"},
    )
    ask_nodes: bool = Field(
        True,
        description="Ask the robot's nodes for the definitions of types that are not installed.",
    )


class Config(Section):
    """The address, the port, and the web pages that may connect.

    The sections below are tables of the file. With the defaults, only this machine can connect.
    """

    host: Host = Field(
        "127.0.0.1",
        description="Address to listen on. By default only this machine can connect."
        " Clients need a token if other machines can reach the address.",
    )
    lan: bool = Field(
        False,
        description="Listen on all networks, IPv4 and IPv6. Clients then need a token.",
    )
    port: Annotated[int, Field(ge=0, le=65535)] = Field(
        9090, description="TCP port. The default is the port of rosbridge. 0 selects a free port."
    )
    path: UrlPath = Field("/", description="Path of the WebSocket.")
    allowed_origins: Origins = Field(
        (),
        description="Origins of web pages that may connect, in addition to the gateway's"
        " own pages. `*` allows all pages.",
    )
    trusted_proxies: Networks = Field(
        (),
        description="Reverse proxies whose `Forwarded` or `X-Forwarded-For` header is"
        " trusted. Limits per address then use the clients' own addresses.",
    )
    allowed_hosts: HostNames = Field(
        (),
        description="Names of this gateway, in addition to addresses, `localhost`, and this"
        " machine's name. `*` allows all names.",
    )
    discoverable: bool = Field(
        True,
        description="Answer clients that search for gateways, such as `ros2-gateway find`."
        " Needs a gateway that listens on all networks.",
    )
    qr: bool = Field(
        True,
        description="Show the address as a QR code in the terminal, if other machines can connect.",
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
    recording: RecordingConfig = RecordingConfig()
    uplink: UplinkConfig = UplinkConfig()
    relay: RelayConfig = RelayConfig()
