# SPDX-License-Identifier: Apache-2.0
"""The choices of ``serve --zenoh``. This module imports nothing that takes time."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

_REMEDY: Final = (
    "start the router on the robot (ros2 run rmw_zenoh_cpp rmw_zenohd), check the address and the"
    " firewall, and try again"
)


@dataclass(frozen=True)
class ZenohOptions:
    """The router of the robot, and how the gateway speaks to it."""

    router: str  # such as tcp/robot:7447
    overrides: str = ""  # the value of ZENOH_CONFIG_OVERRIDE
    settings: Mapping[str, object] = field(default_factory=dict)  # of Zenoh, by key
    section: str = ""  # of the configuration, that has the settings
    given_by: str = "--zenoh or ZENOH_CONFIG_OVERRIDE"  # for errors, with what to do
    remedy: str = _REMEDY
    namespace: str = ""  # before all keys of the session, such as gw/r1. It sees no others
