# SPDX-License-Identifier: Apache-2.0
"""Trees of frames, held to 4x4 matrices where they are whole, and to words where they are not."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gateway.tf import buffer as module
from gateway.tf.buffer import Buffer
from gateway.tf.errors import (
    ExtrapolationError,
    InvalidTransformError,
    LoopError,
    NotConnectedError,
    UnknownFrameError,
)
from gateway.tf.rigid import Rigid
from tests.tf.test_rigid import matrix, rigids

SECOND = 1_000_000_000


def at(x):
    return Rigid(float(x), 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)


def moved(buffer, child, parent, second, x=0.0, *, heard=0):
    stamp_ns = round(second * SECOND)
    heard_ns = round(heard * SECOND)
    return buffer.insert(child, parent, stamp_ns, at(x), heard_ns=heard_ns, is_static=False)


def fixed(buffer, child, parent, x=0.0, *, heard=0):
    return buffer.insert(child, parent, 0, at(x), heard_ns=round(heard * SECOND), is_static=True)


def noted(monkeypatch, name):
    """Return the calls of one of the buffer's methods from now on."""
    calls = []
    method = getattr(Buffer, name)

    def note(*args):
        calls.append(args)
        return method(*args)

    monkeypatch.setattr(Buffer, name, note)
    return calls


@pytest.fixture
def robot():
    """Return map > odom > base_link > laser, of which the latter is fixed. At 1 s and 2 s."""
    buffer = Buffer()
    for second in (1, 2):
        moved(buffer, "odom", "map", second, 100)
        moved(buffer, "base_link", "odom", second, 10 * second)
    fixed(buffer, "laser", "base_link", 1)
    return buffer


@st.composite
def trees(draw):
    """Draw a tree as parents by index, with a transform each. 0 is the root."""
    count = draw(st.integers(2, 12))
    return [
        (draw(st.integers(0, child - 1)), draw(rigids()), draw(st.booleans()))
        for child in range(1, count)
    ]


@given(trees(), st.data())
def test_in_any_tree_any_frame_is_where_the_matrices_say(tree, data):
    buffer = Buffer()
    order = data.draw(st.permutations(range(1, len(tree) + 1)))
    for child in order:
        parent, transform, is_static = tree[child - 1]
        buffer.insert(f"f{child}", f"f{parent}", SECOND, transform, heard_ns=0, is_static=is_static)
    places = {0: np.eye(4)}
    for child, (parent, transform, _) in enumerate(tree, start=1):
        places[child] = places[parent] @ matrix(transform)
    target, source = (data.draw(st.sampled_from(sorted(places))) for _ in range(2))
    found = buffer.lookup(f"f{target}", f"f{source}")
    wanted = np.linalg.inv(places[target]) @ places[source]
    assert np.allclose(matrix(found.transform), wanted, atol=1e-6)


@given(st.lists(rigids(), min_size=2, max_size=2), st.floats(0, 1), rigids())
def test_between_two_samples_a_chain_is_interpolated_link_by_link(ends, ratio, mount):
    buffer = Buffer()
    for second, transform in enumerate(ends):
        buffer.insert("base", "odom", (1 + second) * SECOND, transform, heard_ns=0, is_static=False)
    buffer.insert("laser", "base", 0, mount, heard_ns=0, is_static=True)
    stamp_ns = SECOND + math.floor(ratio * SECOND)
    found = buffer.lookup("odom", "laser", stamp_ns)
    between = ends[0].towards(ends[1], (stamp_ns - SECOND) / SECOND)
    assert found.stamp_ns == stamp_ns
    assert np.allclose(matrix(found.transform), matrix(between) @ matrix(mount), atol=1e-6)


def test_points_go_from_the_source_to_the_target(robot: Buffer):
    assert robot.lookup("map", "laser").transform == at(100 + 20 + 1)
    assert robot.lookup("laser", "map").transform == at(-121)


def test_without_a_time_it_is_the_newest_that_all_frames_have(robot: Buffer):
    moved(robot, "base_link", "odom", 3, 30)
    found = robot.lookup("map", "base_link")
    assert (found.stamp_ns, found.transform) == (2 * SECOND, at(120))
    # frames above both do not matter
    found = robot.lookup("odom", "base_link")
    assert (found.stamp_ns, found.transform) == (3 * SECOND, at(30))


def test_frames_that_are_fixed_to_each_other_need_no_time(robot: Buffer):
    fixed(robot, "camera", "base_link", 2)
    assert robot.lookup("laser", "camera") == (0, at(1))
    assert robot.lookup("laser", "camera", 99 * SECOND) == (99 * SECOND, at(1))


def test_a_frame_is_where_it_is_in_itself(robot: Buffer):
    assert robot.lookup("laser", "laser") == (0, at(0))
    assert robot.lookup("map", "map") == (0, at(0))


def test_a_frame_may_be_handed_from_parent_to_parent():
    buffer = Buffer()
    for second in (1, 4):
        moved(buffer, "table", "map", second, 5)
        moved(buffer, "gripper", "map", second, 9)
    moved(buffer, "cup", "table", 1)
    moved(buffer, "cup", "gripper", 3)
    assert buffer.lookup("map", "cup", 2 * SECOND).transform == at(5)
    assert buffer.lookup("map", "cup", 3 * SECOND).transform == at(9)


def test_the_newest_common_time_may_lie_before_a_change_of_parents():
    buffer = Buffer()
    moved(buffer, "table", "map", 1, 5)
    moved(buffer, "table", "map", 2, 5)
    fixed(buffer, "gripper", "table", 3)
    moved(buffer, "cup", "table", 1, 1)
    moved(buffer, "cup", "gripper", 3, 0)
    found = buffer.lookup("map", "cup")
    assert (found.stamp_ns, found.transform) == (2 * SECOND, at(6))


def test_leading_slashes_do_not_matter(robot: Buffer):
    moved(robot, "/arm", "/base_link", 2, 7)
    assert robot.lookup("/base_link", "arm").transform == at(7)


def test_an_unknown_frame_is_told_with_the_one_that_was_meant(robot: Buffer):
    with pytest.raises(UnknownFrameError) as caught:
        robot.lookup("map", "bas_link")
    assert str(caught.value) == "frame 'bas_link' is unknown; did you mean base_link?"
    with pytest.raises(UnknownFrameError, match=r"'nowhere' is unknown$"):
        robot.lookup("nowhere", "nowhere")
    for target, source in (("map", "nowhere"), ("nowhere", "map")):
        with pytest.raises(UnknownFrameError, match=r"'nowhere' is unknown$"):
            robot.lookup(target, source)


def test_frames_that_are_not_connected_are_told_with_their_trees(robot: Buffer):
    fixed(robot, "lens", "tripod")
    with pytest.raises(NotConnectedError) as caught:
        robot.lookup("laser", "lens")
    assert str(caught.value) == "frames are not connected: map .. laser, tripod .. lens"
    with pytest.raises(NotConnectedError, match=r"map \.\. odom, tripod$"):
        robot.lookup("odom", "tripod")


def test_a_time_without_samples_is_told_with_how_far_the_samples_are(robot: Buffer):
    with pytest.raises(ExtrapolationError) as caught:
        robot.lookup("odom", "laser", round(2.2 * SECOND))
    assert str(caught.value) == "base_link in odom: newest is 0.2 s older than asked"
    assert not caught.value.is_early
    with pytest.raises(ExtrapolationError) as caught:
        robot.lookup("odom", "laser", SECOND // 2)
    assert str(caught.value) == "base_link in odom: oldest is 0.5 s newer than asked"
    assert caught.value.is_early


def test_a_loop_is_told_where_no_frame_is_above_both():
    buffer = Buffer()
    for child, parent in ("ab", "bc", "ca", "da", "xy"):
        moved(buffer, child, parent, 1)
    for target, source in ("xd", "dx"):
        with pytest.raises(LoopError, match=r"frames are in a loop: a in b in c in a$"):
            buffer.lookup(target, source)


def test_a_loop_above_both_frames_does_not_matter(robot: Buffer):
    fixed(robot, "camera", "base_link", 3)
    moved(robot, "map", "odom", 2)
    assert robot.lookup("base_link", "laser").transform == at(1)
    assert robot.lookup("laser", "base_link").transform == at(-1)
    assert robot.lookup("camera", "laser").transform == at(-2)


@pytest.mark.parametrize(
    ("child", "parent", "transform", "reason"),
    [
        ("", "map", at(0), "frame '': it or its parent has no name"),
        ("a", "/", at(0), "frame 'a': it or its parent has no name"),
        ("a", "/a", at(0), "frame 'a': it is said to be in itself"),
        ("a", "map", at(math.nan), "frame 'a': a number is not finite"),
        ("a", "map", Rigid(0, 0, 0, 0, 0, 0, 0), "frame 'a': its quaternion has no direction"),
        ("a" * 257, "map", at(0), "aaa...': it or its parent has a name of over 256 characters"),
        ("a", "b" * 257, at(0), "frame 'a': it or its parent has a name of over 256 characters"),
    ],
)
def test_an_invalid_transform_is_refused_and_changes_nothing(
    robot: Buffer, child, parent, transform, reason
):
    before = robot.revision
    with pytest.raises(InvalidTransformError, match=reason):
        robot.insert(child, parent, SECOND, transform, heard_ns=0, is_static=False)
    assert robot.revision == before


def test_names_of_256_characters_are_accepted(robot: Buffer):
    child, parent = "a" * 256, "b" * 256
    fixed(robot, child, parent, 2)
    assert robot.lookup(parent, child).transform == at(2)


def test_clearing_leaves_what_is_fixed(robot: Buffer):
    robot.clear()
    assert robot.lookup("base_link", "laser").transform == at(1)
    with pytest.raises(UnknownFrameError, match="'map'"):
        robot.lookup("map", "laser")
    robot.forget()
    with pytest.raises(UnknownFrameError, match="'base_link'"):
        robot.lookup("base_link", "laser")


def test_a_revision_tells_that_an_answer_may_have_changed(robot: Buffer):
    before = robot.revision
    fixed(robot, "laser", "base_link", 1)
    moved(robot, "odom", "map", 2, 100)
    assert robot.revision == before
    fixed(robot, "laser", "base_link", 2)
    assert robot.revision > before


def test_an_answer_is_worked_out_once_per_revision(robot: Buffer, monkeypatch: pytest.MonkeyPatch):
    worked_out = noted(monkeypatch, "_paths")
    first = robot.lookup("map", "laser")
    count = len(worked_out)
    assert robot.lookup("/map", "laser") == first
    assert len(worked_out) == count
    assert robot.lookup("map", "base_link").transform == at(120)
    moved(robot, "base_link", "odom", 2.5, 50)
    moved(robot, "odom", "map", 2.5, 100)
    assert robot.lookup("map", "laser").transform == at(151)


def test_answers_are_bounded():
    buffer = Buffer()
    for number in range(30):
        fixed(buffer, f"frame_{number}", "map", 1)
    names = [f"frame_{number}" for number in range(30)]
    most = 0
    for target, source in itertools.product(names, names):
        buffer.lookup(target, source)
        most = max(most, len(buffer._answers))
    assert most == 512


def test_a_moving_frame_stays_moving_when_it_is_called_fixed(robot: Buffer):
    assert not fixed(robot, "base_link", "odom", 7, heard=1)
    assert robot.lookup("odom", "base_link", 3 * SECOND // 2).transform == at(15)
    # once it has ceased, it counts
    assert fixed(robot, "base_link", "odom", 7, heard=11)
    assert robot.lookup("odom", "base_link") == (0, at(7))


def test_a_fixed_frame_moves_when_it_is_published_as_moving(robot: Buffer):
    assert not moved(robot, "laser", "base_link", 2, 5)
    assert moved(robot, "laser", "base_link", 3, 6)
    assert robot.lookup("base_link", "laser") == (3 * SECOND, at(6))


def test_frames_are_bounded_and_those_that_ceased_make_room(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(module, "MAX_FRAMES", 4)
    buffer = Buffer()
    fixed(buffer, "laser", "base")
    moved(buffer, "person_1", "base", 1, heard=1)
    moved(buffer, "person_2", "base", 9999, heard=2)  # by a clock that is wrong
    with pytest.raises(InvalidTransformError, match="'person_3': at most 4 frames are kept"):
        moved(buffer, "person_3", "base", 3, heard=3)
    moved(buffer, "person_2", "base", 9999, heard=10)
    before = buffer.revision
    moved(buffer, "person_3", "base", 12, heard=11.5)
    assert buffer.revision > before
    assert buffer.lookup("laser", "person_3").stamp_ns == 12 * SECOND
    assert buffer.lookup("laser", "person_2").stamp_ns == 9999 * SECOND
    with pytest.raises(UnknownFrameError, match="person_1"):
        buffer.lookup("laser", "person_1")


def test_too_many_frames_are_refused_without_a_sweep_for_each(monkeypatch: pytest.MonkeyPatch):
    sweeps = noted(monkeypatch, "_keep")
    buffer = Buffer()
    for number in range(module.MAX_FRAMES - 1):
        moved(buffer, f"frame_{number}", "base", 1, heard=1)

    def refused(heard):
        count = 0
        for number in range(600):
            try:
                moved(buffer, f"frame_{number}", "base", heard, heard=heard)
            except InvalidTransformError:
                count += 1
        return count

    assert refused(heard=2) == 600 - 511
    assert len(sweeps) == 1
    assert refused(heard=2.9) == 600 - 511
    assert len(sweeps) == 1
    assert refused(heard=3) == 600 - 511
    assert len(sweeps) == 2
    assert buffer.lookup("base", "frame_510").stamp_ns == 3 * SECOND
