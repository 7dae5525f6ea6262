# SPDX-License-Identifier: Apache-2.0
"""The robot's URDF is a tree of its frames, and has what those who draw it need."""

import math
import re
from xml.etree.ElementTree import fromstring

import numpy as np
import pytest

from gateway_sim.mounts import FIXED, WHEELS
from gateway_sim.robot import RADIUS, WHEEL_RADIUS
from gateway_sim.robot_description import urdf
from tests.gateway_sim.test_mounts import of_quaternion, rotation

NUMBERS = re.compile(r"-?\d+(\.\d+)?(e-?\d+)?( -?\d+(\.\d+)?(e-?\d+)?)*")


@pytest.fixture
def robot():
    return fromstring(urdf())  # noqa: S314  # our own


def numbers(text):
    assert NUMBERS.fullmatch(text), text
    return np.array([float(number) for number in text.split()])


def placed(robot):
    """Return the place and rotation of each link in the first one."""
    found = {robot.find("link").get("name"): (np.zeros(3), np.eye(3))}
    for joint in robot.iter("joint"):
        place, turned = found[joint.find("parent").get("link")]
        origin = joint.find("origin")
        own = rotation(*numbers(origin.get("rpy")))
        child = joint.find("child").get("link")
        assert child not in found, "a link with two parents"
        found[child] = (place + turned @ numbers(origin.get("xyz")), turned @ own)
    return found


def test_all_links_hang_together_in_one_tree(robot):
    assert robot.tag == "robot"
    links = [link.get("name") for link in robot.iter("link")]
    assert sorted(placed(robot)) == sorted(links) == sorted(set(links))
    assert len(links) == len(FIXED) + len(WHEELS) + 1


def test_joints_are_at_the_transforms_of_their_frames(robot):
    joints = {joint.get("name"): joint for joint in robot.iter("joint")}
    assert set(joints) == {mount.joint for mount in (*FIXED, *WHEELS)}
    for mount in (*FIXED, *WHEELS):
        joint = joints[mount.joint]
        assert joint.find("parent").get("link") == mount.parent
        assert joint.find("child").get("link") == mount.child
        origin = joint.find("origin")
        assert numbers(origin.get("xyz")) == pytest.approx((mount.x, mount.y, mount.z))
        in_urdf = rotation(*numbers(origin.get("rpy")))
        assert in_urdf == pytest.approx(of_quaternion(*mount.rotation), abs=1e-8)


def test_wheels_turn_as_joint_states_say(robot):
    turning = [joint for joint in robot.iter("joint") if joint.get("type") == "continuous"]
    assert [joint.get("name") for joint in turning] == ["wheel_left_joint", "wheel_right_joint"]
    for joint, mount in zip(turning, WHEELS, strict=True):
        axis = numbers(joint.find("axis").get("xyz"))
        # forwards is about y of the base, and so is what the frame does
        assert rotation(mount.roll, mount.pitch, mount.yaw) @ axis == pytest.approx((0, 1, 0))
        turn = of_quaternion(*mount.turned(0.5)) @ of_quaternion(*mount.rotation).T
        assert turn == pytest.approx(rotation(0, 0.5, 0))


def test_bodies_are_primitives_of_known_colours_on_and_above_the_floor(robot):
    colours = {material.get("name") for material in robot.findall("material")}
    for material in robot.findall("material"):
        rgba = numbers(material.find("color").get("rgba"))
        assert len(rgba) == 4
        assert ((rgba >= 0) & (rgba <= 1)).all()
    places = placed(robot)
    lowest = {}
    for link in robot.iter("link"):
        name = link.get("name")
        for visual in link.iter("visual"):
            assert visual.find("material").get("name") in colours
            place, turned = places[name]
            middle = place + turned @ numbers(visual.find("origin").get("xyz"))
            half = _half_sizes(visual.find("geometry"), turned)
            lowest[name] = min(lowest.get(name, 1.0), (middle - half)[2])
            assert math.hypot(*middle[:2]) < RADIUS + 0.01
    assert min(lowest.values()) > -1e-9
    for name in ("base_link", "wheel_left_link", "wheel_right_link"):
        assert lowest[name] == pytest.approx(0, abs=1e-9), "it stands on the floor"


def _half_sizes(geometry, turned):
    (shape,) = geometry
    if shape.tag == "box":
        return np.abs(turned) @ numbers(shape.get("size")) / 2
    radius = float(shape.get("radius"))
    if shape.tag == "sphere":
        return np.full(3, radius)
    assert shape.tag == "cylinder"
    axis = np.abs(turned[:, 2])
    return axis * float(shape.get("length")) / 2 + np.sqrt(1 - np.minimum(axis**2, 1)) * radius


def test_wheels_reach_from_the_floor_to_their_diameter(robot):
    (cylinder,) = robot.findall("link[@name='wheel_left_link']/visual/geometry/cylinder")
    assert float(cylinder.get("radius")) == WHEEL_RADIUS
