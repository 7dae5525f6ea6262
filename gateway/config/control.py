# SPDX-License-Identifier: Apache-2.0
"""Moving a robot: the command topics and their rules, set by the operator."""

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
    """Commands to a robot, and the stops that protect it."""

    topics: CommandTopics = Field(
        ("/cmd_vel",),
        description="topics of `geometry_msgs/msg/Twist` or `TwistStamped` that move a robot:"
        " deadline, stop, lease and the other rules of docs/explanation/safety.md hold for these",
    )
    deadline_s: Annotated[float, Field(ge=0.1, le=2, allow_inf_nan=False)] = Field(
        0.5,
        description="seconds after the last command until the robot is stopped",
    )
    lease_s: Annotated[float, Field(ge=2, le=60, allow_inf_nan=False)] = Field(
        2, description="seconds of silence after which another client may drive"
    )
    first_command: Literal["any", "zero"] = Field(
        "any",
        description="what a client that drives must send first: with `zero`, nothing moves until"
        " its client has sent a command to stop; plain rosbridge clients do not know that",
    )
    max_linear_m_s: Speed = Field(
        10, description="m/s that a command may ask for; a faster one is clamped, not refused"
    )
    max_angular_rad_s: Speed = Field(
        10, description="rad/s that a command may ask for; a faster one is clamped, not refused"
    )
