# SPDX-License-Identifier: Apache-2.0
"""A node next to the gateway, for tests of whole systems."""

import contextlib
from collections.abc import Iterator

import pytest

from tests.sources.outside import Outside


@pytest.fixture
def outside() -> Iterator[Outside]:
    """Yield another node, by plain rclpy."""
    with contextlib.closing(Outside()) as outside:
        yield outside
