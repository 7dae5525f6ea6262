# SPDX-License-Identifier: Apache-2.0
"""The definitions of rosapi_msgs, for machines that have no such package."""

from pathlib import Path


def interfaces_prefix() -> Path:
    """Return the prefix of an `InstalledDefinitions` below which they are."""
    return Path(__file__).parent
