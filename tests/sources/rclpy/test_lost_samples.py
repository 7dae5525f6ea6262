# SPDX-License-Identifier: Apache-2.0
from collections.abc import Sequence

import pytest

from gateway.sources.rclpy.lost_samples import NO_NUMBER, LostSamples


class Reader:
    """Follows numbers as a reader does."""

    def __init__(self) -> None:
        self.publishers = 1
        self.told: list[int] = []
        self.lost = LostSamples(lambda: self.publishers, self.told.append)
        self.expected = NO_NUMBER

    def take(self, *numbers: int | None) -> int:
        for number in numbers:
            if number != self.expected:
                self.expected = self.lost.jump(self.expected, number)
            self.expected += 1
        return self.lost.total


@pytest.mark.parametrize(
    ("numbers", "lost"),
    [
        ([1, 2, 3], 0),
        ([70, 71], 0),  # earlier samples are not lost
        ([1, 2, 5], 2),
        ([5, 7, 9], 2),
        ([8, 9, 1, 2], 0),  # the publisher was started again
        ([8, 9, 1, 4], 2),
        ([None, None, None], 0),  # a middleware without numbers
    ],
)
def test_gaps_in_the_numbers_of_one_publisher_are_counted(numbers: Sequence[int | None], lost: int):
    reader = Reader()
    assert reader.take(*numbers) == lost
    assert sum(reader.told) == lost


def test_numbers_of_several_publishers_say_nothing():
    reader = Reader()
    reader.take(1, 2)
    reader.publishers = 2
    assert reader.take(100, 3, 101, 4) == 0
    reader.publishers = 1  # the one with small numbers has left
    assert reader.take(102) == 0
    assert reader.take(103, 105) == 1


def test_a_publisher_that_left_between_two_samples_is_not_counted():
    reader = Reader()
    reader.publishers = 2
    reader.take(1, 50)
    reader.publishers = 1
    assert reader.take(90) == 0


def test_losses_that_dds_also_counts_are_not_counted_twice():
    reader = Reader()
    reader.take(1, 4)  # 2 of them
    assert reader.lost.take(by_dds=2) == 2
    assert reader.lost.take(by_dds=0) == 0
    assert reader.lost.take(by_dds=3) == 3
    reader.take(9)  # 4 more, 3 of which DDS has told already
    assert reader.lost.take(by_dds=0) == 1
    assert reader.told == [2, 3, 1]
