# SPDX-License-Identifier: Apache-2.0
"""The bench of the core, with the front on it."""

from tests.core.conftest import bench, empty

__all__ = ["bench", "empty"]
