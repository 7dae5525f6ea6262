# SPDX-License-Identifier: Apache-2.0
"""The configuration, and the sources of its values.

The map is docs/contributing/architecture.md.
"""
