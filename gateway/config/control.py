# SPDX-License-Identifier: Apache-2.0
"""Settings of the command topics, which move a robot."""

from typing import Annotated, Literal

from pydantic import Field, StringConstraints

from gateway.config.section import Section

CommandTopic = Annotated[
    str, StringConstraints(pattern=r"^(/[A-Za-z_][A-Za-z0-9_]*)+$", max_length=200)
]
CommandTopics = Annotated[
    tuple[CommandTopic, ...],
    Field(max_length=16, json_schema_extra={"expected": "up to 16 topics such as /cmd_vel"}),
]
Speed = Annotated[float, Field(gt=0, le=1000, allow_inf_nan=False)]


class ControlConfig(Section):
    """The rules for commands that move the robot."""

    topics: CommandTopics = Field(
        ("/cmd_vel",),
        description="Topics of `geometry_msgs/msg/Twist` or `TwistStamped` that move a robot. The"
        " safety rules apply to these topics.",
    )
    deadline_s: Annotated[float, Field(ge=0.1, le=2, allow_inf_nan=False)] = Field(
        0.5,
        description="Command timeout. If no command arrives for this time, the gateway stops the"
        " robot.",
    )
    lease_s: Annotated[float, Field(ge=2, le=60, allow_inf_nan=False)] = Field(
        2, description="Time without commands after which another client can take control."
    )
    first_command: Literal["any", "zero"] = Field(
        "any",
        description="`zero`: nothing moves until the client has sent a zero command. Plain"
        " rosbridge clients do not send one.",
    )
    max_linear_m_s: Speed = Field(
        10, description="Maximum speed of a command in m/s. The gateway reduces a faster one."
    )
    max_angular_rad_s: Speed = Field(
        10, description="Maximum speed of a command in rad/s. The gateway reduces a faster one."
    )
