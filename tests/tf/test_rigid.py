# SPDX-License-Identifier: Apache-2.0
"""Rigid transforms, held to 4x4 matrices."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gateway.tf.rigid import IDENTITY, Rigid

numbers = st.floats(-1000, 1000)
parts = st.floats(-1, 1)


@st.composite
def rigids(draw):
    quaternion = draw(st.tuples(parts, parts, parts, parts).filter(lambda q: math.hypot(*q) > 0.01))
    return Rigid(draw(numbers), draw(numbers), draw(numbers), *quaternion).normalized()


def matrix(transform):
    """Return the 4x4 matrix, by the textbook's formula for the rotation."""
    x, y, z, w = transform[3:]
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), transform.x],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), transform.y],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), transform.z],
            [0, 0, 0, 1],
        ]
    )


def same(one, other):
    return np.allclose(matrix(one), matrix(other), atol=1e-9)


def turned(degrees):
    half = math.radians(degrees) / 2
    return Rigid(0.0, 0.0, 0.0, 0.0, 0.0, math.sin(half), math.cos(half))


@given(rigids(), rigids())
def test_one_transform_after_another_is_the_product_of_their_matrices(one, other):
    assert np.allclose(matrix(one.after(other)), matrix(one) @ matrix(other), atol=1e-9)


@given(rigids())
def test_an_inverse_is_the_inverse_matrix(transform):
    assert np.allclose(matrix(transform.inverse()), np.linalg.inv(matrix(transform)), atol=1e-9)
    assert same(transform.after(transform.inverse()), IDENTITY)


@given(rigids(), rigids(), st.floats(0, 1))
def test_interpolation_gives_a_rotation_and_ends_at_both_ends(one, other, ratio):
    assert same(one.towards(other, 0.0), one)
    assert same(one.towards(other, 1.0), other)
    between = one.towards(other, ratio)
    assert math.isclose(math.hypot(*between[3:]), 1.0)
    assert math.isclose(between.x, one.x + ratio * (other.x - one.x), abs_tol=1e-9)


@given(rigids(), rigids(), st.floats(0, 1))
def test_a_rotation_goes_at_one_speed_the_short_way(one, other, ratio):
    def angle(a, b):
        return 2 * math.acos(min(1.0, abs(sum(p * q for p, q in zip(a[3:], b[3:], strict=True)))))

    whole = angle(one, other)
    assert math.isclose(angle(one, one.towards(other, ratio)), ratio * whole, abs_tol=1e-6)


def test_half_way_between_0_and_90_degrees_is_45_whatever_the_sign_of_the_quaternion():
    quarter = turned(90)
    flipped = Rigid(*quarter[:3], *(-part for part in quarter[3:]))
    for end in (quarter, flipped):
        assert same(turned(0).towards(end, 0.5), turned(45))


def test_a_quaternion_of_any_length_becomes_one_of_length_1():
    assert same(
        Rigid(1.0, 2.0, 3.0, 0.0, 0.0, 5e-3, 5e-3).normalized()._replace(x=0.0, y=0.0, z=0.0),
        turned(90),
    )


@pytest.mark.parametrize(
    ("transform", "reason"),
    [
        (Rigid(math.nan, 0, 0, 0, 0, 0, 1), "a number is not finite"),
        (Rigid(0, 0, 0, 0, 0, math.inf, 1), "a number is not finite"),
        (Rigid(0, 0, 0, 0, 0, 0, 0), "its quaternion has no direction"),
    ],
)
def test_an_invalid_transform_is_refused(transform, reason):
    with pytest.raises(ValueError, match=reason):
        transform.normalized()


@given(rigids(), rigids())
def test_the_angle_between_two_is_that_of_the_rotation_from_one_to_the_other(one, other):
    rotation = matrix(one.inverse().after(other))[:3, :3]
    cosine = (np.trace(rotation) - 1) / 2
    assert one.angle(other) == pytest.approx(math.acos(max(-1.0, min(1.0, cosine))), abs=1e-6)
    negated = other._replace(qx=-other.qx, qy=-other.qy, qz=-other.qz, qw=-other.qw)
    assert one.angle(negated) == pytest.approx(one.angle(other), abs=1e-9)
    assert one.distance(other) == pytest.approx(math.dist(one[:3], other[:3]))


@pytest.mark.parametrize("degrees", [1e-9, 1, 90, 179, 180])
def test_an_angle_however_small_is_found(degrees):
    assert turned(0).angle(turned(degrees)) == pytest.approx(math.radians(degrees), rel=1e-6)
    assert turned(0).angle(turned(0)) == 0
