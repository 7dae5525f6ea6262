# SPDX-License-Identifier: Apache-2.0
"""Gaps, repetitions and disorder in numbers are found, and only those."""

import pytest

from tests.soak.load import NUMBER_BITS
from tests.soak.sequence import Sequence

SECOND = 1 << NUMBER_BITS  # epoch


def faults(*values: int) -> tuple[int, int, int]:
    sequence = Sequence()
    for value in values:
        sequence.add(value)
    return sequence.missing, sequence.repeated, sequence.disordered


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ((5, 6, 7), (0, 0, 0)),
        ((5, 8), (2, 0, 0)),
        ((5, 5, 6), (0, 1, 0)),
        ((5, 7, 6, 8), (1, 0, 1)),
        ((5, SECOND + 3, SECOND + 4), (0, 0, 0)),
        ((5, SECOND + 3, SECOND + 5), (1, 0, 0)),
        ((SECOND + 3, 5), (0, 0, 1)),
    ],
)
def test_faults_are_counted_within_an_epoch(values, expected):
    assert faults(*values) == expected


def test_a_connection_begins_anywhere():
    sequence = Sequence()
    sequence.add(5)
    sequence.connect()
    sequence.add(9)
    assert sequence.as_json() == {
        "received": 2,
        "epochs": 2,
        "missing": 0,
        "repeated": 0,
        "disordered": 0,
        "spans": {0: (5, 9)},
    }
