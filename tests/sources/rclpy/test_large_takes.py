# SPDX-License-Identifier: Apache-2.0
"""The thread that takes large samples, without DDS."""

from typing import Any, cast

from gateway.sources.rclpy.large_takes import LargeTakes
from gateway.sources.source import Sample
from tests.client import TIMEOUT_S


def test_four_samples_are_taken_at_once_however_many_there_are():
    takes = LargeTakes()
    takes._take = lambda *_: Sample(b"", 0, 0, 1)
    take = takes.start(cast("Any", None), object, lambda: None)
    assert len(take.result.result(TIMEOUT_S).samples) == 4
    takes.close()
