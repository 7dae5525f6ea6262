# SPDX-License-Identifier: Apache-2.0
"""Pictures that become smaller and larger with the link."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gateway.core.topics.picture_adaptation import (
    MAX_HOLD_S,
    ROOM,
    STEPS,
    PictureAdaptation,
)

WHOLE = 50_000
PERIOD_NS = 50_000_000


class Camera:
    """Pictures of one size, as they are sent to one client."""

    def __init__(self) -> None:
        self.adaptation = PictureAdaptation()
        self.now_ns = 0
        self.changes = 0

    def send(self, bytes_per_s: float | None, count: int = 1, whole: int = WHOLE) -> int:
        """Send pictures. Return the size of the last one."""
        size = 0
        for _ in range(count):
            self.now_ns += PERIOD_NS
            size = round(whole * self.adaptation.step.part)
            self.changes += self.adaptation.sent(size, bytes_per_s, self.now_ns)
        return size


def test_steps_become_smaller_and_the_first_is_as_asked_for():
    assert STEPS[0] == (100, 1, 1.0)
    assert all(larger.part > smaller.part for larger, smaller in pairwise(STEPS))
    assert all(larger.reduction <= smaller.reduction for larger, smaller in pairwise(STEPS))


def test_on_a_link_that_never_was_full_pictures_are_as_asked_for():
    camera = Camera()
    assert camera.send(None, 100) == WHOLE
    assert camera.changes == 0


def test_a_picture_that_holds_up_the_rest_is_followed_by_one_that_does_not():
    for bytes_per_s in (50e3, 250e3, 500e3):
        camera = Camera()
        camera.send(bytes_per_s)
        assert camera.changes == 1
        assert camera.send(bytes_per_s) <= bytes_per_s * MAX_HOLD_S
        camera.send(bytes_per_s, 100)
        assert camera.changes == 1


def test_pictures_become_larger_one_step_after_the_other_while_they_would_fit():
    camera = Camera()
    camera.send(50e3, 2)
    small = STEPS.index(camera.adaptation.step)
    begin_ns = camera.now_ns
    sizes = [camera.send(5e6) for _ in range(1000)]
    assert sizes[-1] == WHOLE
    assert camera.changes == 1 + small
    first = next(number for number, size in enumerate(sizes) if size > sizes[0])
    assert first * PERIOD_NS >= 2_000_000_000
    del begin_ns


def test_a_larger_one_is_not_tried_without_room():
    camera = Camera()
    camera.send(250e3, 2)
    step = STEPS.index(camera.adaptation.step)
    just = WHOLE * STEPS[step - 1].part / MAX_HOLD_S / ROOM
    camera.send(just * 0.99, 1000)
    assert camera.changes == 1
    camera.send(just * 1.01, 50)
    assert camera.changes == 2


def test_room_for_a_moment_does_not_make_pictures_larger():
    camera = Camera()
    camera.send(50e3, 2)
    for _ in range(100):
        camera.send(5e6, 2_000_000_000 // PERIOD_NS - 1)
        camera.send(50e3)
    assert camera.changes == 1


# the size of a picture by its quality, relative to quality 80, and by its reduction
BY_QUALITY = {95: 2.2, 90: 1.6, 80: 1.0, 65: 0.67, 60: 0.62, 50: 0.5, 40: 0.46, 30: 0.4, 20: 0.3}
BY_REDUCTION = {1: 1.0, 2: 0.34, 4: 0.145, 8: 0.08}


@pytest.mark.parametrize("asked", [20, 30, 40, 50, 60, 65, 80, 90, 95])
def test_pictures_of_any_quality_settle_on_a_step(asked: int):
    for bytes_per_s in range(20_000, 2_000_000, 5_000):
        adaptation = PictureAdaptation()
        late_changes = 0
        for number in range(600):  # half a minute
            step = adaptation.step
            quality = min(asked, step.quality)
            size = round(WHOLE * BY_QUALITY[quality] * BY_REDUCTION[step.reduction])
            changed = adaptation.sent(size, bytes_per_s, number * PERIOD_NS)
            late_changes += changed and number > 300
        assert late_changes == 0, bytes_per_s


@given(st.lists(st.tuples(st.integers(1, 10**7), st.floats(1, 1e9)), max_size=60))
def test_a_picture_that_is_too_large_is_never_followed_by_a_larger_step(
    frames: list[tuple[int, float]],
):
    adaptation = PictureAdaptation()
    for number, (size, bytes_per_s) in enumerate(frames):
        before = STEPS.index(adaptation.step)
        adaptation.sent(size, bytes_per_s, number * PERIOD_NS)
        if size > bytes_per_s * MAX_HOLD_S:
            assert STEPS.index(adaptation.step) > before or before == len(STEPS) - 1


def test_a_dark_picture_after_a_change_does_not_keep_the_next_ones_small():
    camera = Camera()
    camera.send(250e3)
    assert camera.adaptation.step is not STEPS[0]
    camera.send(250e3, whole=100)  # of which the step seems to have left next to nothing
    assert camera.send(10 * WHOLE / MAX_HOLD_S / ROOM, 1000) == WHOLE


def test_frames_of_the_step_before_are_not_judged():
    camera = Camera()
    camera.send(250e3)
    step = camera.adaptation.step
    camera.adaptation.stepped(2)
    for _ in range(2):
        assert not camera.adaptation.sent(WHOLE, 250e3, camera.now_ns)
    assert camera.adaptation.step is step
    assert camera.adaptation.sent(WHOLE, 250e3, camera.now_ns)


def test_the_smallest_is_sent_on_however_slow_a_link():
    camera = Camera()
    camera.send(10.0, 3)
    assert camera.adaptation.step is STEPS[-1]


@given(st.lists(st.tuples(st.integers(1, 10**7), st.none() | st.floats(1, 1e9)), max_size=60))
def test_there_is_a_step_for_all_sizes(frames: list[tuple[int, float | None]]):
    adaptation = PictureAdaptation()
    for number, (size, bytes_per_s) in enumerate(frames):
        before = adaptation.step
        has_changed = adaptation.sent(size, bytes_per_s, number * PERIOD_NS)
        assert has_changed == (adaptation.step is not before)
        assert adaptation.step in STEPS
