# SPDX-License-Identifier: Apache-2.0
"""Settings of connections to a Zenoh router of a network that others share."""

from typing import Annotated, Final

from pydantic import Field, StringConstraints

from gateway.config.access import FileName, Role
from gateway.config.section import Section

# in a key of Zenoh, and in the path of a relay
ROBOT_NAME: Final = r"^[a-z0-9_-]{1,32}$"

Endpoint = Annotated[
    str,
    StringConstraints(pattern=r"^[a-z0-9_-]+/[^/\s;=]+([?#][^\s;]*)?$"),
    Field(json_schema_extra={"expected": "PROTOCOL/HOST:PORT such as tls/router.example:7447"}),
]
RobotName = Annotated[
    str,
    StringConstraints(pattern=ROBOT_NAME),
    Field(json_schema_extra={"expected": "1 to 32 lowercase letters, digits, - and _"}),
]


class ZenohLinkConfig(Section):
    """A connection to a router, and the proof of who connects."""

    ca: FileName | None = Field(
        None, description="Certificate in PEM that signed the router's. Unset: public authorities."
    )
    cert: FileName | None = Field(
        None, description="Certificate in PEM of this machine, if the router asks for one."
    )
    key: FileName | None = Field(None, description="The private key of `cert` in PEM.")
    user: str | None = Field(None, description="Name of this machine, if the router asks for one.")
    user_file: FileName | None = Field(
        None, description="File with the password of `user`, and nothing else."
    )
    settings: str = Field(
        "",
        description="Further settings of Zenoh, `key=json;key=json` as in `ZENOH_CONFIG_OVERRIDE`.",
    )


class RelayConfig(ZenohLinkConfig):
    """A relay: it serves the robots behind a Zenoh router."""

    max_robots: Annotated[int, Field(ge=1, le=1000)] = Field(
        128, description="Most robots that a relay serves. It leaves out further ones."
    )
    drain_s: Annotated[float, Field(ge=0, le=3600, allow_inf_nan=False)] = Field(
        10.0,
        description="After SIGTERM, a relay serves for so long, and reports that it is not ready.",
    )


class UplinkConfig(ZenohLinkConfig):
    """The uplink: it offers the robot to relays, through a Zenoh router."""

    endpoint: Endpoint | None = Field(
        None, description="Address of the Zenoh router. Unset: there is no uplink."
    )
    robot_name: RobotName | None = Field(
        None, description="Name of the robot for viewers. Unset: the name of this machine."
    )
    role: Role = Field(
        "operator", description="Role of everybody who uses the robot through the uplink."
    )
    max_image_hz: Annotated[float, Field(gt=0, le=1000, allow_inf_nan=False)] | None = Field(
        None, description="Most images per second of one camera. Unset: all that fit the link."
    )
    max_cloud_hz: Annotated[float, Field(gt=0, le=1000, allow_inf_nan=False)] | None = Field(
        None, description="Most point clouds per second of one topic. Unset: all of them."
    )
    max_cloud_points: Annotated[int, Field(ge=1, le=500_000)] | None = Field(
        None, description="Most points of a point cloud. Of more, evenly spaced ones stay."
    )
    cloud_voxel_m: Annotated[float, Field(ge=0.001, le=1000, allow_inf_nan=False)] | None = Field(
        None, description="Width in m of the cubes in which one point of a cloud stays. Unset: all."
    )
