# SPDX-License-Identifier: Apache-2.0
"""The simulated robot: a TurtleBot3-like base with two driven wheels, in a world, over time.

Pure: time is an argument, in nanoseconds of any clock that does not jump.
"""

import itertools
import math
import random
from collections import deque
from enum import Enum
from typing import Final

from gateway_sim.planner import Planner
from gateway_sim.world import START, Point, Pose, World

MAX_LINEAR: Final = 0.26  # m/s, a TurtleBot3 Waffle Pi's
MAX_ANGULAR: Final = 1.82  # rad/s
SILENCE_NS: Final = 500_000_000  # a command holds this long: a lost link must not drive a robot
RADIUS: Final = 0.14  # m, of the circle around the base
WHEEL_RADIUS: Final = 0.033  # m
WHEEL_SEPARATION: Final = 0.287  # m

_ROUNDING: Final = 1e-6  # a limit that was a float32 in between is still the limit
_LINEAR_ACCELERATION: Final = 1.0  # m/s², from full speed to rest in 34 mm
_ANGULAR_ACCELERATION: Final = 8.0  # rad/s²
_TOUCH: Final = 0.005  # m to the obstacle that was hit: farther away, it can be hit again
_STEP_NS: Final = 10_000_000  # at full speed 2.6 mm: small against anything in a room

# The errors of the odometry. Ten metres straight ahead end about 10 cm next to the truth.
_DISTANCE_ERROR: Final = 0.004  # worn tyres: 4 mm per metre
_TURN_ERROR: Final = 0.006  # a mismeasured wheel separation: 2° per turn
_HEADING_ERROR_PER_METRE: Final = 0.002  # rad, unequal tyres
_HEADING_NOISE: Final = 0.002  # rad after a metre, growing with its root: slip

_GOAL_DISTANCE: Final = 0.02  # m
_GOAL_HEADING: Final = 0.02  # rad
_GOAL_LOOKAHEAD: Final = 0.10  # m of free floor ahead, three times the braking distance
GOAL_SPEED: Final = 0.22  # m/s, what leaves room to correct the course
_CORNER: Final = (
    0.05  # m before a corner of the way, the next leg begins: twice the braking distance
)


class Event(Enum):
    """Something that happened to the robot. The value is the text for its log."""

    HIT = "hit an obstacle"
    GOAL_REACHED = "goal reached"
    GOAL_BLOCKED = "goal given up, an obstacle is in the way"
    GOAL_CANCELED = "goal given up, as asked for"
    GOAL_COMMANDED = "goal given up, a command takes over"
    GOAL_PLACED = "goal given up, the robot was put elsewhere"
    GOAL_POWERLESS = "goal given up, the motors are off"
    GOAL_REPLACED = "goal given up for a newer one"
    SILENCE = "stopping, cmd_vel is silent for 0.5 s"
    PARKED = "parked in the bay"


class DismissedError(ValueError):
    """A command or a pose is not obeyed. The text says why."""


class Robot:
    """A robot that moves as its commands, its motors and its world allow.

    ``pose`` is the truth, ``odometry`` the wheels' estimate of it. Only `step` moves the robot.
    Every other method takes effect from the time of the last step on.
    """

    def __init__(self, world: World, now_ns: int, seed: int = 0) -> None:
        self._world = world
        self._now_ns = now_ns
        self._random = random.Random(seed)  # noqa: S311  # slip, not secrets
        self._command = (0.0, 0.0)
        self._commanded_ns: int | None = None
        self._goal: Pose | None = None
        self._goal_near = False
        self._goal_end: Event | None = None
        self._way: deque[Point] = deque()  # the corners between here and the goal
        self._planner = Planner(world, RADIUS)
        self._touching = False
        self._parked = False
        self._events: deque[Event] = deque(maxlen=16)  # a second of the worst, older ones are stale
        self.motors_on = True
        self.linear = 0.0  # m/s, as driven now
        self.angular = 0.0  # rad/s
        self.acceleration = 0.0  # m/s² ahead
        self.left_wheel = 0.0  # rad turned since the start
        self.right_wheel = 0.0
        self.pose = START
        self.odometry = START

    @property
    def goal(self) -> Pose | None:
        """The pose that the robot drives to by itself, in truth's frame, or ``None``."""
        return self._goal

    @property
    def goal_end(self) -> Event | None:
        """The event that ended the last goal. It is ``None`` before, and while there is a goal."""
        return self._goal_end

    @property
    def distance_left(self) -> float:
        """Metres of the way to the goal, 0 without one."""
        return sum(math.dist(start, end) for start, end in itertools.pairwise(self.way))

    @property
    def way(self) -> list[Point]:
        """The corners from the robot to its goal, both included. Empty without a goal."""
        if self._goal is None:
            return []
        return [self.pose[:2], *self._way, self._goal[:2]]

    @property
    def parked(self) -> bool:
        """True while the robot stands in the bay."""
        return self._parked

    def from_odometry(self, pose: Pose) -> Pose:
        """Return the true pose for one in the odometry's frame, as a localisation would."""
        turn = self.pose.heading - self.odometry.heading
        cosine, sine = math.cos(turn), math.sin(turn)
        dx, dy = pose.x - self.odometry.x, pose.y - self.odometry.y
        return Pose(
            self.pose.x + cosine * dx - sine * dy,
            self.pose.y + sine * dx + cosine * dy,
            math.remainder(pose.heading + turn, math.tau),
        )

    def take_events(self) -> list[Event]:
        """Return the events since the last call, oldest first."""
        events = list(self._events)
        self._events.clear()
        return events

    def command(self, linear: float, angular: float) -> None:
        """Drive at this speed until another command, for half a second at most, and drop a goal.

        Raises:
            DismissedError: a speed is beyond the robot's limits. The last command stays in force.
        """
        # written so that NaN fails
        if not abs(linear) <= MAX_LINEAR + _ROUNDING:
            raise DismissedError(f"linear.x {linear:g} is beyond ±{MAX_LINEAR} m/s")
        if not abs(angular) <= MAX_ANGULAR + _ROUNDING:
            raise DismissedError(f"angular.z {angular:g} is beyond ±{MAX_ANGULAR} rad/s")
        if not self.motors_on:
            raise DismissedError("the motors are off")
        self._end_goal(Event.GOAL_COMMANDED)
        self._command = (linear, angular)
        self._commanded_ns = self._now_ns

    def drive_to(self, goal: Pose) -> None:
        """Drive to *goal* around what is in the way, turn to its heading.

        Raises:
            DismissedError: the robot does not fit there, no way leads there, or its motors are off.
                The goal before stays.
        """
        self._require_room(goal)
        if not self.motors_on:
            raise DismissedError("the motors are off")
        way = self._planner.plan(self.pose[:2], goal[:2])
        if way is None:
            raise DismissedError(f"no way leads to x {goal.x:.2f}, y {goal.y:.2f} m")
        self._end_goal(Event.GOAL_REPLACED)
        self._commanded_ns = None
        self._goal = goal
        self._goal_end = None
        self._goal_near = False
        self._way = deque(way[:-1])

    def cancel_goal(self) -> None:
        """Brake, and drive to the goal no longer. Without a goal it does nothing."""
        self._end_goal(Event.GOAL_CANCELED)

    def place(self, pose: Pose) -> None:
        """Lift the robot to *pose*, at rest. The odometry starts again from there, without drift.

        Raises:
            DismissedError: the robot does not fit there.
        """
        self._require_room(pose)
        self.pose = self.odometry = pose
        self._halt(Event.GOAL_PLACED)
        self._touching = False

    def reset(self) -> None:
        """Put the robot back to its start, at rest, with its motors on."""
        self.place(START)
        self.motors_on = True

    def switch_motors(self, on: bool) -> None:
        """Switch the motors. Without them the robot stands and dismisses commands."""
        self.motors_on = on
        if not on:
            self._halt(Event.GOAL_POWERLESS)

    def step(self, now_ns: int) -> None:
        """Move from the last step's time to this one's."""
        while self._now_ns < now_ns:
            step_ns = min(_STEP_NS, now_ns - self._now_ns)
            self._now_ns += step_ns
            self._move(step_ns / 1e9)
        parked = self.linear == 0.0 and self._world.bay.holds(self.pose)
        if parked and not self._parked:
            self._events.append(Event.PARKED)
        self._parked = parked

    def _halt(self, why: Event) -> None:
        self._end_goal(why)
        self._commanded_ns = None
        self.linear = self.angular = self.acceleration = 0.0

    def _require_room(self, pose: Pose) -> None:
        if not all(math.isfinite(value) for value in pose):
            raise DismissedError("the pose is not finite")
        if self._world.clearance(pose.x, pose.y) < RADIUS:
            raise DismissedError(f"no room for the robot at x {pose.x:.2f}, y {pose.y:.2f} m")

    def _move(self, seconds: float) -> None:
        target_linear, target_angular = self._wanted()
        if (target_linear, target_angular, self.linear, self.angular) == (0.0, 0.0, 0.0, 0.0):
            self.acceleration = 0.0
            return
        before = self.linear
        self.linear = _towards(before, target_linear, _LINEAR_ACCELERATION * seconds)
        self.angular = _towards(self.angular, target_angular, _ANGULAR_ACCELERATION * seconds)
        self._advance(self.linear * seconds, self.angular * seconds)
        self.acceleration = (self.linear - before) / seconds

    def _wanted(self) -> tuple[float, float]:
        """Return the linear and angular speed to approach now."""
        if self._goal is not None:
            return self._towards_goal(self._goal)
        if self._commanded_ns is None:
            return 0.0, 0.0
        if self._now_ns - self._commanded_ns <= SILENCE_NS:
            return self._command
        self._commanded_ns = None
        if self._command != (0.0, 0.0):
            self._events.append(Event.SILENCE)
        return 0.0, 0.0

    def _towards_goal(self, goal: Pose) -> tuple[float, float]:
        """Drive from corner to corner, then turn to the goal's heading."""
        if self._way and math.dist(self.pose[:2], self._way[0]) < _CORNER:
            self._way.popleft()
        if self._way:
            return self._towards_point(*self._way[0])
        distance = math.dist(self.pose[:2], goal[:2])
        # Near the goal, the direction to it means little: only the heading is left.
        self._goal_near = distance < (3 if self._goal_near else 1) * _GOAL_DISTANCE
        if self._goal_near:
            turn = math.remainder(goal.heading - self.pose.heading, math.tau)
            if abs(turn) < _GOAL_HEADING and self.linear == 0.0:
                self._end_goal(Event.GOAL_REACHED)
                return 0.0, 0.0
            return 0.0, _within(2.5 * turn, 1.2)
        return self._towards_point(goal.x, goal.y)

    def _towards_point(self, x: float, y: float) -> tuple[float, float]:
        """Turn, then drive: proportional to the error, slow enough to brake in time."""
        distance = math.dist(self.pose[:2], (x, y))
        bearing = math.atan2(y - self.pose.y, x - self.pose.x)
        turn = math.remainder(bearing - self.pose.heading, math.tau)
        if abs(turn) > 0.3 or (self.linear == 0.0 and abs(turn) > _GOAL_HEADING):
            return 0.0, _within(2.5 * turn, 1.2)
        ahead_x = self.pose.x + _GOAL_LOOKAHEAD * math.cos(self.pose.heading)
        ahead_y = self.pose.y + _GOAL_LOOKAHEAD * math.sin(self.pose.heading)
        ahead = self._world.clearance(ahead_x, ahead_y)
        if (
            ahead < RADIUS
            and distance > _GOAL_LOOKAHEAD
            and ahead < self._world.clearance(self.pose.x, self.pose.y)
        ):
            self._end_goal(Event.GOAL_BLOCKED)
            return 0.0, 0.0
        speed = max(1.5 * self.distance_left, 0.03)
        return _within(speed, GOAL_SPEED), _within(2.5 * turn, 0.8)

    def _end_goal(self, event: Event) -> None:
        if self._goal is None:
            return
        self._goal = None
        self._goal_end = event
        self._way.clear()
        self._events.append(event)

    def _advance(self, distance: float, turn: float) -> None:
        """Drive an arc as far as the world allows, and add it to the odometry."""
        pose = _moved(self.pose, distance, turn)
        clearance = self._world.clearance(pose.x, pose.y)
        # A robot that touches something may still leave it, and turn on the spot.
        if clearance < RADIUS and clearance < self._world.clearance(self.pose.x, self.pose.y):
            if not self._touching:
                self._events.append(Event.HIT)
            self._end_goal(Event.GOAL_BLOCKED)  # the last step to a goal may graze a corner
            self._touching = True
            self.linear = distance = 0.0
            pose = _moved(self.pose, 0.0, turn)
        elif clearance > RADIUS + _TOUCH:
            self._touching = False
        self.pose = pose
        self.left_wheel += (distance - turn * WHEEL_SEPARATION / 2) / WHEEL_RADIUS
        self.right_wheel += (distance + turn * WHEEL_SEPARATION / 2) / WHEEL_RADIUS
        slip = self._random.gauss(0.0, _HEADING_NOISE) * math.sqrt(abs(distance))
        self.odometry = _moved(
            self.odometry,
            distance * (1 + _DISTANCE_ERROR),
            turn * (1 + _TURN_ERROR) + _HEADING_ERROR_PER_METRE * abs(distance) + slip,
        )


def _towards(value: float, target: float, most: float) -> float:
    return target if abs(target - value) <= most else value + math.copysign(most, target - value)


def _within(value: float, limit: float) -> float:
    return max(-limit, min(limit, value))


def _moved(pose: Pose, distance: float, turn: float) -> Pose:
    """Drive *distance* along an arc that turns by *turn* (midpoint rule)."""
    middle = pose.heading + turn / 2
    return Pose(
        pose.x + distance * math.cos(middle),
        pose.y + distance * math.sin(middle),
        math.remainder(pose.heading + turn, math.tau),
    )
