# SPDX-License-Identifier: Apache-2.0
"""A robot that publishes frames, and a client, as the core's transforms have them."""

from tests.core.transforms.conftest import client, looks, robot

__all__ = ["client", "looks", "robot"]
