# SPDX-License-Identifier: Apache-2.0
"""The definitions of rosapi_msgs, for machines without that package."""

from pathlib import Path


def interfaces_prefix() -> Path:
    """Return the prefix that contains them, for an `InstalledDefinitions`."""
    return Path(__file__).parent
