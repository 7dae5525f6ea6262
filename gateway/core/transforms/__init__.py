# SPDX-License-Identifier: Apache-2.0
"""Transforms: lookups, once or periodic, in the tf tree, and what tf2_web_republisher answers."""
