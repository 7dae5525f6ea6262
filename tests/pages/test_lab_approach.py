# SPDX-License-Identifier: Apache-2.0
"""The lab's way to a target, without a robot: pose and time are made up."""

import math

import pytest

pytestmark = pytest.mark.asyncio(loop_scope="package")

# a robot that obeys, stepped at 20 Hz until the approach ends
RUN = """async ({ pose, target, steps = 4000, obeys = 1, staleAt = Infinity }) => {
    const { Approach, MOST } = await import("/lab/approach.js");
    const approach = new Approach();
    approach.begin(...target, 0);
    let count = 0, worst = 0, posed = 0, both = 0;
    for (; approach.isActive && count < steps; count += 1) {
        const now = count / 20;
        if (now < staleAt) posed = now;
        const { linear, angular } = approach.step(pose, posed, now);
        worst = Math.max(worst, Math.abs(linear) / MOST.linear, Math.abs(angular) / MOST.angular);
        pose.yaw += obeys * angular / 20;
        pose.x += obeys * linear / 20 * Math.cos(pose.yaw);
        pose.y += obeys * linear / 20 * Math.sin(pose.yaw);
    }
    const { linear, angular } = approach.step(pose, posed, count / 20);
    const rest = Math.hypot(pose.x - target[0], pose.y - target[1]);
    const { state, reason } = approach;
    return { state, reason, seconds: count / 20, rest, worst, after: [linear, angular] };
}"""


@pytest.fixture
def run(evaluate):
    """Return a function that lets the approach run in a page."""

    async def run_it(pose, target, **options):
        start = dict(zip(("x", "y", "yaw"), pose, strict=True))
        return await evaluate(RUN, {"pose": start, "target": target, **options})

    return run_it


@pytest.mark.parametrize(
    "target",
    [(1, 0), (-1, 0.001), (0, 1.5), (0.05, 0.05), (-0.03, 0), (3, -2)],
)
async def test_it_arrives_within_the_tolerance_and_the_limits(run, target):
    ended = await run((0, 0, 0), target)
    assert ended["state"] == "arrived"
    assert ended["rest"] <= 0.03
    assert ended["worst"] <= 1 + 1e-9
    assert ended["after"] == [0, 0]


@pytest.mark.parametrize("yaw", [math.pi, -math.pi / 2, 7.0])
async def test_it_arrives_whatever_the_heading_was(run, yaw):
    assert (await run((0.5, 0.5, yaw), (0, 0)))["state"] == "arrived"


@pytest.mark.parametrize(
    ("pose", "target", "options", "reason"),
    [
        ((0, 0, 0), (3, 0), {"staleAt": 2}, "no odometry for 0.5 s"),
        ((0, 0, 0), (1, 0), {"obeys": 0}, "no progress for 5 s"),
        ((0, 0, 0), (2, 0), {"obeys": 0.05}, "not there after"),  # too slow
        ((0, 0, 0), ("x", 0), {}, ""),
        (("x", 0, 0), (1, 0), {}, ""),
        # nobody can have pointed at it
        ((1e12, 0, 0), (1, 0), {}, "the target is over 200 m away"),
    ],
)
async def test_an_approach_without_an_arrival_ends_with_its_reason(
    run, pose, target, options, reason
):
    ended = await run(pose, target, **options)
    assert ended["state"] == "failed"
    assert ended["reason"].startswith(reason)
    assert ended["after"] == [0, 0]


# the words about the last of some poses, each [seconds, x, y, yaw]
JUMP = """async (poses) => {
    const { Jumps } = await import("/lab/jumps.js");
    const jumps = new Jumps();
    return poses.map(([time, x, y, yaw]) => jumps.take({ x, y, yaw }, time)).at(-1);
}"""


@pytest.mark.parametrize(
    ("poses", "words"),
    [
        ([[5, 7, 7, 1]], ""),  # the first
        ([[5, 1.28, 0, 0], [5.03, 0.08, 0, 0]], "the odometry jumped by 1.20 m"),
        ([[5, 0, 0, 0], [5.03, 0, 0.15, 0]], ""),  # the one before was late
        ([[5, 0, 0, 0], [5.03, 0, 0.25, 0]], "the odometry jumped by 0.25 m"),
        ([[5, 0, 0, 0], [5.03, 1e12, 0, 0]], "the odometry jumped by 1000000000000.00 m"),
        ([[5, 0, 0, 0], [5.03, 0, 0, math.pi]], "the odometry turned by 180 degrees at once"),
        ([[5, 0, 0, 3.1], [5.03, 0, 0, -3.1]], ""),
        ([[5, 0, 0, 0], [8, 0.9, 0, 3]], ""),  # in so long a robot can be there
        ([[5, 0, 0, 0], [5.03, "x", 0, 0], [5.06, 2, 0, 0]], "the odometry jumped by 2.00 m"),
    ],
)
async def test_a_pose_is_a_jump_where_no_drive_explains_it(evaluate, poses, words):
    assert await evaluate(JUMP, poses) == words


async def test_a_pid_stays_within_its_limit_and_does_not_wind_up(evaluate):
    outputs = await evaluate("""async () => {
        const { Pid } = await import("/lab/pid.js");
        const pid = new Pid({ proportional: 1, integral: 1, derivative: 0 }, 1);
        const outputs = [];
        for (let at = 0; at < 200; at += 1) outputs.push(pid.step(5, at / 10));
        const after = pid.step(-0.5, 20);
        pid.reset();
        return { most: Math.max(...outputs), after, broken: pid.step(NaN, 1) };
    }""")
    assert outputs["most"] == 1
    assert outputs["after"] < 0
    assert outputs["broken"] == 0
