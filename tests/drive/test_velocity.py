# SPDX-License-Identifier: Apache-2.0
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gateway.codec.types import Types
from gateway.drive.twist_cdr import COMMAND_TYPES, TWIST, TWIST_STAMPED, encode
from gateway.drive.velocity import ZERO, Velocity
from schemas.installed import InstalledDefinitions

NUMBERS = st.floats(allow_nan=False, allow_infinity=False)
VELOCITIES = st.builds(Velocity, *[NUMBERS] * 6)


@given(VELOCITIES)
def test_no_velocity_is_faster_than_allowed_after_clamping(velocity: Velocity):
    clamped = velocity.clamped(2.0, 0.5)
    assert math.hypot(*clamped[:3]) <= 2.0 * (1 + 1e-9)
    assert math.hypot(*clamped[3:]) <= 0.5 * (1 + 1e-9)
    assert clamped.is_finite
    assert [math.copysign(1, a) for a in clamped] == [math.copysign(1, a) for a in velocity]


def test_a_velocity_within_its_limits_is_not_touched_and_a_faster_one_keeps_its_direction():
    slow = Velocity(linear_x=0.3, angular_z=-1.0)
    assert slow.clamped(0.3, 1.0) == slow
    assert Velocity(linear_x=3.0, linear_y=4.0).clamped(1.0, 1.0) == pytest.approx(
        Velocity(linear_x=0.6, linear_y=0.8)
    )


def test_only_six_zeros_are_a_stop():
    assert ZERO.is_zero
    assert Velocity(linear_x=-0.0).is_zero
    assert not Velocity(angular_y=5e-324).is_zero
    assert not Velocity(linear_z=math.nan).is_finite
    assert not Velocity(angular_x=-math.inf).is_finite


@pytest.mark.parametrize("frame_id", ["", "b", "base_link", "Füße"])
def test_the_cdr_is_what_the_codec_of_the_type_reads(frame_id: str):
    types = Types(InstalledDefinitions())
    velocity = Velocity(1.0, -2.0, 3.5, 0.25, 1e-9, 7.0)
    decode = {name: types.get(name).decode for name in COMMAND_TYPES}
    twist = decode[TWIST](encode(TWIST, velocity, 5, "ignored"))
    assert (*twist["linear"].values(), *twist["angular"].values()) == velocity
    stamped = decode[TWIST_STAMPED](encode(TWIST_STAMPED, velocity, 12_000_000_345, frame_id))
    assert stamped["twist"] == twist
    assert stamped["header"] == {"stamp": {"sec": 12, "nanosec": 345}, "frame_id": frame_id}
