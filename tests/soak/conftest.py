# SPDX-License-Identifier: Apache-2.0
"""Puts the soak before all other tests: it takes the longest, and mostly waits."""

import pytest

from tests.soak import test_soak


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Have the first worker begin with it; the others take over the rest of that worker's tests."""
    items.sort(key=lambda item: item.path.name != test_soak.FILE)
