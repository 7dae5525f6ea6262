# SPDX-License-Identifier: Apache-2.0
"""Pauses are kept, and a pause of a control is not a pause of the gateway."""

import pytest

from tests.soak.silences import Silences, beyond_control


def test_a_pause_is_kept_and_the_last_one_lasts():
    silences = Silences()
    for now_s in (1.0, 1.1, 3.0, 3.1):
        silences.hear(now_s)
    first, last = silences.so_far()
    assert (first, last[0], silences.count) == ((1.1, 3.0), 3.1, 4)


@pytest.mark.parametrize(
    ("control", "expected"),
    [
        ([], 4.0),
        ([(0.0, 9.0)], 4.0),
        ([(11.0, 13.0)], 2.0),
        ([(9.0, 11.0), (12.0, 12.5)], 2.5),
        ([(10.0, 14.0)], 0.0),
        ([(11.0, 13.0), [9.0, 12.0]], 1.0),
        ([(9.0, 15.0), (11.0, 12.0)], 0.0),
    ],
)
def test_the_pauses_of_the_control_are_taken_off(control, expected):
    assert beyond_control((10.0, 14.0), control) == expected
