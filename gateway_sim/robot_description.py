# SPDX-License-Identifier: Apache-2.0
"""The simulated robot's URDF (http://wiki.ros.org/urdf/XML): its frames, and bodies to draw.

All bodies are boxes, cylinders and spheres, so a program that draws it, such as RViz or three.js,
needs no other files. As with robot_state_publisher, names of frames are without a prefix.
"""

from collections.abc import Sequence
from typing import Final, NamedTuple
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from gateway_sim.mounts import BASE_HEIGHT, FIXED, WHEELS, Mount
from gateway_sim.robot import WHEEL_RADIUS

NAME: Final = "simulated_robot"
_COLOURS: Final = {
    "dark": (0.16, 0.17, 0.19),
    "light": (0.82, 0.84, 0.86),
    "tyre": (0.08, 0.08, 0.08),
    "lens": (0.10, 0.25, 0.45),
}


class Body(NamedTuple):
    """A box, a cylinder along z or a sphere, by the middle, in metres, in the frame of a link."""

    shape: str
    sizes: tuple[tuple[str, str], ...]
    middle: tuple[float, float, float]
    colour: str


def _box(x: float, y: float, z: float, middle: tuple[float, float, float], colour: str) -> Body:
    return Body("box", (("size", _numbers(x, y, z)),), middle, colour)


def _cylinder(
    radius: float, length: float, middle: tuple[float, float, float], colour: str
) -> Body:
    return Body("cylinder", (("radius", f"{radius:g}"), ("length", f"{length:g}")), middle, colour)


def _numbers(*values: float) -> str:
    return " ".join(f"{value:.9g}" for value in values)


_WHEEL: Final = (_cylinder(WHEEL_RADIUS, 0.018, (0.0, 0.0, 0.0), "tyre"),)
_CASTER: Final = Body(
    "sphere", (("radius", f"{BASE_HEIGHT:g}"),), (-0.09, 0.0, 0.0), "light"
)  # its lowest point is on the floor
BODIES: Final[dict[str, tuple[Body, ...]]] = {
    "base_footprint": (),
    "base_link": (
        _cylinder(0.13, 0.03, (0.0, 0.0, 0.02), "dark"),
        _cylinder(0.125, 0.01, (0.0, 0.0, 0.085), "light"),
        _box(0.05, 0.09, 0.045, (0.0, 0.0, 0.0575), "dark"),
        _box(0.014, 0.014, 0.14, (0.07, 0.0, 0.16), "dark"),
        _CASTER,
    ),
    "base_scan": (_cylinder(0.036, 0.06, (0.0, 0.0, 0.0), "dark"),),
    "imu_link": (),
    "camera_link": (
        _box(0.02, 0.09, 0.025, (-0.01, 0.0, 0.0), "light"),
        _box(0.004, 0.02, 0.015, (0.0, 0.0, 0.0), "lens"),
    ),
    "camera_rgb_optical_frame": (),
    "wheel_left_link": _WHEEL,
    "wheel_right_link": _WHEEL,
}


def urdf() -> str:
    """Return the robot as a URDF document."""
    robot = Element("robot", name=NAME)
    for name, colour in _COLOURS.items():
        SubElement(SubElement(robot, "material", name=name), "color", rgba=_numbers(*colour, 1.0))
    for name, bodies in BODIES.items():
        _add_link(robot, name, bodies)
    for mount in FIXED:
        _add_joint(robot, mount, "fixed")
    for mount in WHEELS:
        SubElement(_add_joint(robot, mount, "continuous"), "axis", xyz="0 0 1")
    indent(robot)
    return tostring(robot, encoding="unicode", xml_declaration=True)


def _add_link(robot: Element, name: str, bodies: Sequence[Body]) -> None:
    link = SubElement(robot, "link", name=name)
    for body in bodies:
        visual = SubElement(link, "visual")
        SubElement(visual, "origin", xyz=_numbers(*body.middle), rpy="0 0 0")
        SubElement(SubElement(visual, "geometry"), body.shape, dict(body.sizes))
        SubElement(visual, "material", name=body.colour)


def _add_joint(robot: Element, mount: Mount, kind: str) -> Element:
    joint = SubElement(robot, "joint", name=mount.joint, type=kind)
    SubElement(joint, "parent", link=mount.parent)
    SubElement(joint, "child", link=mount.child)
    place = _numbers(mount.x, mount.y, mount.z)
    SubElement(joint, "origin", xyz=place, rpy=_numbers(mount.roll, mount.pitch, mount.yaw))
    return joint
