# SPDX-License-Identifier: Apache-2.0
"""The robot obeys its limits, its clock and its world."""

import math

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from gateway_sim.robot import (
    MAX_ANGULAR,
    MAX_LINEAR,
    RADIUS,
    WHEEL_RADIUS,
    DismissedError,
    Event,
    Robot,
)
from gateway_sim.world import START, Obstacle, Pose, World, furnished_room

TICK_NS = 33_000_000


class Drive:
    """A robot with its clock."""

    def __init__(self, seed=1):
        self.world = furnished_room()
        self.now_ns = 5_000
        self.robot = Robot(self.world, self.now_ns, seed)
        self.events = []

    def wait(self, seconds):
        end_ns = self.now_ns + round(seconds * 1e9)
        while self.now_ns < end_ns:
            self.now_ns = min(end_ns, self.now_ns + TICK_NS)
            self.robot.step(self.now_ns)
            self.events += self.robot.take_events()

    def command(self, seconds, linear, angular=0.0):
        end_ns = self.now_ns + round(seconds * 1e9)
        while self.now_ns < end_ns:
            self.robot.command(linear, angular)
            self.wait(min(TICK_NS, end_ns - self.now_ns) / 1e9)

    def finish(self, timeout=120):
        end_ns = self.now_ns + timeout * 10**9
        while self.robot.goal and self.now_ns < end_ns:
            self.wait(0.1)
        self.wait(1)


@pytest.fixture
def drive():
    return Drive()


def drift(robot):
    return math.hypot(robot.pose.x - robot.odometry.x, robot.pose.y - robot.odometry.y)


def test_a_straight_drive_covers_speed_times_time(drive):
    drive.command(5, 0.2)
    assert drive.robot.pose.x == pytest.approx(1.0, abs=0.03)
    assert drive.robot.pose.y == 0
    assert drive.robot.left_wheel == pytest.approx(drive.robot.pose.x / WHEEL_RADIUS)


def test_four_sides_and_four_corners_lead_back(drive):
    corners = []
    for _ in range(4):
        drive.command(4, 0.2)
        drive.command(1, 0.0)
        drive.command(2, 0.0, math.pi / 4)
        drive.command(1, 0.0)
        corners.append(drive.robot.pose[:2])
    # starting up takes away as much as braking adds
    assert corners[1] == pytest.approx((0.8, 0.8), abs=0.02)
    assert drive.robot.pose == pytest.approx((0, 0, 0), abs=0.02)


def test_silence_stops_the_robot_and_is_told_once(drive):
    drive.command(2, 0.26)
    drive.wait(0.45)
    assert drive.robot.linear == pytest.approx(0.26)
    drive.wait(0.5)
    assert drive.robot.linear == 0
    rest = drive.robot.pose
    drive.wait(5)
    assert drive.robot.pose == rest
    assert drive.events == [Event.SILENCE]


def test_an_ordered_stop_is_not_a_silence(drive):
    drive.command(1, 0.2)
    drive.robot.command(0.0, 0.0)
    drive.wait(2)
    assert drive.robot.linear == 0
    assert drive.events == []


@pytest.mark.parametrize(
    ("linear", "angular", "words"),
    [
        (0.27, 0.0, r"linear\.x 0\.27 is beyond ±0\.26 m/s"),
        (-0.27, 0.0, r"linear\.x -0\.27"),
        (0.0, 1.9, r"angular\.z 1\.9 is beyond ±1\.82 rad/s"),
        (math.nan, 0.0, r"linear\.x nan"),
        (0.0, math.inf, r"angular\.z inf"),
    ],
)
def test_a_command_beyond_the_limits_is_dismissed_not_clamped(drive, linear, angular, words):
    drive.robot.command(0.1, 0.0)
    with pytest.raises(DismissedError, match=words):
        drive.robot.command(linear, angular)
    drive.wait(0.3)
    assert drive.robot.linear == pytest.approx(0.1), "the command before stays in force"
    assert drive.robot.angular == 0


@pytest.mark.parametrize("sign", [1, -1])
def test_the_limits_themselves_are_obeyed_also_as_float32(drive, sign):
    drive.robot.command(sign * MAX_LINEAR, sign * MAX_ANGULAR)
    drive.robot.command(sign * MAX_LINEAR, sign * 1.8200000524520874)
    drive.wait(0.4)
    assert drive.robot.angular == pytest.approx(sign * MAX_ANGULAR)


def test_a_wall_stops_the_robot_and_is_told_once(drive):
    drive.command(30, 0.26)
    assert drive.world.x_max - drive.robot.pose.x == pytest.approx(RADIUS, abs=0.005)
    assert drive.robot.linear == 0
    assert drive.events == [Event.HIT]
    drive.command(1, -0.2)
    assert drive.robot.pose.x < drive.world.x_max - RADIUS - 0.1, "it can back away"


def test_the_robot_enters_no_obstacle_from_any_side(drive):
    for degrees in range(0, 360, 45):
        drive.robot.reset()
        drive.robot.place(Pose(0, 0, math.radians(degrees)))
        drive.command(25, 0.26)
        x, y, _ = drive.robot.pose
        assert drive.world.clearance(x, y) > RADIUS - 0.005
    assert drive.events.count(Event.HIT) == 8


def test_the_robot_turns_on_the_spot_while_it_touches_a_wall(drive):
    drive.command(20, 0.26)
    drive.command(2, 0.0, 1.0)
    assert drive.robot.pose.heading > 1.5


def test_drift_grows_with_the_way_and_not_with_time(drive):
    drive.command(5, 0.2)
    short = drift(drive.robot)
    drive.wait(600)
    assert drift(drive.robot) == pytest.approx(short, abs=0.01)
    drive.command(5, -0.2)
    drive.command(60, 0.15, 0.8)
    drive.wait(1)
    long = drift(drive.robot)
    assert 0 < short < 0.02
    assert short < long < 0.3
    assert drive.robot.pose.heading != drive.robot.odometry.heading


def test_slip_follows_the_seed():
    ways = []
    for seed in (1, 1, 2):
        drive = Drive(seed)
        drive.command(5, 0.2, 0.2)
        ways.append(drive.robot.odometry)
    assert ways[0] == ways[1] != ways[2]


def test_steps_of_any_length_lead_to_the_same_place():
    poses = []
    for tick_ns in (10_000_000, 130_000_000):
        robot = Robot(furnished_room(), 0)
        for now_ns in range(0, 1_300_000_001, tick_ns):
            robot.step(now_ns)
            if now_ns == 0:
                robot.command(0.2, 0.5)
        poses.append(robot.pose)
    assert poses[0] == pytest.approx(poses[1])


@pytest.mark.parametrize("goal", [Pose(1.0, -0.5, 1.0), Pose(-1.5, 0.5, -3.0), Pose(0.5, 0.0, 0.0)])
def test_a_goal_is_reached_with_its_heading(drive, goal):
    drive.robot.drive_to(goal)
    drive.finish()
    pose = drive.robot.pose
    assert math.hypot(pose.x - goal.x, pose.y - goal.y) < 0.04
    assert abs(math.remainder(pose.heading - goal.heading, math.tau)) < 0.05
    assert drive.events == [Event.GOAL_REACHED]
    assert drive.robot.linear == drive.robot.angular == 0


def test_a_goal_behind_an_obstacle_is_reached_around_it(drive):
    goal = Pose(2.4, 2.0, 0)
    drive.robot.place(Pose(1.4, 2.0, 0))
    drive.robot.drive_to(goal)
    direct = math.dist(drive.robot.pose[:2], goal[:2])
    assert drive.robot.distance_left > 2 * direct
    drive.finish()
    assert drive.events == [Event.GOAL_REACHED]
    assert math.dist(drive.robot.pose[:2], goal[:2]) < 0.04
    assert drive.robot.distance_left == 0


PLACES = st.tuples(st.floats(-2.0, 4.0), st.floats(-2.5, 2.5), st.floats(-math.pi, math.pi))


@given(start=PLACES, goal=PLACES)
@settings(max_examples=10, deadline=None)  # each is a drive of some meters
def test_every_goal_with_some_room_is_reached_from_everywhere(start, goal):
    drive = Drive()
    assume(min(drive.world.clearance(*start[:2]), drive.world.clearance(*goal[:2])) > 0.25)
    drive.robot.place(Pose(*start))
    drive.robot.drive_to(Pose(*goal))
    drive.finish()
    assert drive.robot.goal_end == Event.GOAL_REACHED
    assert Event.HIT not in drive.events


def put_a_crate(drive, x, y):
    """Put something into the room that the robot's map lacks."""
    half = 0.2
    outline = (
        (x - half, y - half),
        (x + half, y - half),
        (x + half, y + half),
        (x - half, y + half),
    )
    world = drive.world
    obstacles = [*world.obstacles, Obstacle("crate", outline, 0.4, (0, 0, 0))]
    drive.world = World(
        (world.x_min, world.y_min), (world.x_max, world.y_max), world.height, obstacles, world.bay
    )
    drive.robot._world = drive.world


def test_a_goal_is_given_up_before_an_obstacle_that_no_map_shows(drive):
    drive.robot.drive_to(Pose(2.0, 0, 0))
    put_a_crate(drive, 1.0, 0.0)
    drive.finish()
    assert drive.events == [Event.GOAL_BLOCKED]
    assert drive.robot.goal_end == Event.GOAL_BLOCKED
    assert drive.world.clearance(*drive.robot.pose[:2]) > RADIUS
    assert drive.robot.linear == 0


def test_a_goal_that_only_a_corner_hides_is_given_up_at_the_corner(drive):
    # too near for the lookahead
    drive.robot.drive_to(Pose(0.09, 0.0, 0))
    put_a_crate(drive, 0.2 + RADIUS + 0.05, 0.2)
    drive.finish()
    assert drive.robot.goal is None
    assert drive.events == [Event.HIT, Event.GOAL_BLOCKED]


def test_a_place_to_which_no_way_leads_is_dismissed_and_the_goal_before_stays(drive):
    world = drive.world
    fence = (Obstacle("fence", ((2.9, -2.5), (3.0, -2.5), (3.0, 2.5), (2.9, 2.5)), 0.5, (0, 0, 0)),)
    robot = Robot(
        World((world.x_min, world.y_min), (world.x_max, world.y_max), 1.2, fence, world.bay), 0
    )
    goal = Pose(1.0, 0.0, 0.0)
    robot.drive_to(goal)
    with pytest.raises(DismissedError, match=r"no way leads to x 3\.50, y 0\.00 m"):
        robot.drive_to(Pose(3.5, 0.0, 0.0))
    assert robot.goal is goal


def test_the_end_of_a_goal_is_known_afterwards(drive):
    robot = drive.robot
    for end, why in (
        (lambda: robot.command(0.1, 0.0), Event.GOAL_COMMANDED),
        (robot.cancel_goal, Event.GOAL_CANCELED),
        (robot.reset, Event.GOAL_PLACED),
        (lambda: robot.switch_motors(False), Event.GOAL_POWERLESS),
    ):
        robot.reset()
        robot.drive_to(Pose(2.0, 0.0, 0.0))
        assert robot.goal_end is None
        drive.wait(0.5)
        drive.events.clear()
        end()
        assert (robot.goal, robot.goal_end, robot.distance_left) == (None, why, 0)
        assert robot.take_events() == [why]


def test_a_goal_that_is_canceled_lets_the_robot_brake(drive):
    drive.robot.drive_to(Pose(2.0, 0.0, 0.0))
    drive.wait(2)
    assert drive.robot.linear > 0.1
    drive.robot.cancel_goal()
    drive.wait(0.1)
    assert 0 < drive.robot.linear < 0.2
    drive.wait(0.5)
    assert drive.robot.linear == 0


def test_without_a_goal_there_is_nothing_to_cancel(drive):
    drive.robot.cancel_goal()
    assert (drive.robot.goal_end, drive.robot.take_events()) == (None, [])


def test_a_newer_goal_replaces_the_one_before(drive):
    drive.robot.drive_to(Pose(2.0, 0.0, 0.0))
    newer = Pose(0.1, 0.0, 0.0)
    drive.robot.drive_to(newer)
    assert drive.robot.goal is newer
    drive.finish()
    assert drive.events == [Event.GOAL_REPLACED, Event.GOAL_REACHED]


def test_driving_to_the_bay_parks_the_robot(drive):
    bay = drive.world.bay
    drive.robot.drive_to(Pose(bay.x, bay.y, 0.0))
    drive.finish()
    assert drive.robot.parked
    assert Event.PARKED in drive.events
    drive.command(2, -0.2)
    assert not drive.robot.parked


@pytest.mark.parametrize(
    "pose", [Pose(9, 9, 0), Pose(1.9, 1.75, 0), Pose(3.95, 0, 0), Pose(math.nan, 0, 0)]
)
def test_a_pose_without_room_is_dismissed(drive, pose):
    with pytest.raises(DismissedError):
        drive.robot.place(pose)
    with pytest.raises(DismissedError):
        drive.robot.drive_to(pose)
    assert drive.robot.pose == START
    assert drive.robot.goal is None


def test_placing_the_robot_stops_it_and_ends_the_drift(drive):
    drive.command(8, 0.2, 0.3)
    target = Pose(-1.0, 0.5, 2.0)
    drive.robot.place(target)
    drive.wait(1)
    assert drive.robot.pose == drive.robot.odometry == target


def test_reset_leads_back_to_the_start_with_motors_on(drive):
    drive.command(3, 0.2)
    drive.robot.switch_motors(False)
    drive.robot.reset()
    drive.wait(1)
    assert drive.robot.pose == drive.robot.odometry == START
    drive.command(1, 0.2)
    assert drive.robot.pose.x > 0.1


def test_without_motors_the_robot_stands_and_dismisses_commands(drive):
    drive.command(1, 0.2)
    drive.robot.switch_motors(False)
    rest = drive.robot.pose
    for refused in (lambda: drive.robot.command(0.1, 0), lambda: drive.robot.drive_to(START)):
        with pytest.raises(DismissedError, match="the motors are off"):
            refused()
    drive.wait(1)
    assert drive.robot.pose == rest


def test_a_pose_of_the_odometry_is_found_in_the_truth(drive):
    drive.command(20, 0.2, 0.4)
    robot = drive.robot
    assert robot.from_odometry(robot.odometry) == pytest.approx(robot.pose)
    metre_ahead = Pose(
        robot.odometry.x + math.cos(robot.odometry.heading),
        robot.odometry.y + math.sin(robot.odometry.heading),
        robot.odometry.heading,
    )
    assert robot.from_odometry(metre_ahead) == pytest.approx(
        (
            robot.pose.x + math.cos(robot.pose.heading),
            robot.pose.y + math.sin(robot.pose.heading),
            robot.pose.heading,
        )
    )
