# SPDX-License-Identifier: Apache-2.0
"""A mount's quaternion is the rotation that URDF means by its three angles."""

import math

import numpy as np
import pytest

from gateway_sim.mounts import Mount

ANGLES = (0.3, -0.7, 2.1)


def rotation(roll, pitch, yaw):
    """Return the matrix of URDF's three angles: about fixed axes, x first."""
    cx, sx, cy, sy, cz, sz = (f(a) for a in (roll, pitch, yaw) for f in (math.cos, math.sin))
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def of_quaternion(x, y, z, w):
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


@pytest.fixture
def mount():
    return Mount("joint", "parent", "child", 0.0, 0.0, 0.0, *ANGLES)


def test_the_quaternion_is_the_rotation_about_x_then_y_then_z(mount):
    assert of_quaternion(*mount.rotation) == pytest.approx(rotation(*ANGLES))


def test_a_turn_is_about_the_frames_own_z(mount):
    turned = rotation(*ANGLES) @ rotation(0, 0, 0.5)
    assert of_quaternion(*mount.turned(0.5)) == pytest.approx(turned)
