# SPDX-License-Identifier: Apache-2.0
"""The places of the simulated robot's frames, for its transforms and for its description.

The names of frames and joints are those of a TurtleBot3.
"""

import math
from typing import Final, NamedTuple

from gateway_sim import camera
from gateway_sim.robot import WHEEL_RADIUS, WHEEL_SEPARATION

# x, y, z, w of a unit quaternion
Rotation = tuple[float, float, float, float]


class Mount(NamedTuple):
    """The place of a frame in its parent: metres, and radians about the parent's x, y and z.

    A wheel turns about the z of its frame.
    """

    joint: str
    parent: str
    child: str
    x: float
    y: float
    z: float
    roll: float = 0.0
    pitch: float = 0.0
    yaw: float = 0.0

    @property
    def rotation(self) -> Rotation:
        """The turns as a quaternion: about x first, about z last, as URDF has it."""
        (sr, cr), (sp, cp), (sy, cy) = (
            (math.sin(angle / 2), math.cos(angle / 2))
            for angle in (self.roll, self.pitch, self.yaw)
        )
        return (
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
            cr * cp * cy + sr * sp * sy,
        )

    def turned(self, angle: float) -> Rotation:
        """Return the rotation after a turn about the frame's own z, in radians."""
        x, y, z, w = self.rotation
        s, c = math.sin(angle / 2), math.cos(angle / 2)
        return x * c + y * s, y * c - x * s, z * c + w * s, w * c - z * s


BASE_HEIGHT: Final = 0.01  # m from the floor to base_link
_HALF: Final = WHEEL_SEPARATION / 2
_WHEEL_HEIGHT: Final = WHEEL_RADIUS - BASE_HEIGHT
_QUARTER: Final = math.pi / 2

FIXED: Final = (
    Mount("base_joint", "base_footprint", "base_link", 0.0, 0.0, BASE_HEIGHT),
    Mount("scan_joint", "base_link", "base_scan", 0.0, 0.0, 0.122),
    Mount("imu_joint", "base_link", "imu_link", 0.0, 0.0, 0.068),
    Mount(
        "camera_joint", "base_link", "camera_link", camera.AHEAD, 0.0, camera.ABOVE - BASE_HEIGHT
    ),
    # REP 103: z ahead, x to the right, y down
    Mount(
        *("camera_rgb_optical_joint", "camera_link", "camera_rgb_optical_frame", 0.0, 0.0, 0.0),
        roll=-_QUARTER,
        yaw=-_QUARTER,
    ),
)
# z along the axle, to the left
LEFT_WHEEL: Final = Mount(
    *("wheel_left_joint", "base_link", "wheel_left_link", 0.0, _HALF, _WHEEL_HEIGHT),
    roll=-_QUARTER,
)
RIGHT_WHEEL: Final = Mount(
    *("wheel_right_joint", "base_link", "wheel_right_link", 0.0, -_HALF, _WHEEL_HEIGHT),
    roll=-_QUARTER,
)
WHEELS: Final = (LEFT_WHEEL, RIGHT_WHEEL)
