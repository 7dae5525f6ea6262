# SPDX-License-Identifier: Apache-2.0
"""TOML for Python 3.10, which ROS 2 Humble has."""

import sys

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

__all__ = ["tomllib"]
