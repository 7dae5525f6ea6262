# SPDX-License-Identifier: Apache-2.0
"""The frames of the simulated robot, with tf2_msgs installed or not, as other nodes hear them."""

import math
import os
import re

import pytest
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import Log
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState

from gateway_sim.mounts import FIXED, WHEELS
from tests.gateway_sim.ros import WITHOUT_PACKAGES, Watcher, child
from tests.transforms import from_cdr, tf_message

SIMULATION = """
from gateway.sources.rclpy import message_classes
from gateway_sim.node import SimOptions, run
{before}
raise SystemExit(run(SimOptions(camera=False, namespace="{namespace}")))
"""
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
LOG = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def simulation(namespace, check=None):
    """Return code that runs a robot. The test whether types can be made may be another script."""
    before = f"message_classes._CHECK = ('-c', {check!r})" if check else ""
    return SIMULATION.format(before=before, namespace=namespace)


@pytest.fixture
def watcher():
    watcher = Watcher("watcher")
    yield watcher
    watcher.close()


class Frames:
    """The transforms of a robot, whose type this process may also lack."""

    def __init__(self, watcher, prefix):
        self._prefix = prefix
        self._fixed = watcher.subscribe(tf_message(), "/tf_static", LATCHED, raw=True)
        self._moving = watcher.subscribe(tf_message(), "/tf", raw=True)

    def fixed(self):
        return self._newest(self._fixed)

    def moving(self):
        return self._newest(self._moving)

    def _newest(self, messages):
        """Return child, parent and transform of what was heard last."""
        found = {}
        for message in messages:
            for each in from_cdr(message):
                if each["child_frame_id"].startswith(self._prefix):
                    parent = each["header"]["frame_id"].removeprefix(self._prefix)
                    child_frame = each["child_frame_id"].removeprefix(self._prefix)
                    found[child_frame] = (parent, each["transform"])
        return found


@pytest.mark.parametrize(
    "without", [frozenset(), WITHOUT_PACKAGES], ids=["as it is here", "by the wheels alone"]
)
def test_every_frame_leads_to_the_map(without, watcher):
    with child(simulation("whole"), without=without):
        frames = Frames(watcher, "whole/")
        watcher.until(lambda: frames.fixed() and frames.moving(), what="/tf and /tf_static")
        fixed, moving = frames.fixed(), frames.moving()
    assert set(fixed) == {mount.child for mount in FIXED}
    assert set(moving) == {"odom", "base_footprint", *(mount.child for mount in WHEELS)}
    parents = {child_frame: parent for child_frame, (parent, _) in (fixed | moving).items()}
    for frame in parents:
        while frame != "map":
            frame = parents[frame]
    height = fixed["base_link"][1]["translation"]["z"] + fixed["base_scan"][1]["translation"]["z"]
    assert height == pytest.approx(0.132)
    optical = fixed["camera_rgb_optical_frame"][1]["rotation"]
    assert list(optical.values()) == pytest.approx([-0.5, 0.5, -0.5, 0.5])


def test_wheels_turn_as_their_joints_do(watcher):
    with child(simulation("turning")):
        frames = Frames(watcher, "turning/")
        joints = watcher.subscribe(JointState, "/turning/joint_states")
        commands = watcher.node.create_publisher(Twist, "/turning/cmd_vel", 10)
        command = Twist()
        command.linear.x = 0.2

        def drive():
            commands.publish(command)

        watcher.until(lambda: joints and joints[-1].position[0] > 1, drive, "motion")
        watcher.until(lambda: joints[-1].velocity[0] == 0, what="the stop")
        seen = len(frames._moving)
        watcher.until(lambda: len(frames._moving) > seen + 1, what="/tf")
        _, left = frames.moving()["wheel_left_link"]
        angle = joints[-1].position[0]
    q = left["rotation"]
    # it turns about the axle, which points to the left: about y of the base
    assert q["w"] == pytest.approx(math.sqrt(0.5) * math.cos(angle / 2))
    assert q["z"] == pytest.approx(math.sqrt(0.5) * math.sin(angle / 2))
    assert q["x"] == pytest.approx(-math.sqrt(0.5) * math.cos(angle / 2))
    assert q["y"] == pytest.approx(math.sqrt(0.5) * math.sin(angle / 2))


def test_a_robot_that_can_make_no_type_says_so_and_runs_without(watcher):
    check = "print('no, and why'); raise SystemExit(1)"
    with child(simulation("bare", check), without=WITHOUT_PACKAGES):
        joints = watcher.subscribe(JointState, "/bare/joint_states")
        log = watcher.subscribe(Log, "/rosout", LOG)
        watcher.until(
            lambda: joints and [entry for entry in log if "no action" in entry.msg],
            what="/bare/joint_states and the log",
        )
        topics = dict(watcher.node.get_topic_names_and_types())
    (said,) = (entry.msg for entry in log if "no transforms" in entry.msg)
    missing = "no ROS package tf2_msgs is installed here (tf2_msgs/msg/TFMessage)"
    assert said == f"no transforms on /tf: {missing}, and no, and why"
    assert "/tf_static" not in topics
    (said,) = (entry.msg for entry in log if "no action" in entry.msg)
    assert said.startswith("no action navigate_to_pose: no ROS package nav2_msgs is installed here")
    assert said.endswith(", and no, and why")


def test_a_robot_that_ends_early_leaves_no_process(watcher, tmp_path):
    file = tmp_path / "pid"
    check = (
        f"import os, time\nwith open({str(file)!r}, 'w') as file: file.write(f'{{os.getpid()}};')"
    )
    with child(simulation("early", f"{check}\ntime.sleep(600)"), without=WITHOUT_PACKAGES):
        watcher.until(
            lambda: file.exists() and re.fullmatch(r"\d+;", file.read_text()), what="the process"
        )
    with pytest.raises(ProcessLookupError):
        os.kill(int(file.read_text().removesuffix(";")), 0)
